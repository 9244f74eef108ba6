# GPL-2.0-or-later. The manifest of a project: which maps are compiled, with which options.
"""docs/guide/nightly.md describes the file. Errors are ManifestError with one line that names the key."""

import os
import re
import shlex
import shutil
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

STAGES = ("bsp", "vis", "light")
PATH_OPTIONS = ("-fs_basepath", "-fs_homepath", "-fs_pakpath")
COMPANIONS = (".map", ".srf", ".ent")  # of a .bsp that is only lit
MINUTES, PICTURES = 60, 10


class ManifestError(Exception):
    """The text is for the user."""


@dataclass(frozen=True)
class Map:
    """A map of the project. name: unique in the project; stages: words of each stage that runs, in their order."""
    name: str
    source: Path
    stages: dict = field(hash=False)
    seconds: float

    def files(self):
        """The source and what belongs to it."""
        extra = COMPANIONS if self.source.suffix == ".bsp" else ()
        return [self.source, *(path for path in map(self.source.with_suffix, extra) if path.exists())]


@dataclass(frozen=True)
class Manifest:
    """options: of all stages; folder: work folder; inputs: more files that all maps depend on."""
    program: Path
    options: list
    folder: Path
    inputs: list
    pictures: int
    maps: list


def words(value, key):
    """Options as a list, from a string as in a shell or a list of words."""
    if isinstance(value, str):
        return shlex.split(value)
    if isinstance(value, list) and all(isinstance(word, str) for word in value):
        return value
    raise ManifestError(f"{key}: expected options as a string or a list of strings")


def typed(table, key, kind, default):
    """A value of a table. A number may be whole where a fraction is allowed."""
    value = table.get(key, default)
    if isinstance(value, bool) or not isinstance(value, (int, float) if kind is float else kind):
        raise ManifestError(f"{key}: {value!r} is not a {'number' if kind in (int, float) else kind.__name__}")
    return value


def known(table, keys, where):
    for key in table:
        if key not in keys:
            raise ManifestError(f"{where}: there is no key {key}")


def found(base, patterns, key):
    """Files by patterns relative to the manifest. A pattern without a file is an error."""
    if not isinstance(patterns, list) or not all(isinstance(pattern, str) for pattern in patterns):
        raise ManifestError(f"{key}: expected a list of file names")
    files = []
    for pattern in patterns:
        path = base / Path(pattern).expanduser()
        matches = sorted(Path(path.anchor).glob(str(path.relative_to(path.anchor))))
        if not matches:
            raise ManifestError(f"{key}: {pattern}: no such file")
        files += [match for match in matches if match.is_file()]
    return list(dict.fromkeys(files))


def absolute_paths(options, base):
    """The options with folders relative to the manifest made absolute. ~ stays: each host has its own."""
    fixed = list(options)
    for i in range(1, len(fixed)):
        if fixed[i - 1].lower() in PATH_OPTIONS and not fixed[i].startswith("~"):
            fixed[i] = os.path.normpath(base / fixed[i])
    return fixed


def maps_of(table, base, minutes):
    """The maps of one [[maps]] table."""
    known(table, ("files", "without", "prefix", "minutes", *STAGES), "maps")
    prefix, without = typed(table, "prefix", str, ""), set()
    if "without" in table:
        without = set(found(base, table["without"], "without"))
    stages = {stage: words(table[stage], stage) for stage in STAGES if stage in table}
    if not stages:
        raise ManifestError("maps: a table has none of the keys bsp, vis and light")
    maps = []
    for source in found(base, table.get("files", []), "files"):
        if source in without:
            continue
        if source.suffix not in (".map", ".bsp"):
            raise ManifestError(f"files: {source}: expected .map or .bsp")
        if (source.suffix == ".map") != ("bsp" in stages):
            raise ManifestError(f"{source}: a .map needs the key bsp, and a .bsp cannot have it")
        if source.suffix == ".bsp" and "vis" in stages:
            raise ManifestError(f"{source}: the vis stage needs a .map")
        name = prefix + source.stem
        if not re.fullmatch(r"[\w+.-]+", name) or name.startswith("."):
            raise ManifestError(f"{source}: the name of a map may have letters, digits, and . _ + -")
        maps.append(Map(name, source, stages, 60 * typed(table, "minutes", float, minutes)))
    return maps


def read_manifest(path):
    """The checked manifest."""
    path = Path(path).resolve()
    try:
        table = tomllib.loads(path.read_text())
    except OSError as error:
        raise ManifestError(error.strerror) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ManifestError(str(error)) from error
    known(table, ("program", "options", "folder", "inputs", "minutes", "pictures", "maps"), "manifest")
    base = path.parent
    if not isinstance(table.get("maps"), list) or not table["maps"]:
        raise ManifestError("there is no table [[maps]]")
    name = os.path.expanduser(typed(table, "program", str, "q3map2"))
    program = shutil.which(str(base / name) if "/" in name else name)
    if not program:
        raise ManifestError(f"program: {name}: no such program")
    maps = [one for entry in table["maps"] for one in maps_of(entry, base, typed(table, "minutes", float, MINUTES))]
    names = [one.name for one in maps]
    twice = next((one for one in maps if names.count(one.name) > 1), None)
    if twice:
        raise ManifestError(f"two maps have the name {twice.name}: give one table a prefix")
    return Manifest(Path(program).resolve(), absolute_paths(words(table.get("options", []), "options"), base),
                    base / Path(typed(table, "folder", str, path.stem + ".night")).expanduser(),
                    found(base, table.get("inputs", []), "inputs"), typed(table, "pictures", int, PICTURES), maps)
