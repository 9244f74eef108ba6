#!/usr/bin/env python3
# GPL-2.0-or-later. Nights of a small project: what runs again, limits, killed nights, reports and exit status.
"""usage: nightly_test.py PROGRAM SOURCE_FOLDER local|slurm|ssh

The project is the demo arena as three maps. PROGRAM is called through a script that notes each call, and that fails or hangs
as a test wants. With slurm and ssh, only what differs from the local engine is tested. Skipped (77) without the engine."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cluster"))
from engines import ENGINES, wait_for  # pylint: disable=wrong-import-position

MANIFEST = """program = "q3map2"
options = "-fs_basepath . -fs_basegame demo"
folder = "work"
pictures = 0
[[maps]]
files = ["demo/maps/*.map"]
without = ["demo/maps/two.map"]
bsp = "-meta"
vis = ""
light = "{light}"
[[maps]]
files = ["demo/maps/two.map"]
minutes = {minutes}
bsp = "-meta"
vis = ""
light = "{light}"
[[maps]]
files = ["demo/old/*.bsp"]
prefix = "old_"
light = "-fast -onlygrid"
"""
# Notes stage and map of each call. A file hang-STAGE.MAP makes that call hang, and with unplug-STAGE.MAP one call waits until
# somebody switches off its computer, whose port it names.
WRAPPER = """#!/bin/sh
for last; do :; done
map=${{last##*/}}
map=${{map%.*}}
[ "$1" = -shreport ] || echo "$1 $map" >>'{folder}/calls'
[ ! -e "{folder}/hang$1.$map" ] || sleep 1000
if rm "{folder}/unplug$1.$map" 2>/dev/null; then
    echo "${{SSH_CONNECTION##* }}" >'{folder}/port'
    sleep 1000
fi
exec '{program}' "$@"
"""
BAD_MODEL = '{\n"classname" "misc_model"\n"origin" "0 0 32"\n"model" "models/missing.md3"\n}\n'
BROKEN = '{\n"key'
ALL = sorted(f"-{stage} {name}" for stage in ("bsp", "vis", "light") for name in ("one", "two")) + ["-light three"]


class Project:
    """The folder of a project. `night` compiles it."""

    def __init__(self, folder, program, source, words=(), environment=None):
        self.folder, self.work, self.calls = folder, folder / "work", folder / "calls"
        self.line = [sys.executable, str(source / "tools/nightly/nightly"), str(folder / "night.toml"), *words]
        self.environment = environment or dict(os.environ)
        shutil.copytree(source / "tools/demo_data/demo_arena", folder / "demo")
        self.maps, old = folder / "demo/maps", folder / "demo/old"
        demo = (self.maps / "demo.map")
        shutil.copy(demo, self.maps / "one.map")
        demo.rename(self.maps / "two.map")
        old.mkdir()
        shutil.copy(self.maps / "one.map", old / "three.map")
        subprocess.run([program, "-fs_basepath", folder, "-fs_basegame", "demo", "-meta", old / "three.map"],
                       stdout=subprocess.DEVNULL, check=True)
        # A wrapper where the manifest looks for the program, in a folder of PATH.
        (folder / "q3map2").write_text(WRAPPER.format(folder=folder, program=program))
        (folder / "q3map2").chmod(0o755)
        self.environment["PATH"] = f"{folder}:{self.environment['PATH']}"
        self.manifest()

    def manifest(self, light="-fast -shbspx", minutes=5.0):
        (self.folder / "night.toml").write_text(MANIFEST.format(light=light, minutes=minutes))

    def night(self, status, *more):
        """What was called, sorted, and what was printed. The exit status must be as given."""
        self.calls.write_text("")
        run = subprocess.run([*self.line, *more], env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                             text=True, check=False, timeout=500)
        assert run.returncode == status, f"status {run.returncode} instead of {status}\n{run.stdout}"
        return sorted(self.calls.read_text().splitlines()), run.stdout

    def start(self):
        self.calls.write_text("")
        return subprocess.Popen(self.line, env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def report(self):
        return (self.work / "report.html").read_text()

    def bsp(self, name, stem):
        return (self.work / f"maps/{name}/light/maps/{stem}.bsp").read_bytes()

    def spoil(self, name):
        with open(self.maps / f"{name}.map", "a", encoding="utf-8") as file:
            file.write(BROKEN)

    def edit(self, name, old, new):
        path = self.maps / f"{name}.map"
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new, 1))


def same(calls, expected):
    assert sorted(calls) == sorted(expected), f"called {calls} instead of {sorted(expected)}"


def has(text, *parts):
    for part in parts:
        assert part in text, f"no {part!r} in\n{text}"


def processes_of(project):
    """Lines of processes with the folder of the project in their words."""
    listed = subprocess.run(["ps", "-eo", "pid=,args="], stdout=subprocess.PIPE, text=True, check=True).stdout
    return [line for line in listed.splitlines() if f"{project.folder}/" in line and str(os.getpid()) not in line.split()]


# ---- Tests with the local engine ----

def only_changes_run(project):
    same(project.night(0)[0], ALL)
    same(project.night(0)[0], [])
    project.edit("two", '"light" "700"', '"light" "1400"')
    same(project.night(0)[0], ["-bsp two", "-vis two", "-light two"])
    page = project.report()
    has(page, 'id="two"', "LIGHTGRID_SH", "1 made, 2 unchanged", "the manifest asks for no pictures")
    assert 'id="one"' not in page, "an unchanged map has a section"
    project.manifest(light="-fast -shbspx -gamma 1.2")
    same(project.night(0)[0], ["-light one", "-light two"])
    (project.folder / "demo/scripts/more.shader").write_text("textures/none\n{\n}\n")
    same(project.night(0)[0], ALL)
    with open(project.folder / "q3map2", "a", encoding="utf-8") as program:
        program.write("# another version\n")
    same(project.night(0)[0], ALL)


def products_are_those_of_the_program(project, program):
    """The chain of stages by hand gives the same bytes."""
    hand = project.folder / "hand/maps"
    hand.mkdir(parents=True)
    shutil.copy(project.maps / "one.map", hand)
    for words in (["-meta"], ["-vis"], ["-light", "-fast", "-shbspx"]):
        subprocess.run([program, "-fs_basepath", project.folder, "-fs_basegame", "demo", *words, "one.map"], cwd=hand,
                       stdout=subprocess.DEVNULL, check=True)
    assert project.bsp("one", "one") == (hand / "one.bsp").read_bytes(), "other bytes than by hand"


def faults_stop_only_their_map(project):
    project.night(0)
    project.spoil("one")
    project.edit("two", '"light" "700"', '"light" "800"')
    calls, printed = project.night(1)
    same(calls, ["-bsp one", "-bsp two", "-vis two", "-light two"])
    has(printed, "one: failed: ", "1 failed")
    has(project.report(), "bsp: ", "1 failed", 'class="bad"')
    same(project.night(1)[0], ["-bsp one"])
    project.edit("one", BROKEN, "")
    same(project.night(0)[0], ["-bsp one", "-vis one", "-light one"])


def limits_stop_only_their_job(project):
    project.manifest(minutes=0.05)
    (project.folder / "hang-bsp.two").touch()
    calls, printed = project.night(1)
    same(calls, [call for call in ALL if call not in ("-vis two", "-light two")])
    has(printed, "two: timeout: stopped after 0.05 minutes", "1 over the time limit")
    assert not processes_of(project), processes_of(project)


def killed_nights_go_on(project):
    kills = ((signal.SIGKILL, -signal.SIGKILL, ALL),
             (signal.SIGTERM, 128 + signal.SIGTERM, ["-bsp two", "-vis two", "-light two"]))
    for number, status, everything in kills:
        hang = project.folder / "hang-light.two"
        hang.touch()
        night = project.start()
        wait_for("the last job", lambda: "-light two" in project.calls.read_text())
        before = project.calls.read_text().splitlines()
        has(project.night(2)[1], "another night works there")
        night.send_signal(number)
        assert night.wait(100) == status
        wait_for("jobs end", lambda: not processes_of(project))
        hang.unlink()
        calls, printed = project.night(0)
        same(calls + before, [*everything, "-light two"])
        has(printed, "resumed")
        same(project.night(0)[0], [])
        project.edit("two", '"light" "', '"light" "1')


def new_warnings_are_found(project):
    project.night(0, "--fail-on-new-warnings")
    path = project.maps / "one.map"
    text = path.read_text()
    path.write_text(text + BAD_MODEL)
    has(project.night(3, "--fail-on-new-warnings")[1], "new warning")
    has(project.report(), "New warnings", "models/missing.md3")
    has(project.night(0, "--fail-on-new-warnings")[1], "0 new warnings")
    path.write_text(text)
    project.night(0, "--fail-on-new-warnings")
    has(project.report(), "Warnings that went", "models/missing.md3")


def wrong_manifests_are_refused(project):
    good = (project.folder / "night.toml").read_text()
    for old, new, message in (("pictures", "picture", "there is no key picture"),
                              ('prefix = "old_"', 'bsp = ""', "needs the key bsp"),
                              ("*.map", "*.mop", "no such file"),
                              ('["demo/maps/*.map"]', '["demo/scripts/*"]', "expected .map or .bsp"),
                              ('program = "', 'program = "x', "no such program"),
                              ('bsp = "-meta"', "bsp = 3", "expected options"),
                              ("minutes = 5.0", 'minutes = "x"', "not a number")):
        assert old in good
        (project.folder / "night.toml").write_text(good.replace(old, new, 1))
        has(project.night(2)[1], message)


# ---- Tests with other engines ----

def engine_compiles_the_same(project, local):
    """The other engine, with one map that does not parse, and the local engine make the same bytes."""
    local.night(0)
    project.spoil("two")
    calls, printed = project.night(1)
    same(calls, [call for call in ALL if "two" not in call or "bsp" in call])
    has(printed, "two: failed: ")
    for name, stem in (("one", "one"), ("old_three", "three")):
        assert project.bsp(name, stem) == local.bsp(name, stem), f"{name}: other bytes"
    project.edit("two", BROKEN, "")
    same(project.night(0)[0], ["-bsp two", "-vis two", "-light two"])
    assert project.bsp("two", "two") == local.bsp("two", "two"), "two: other bytes"
    print("three maps: same bytes as with the local engine", flush=True)
    same(project.night(0)[0], [])
    project.manifest(minutes=0.05)
    project.edit("two", '"light" "700"', '"light" "800"')
    (project.folder / "hang-bsp.two").touch()
    has(project.night(1)[1], "two: timeout: ")


def another_host_takes_over(project, local, engine):
    """A computer is switched off while it compiles."""
    project.manifest()
    local.edit("two", '"light" "700"', '"light" "800"')
    local.night(0)
    (project.folder / "hang-bsp.two").unlink()
    (project.folder / "unplug-light.two").touch()
    plug = threading.Thread(target=engine.switch_off_computer, args=(project.folder / "port",), daemon=True)
    plug.start()
    project.night(0)
    plug.join()
    assert project.bsp("two", "two") == local.bsp("two", "two"), "two: other bytes"
    print("one computer off: same bytes", flush=True)


LOCAL = [only_changes_run, faults_stop_only_their_map, limits_stop_only_their_job, killed_nights_go_on,
         new_warnings_are_found, wrong_manifests_are_refused]


def main():
    program, source, name = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), sys.argv[3]
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        if name == "local":
            for test in LOCAL:
                project = Project(folder / test.__name__, program, source)
                start = time.monotonic()
                test(project)
                print(f"{test.__name__}: {time.monotonic() - start:.1f} s", flush=True)
                if test is new_warnings_are_found:
                    products_are_those_of_the_program(project, program)
            return
        (folder / "engine").mkdir()
        with ENGINES[name](folder / "engine", source / "tools/cluster") as engine:
            words = {"slurm": ["--engine", "slurm"], "ssh": ["--engine", "parallel", "--hosts", "pc1,pc2,pc3"]}[name]
            project = Project(folder / "project", program, source, words, engine.environment)
            local = Project(folder / "local", program, source)
            engine_compiles_the_same(project, local)
            if name == "ssh":
                another_host_takes_over(project, local, engine)


if __name__ == "__main__":
    main()
