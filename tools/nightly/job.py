#!/usr/bin/env python3
# GPL-2.0-or-later. Runs stages of one map. It is a file of its own, since hosts without the other files run it too.
"""usage: job.py TASK [STAGE]

TASK is a folder with task.json, and the files of the map in in/maps. Each stage works on a copy of the files of the stage
before, and leaves out/STAGE with its files, out/STAGE.log, and last out/STAGE.json, which says how it ended. With a file
instead of a folder, TASK is the line SLURM_ARRAY_TASK_ID of that file."""

import functools
import hashlib
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

running, stopping = set(), threading.Event()  # process groups; set when everything ends


def write_json(path, value):
    """Writes a whole file or none."""
    path = Path(path)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    with os.fdopen(handle, "w") as file:
        json.dump(value, file, indent=1)
        file.flush()
        os.fsync(file.fileno())
    os.replace(name, path)


def file_hash(path):
    """SHA-256 of a file. One that is read often and has not changed is read once."""
    facts = os.stat(path)
    return _hash_of(str(path), facts.st_size, facts.st_mtime_ns)


@functools.lru_cache(maxsize=16)
def _hash_of(path, *_):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def stop_all():
    """Ends the stages that run in this process. They leave no result."""
    stopping.set()
    for group in list(running):
        end_group(group)


def end_group(group):
    try:
        os.killpg(group, signal.SIGKILL)
    except ProcessLookupError:
        pass


def measured(line, folder, log, seconds):
    """Runs a program. (status, whether it ran into its limit, seconds, CPU seconds, bytes of peak memory)."""
    if shutil.which("setpriv"):  # the stage ends with this process, whatever ends that
        line = ["setpriv", "--pdeathsig", "KILL", *line]
    start, late = time.monotonic(), threading.Event()
    with open(log, "wb") as output:
        child = subprocess.Popen(line, cwd=folder, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
                                 start_new_session=True)
    running.add(child.pid)

    def expire():
        late.set()
        end_group(child.pid)

    limit = threading.Timer(seconds, expire)
    limit.daemon = True
    limit.start()
    if stopping.is_set():
        end_group(child.pid)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    running.discard(child.pid)
    limit.cancel()
    return (child.returncode, late.is_set(), time.monotonic() - start, usage.ru_utime + usage.ru_stime,
            usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024))


def error_line(log):
    """What the log says after its title ERROR, or else its last line."""
    lines = [line.strip() for line in Path(log).read_text(errors="replace").splitlines() if line.strip()]
    errors = [after for line, after in zip(lines, lines[1:]) if line.strip("* ") == "ERROR"]
    return (errors or lines[-1:] or ["it printed nothing"])[0]


def run_stage(task, stage):
    """True if the stage is done, and None if everything is ending."""
    task = Path(task).resolve()
    facts = json.loads((task / "task.json").read_text())
    todo, out = facts["stages"][stage], task / "out"
    result = {"key": todo["key"], "status": "failed", "host": socket.gethostname(), "seconds": 0, "cpu": 0, "peak": 0,
              "warnings": [], "error": ""}
    before = out / todo["after"] if todo["after"] else task / "in"
    if not before.is_dir():
        return False
    program = os.path.expanduser(facts["program"])
    with tempfile.TemporaryDirectory(dir=task, prefix=f"{stage}.") as scratch:
        work, log, report = Path(scratch) / "work", out / f"{stage}.log", Path(scratch) / "report.json"
        shutil.copytree(before, work)
        threads = ["-threads", str(facts["threads"])] if facts["threads"] else []
        line = [program, f"-{stage}", *map(os.path.expanduser, todo["words"]), *threads, "-report", str(report),
                f"maps/{facts['map']}.{'map' if stage == 'bsp' else 'bsp'}"]
        try:
            if file_hash(program) != facts["program hash"]:
                raise OSError(f"{program}: another version than the manager has")
            status, late, *used = measured(line, work, log, todo["seconds"])
        except OSError as error:
            result["error"] = f"{result['host']}: {error}"
            write_json(out / f"{stage}.json", result)
            return False
        if stopping.is_set():
            return None
        result |= dict(zip(("seconds", "cpu", "peak"), used))
        written = json.loads(report.read_text()) if report.exists() else {"warnings": []}
        result["warnings"] = [[one["kind"], one["text"].replace(f"{work}/", "")] for one in written["warnings"]]
        # Of the system's figure, at least as much is memory of this process before it started the program.
        result["peak"] = int(written.get("peakMemoryBytes", result["peak"]))
        error = written.get("error", "").replace(f"{work}/", "")
        if late:
            result |= {"status": "timeout", "error": f"stopped after {todo['seconds'] / 60:g} minutes"}
        elif status:
            result["error"] = error or (f"signal {-status}" if status < 0 else error_line(log))
        else:
            shutil.rmtree(out / stage, ignore_errors=True)
            work.rename(out / stage)
            result["status"] = "done"
        write_json(out / f"{stage}.json", result)
    return result["status"] == "done"


def main():
    task = Path(sys.argv[1])
    if task.is_file():
        task = Path(task.read_text().splitlines()[int(os.environ["SLURM_ARRAY_TASK_ID"])])
    stages = sys.argv[2:] or list(json.loads((task / "task.json").read_text())["stages"])
    # Always 0: out/STAGE.json says how a stage ended, and for Slurm a failed job would hold up those of other maps.
    for stage in stages:
        if not run_stage(task, stage):
            break


if __name__ == "__main__":
    main()
