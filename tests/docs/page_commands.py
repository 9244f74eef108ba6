#!/usr/bin/env python3
# GPL-2.0-or-later. Runs every command line of the pages for mappers, as a reader would, on a small map.
"""usage: page_commands.py PROGRAM SOURCE_FOLDER

A command is an indented or fenced line that begins with q3map2. Each page starts with a fresh game folder in which
maps/mymap.map is compiled; its commands run in their order, in the folder that the page last changed to (cd), else in
that of the game or of the mod that they name; mkdir is followed too. /games/quake3 in a page is that game; another /games/NAME that a page changes to is a copy of it.

Commands with a word in capitals (DIR, MOD) are patterns, and -watch runs until it is stopped: these do not run. Like
all others, and like those in running text, they may only use options that the program has.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

# Pages whose commands run: those for mappers and engine programmers, and how the stages work.
RUN = ["README.md", "docs/guide/*.md", "docs/engines/*.md", "docs/reference/json.md", "docs/reference/report.md",
       "docs/internals/bsp.md", "docs/internals/vis.md", "docs/internals/lightmaps.md", "docs/internals/sh_grid.md"]
# Their commands are for editors and other systems: only their options are checked, as on all other pages.
CHECKED = ["docs/guide/editors.md"]
COMMAND = re.compile(r"^(?: {4,}|\t)?((?:build/bin/)?q3map2(?: .*)?)$")
INLINE = re.compile(r"`((?:build/bin/)?q3map2 [^`]*)`")
PATTERN_WORD = re.compile(r"^[A-Z][A-Z0-9_]*(\.[a-z0-9]+)?$")
SECONDS = 900 # a command that hangs; with sanitizers, they take over a minute

SHADERS = """textures/t/wall
{
	{
		map $whiteimage
		rgbGen exactVertex
	}
}
textures/t/lamp
{
	q3map_surfaceLight 2000
	{
		map $whiteimage
	}
}
"""


def box(low, high, shader):
    """A brush."""
    (a, b, c), (d, e, f) = low, high
    planes = [((a, b, f), (a, e, f), (d, b, f)), ((a, b, c), (d, b, c), (a, e, c)),
              ((d, b, c), (d, b, f), (d, e, c)), ((a, b, c), (a, e, c), (a, b, f)),
              ((a, e, c), (d, e, c), (a, e, f)), ((a, b, c), (a, b, f), (d, b, c))]
    sides = ["".join("( %d %d %d ) " % point for point in plane) + f"{shader} 0 0 0 0.5 0.5 0 0 0" for plane in planes]
    return "{\n" + "\n".join(sides) + "\n}\n"


def room():
    """Map source: a room with a lamp in its ceiling, a pillar, a light and a player."""
    half, high, thick = 192, 128, 16
    walls = [((-half, -half, -thick), (half, half, 0)), ((-half, -half, high), (half, half, high + thick)),
             ((-half - thick, -half, 0), (-half, half, high)), ((half, -half, 0), (half + thick, half, high)),
             ((-half, -half - thick, 0), (half, -half, high)), ((-half, half, 0), (half, half + thick, high)),
             ((-32, 64, 0), (0, 96, high))]
    brushes = "".join(box(low, high, "t/wall") for low, high in walls) + box((64, 64, 112), (128, 128, 120), "t/lamp")
    entities = [("light", "-100 -100 96", '"light" "200"'), ("info_player_deathmatch", "0 0 32", '"angle" "90"')]
    return ('{\n"classname" "worldspawn"\n' + brushes + "}\n"
            + "".join(f'{{\n"classname" "{name}"\n"origin" "{at}"\n{more}\n}}\n' for name, at, more in entities))


def is_same(a, b):
    """Whether two values are one word or one number, such as 1 and 1.0."""
    try:
        return float(a) == float(b)
    except ValueError:
        return a == b


class Reader:
    """Commands of a page and the folders in which to follow them."""

    def __init__(self, program, scratch):
        self.program = program
        self.game = scratch / "quake3"
        self.home = scratch / "home"
        self.ready = scratch / "ready"
        self.failures = []
        self.defaults = {}  # of options, by stage
        self.options = self.known_options()
        self.prepare()

    def call(self, words, folder):
        return subprocess.run([self.program, *words], cwd=folder, capture_output=True, text=True, errors="replace",
                              timeout=SECONDS, env={**os.environ, "HOME": str(self.home)})

    def known_options(self):
        """Options by stage, in lower case, from the reference pages; those of all stages are under ''."""
        help_of = {name: self.call(["-help", f"{name}.md"], "/").stdout
                   for name in ("command_line", "bsp", "vis", "light", "other_stages")}
        options = {word: set() for word in re.findall(r"^\| \[(-\w+)\]\(", help_of["command_line"], re.MULTILINE)}
        for name, text in help_of.items():
            stage = {"command_line": "", "other_stages": None}.get(name, f"-{name}")
            names = []
            for line in text.splitlines():
                if name == "other_stages" and (heading := re.match(r"## (-\S+)", line)):
                    stage = heading.group(1)
                elif entry := re.match(r"#{3,4} (-\S+)|((?:`-[^`]+`(?:, )?)+)$", line):
                    # An entry: its heading, and then its usage with all names.
                    names = [entry.group(1)] if entry.group(1) else re.findall(r"`(--?[^` ]+)", line)
                    names = [word.lower() for word in names]
                    options.setdefault(stage, set()).update(names)
                    self.defaults.setdefault(stage, {}).update((word, "") for word in names)
                elif default := re.match(r"- Default: (.*)", line):
                    self.defaults[stage].update((word, default.group(1)) for word in names)
        return options

    def prepare(self):
        """The game folder that each page finds, with a mod folder beside it that holds the same map."""
        base = self.ready / "baseq3"
        for folder in (base / "maps", base / "scripts", base / "shaders", self.home):
            folder.mkdir(parents=True)
        (base / "maps/mymap.map").write_text(room())
        for scripts in ("scripts", "shaders"):  # the second is that of Jedi Academy
            (base / scripts / "t.shader").write_text(SHADERS)
        for words in (["-meta"], ["-vis", "-saveprt"], ["-light"]):
            done = self.call(["-fs_basepath", str(self.ready), *words, "maps/mymap.map"], base)
            if done.returncode:
                sys.exit(f"the map of this test does not compile:\n{done.stdout}")
        maps = base / "maps"
        (maps / "mymap.aas").write_bytes(b"EAAS\5\0\0\0abcdareas")
        (maps / "mymap.ent").write_text("")
        for name in ("a", "b"):
            shutil.copy(maps / "mymap.bsp", maps / f"{name}.bsp")
        shutil.copy(maps / "mymap.bsp", base / "some.bsp")
        for mod in ("relit", "mymod"):
            shutil.copytree(base, self.ready / mod)
        (self.ready / "relit/maps/mymap.srf").unlink()  # a downloaded map, with its light entities

    @staticmethod
    def words_of(command):
        """As a shell splits it; what stands two blanks further is a remark. Menus of editors may have odd quotes."""
        command = re.sub(r"\s{2,}.*", "", command)
        try:
            return shlex.split(command)[1:]
        except ValueError:
            return command.split()[1:]

    def in_scratch(self, word):
        """A path below /games as one of the scratch folder."""
        return re.sub(r"^/games(?=/)", str(self.game.parent), word)

    def check_effect(self, where, command, words, log):
        """Each option that is not at its default is among the settings that the run lists, or in a warning."""
        stage = next((word.lower() for word in words if word.lower() in self.options), "-bsp")
        for word, value in zip(words, [*words[1:], ""]):
            known = self.defaults.get(stage, {}).get(word.lower())
            if known is None or "by game" in known or is_same(known, "on" if value.startswith("-") else value):
                continue
            if not re.search(rf"(  |WARNING: .*){word} ", log):
                self.failures.append(f"{where}: {command}\n  {word} shows no effect")

    def check_options(self, where, words):
        stage = next((word.lower() for word in words if word.lower() in self.options), "-bsp")
        known = self.options[stage] | self.options[""]
        if stage == "-shreport" and "-explain" in words:  # explains a run of the light stage
            known = known | self.options["-light"]
        for before, word in zip(["", *words], words):
            name = word.lower()
            if stage == "-watch" and before.endswith("options"):  # options of another stage
                continue
            is_option = name.startswith("-") and not re.match(r"-[\d.]", name)
            if is_option and name != stage and name not in known:
                self.failures.append(f"{where}: {stage} has no option {word}")

    def run(self, where, command, words):
        mods = [words[i + 1] for i, word in enumerate(words[:-1]) if word == "-fs_game"]
        folder = self.folder or self.game / (mods[0] if mods else "baseq3")
        try:
            done = self.call([self.in_scratch(word) for word in words], folder)
        except subprocess.TimeoutExpired:
            self.failures.append(f"{where}: {command}\n  takes over {SECONDS} s")
            return
        if not done.returncode and where.startswith("from_q3map2.md"):
            self.check_effect(where, command, words, done.stdout)
        if done.returncode or "WARNING: Unknown" in done.stdout:
            text = "\n  ".join(done.stdout.splitlines()[-12:])
            self.failures.append(f"{where}: {command}\n  exit status {done.returncode}\n  {text}")

    def read(self, page, may_run):
        """Follows a page. Returns how many commands ran, and how many were checked only."""
        for folder in self.game.parent.iterdir():
            if folder not in (self.home, self.ready):
                shutil.rmtree(folder)
        shutil.copytree(self.ready, self.game)
        ran = checked = 0
        fenced = False
        self.folder = None
        for number, line in enumerate(page.read_text().splitlines(), 1):
            fenced ^= line.lstrip().startswith("```")
            where = f"{page.name}:{number}"
            if change := re.match(r" {4}cd (\S+)$", line):
                self.folder = Path(self.in_scratch(change.group(1)))
                if not self.folder.exists():
                    shutil.copytree(self.ready / "baseq3", self.folder)
            if made := re.match(r" {4}mkdir -p (\S+)$", line):
                (self.folder / self.in_scratch(made.group(1))).mkdir(parents=True, exist_ok=True)
            found = COMMAND.match(line)
            is_command = found and (fenced or line[:1] in " \t")
            for command in [found.group(1)] if is_command else INLINE.findall(line):
                words = self.words_of(command)
                self.check_options(where, words)
                ends = "-watch" not in words
                if is_command and may_run and ends and not any(PATTERN_WORD.match(word) for word in words):
                    self.run(where, command, words)
                    ran += 1
                else:
                    checked += 1
        return ran, checked


def main():
    program, source = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        reader = Reader(str(program), Path(folder))
        total = 0
        for pattern in RUN + CHECKED:
            if not any(source.glob(pattern)):
                sys.exit(f"no page is called {pattern}")
        run = {page for pattern in RUN for page in source.glob(pattern)} - {source / name for name in CHECKED}
        for page in sorted({source / "README.md", source / "CONTRIBUTING.md", *source.glob("docs/**/*.md")}):
            ran, checked = reader.read(page, page in run)
            if ran or checked:
                print(f"{page.relative_to(source)}: {ran} commands ran, {checked} checked")
            total += ran
    if total < 150:
        reader.failures.append(f"{total} commands found: the pages are not read as they are written")
    print("\n".join(reader.failures) or "no failures")
    return 1 if reader.failures else 0


if __name__ == "__main__":
    sys.exit(main())
