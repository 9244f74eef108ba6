#!/usr/bin/env python3
# GPL-2.0-or-later. Runs the build lines of projects and checks that their files are what the lines ask for.
"""usage: build_lines.py PROGRAM SOURCE_FOLDER

The lines are those of "Build lines of projects" in docs/guide/from_q3map2.md and those of LINES. Each cd finds a fresh game folder
with a small map. What a line asks for follows from its options; FAULTS says what is checked in each stage. Lines of games
that the program does not know are left out.
"""

import re
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from page_commands import box

# Lines of projects that are not on the page.
LINES = """
    cd /games/smokinguns/src
    mkdir -p build/maps
    q3map2 -fs_nobasepath -fs_nohomepath -fs_nomagicpath -fs_basepath /games/smokinguns -fs_game smokinguns -fs_pakpath . -prtfile build/m.prt -srffile build/m.srf -bspfile build/maps/mymap.bsp -linfile build/m.lin -fastmeta -custinfoparms maps/mymap.map -bsp
    q3map2 -fs_nobasepath -fs_nohomepath -fs_nomagicpath -fs_basepath /games/smokinguns -fs_game smokinguns -fs_pakpath . -prtfile build/m.prt -bspfile build/maps/mymap.bsp maps/mymap.map -vis
    q3map2 -fs_nobasepath -fs_nohomepath -fs_nomagicpath -fs_basepath /games/smokinguns -fs_game smokinguns -fs_pakpath . -srffile build/m.srf -bspfile build/maps/mymap.bsp -faster -backsplasharea 2 -lightmapsize 256 -external maps/mymap.map -light
    cd /games/urbanterror/q3ut4
    q3map2 -fs_basepath /games/urbanterror -fs_game q3ut4 -meta -patchmeta -subdivisions 1 -custinfoparms maps/mymap.map
    q3map2 -fs_basepath /games/urbanterror -fs_game q3ut4 -vis -saveprt maps/mymap.map
    q3map2 -fs_basepath /games/urbanterror -fs_game q3ut4 -light -nocollapse -fast -filter -bounce 3 -patchshadows -gamma 1.7 -samples 2 maps/mymap.map
    cd /games/xonotic/data
    q3map2 -game xonotic -fs_basepath /games/xonotic -bsp -meta -maxarea -samplesize 8 -mv 1000000 -mi 6000000 -custinfoparms -keeplights maps/mymap.map
    q3map2 -game xonotic -fs_basepath /games/xonotic -vis maps/mymap.map
    q3map2 -game xonotic -fs_basepath /games/xonotic -light -custinfoparms -sRGBlight -sRGBtex -sRGBcolor -deluxe -patchshadows -samples 4 -lightmapsize 512 -bounce 2 -bouncegrid -fill maps/mymap.map
    q3map2 -game xonotic -fs_basepath /games/xonotic -minimap -size 256 -samples 4 -sharpen 1 -border 0.02 -autolevel -o ../data/gfx/mini.tga maps/mymap.bsp
"""

# ---- The map and its game folder ----

NO_WALL_JUMP = 0x80000
SHADERS = """textures/t/wall
{
	surfaceparm nowalljump
	{
		map $whiteimage
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
PATCH = """{
patchDef2
{
t/curve
( 3 3 0 0 0 )
(
( ( -64 -64 0 0 0 ) ( -64 -64 32 0 0.5 ) ( -64 -64 64 0 1 ) )
( ( -64 0 0 0.5 0 ) ( -64 0 32 0.5 0.5 ) ( -64 0 64 0.5 1 ) )
( ( 0 0 0 1 0 ) ( 0 0 32 1 0.5 ) ( 0 0 64 1 1 ) )
)
}
}
"""
# Six planes show, one of them on two brushes; the curve is one more surface.
FACES, PLANES = 7, 6


def room():
    """Map source: a room whose floor is of two brushes, with a lamp for its ceiling, a curve, a light and a player."""
    half, high, thick = 192, 128, 16
    walls = [((-half, -half, -thick), (0, half, 0)), ((0, -half, -thick), (half, half, 0)),
             ((-half - thick, -half, 0), (-half, half, high)), ((half, -half, 0), (half + thick, half, high)),
             ((-half, -half - thick, 0), (half, -half, high)), ((-half, half, 0), (half, half + thick, high))]
    brushes = "".join(box(low, high, "t/wall") for low, high in walls)
    brushes += box((-half, -half, high), (half, half, high + thick), "t/lamp")
    entities = [("light", "-100 -100 96", '"light" "200"'), ("info_player_deathmatch", "0 0 32", '"angle" "90"')]
    return ('{\n"classname" "worldspawn"\n' + brushes + PATCH + "}\n"
            + "".join(f'{{\n"classname" "{name}"\n"origin" "{at}"\n{more}\n}}\n' for name, at, more in entities))


def make_game_folder(folder):
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "maps").mkdir(parents=True)
    for scripts in ("scripts", "shaders"):  # the second is that of Jedi Academy
        (folder / scripts).mkdir()
        (folder / scripts / "t.shader").write_text(SHADERS)
    (folder / "maps/mymap.map").write_text(room())
    (folder / "scripts/custinfoparms.txt").write_text(f"{{\n}}\n{{\nnowalljump {NO_WALL_JUMP:x}\n}}\n")


# ---- What a .bsp holds ----

@dataclass
class Layout:
    """Sizes of records in bytes and places in them."""
    version: int
    ident: bytes = b"IBSP"
    surface: int = 104
    lightmap_number: int = 28
    page: int = 128
    least_pages: int = 1  # in a file that has any


RBSP = Layout(1, b"RBSP", surface=148, lightmap_number=36, least_pages=2)
FBSP = Layout(1, b"FBSP", surface=148, lightmap_number=36, page=512)


class Bsp:
    ENTITIES, SHADERS, SURFACES, LIGHTMAPS, VISIBILITY = 0, 1, 13, 14, 16
    PATCH = 2

    def __init__(self, path, layout):
        self.bytes = path.read_bytes()
        self.ident, self.version = struct.unpack_from("<4si", self.bytes)
        self.layout = layout
        self.entities = self.lump(self.ENTITIES).decode("latin-1")
        names = [self.shader(number) for number in self.numbers_of_surfaces(0)]
        self.surfaces = list(zip(names, self.numbers_of_surfaces(8)))  # shader and kind of each
        self.lightmap_numbers = [n for n in self.numbers_of_surfaces(layout.lightmap_number) if n >= 0]
        self.pages = len(self.lump(self.LIGHTMAPS)) / (3 * layout.page ** 2)

    def lump(self, number):
        offset, length = struct.unpack_from("<2i", self.bytes, 8 + 8 * number)
        return self.bytes[offset:offset + length]

    def numbers_of_surfaces(self, place):
        lump = self.lump(self.SURFACES)
        return [struct.unpack_from("<i", lump, at + place)[0] for at in range(0, len(lump), self.layout.surface)]

    def shader(self, number):
        return self.lump(self.SHADERS)[72 * number:72 * number + 64].rstrip(b"\0").decode("latin-1")

    def surface_flags(self, shader):
        lump = self.lump(self.SHADERS)
        flags = {self.shader(n): struct.unpack_from("<i", lump, 72 * n + 64)[0] for n in range(len(lump) // 72)}
        return flags.get(shader, 0)

    def has_light(self):
        return '"classname" "light"' in self.entities


@dataclass
class Game:
    layout: Layout = field(default_factory=lambda: Layout(46))
    minimap: str = "{}.tga"  # from the folder of the map
    keeps_lights: bool = False  # light entities, without -keeplights
    deluxe: bool = False  # without -deluxe


# By the name of -game.
GAMES = {
    "quake3": Game(), "tremulous": Game(),
    "quakelive": Game(Layout(47)), "et": Game(Layout(47)), "wolf": Game(Layout(47)),
    "nexuiz": Game(minimap="../gfx/{}_mini.tga", keeps_lights=True),
    "xonotic": Game(minimap="../gfx/{}_mini.tga", keeps_lights=True),
    "unvanquished": Game(minimap="../minimaps/{}.tga", keeps_lights=True),
    "ja": Game(RBSP),
    "qfusion": Game(FBSP, "../minimaps/{}.tga", keeps_lights=True, deluxe=True),
}


# ---- What lines ask for ----

class Line:
    """A command that ran without an error, and where its files are."""

    def __init__(self, words, folder):
        self.words, self.folder = words, folder
        self.game = GAMES[self.value("-game", "quake3")]
        stages = [word for word in words if word in ("-bsp", "-vis", "-light", "-minimap")]
        self.stage = stages[0] if stages else "-bsp"
        self.map = self.path(words[-1])
        self.bsp_path = self.placed("-bspfile", ".bsp")

    def value(self, option, default=None):
        return self.words[self.words.index(option) + 1] if option in self.words else default

    def path(self, word):
        return self.folder / word

    def placed(self, option, extension):
        """The file that the option places, else the one beside the map."""
        word = self.value(option)
        return self.path(word) if word else self.map.with_suffix(extension)

    def bsp(self):
        return Bsp(self.bsp_path, self.game.layout)

    def images(self):
        """Width and height of the lightmap images, by their order."""
        files = sorted(self.bsp_path.with_suffix("").glob("lm_*.tga"))
        return [struct.unpack_from("<2H", file.read_bytes(), 12) for file in files]


def faults_of_bsp(line):
    """The bsp stage: its files, the surfaces of -meta, keys and flags."""
    bsp = line.bsp()
    flat = sum(name != "textures/t/curve" for name, _ in bsp.surfaces)
    pieces = sum(name == "textures/t/curve" and kind != Bsp.PATCH for name, kind in bsp.surfaces)
    merges = bool({"-meta", "-fastmeta", "-patchmeta"} & set(line.words))
    keeps_lights = line.game.keeps_lights or "-keeplights" in line.words
    flags = bsp.surface_flags("textures/t/wall")
    return [
        ((bsp.ident, bsp.version) == (line.game.layout.ident, line.game.layout.version),
         f"{bsp.ident} of version {bsp.version}"),
        (line.placed("-srffile", ".srf").is_file(), "no .srf"),
        (line.placed("-prtfile", ".prt").is_file(), "no .prt"),
        (not line.placed("-linfile", ".lin").exists(), "a .lin, without a leak"),
        (flat == (PLANES if merges else FACES), f"{flat} flat surfaces"),
        ((pieces > 0) == ("-patchmeta" in line.words), f"-patchmeta: {pieces} surfaces of triangles of the curve"),
        (bsp.has_light() == keeps_lights, "light entities"),
        ((flags & NO_WALL_JUMP != 0) == ("-custinfoparms" in line.words), f"-custinfoparms: flags {flags:x}"),
    ]


def faults_of_vis(line):
    return [(len(line.bsp().lump(Bsp.VISIBILITY)) > 8, "no visibility"),
            (line.placed("-prtfile", ".prt").exists() == ("-saveprt" in line.words), "-saveprt")]


def faults_of_light(line):
    """The light stage: pages in the file or as images, their size, and pages of directions behind them."""
    bsp, images = line.bsp(), line.images()
    used = set(bsp.lightmap_numbers)
    size = int(line.value("-lightmapsize", line.game.layout.page))
    is_external = "-external" in line.words or size != line.game.layout.page
    pages = len(images) if is_external else bsp.pages
    least = 0 if is_external else line.game.layout.least_pages
    step = 2 if "-deluxe" in line.words or line.game.deluxe else 1
    return [(used, "no surface has a lightmap"),
            (pages == max(least, step * (max(used, default=0) // step + 1)), f"{pages} pages, lightmaps {sorted(used)}"),
            (all(number % step == 0 for number in used), f"-deluxe: lightmaps {sorted(used)}"),
            (bool(images) == is_external, f"{len(images)} images"),
            (not is_external or not bsp.lump(Bsp.LIGHTMAPS), "lightmaps in the file besides images"),
            (all(image == (size, size) for image in images), f"images of {images}")]


def faults_of_minimap(line):
    image = line.path(line.value("-o")) if "-o" in line.words else (
        line.bsp_path.parent / line.game.minimap.format(line.bsp_path.stem))
    if not image.is_file():
        return [(False, f"no {image}")]
    size = int(line.value("-size", 512))
    written = struct.unpack_from("<2H", image.read_bytes(), 12)
    return [(written == (size, size), f"an image of {written}")]


FAULTS = {"-bsp": faults_of_bsp, "-vis": faults_of_vis, "-light": faults_of_light, "-minimap": faults_of_minimap}


# ---- Running them ----

def lines_of(text):
    """Indented lines: commands, and the folders that they run in."""
    return [line.strip() for line in text.splitlines() if re.match(r" {4}(q3map2|cd|mkdir) ", line)]


def known_games(program):
    text = subprocess.run([program, "-help", "game"], capture_output=True, text=True).stdout
    return {row.group(1) for row in re.finditer(r"^  (\w+) ", text, re.M)}


class Runner:
    def __init__(self, program, scratch):
        self.program, self.scratch, self.folder = program, scratch, scratch
        self.games = known_games(program)
        self.failures, self.stages = [], set()

    def in_scratch(self, word):
        return re.sub(r"^/games(?=/)", str(self.scratch), word)

    def follow(self, text):
        command, *words = [self.in_scratch(word) for word in shlex.split(text)]
        if command == "cd":
            self.folder = Path(words[0])
            make_game_folder(self.folder)
        elif command == "mkdir":
            (self.folder / words[-1]).mkdir(parents=True)
        elif "-game" not in words or words[words.index("-game") + 1] in self.games:
            self.run(text, words)

    def run(self, text, words):
        done = subprocess.run([self.program, *words], cwd=self.folder, capture_output=True, text=True,
                              env={"HOME": str(self.scratch)})
        faults = [] if done.returncode == 0 else [f"exit status {done.returncode}", *done.stdout.splitlines()[-6:]]
        faults += re.findall(r"^WARNING: Unknown.*", done.stdout, re.M)
        if not faults:
            line = Line(words, self.folder)
            self.stages.add((words[words.index("-game") + 1] if "-game" in words else "quake3", line.stage))
            facts = FAULTS[line.stage](line) if line.bsp_path.is_file() else [(False, f"no {line.bsp_path}")]
            faults = [fault for holds, fault in facts if not holds]
        if faults:
            self.failures.append("\n  ".join([text, *faults]))


def main():
    program, source = str(Path(sys.argv[1]).resolve()), Path(sys.argv[2])
    page = (source / "docs/guide/from_q3map2.md").read_text()
    section = page.split("\n## Build lines of projects\n")[1].split("\n## ")[0]
    with tempfile.TemporaryDirectory() as folder:
        runner = Runner(program, Path(folder))
        for text in lines_of(section) + lines_of(LINES):
            runner.follow(text)
    missing = {(game, stage) for game in GAMES for stage in ("-bsp", "-vis", "-light")
               if game in runner.games} - runner.stages
    runner.failures += [f"no line of {game} for {stage} held" for game, stage in sorted(missing)]
    print("\n".join(runner.failures) or f"{len(runner.stages)} stages of games do what their lines ask for")
    return 1 if runner.failures else 0


if __name__ == "__main__":
    sys.exit(main())
