# GPL-2.0-or-later. The work folder of nights: products, results, and what has to run again.
"""In the folder:

lock                    held by the night that runs
night.json              number of the night, when it started and ended
maps/NAME/STAGE         files after that stage: the newest that it made
maps/NAME/STAGE.before  those of the night before it changed
maps/NAME/STAGE.json    how the last run of the stage ended; "before": how the one before that made files did
tasks/NAME              what a job works in (job.py)

Everything that is not in tasks is written by one process, whole or not at all."""

import fcntl
import hashlib
import json
import os
import shutil
import time
from pathlib import Path

from job import file_hash, write_json

MAP_FILES = (".map", ".bsp", ".prt", ".srf", ".lin", ".aas", ".autosave", ".bak")
CONTENT = ("key", "night", "seconds", "cpu", "peak", "warnings")  # of results, kept in "before"


class Locked(Exception):
    """Another night works in the folder."""


def digest(value):
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()


def game_files(options, without):
    """Names, sizes and times of the files in folders of the game that the options name. Maps in them do not count, nor
    does what is in the folder `without`."""
    roots = [Path(os.path.expanduser(options[i + 1])) for i, word in enumerate(options[:-1])
             if word.lower() in ("-fs_basepath", "-fs_homepath", "-fs_pakpath")]
    games = [options[i + 1] for i, word in enumerate(options[:-1]) if word.lower() in ("-fs_basegame", "-fs_game")]
    listed = []
    for root in dict.fromkeys(roots):
        for top in [root / game for game in dict.fromkeys(games)] or [root]:
            for folder, folders, names in os.walk(top, followlinks=True):
                folders[:] = sorted(name for name in folders if Path(folder, name) != without)
                in_maps = Path(folder).name == "maps"
                for name in sorted(names):
                    if in_maps and name.endswith(MAP_FILES):
                        continue
                    facts = os.stat(Path(folder, name))
                    listed.append([str(Path(folder, name)), facts.st_size, facts.st_mtime_ns])
    return listed


class Store:
    """The folder, locked until the process ends."""

    def __init__(self, manifest):
        self.manifest, self.folder = manifest, manifest.folder
        self.maps, self.tasks = self.folder / "maps", self.folder / "tasks"
        self.folder.mkdir(parents=True, exist_ok=True)
        self._lock = open(self.folder / "lock", "a")
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise Locked(f"{self.folder}: another night works there") from error
        self.maps.mkdir(exist_ok=True)
        self.tasks.mkdir(exist_ok=True)
        state = self._json(self.folder / "night.json") or {"night": 0, "ended": 0}
        self.resumed = state["ended"] is None
        if not self.resumed:
            state = {"night": state["night"] + 1, "started": time.time(), "ended": None}
            write_json(self.folder / "night.json", state)
        self.state, self.night = state, state["night"]
        self.program_hash = file_hash(manifest.program)
        self.common = digest([self.program_hash, game_files(manifest.options, self.folder),
                              [[str(path), file_hash(path)] for path in manifest.inputs]])

    @staticmethod
    def _json(path):
        try:
            return json.loads(path.read_text())
        except FileNotFoundError:
            return None

    def end(self):
        self.state["ended"] = time.time()
        write_json(self.folder / "night.json", self.state)

    def result(self, name, stage):
        """How the stage ended when it ran last, or None."""
        return self._json(self.maps / name / f"{stage}.json")

    def product(self, name, stage, before=False):
        return self.maps / name / f"{stage}{'.before' if before else ''}"

    def keys(self, one):
        """What the files of each stage of a map depend on, as a hash."""
        key, keys = digest([[path.name, file_hash(path)] for path in one.files()]), {}
        for stage, words in one.stages.items():
            key = keys[stage] = digest([self.common, key, stage, words, self.manifest.options])
        return keys

    def fresh(self, one, stage, key):
        """Whether the stage need not run. What failed this night is not tried again when the night is resumed."""
        result = self.result(one.name, stage)
        if not result or result["key"] != key:
            return False
        return self.product(one.name, stage).is_dir() if result["status"] == "done" else result["night"] == self.night

    def prepare(self, one, threads):
        """Makes the task of a map. Its stages that have to run, none if everything is as it was."""
        keys = self.keys(one)
        stages = list(one.stages)
        first = next((i for i, stage in enumerate(stages) if not self.fresh(one, stage, keys[stage])), len(stages))
        failed = any(self.result(one.name, stage)["status"] != "done" for stage in stages[:first])
        if failed or first == len(stages):
            return []
        task = self.tasks / one.name
        shutil.rmtree(task, ignore_errors=True)
        (task / "out").mkdir(parents=True)
        if first:
            shutil.copytree(self.product(one.name, stages[first - 1]), task / "in")
        else:
            (task / "in/maps").mkdir(parents=True)
            for path in one.files():
                shutil.copyfile(path, task / "in/maps" / path.name)
        todo = {stage: {"words": [*self.manifest.options, *one.stages[stage]], "seconds": one.seconds, "key": keys[stage],
                        "after": stages[i - 1] if i > first else ""}
                for i, stage in enumerate(stages) if i >= first}
        write_json(task / "task.json", {"map": one.source.stem, "program": str(self.manifest.program),
                                        "program hash": self.program_hash, "threads": threads, "stages": todo})
        return list(todo)

    def expected(self, one, stage):
        """Seconds that the stage took last time; long ones start first."""
        result = self.result(one.name, stage)
        return result["seconds"] if result else one.source.stat().st_size / 1e5

    def collect(self, name, complete=False):
        """Moves what a task made to the files of its map. complete: all stages have ended, so one without a result died."""
        task = self.tasks / name
        facts = self._json(task / "task.json")
        for stage, todo in (facts["stages"] if facts else {}).items():
            result = self._json(task / "out" / f"{stage}.json")
            if not result and complete:
                result = {"key": todo["key"], "status": "failed", "host": "", "seconds": 0, "cpu": 0, "peak": 0,
                          "warnings": [], "error": "the job left no result: it was killed, or its host died"}
            if not result:
                break
            self._keep(name, stage, result, task / "out" / stage)
            if result["status"] != "done":
                break
        shutil.rmtree(task, ignore_errors=True)

    def _keep(self, name, stage, result, files):
        """A result of this night, with the files if there are any. Of earlier ones, those of another night stay."""
        target, old, product = self.maps / name, self.result(name, stage), self.product(name, stage)
        target.mkdir(exist_ok=True)
        made = old if old and old["status"] == "done" else old and old["before"]  # the run that made the product
        if made and made["night"] == self.night:
            made = old["before"] if old is made else None
            earlier = False
        else:
            earlier = product.is_dir()
        result |= {"night": self.night, "before": made and {key: made[key] for key in CONTENT}}
        log = files.with_suffix(".log")
        if log.exists():
            os.replace(log, target / log.name)
        if result["status"] == "done" and files.is_dir():  # else a night was killed after it had moved them
            before = self.product(name, stage, before=True)
            if earlier:
                shutil.rmtree(before, ignore_errors=True)
                product.rename(before)
            shutil.rmtree(product, ignore_errors=True)
            files.rename(product)
        write_json(target / f"{stage}.json", result)
