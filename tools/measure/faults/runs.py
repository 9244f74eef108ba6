# GPL-2.0-or-later. Runs stages of q3map2 in a scratch folder with a fault, and says what is wrong with what they leave.
"""A stage runs in a folder of its own, so that all its paths are relative and its output is the same everywhere. The
state of the folder before and after a run is a dictionary: path -> bytes, or None for a folder."""

import errno
import json
import mmap
import os
import re
import select
import shutil
import signal
import struct
import subprocess
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
KINDS = ["write", "flush", "rename", "open", "read", "stat", "alloc", "thread", "mkdir", "remove", "print", "socket"]
ERRORS = {"write": errno.ENOSPC, "flush": errno.EIO, "rename": errno.EIO, "open": errno.EMFILE, "read": errno.EIO,
          "stat": errno.EIO, "alloc": errno.ENOMEM, "thread": errno.EAGAIN, "mkdir": errno.ENOSPC, "remove": errno.EIO,
          "print": errno.ENOSPC, "socket": errno.EIO}
REQUEST = struct.Struct("<3q4096s")  # struct Record of faults.c: what a run is asked for, then what happened
COUNTS = struct.Struct("<16q q 64s 8192s")
ANY = 15
SECONDS = 60  # a run that takes longer hangs
HUNG = -1000
HEADER = "************ ERROR ************\n"
UNFINISHED = re.compile(r"\.[0-9A-Za-z]{6}\.tmp$")
PACKAGE = re.compile(r"_(FAILEDpack|repacked)\.pk3$|_strippedBYrepacker\.shader$")
MAPS = "base/baseq3/maps/"
OLD, NEW = "pillar.map", "room.map"  # of tests/data/maps: what the old outputs are from, and what is compiled


@dataclass
class Stage:
    """Commands of q3map2 without the options that all have; M stands for maps/m in the game folder."""
    words: str
    before: list = field(default_factory=list)  # commands that make the old state
    of_new: bool = False  # whether those after the first compile NEW, not OLD
    needs: list = field(default_factory=list)  # files to remove from the old state


COMPILED = ["-bsp -meta M.map"]
LIT = [*COMPILED, "-light -fast M.bsp"]
STAGES = {
    "bsp": Stage("-bsp -meta M.map", COMPILED),
    "vis": Stage("-vis M.bsp", COMPILED),
    "light": Stage("-light -sh M.bsp", COMPILED),
    "light-bounce": Stage("-light -fast -bounce 1 -external -lightmapsize 64 M.bsp",
                          [*COMPILED, "-light -fast -external -lightmapsize 32 M.bsp"]),
    "light-new-pages": Stage("-light -fast -external -lightmapsize 64 M.bsp", COMPILED),
    "unpack": Stage("-json -unpack M.bsp", [*COMPILED, "-json -unpack M.bsp", "-light -sh -fast M.bsp"]),
    "unpack-new": Stage("-json -unpack M.bsp", COMPILED),
    "pack": Stage("-json -pack M.bsp", [*LIT, "-json -unpack M.bsp"]),
    "pk3": Stage("-pk3 M.bsp", LIT),
    "repack": Stage("-repack M.bsp", LIT),
    "scale": Stage("-scale 2 M.bsp", [*COMPILED, "-scale 3 M.bsp"]),
    "merge": Stage("-mergebsp M.bsp N.bsp", COMPILED),
    "export": Stage("-export M.bsp", LIT),
    "minimap": Stage("-minimap -size 64 M.bsp", LIT),
    "shreport": Stage("-shreport M.bsp", [*COMPILED, "-light -sh -fast M.bsp"]),
    "convert": Stage("-convert -format obj M.bsp", LIT),
    "bsp-cache": Stage("-bsp -meta -cache cache M.map", ["-bsp -meta -cache cache M.map"]),
    "light-report": Stage("-light -fast -report r.json -log l.txt -connect 127.0.0.1:9 M.bsp", COMPILED),
}


@dataclass
class Tools:
    program: str
    shim: str


@dataclass
class Result:
    status: int  # as of subprocess; HUNG: it took too long
    text: str
    counts: list  # of calls, by kind, then all
    happened: int
    call: str
    stack: list


def state_of(folder):
    state = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if path.is_dir():
            state[name] = None
        else:
            state[name] = path.read_bytes()
    return state


def restore(folder, state, now=None):
    """Makes the folder what it was; now: its present state, if known."""
    now = state_of(folder) if now is None else now
    for name in sorted(now.keys() - state.keys(), reverse=True):
        path = folder / name
        path.rmdir() if now[name] is None else path.unlink()
    for name, contents in state.items():
        if name not in now and contents is None:
            (folder / name).mkdir()
        elif contents is not None and now.get(name) != contents:
            (folder / name).write_bytes(contents)


class Scratch:
    """A folder in which one stage runs again and again."""

    def __init__(self, folder, tools, stage):
        self.folder, self.tools, self.stage = Path(folder), tools, STAGES[stage]
        self.variables = {}  # more of the environment
        self.also = []  # other right states of the folder
        self.record, self.output = (self.folder.with_name(self.folder.name + end) for end in (".record", ".output"))
        self.record.write_bytes(bytes(REQUEST.size + COUNTS.size))
        self.make()
        self.old = state_of(self.folder)
        self.start()
        self.clean = self.run()
        if self.clean.status != 0:
            raise SystemExit(f"fault_injection: {stage}: status {self.clean.status}: {self.clean.text}")
        self.new = state_of(self.folder)
        restore(self.folder, self.old, self.new)
        again = self.run()
        if again.status != 0 or any(self.differs(name, state_of(self.folder)) for name in self.new):
            raise SystemExit(f"fault_injection: {stage}: two runs differ")
        restore(self.folder, self.old)

    def differs(self, name, state):
        rights = [self.new[name], *(other.get(name) for other in self.also)]
        return name not in state or (state[name] not in rights and not changes_each_time(name))

    def also_right(self, change):
        """From now on the files of a run after `change` are right too, as those of a run that began a moment later."""
        change()
        if self.run().status == 0:
            self.also.append(state_of(self.folder))
        restore(self.folder, self.old)

    def make(self):
        data = ROOT / "tests/data/maps"
        shutil.copytree(ROOT / "tools/demo_data/demo_arena", self.folder / "base/baseq3")
        (self.folder / "home").mkdir()
        with zipfile.ZipFile(self.folder / "base/baseq3/pak0.pk3", "w", zipfile.ZIP_DEFLATED) as archive:
            tga = bytes([0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 8, 0, 8, 0, 24, 0]) + bytes(range(192))
            archive.writestr(zipfile.ZipInfo("textures/test/wall.tga"), tga)
        maps = self.folder / MAPS
        for name in ("m.map", "n.map"):
            shutil.copyfile(data / OLD, maps / name)
        self.must_run("-bsp -meta N.map")
        for command in self.stage.before:
            self.must_run(command)
        if self.stage.words.startswith("-bsp"):
            shutil.copyfile(data / NEW, maps / "m.map")

    def command(self, words):
        words = [re.sub(r"^([MN])\.", lambda found: MAPS + found[1].lower() + ".", word) for word in words.split()]
        return [self.tools.program, "-threads", "2", "-fs_basepath", "base", *words]

    def must_run(self, words):
        run = subprocess.run(self.command(words), cwd=self.folder, env=self.environment({}), capture_output=True,
                             text=True, errors="replace", check=False)
        if run.returncode != 0:
            raise SystemExit(f"fault_injection: {words}: {run.stdout}{run.stderr}")

    def environment(self, fault):
        return {"HOME": str(self.folder / "home"), "PATH": "/usr/bin:/bin", "LC_ALL": "C", **fault}

    def start(self):
        """The program, which waits before main for requests; see FAULT_SERVER in faults.c."""
        request, self.requests = os.pipe()
        self.results, result = os.pipe()
        variables = {"FAULT_FILE": str(self.record), "LD_PRELOAD": self.tools.shim,
                     "FAULT_SERVER": f"{request} {result} {self.output}", **self.variables}
        self.server = subprocess.Popen(self.command(self.stage.words), cwd=self.folder, env=self.environment(variables),
                                       stdin=subprocess.DEVNULL, pass_fds=(request, result))
        os.close(request)
        os.close(result)

    def wait_for(self, seconds):
        """An integer that the server writes; None: too late."""
        if not select.select([self.results], [], [], seconds)[0]:
            return None
        return struct.unpack("<i", os.read(self.results, 4))[0]

    def run(self, kind=None, at=0, action="fail"):
        """Runs the stage. kind: a name or "any"."""
        with open(self.record, "r+b") as file, mmap.mmap(file.fileno(), REQUEST.size + COUNTS.size) as shared:
            wanted = ANY if kind == "any" else KINDS.index(kind) if kind else -1
            shared[:] = REQUEST.pack(wanted, at, ERRORS.get(kind, errno.EIO), action.encode()) + bytes(COUNTS.size)
            os.write(self.requests, b"x")
            process = self.wait_for(SECONDS)
            status = self.wait_for(SECONDS)
            if status is None:
                os.kill(process, signal.SIGKILL)
                self.wait_for(SECONDS)
            *counts, happened, call, stack = COUNTS.unpack(shared[REQUEST.size:])
        return Result(HUNG if status is None else os.waitstatus_to_exitcode(status),
                      self.output.read_bytes().decode(errors="replace"), counts, happened,
                      call.split(b"\0")[0].decode(), stack.split(b"\0")[0].decode(errors="replace").splitlines())

    def close(self):
        os.close(self.requests)
        os.close(self.results)
        self.server.wait()

    # ---- Judging ----

    def judge(self, result, kind, dies=False):
        """(outcome, lost files, files left over, other findings) of a run that has just ended; restores the folder."""
        now = state_of(self.folder)
        lost, left, other, named = [], [], [], []
        may_stay = dies or kind == "remove"
        # A cache that was not written makes the next run slower, and nothing else.
        is_new = all(name.startswith("cache/") or not self.differs(name, now) for name in self.new)
        incomplete = is_incomplete_package(result)
        for name in sorted(self.old.keys() | self.new.keys() | now.keys()):
            old, new, is_now = (state.get(name, "missing") for state in (self.old, self.new, now))
            if is_now in (old, new) and type(is_now) in (type(old), type(new)):
                if is_now is None and old == "missing" and not is_new and not dies and not name.startswith("cache/"):
                    left.append(name)  # a folder for files that are not there
                continue
            if changes_each_time(name) or incomplete and PACKAGE.search(name):
                continue
            if old == "missing" and new == "missing" and is_named_old(name, result, is_now, self.old):
                named.append(UNFINISHED.sub("", name))
            elif old == "missing" and new == "missing":
                # Nothing can be done about an unfinished file that the system refuses to remove.
                if not name.startswith("cache/") and not (may_stay and UNFINISHED.search(name)):
                    left.append(name)
            elif result.status != 0 or dies:
                lost.append(name)
        changed = [name for name in self.new if self.old.get(name, "missing") != self.new[name]
                   and self.new[name] is not None and not is_record(name)]
        done = [name for name in changed if name not in named and now.get(name, "missing") == self.new[name]]
        gone = [name for name in self.old if name not in self.new and name not in now]
        only_records = all(is_record(name) or not self.differs(name, now) for name in self.new)
        if result.status != 0 and not dies and (done or gone) and not only_records and not incomplete:
            other.append("old and new files: " + " ".join(Path(name).name for name in [*done, *gone]))
        if not dies and kind != "print":
            other += wrong_records(result, now)
        outcome = self.outcome(result, kind, is_new and not left, other) if not dies else "died"
        restore(self.folder, self.old, now)
        return outcome, lost, left, other

    def outcome(self, result, kind, is_new, other):
        errors = error_lines(result.text)
        if result.status == 0:
            if errors and kind != "print":
                other.append("status 0 with an error")
            if is_new:
                return "harmless"
            if warnings(result.text) - warnings(self.clean.text):
                return "warned"
            other.append("status 0, other files, no warning")
            return "silent"
        if result.status == 1:
            if is_incomplete_package(result):
                return "error"
            if kind != "print" and (len(errors) != 1 or result.text.count(HEADER) != 1):
                other.append(f"{len(errors)} error lines")
            if any(line.startswith("unexpected failure") for line in errors):
                other.append(errors[0])
            return "error"
        if result.status == HUNG:
            other.append("hung")
        elif result.status < 0:
            other.append(f"signal {-result.status}")
        else:
            other.append(f"status {result.status}")
        return "crash"


def is_named_old(name, result, contents, old):
    """Whether an unfinished file has the old contents of a file that could not be put back, and the error names it."""
    return f"/{name}" in result.text and "cannot be put back" in result.text and \
        contents == old.get(UNFINISHED.sub("", name))


def is_incomplete_package(result):
    """Whether -pk3 or -repack could read less than the map needs, says so, and wrote a package of the rest."""
    return result.status == 1 and re.search(r"^failed: \d+ files? missing", result.text, re.MULTILINE) is not None


def changes_each_time(name):
    """Whether a file has times in it."""
    return name in ("l.txt", "r.json")


def is_record(name):
    """Whether a file tells of the run, or is kept for another one, without being an output of the stage."""
    return changes_each_time(name) or name.startswith("cache/")


def wrong_records(result, state):
    """Whether the files of -log and -report, where a stage writes them, tell another story than the output."""
    wrong = []
    if "l.txt" in state and not state["l.txt"].decode(errors="replace").endswith(result.text.splitlines()[-1] + "\n") \
            and "-log " not in result.text:
        wrong.append("the log is incomplete")
    if "r.json" in state:
        report = json.loads(state["r.json"])
        if (report["status"] == "done") != (result.status == 0):
            wrong.append("the report is of another run")
    return wrong


def error_lines(text):
    lines = text.split(HEADER, 1)[1].splitlines() if HEADER in text else []
    ends = ("failed: ", "WARNING: ")
    return [line for line in lines if line and not line.endswith(" elapsed") and not line.startswith(ends)]


def warnings(text):
    return {line for line in text.splitlines() if line.startswith("WARNING: ")}


def named_frames(program, stack):
    """Functions of the program in the stack of an injection, innermost first, as far as it has symbols."""
    name = Path(program).name
    offsets = [line.split()[0].split("+")[1] for line in stack if line.startswith(name + "+")]
    if not offsets:
        return [line.split(" ")[-1] or line for line in stack[:6]]
    shown = subprocess.run(["addr2line", "-Cfe", program, *[hex(int(offset, 16) - 1) for offset in offsets]],
                           capture_output=True, text=True, check=False).stdout.splitlines()[::2]
    return [re.sub(r"\(.*", "", line.replace("(anonymous namespace)::", "")) for line in shown]
