# GPL-2.0-or-later. Faults that are no single call: a full disk, inputs that change meanwhile, two runs, the clock.
"""Each function makes several runs of a stage in a scratch folder of its own, and yields (what, finding or None) of
each. Where the system does not permit a case, it yields nothing."""

import os
import random
import shutil
import subprocess
import tempfile
from pathlib import Path

import runs

STAGES = ["bsp", "vis", "light", "light-bounce", "unpack", "pk3"]
PAGE = 4096


class Mounted:
    """A disk in memory of its own, for a scratch folder; `folder` is None without the right to mount one."""

    def __init__(self, parent):
        self.folder = Path(tempfile.mkdtemp(dir=parent)) / "s"
        self.folder.mkdir()
        if not self.mount("size=64m"):
            self.folder = None

    def mount(self, options):
        return subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", self.folder], capture_output=True,
                              check=False).returncode == 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.folder:
            subprocess.run(["umount", "-l", self.folder], check=False)


def finding_of(scratch, result, kind="case", allowed=("error", "harmless", "warned")):
    outcome, lost, left, other = scratch.judge(result, kind)
    wrong = [*(f"lost {name}" for name in lost), *(f"left over {name}" for name in left), *other]
    if outcome not in allowed:
        wrong.append(f"{outcome}: {result.text.splitlines()[-3:]}")
    return "; ".join(wrong) or None


def full_disk(stage, tools, folder, _seed):
    """A disk with room for a few pages, for more and more, until the stage succeeds."""
    with Mounted(folder) as disk:
        if not disk.folder:
            return
        scratch = runs.Scratch(disk.folder, tools, stage)
        for pages in [*range(0, 12), *range(12, 80, 6)]:
            space = os.statvfs(disk.folder)
            used = (space.f_blocks - space.f_bfree) * space.f_frsize
            disk.mount(f"remount,size={used + pages * PAGE}")
            result = scratch.run()
            now = runs.state_of(disk.folder)
            disk.mount("remount,size=64m")
            assert now == runs.state_of(disk.folder)
            yield f"{pages} pages free", finding_of(scratch, result)
            if result.status == 0:
                break
        scratch.close()


def read_only(stage, tools, folder, _seed):
    """A disk that may not be written."""
    with Mounted(folder) as disk:
        if not disk.folder:
            return
        scratch = runs.Scratch(disk.folder, tools, stage)
        disk.mount("remount,ro")
        result = scratch.run()
        disk.mount("remount,rw")
        yield "", finding_of(scratch, result, allowed=("error",))
        scratch.close()


def inputs_of(scratch):
    """Files that a stage may read; not those that it only replaces."""
    words = scratch.stage.words
    names = ["m.map"] if words.startswith("-bsp") else ["m.bsp", "m.map", "m.srf", "m.prt"]
    return [runs.MAPS + name for name in names if runs.MAPS + name in scratch.old]


def vanishes(stage, tools, folder, seed):
    """An input, a shader script or an archive is removed at some call."""
    scratch = runs.Scratch(Path(tempfile.mkdtemp(dir=folder)) / "s", tools, stage)
    choose = random.Random(f"{seed} {stage} vanishes")
    for name in [*inputs_of(scratch), "base/baseq3/scripts/demo.shader", "base/baseq3/pak0.pk3"]:
        if (scratch.folder / name).exists():
            scratch.also_right((scratch.folder / name).unlink)
        for point in sorted(choose.sample(range(1, scratch.clean.counts[runs.ANY]), 40)):
            result = scratch.run("any", point, f"remove:{scratch.folder / name}")
            now = runs.state_of(scratch.folder)
            if name not in now and name in scratch.old:  # so that it does not count as lost
                (scratch.folder / name).write_bytes(scratch.old[name])
            yield f"{Path(name).name} at {point}", finding_of(scratch, result)
    scratch.close()


def saved(stage, tools, folder, seed):
    """The map, or its source, is saved at some call."""
    scratch = runs.Scratch(Path(tempfile.mkdtemp(dir=folder)) / "s", tools, stage)
    choose = random.Random(f"{seed} {stage} saved")
    name = inputs_of(scratch)[0]
    other = scratch.old[name] + b"\n"  # which changes neither a map source nor the lumps of a .bsp
    scratch.also_right(lambda: (scratch.folder / name).write_bytes(other))
    for point in sorted(choose.sample(range(1, scratch.clean.counts[runs.ANY]), 60)):
        (scratch.folder / (name + ".saved")).write_bytes(other)
        result = scratch.run("any", point, f"save:{scratch.folder / name}")
        if (scratch.folder / (name + ".saved")).exists():
            (scratch.folder / (name + ".saved")).unlink()
        now = runs.state_of(scratch.folder)[name]
        keeps = now == other or result.status == 0 and now == scratch.new[name]
        if now == other:
            (scratch.folder / name).write_bytes(scratch.old[name])
        lost = None if keeps else "the save is lost"
        yield f"{Path(name).name} at {point}", finding_of(scratch, result) or lost
    scratch.close()


def clock_back(stage, tools, folder, _seed):
    """Each look at the clock shows an earlier hour."""
    scratch = runs.Scratch(Path(tempfile.mkdtemp(dir=folder)) / "s", tools, stage)
    scratch.close()
    scratch.variables = {"FAULT_CLOCK": "3600"}
    scratch.start()
    yield "", finding_of(scratch, scratch.run(), allowed=("harmless",))
    scratch.close()


def two_runs(stage, tools, folder, _seed):
    """Two runs on one map at the same time."""
    scratch = runs.Scratch(Path(tempfile.mkdtemp(dir=folder)) / "s", tools, stage)
    scratch.also_right(lambda: scratch.must_run(scratch.stage.words))  # the second run reads what the first has written
    for _ in range(10):
        outputs = [tempfile.TemporaryFile() for _ in range(2)]
        both = [subprocess.Popen(scratch.command(scratch.stage.words), cwd=scratch.folder, env=scratch.environment({}),
                                 stdout=output, stderr=subprocess.STDOUT) for output in outputs]
        ended, texts = [run.wait() for run in both], []
        for output in outputs:
            output.seek(0)
            texts.append(output.read().decode(errors="replace"))
        clean = all(status == 0 or (status == 1 and len(runs.error_lines(text)) == 1)
                    for status, text in zip(ended, texts))
        result = runs.Result(0, texts[ended.index(0)] if 0 in ended else "", [], 0, "", [])
        wrong = finding_of(scratch, result, allowed=("harmless", "warned"))
        yield "", wrong or (None if clean and 0 in ended else f"statuses {ended}")
    scratch.close()


def killed_twice(stage, tools, folder, seed):
    """After a run that was killed, the next one gives the right files."""
    scratch = runs.Scratch(Path(tempfile.mkdtemp(dir=folder)) / "s", tools, stage)
    choose = random.Random(f"{seed} {stage} killed")
    for point in sorted(choose.sample(range(1, scratch.clean.counts[runs.ANY]), 20)):
        scratch.run("any", point, "kill")
        now = runs.state_of(scratch.folder)
        if any(now.get(name) != contents for name, contents in scratch.old.items()):
            runs.restore(scratch.folder, scratch.old, now)  # it had replaced files, and a stage records each run
            continue
        result = scratch.run()
        for path in list(scratch.folder.rglob("*")):
            if runs.UNFINISHED.search(path.name):  # of the killed run; it may stay
                path.unlink()
        yield f"at {point}", finding_of(scratch, result, allowed=("harmless",))
    scratch.close()


ALL = {"full disk": full_disk, "read-only disk": read_only, "input vanishes": vanishes, "input is saved": saved,
       "clock goes back": clock_back, "two runs at once": two_runs, "run after a kill": killed_twice}


def run_case(name, stage, tools, folder, seed):
    """(number of runs, findings)."""
    place = tempfile.mkdtemp(dir=folder)
    results = list(ALL[name](stage, tools, place, seed))
    shutil.rmtree(place, ignore_errors=True)
    return len(results), [f"{what}: {finding}" for what, finding in results if finding]
