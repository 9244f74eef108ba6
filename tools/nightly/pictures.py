# GPL-2.0-or-later. Pictures of maps whose bytes changed, before and now, from the viewer of the project in Chromium.
"""The places of a map stay the same for all nights: maps/NAME/places.json."""

import json
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from job import write_json
from lumps import places

HERE = Path(__file__).resolve().parent
VIEWER = HERE.parent / "viewer"
TEXTURE = "64"  # texels of the longer side, enough for pictures of this size
SECONDS = 300   # for the pictures of a map


@dataclass
class Pictures:
    """why: why there are none, or empty; by_map: name to (JPEG before, JPEG now, differences) of each place."""
    why: str
    by_map: dict


def final_bsp(store, one, before=False):
    """The .bsp after the last stage, or None."""
    path = store.product(one.name, list(one.stages)[-1], before) / f"maps/{one.source.stem}.bsp"
    return path if path.exists() else None


def changed_maps(store):
    """Maps whose last stage made other bytes this night than before."""
    for one in store.manifest.maps:
        result, old, new = store.result(one.name, list(one.stages)[-1]), final_bsp(store, one, True), final_bsp(store, one)
        if result and result["night"] == store.night and result["status"] == "done" and result["before"] and old and new:
            if old.read_bytes() != new.read_bytes():
                yield one


def missing(count):
    """What pictures need and is not there, or an empty text."""
    chromium = os.environ.get("CHROMIUM", "/usr/bin/chromium")
    if not count:
        return "the manifest asks for no pictures"
    if not shutil.which("node"):
        return "Node.js is not installed"
    if not Path(chromium).exists():
        return f"there is no Chromium ({chromium}; CHROMIUM names another)"
    if not (VIEWER / "node_modules/playwright-core").exists():
        return "tools/viewer has no node_modules: run npm ci there"
    return ""


def page(store, bsp, file):
    """The viewer's page of a map, with textures. False if the program could not write it."""
    line = [store.manifest.program, "-shreport", *map(os.path.expanduser, store.manifest.options), "-texturesize", TEXTURE,
            "-o", file, bsp]
    return subprocess.run(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode == 0


def job_of(store, one, scratch):
    """What pictures.js needs for one map, or None if it has no places or no page."""
    old, new, file = final_bsp(store, one, True), final_bsp(store, one), store.maps / one.name / "places.json"
    if not file.exists():
        write_json(file, places(new.read_bytes(), store.manifest.pictures))
    out = scratch / one.name
    out.mkdir()
    job = {"before": str(out / "before.html"), "now": str(out / "now.html"), "out": str(out),
           "places": json.loads(file.read_text())[:store.manifest.pictures]}
    return job if job["places"] and page(store, old, job["before"]) and page(store, new, job["now"]) else None


def read_pictures(out):
    """(JPEG before, JPEG now, differences) of each place of a map, none if its page failed."""
    file = out / "differences.json"
    return [((out / f"{i}.before.jpg").read_bytes(), (out / f"{i}.now.jpg").read_bytes(), difference)
            for i, difference in enumerate(json.loads(file.read_text()) if file.exists() else [])]


def take_pictures(store, unwanted):
    """Pictures of all maps that changed."""
    why = "--no-pictures" if unwanted else missing(store.manifest.pictures)
    if why:
        return Pictures(why, {})
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        jobs = {one.name: job for one in changed_maps(store) if (job := job_of(store, one, scratch))}
        if jobs:
            write_json(scratch / "jobs.json", list(jobs.values()))
            try:
                subprocess.run(["node", HERE / "pictures.js", scratch / "jobs.json"], stdin=subprocess.DEVNULL, check=False,
                               timeout=SECONDS * len(jobs))
            except subprocess.TimeoutExpired:
                print("pictures: not all within the time limit", flush=True)
        return Pictures("", {name: read_pictures(scratch / name) for name in jobs})
