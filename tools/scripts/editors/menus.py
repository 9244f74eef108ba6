# GPL-2.0-or-later. Reads and expands the menus of level editors as the editors do.
"""read_menu(path) returns the entries of a build menu (.xml), a project (.proj) or compilation profiles (.cfg);
entry.steps(setup) returns the steps of one."""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from pathlib import Path

MONITOR_PORT = 39000
MAX_COMMAND = 2047      # bytes of a command of the build menu
MAX_PROJECT_VALUE = 1023  # bytes of an expanded value of a project


class MenuError(Exception):
    """A file that its editor would refuse or misread."""


@dataclass
class Setup:
    """What an editor knows when a build starts. Folders end in a slash."""
    editor: str
    engine: str
    home: str = ""
    map_file: str = ""
    game: str = "baseq3"       # folder of the game or mod
    base_game: str = "baseq3"
    executable_type: str = "x86_64"
    extra_paths: list = field(default_factory=list)
    monitor: str = f"127.0.0.1:{MONITOR_PORT}"  # empty: off
    tool: str = ""             # path of q3map2, for TrenchBroom


@dataclass
class Step:
    """A shell command, or for TrenchBroom a task."""
    command: str = ""
    arguments: list = field(default_factory=list)
    export: str = ""
    folder: str = ""
    stops_on_status: bool = False


@dataclass
class Entry:
    label: str
    steps: object  # Setup -> [Step]


# NetRadiant, GtkRadiant 1.5: XML with variables in brackets

def expand_brackets(text, variables, undefined=None):
    """Replaces [NAME] by its value, which is not expanded again. Without a closing bracket the rest is lost."""
    result, at = "", 0
    while True:
        start = text.find("[", at)
        if start < 0:
            return result + text[at:]
        result += text[at:start]
        end = text.find("]", start + 1)
        if end < 0:
            return result
        name = text[start + 1:end]
        if name not in variables and undefined is not None:
            undefined.append(name)
        result += variables.get(name, "")
        at = end + 1


def build_variables(setup):
    path = Path(setup.map_file)
    return {
        "RadiantPath": setup.editor,
        "ExecutableType": setup.executable_type,
        "EnginePath": setup.engine,
        "UserEnginePath": setup.home or setup.engine,
        "ExtraResourcePaths": "".join(f' -fs_pakpath "{folder}"' for folder in setup.extra_paths),
        "MonitorAddress": setup.monitor,
        "GameName": setup.game,
        "MapFile": setup.map_file,
        "BspFile": str(path.with_suffix(".bsp")),
        "MapName": path.stem,
    }


def with_extra_paths(text):
    program = "[RadiantPath]q3map2.[ExecutableType]"
    return text + "[ExtraResourcePaths]" if program in text and "[ExtraResourcePaths]" not in text else text


def defined_variables(project, setup, undefined):
    """Built-in variables and those of the file. These are expanded in the byte order of their names."""
    pieces = {}  # name -> [(condition or None, text)]; a repeated name appends
    for var in project.findall("var"):
        parts = pieces.setdefault(var.get("name", ""), [])
        parts.append((None, with_extra_paths(var.text or "")))
        for cond in var:
            if cond.tag != "cond" or len(cond):
                raise MenuError(f"<{cond.tag}> in a <var>")
            parts.append((cond.get("value", ""), with_extra_paths(cond.text or "")))
            parts.append((None, with_extra_paths(cond.tail or "")))
    variables = build_variables(setup)
    for name in sorted(pieces, key=str.encode):
        value = ""
        for condition, text in pieces[name]:
            if condition is None or expand_brackets(condition, variables, undefined):
                value += expand_brackets(text, variables, undefined)
        variables[name] = value
    return variables


def build_menu_steps(project, build, setup):
    undefined = []
    variables = defined_variables(project, setup, undefined)
    commands = [expand_brackets(command.text or "", variables, undefined) for command in build.findall("command")]
    if undefined:
        raise MenuError(f"undefined build variable: {undefined[0]}")
    for command in commands:
        if len(command.encode()) > MAX_COMMAND:
            raise MenuError(f"a command of {len(command)} bytes")
    return [Step(command=command) for command in commands if command]


def read_build_menu(text):
    project = ElementTree.fromstring(text)
    major, minor = project.get("version", "0.0").split(".")
    if project.tag != "project" or int(major) != 2 or int(minor) > 0:
        raise MenuError("no <project> of version 2.0")
    for child in project:
        if child.tag not in ("var", "build", "separator"):
            raise MenuError(f"<{child.tag}> is unknown")
        if child.tag == "build" and any(len(command) or command.tag != "command" for command in child):
            raise MenuError("an element in a <build> that is no plain <command>")
    # build=child binds the element of this iteration.
    return [None if child.tag == "separator" else
            Entry(child.get("name", ""), lambda setup, build=child: build_menu_steps(project, build, setup))
            for child in project if child.tag != "var"]


# GtkRadiant 1.6: XML with one key for each entry

def expand_template(value, setup):
    names = {"apppath": setup.editor, "enginepath": setup.engine, "toolspath": setup.editor,
             "userhomepath": setup.home or setup.engine, "basedir": setup.base_game, "q3map2": "q3map2"}
    for name, text in names.items():
        value = value.replace(f"$TEMPLATE{name}", text)
    if len(value.encode()) > MAX_PROJECT_VALUE:
        raise MenuError(f"a value of {len(value)} bytes")
    return value


def project_steps(value, setup):
    """Steps of a command. Marks: ! nothing, # -connect and its address, $ the map, @ a quote, && the next step."""
    value = expand_template(value, setup)
    map_words = f'"{setup.map_file}"'
    if setup.game != setup.base_game:
        map_words = f"-fs_game {setup.game} {map_words}"
    marks = {"!": "", "#": f" -connect {setup.monitor} " if setup.monitor else "", "$": map_words, "@": '"'}
    steps, text, at = [], "", 0
    while at < len(value):
        if value.startswith("&&", at):
            steps.append(Step(command=text))
            text, at = value[at + 2:at + 3], at + 3  # the next character is copied as it is
        else:
            text += marks.get(value[at], value[at])
            at += 1
    return steps + [Step(command=text)]


def read_project(text):
    if "<!DOCTYPE project SYSTEM" not in text:
        raise MenuError("no <!DOCTYPE project>")
    project = ElementTree.fromstring(text)
    values = {}
    for key in project:
        if key.tag != "key" or list(key.attrib) != ["name", "value"]:
            raise MenuError("a <key> needs a name, then a value")
        values[key.get("name")] = key.get("value")
    if int(values.get("version", 0)) != 2:
        raise MenuError("no project of version 2")
    return [Entry(name.removeprefix("bsp_"), lambda setup, value=value: project_steps(value, setup))
            for name, value in values.items() if name.startswith("bsp_")]


# TrenchBroom: its expression language, with ${NAME} in strings

class ExpressionReader:
    """Parses a value: map, array, string, number or boolean. A bare name is a string."""

    def __init__(self, text):
        lines = []
        for line in text.splitlines():
            lines.append("" if line.lstrip().startswith("//") else line)
        self.text, self.at = "\n".join(lines), 0

    def peek(self):
        while self.at < len(self.text) and self.text[self.at].isspace():
            self.at += 1
        return self.text[self.at:self.at + 1]

    def take(self, token):
        if self.peek() != token:
            raise MenuError(f"expected {token} at: {self.text[self.at:self.at + 30]!r}")
        self.at += 1

    def items(self, closing, read):
        """Items between commas; a comma before the closing bracket is an error."""
        if self.peek() == closing:
            self.at += 1
            return []
        result = [read()]
        while self.peek() == ",":
            self.at += 1
            result.append(read())
        self.take(closing)
        return result

    def pair(self):
        key = self.string() if self.peek() in "\"'" else self.word()
        self.take(":")
        return key, self.value()

    def string(self):
        quote = self.peek()
        self.at += 1
        text = ""
        while self.text[self.at] != quote:
            if self.text[self.at] == "\\" and self.text[self.at + 1] in '\\"':
                self.at += 1
            text += self.text[self.at]
            self.at += 1
        self.at += 1
        return text

    def word(self):
        self.peek()
        start = self.at
        while self.at < len(self.text) and (self.text[self.at].isalnum() or self.text[self.at] in "_.-"):
            self.at += 1
        if self.at == start:
            raise MenuError(f"expected a value at: {self.text[self.at:self.at + 30]!r}")
        return self.text[start:self.at]

    def value(self):
        first = self.peek()
        if first in ("{", "["):
            self.at += 1
            return dict(self.items("}", self.pair)) if first == "{" else self.items("]", self.value)
        if first and first in "\"'":
            return self.string()
        word = self.word()
        if word in ("true", "false"):
            return word == "true"
        return word if word[0].isalpha() else float(word)

    def whole(self):
        value = self.value()
        if self.peek():
            raise MenuError("text after the closing bracket")
        return value


def interpolate(text, variables):
    """${NAME} and ${NAME[INDEX]}; what is not defined is an error, as in the editor."""
    result, at = "", 0
    while (start := text.find("${", at)) >= 0:
        end = text.find("}", start)
        name, _, index = text[start + 2:end].partition("[")
        if end < 0 or name not in variables:
            raise MenuError(f"undefined: {text[start:]}")
        value = variables[name]
        result += text[at:start] + str(value[int(index.rstrip("]"))] if index else value)
        at = end + 1
    return result + text[at:]


def split_parameters(text):
    """Blanks separate; a quoted stretch is an argument without its quotes, and drops the word part before it."""
    arguments, word, at = [], "", 0
    while at < len(text):
        if text[at] == '"' and not word.endswith("\\"):
            end = text.find('"', at + 1)
            if end < 0:
                break
            arguments.append(text[at + 1:end])
            word, at = "", end
        elif text[at] == " ":
            arguments += [word] if word else []
            word = ""
        else:
            word += text[at]
        at += 1
    return arguments + ([word] if word else [])


def profile_steps(profile, setup):
    path = Path(setup.map_file)
    mods = [setup.base_game] + ([setup.game] if setup.game != setup.base_game else [])
    variables = {"MAP_BASE_NAME": path.stem, "MAP_FULL_NAME": path.name, "MAP_DIR_PATH": str(path.parent),
                 "GAME_DIR_PATH": setup.engine.rstrip("/"), "APP_DIR_PATH": setup.editor.rstrip("/"), "MODS": mods,
                 "CPU_COUNT": 2, "q3map2": setup.tool}
    folder = interpolate(profile["workdir"], variables)
    variables["WORK_DIR_PATH"] = folder
    steps = []
    for task in profile["tasks"]:
        if not task.get("enabled", True):
            continue
        if task["type"] == "export":
            steps.append(Step(export=interpolate(task["target"], variables), folder=folder))
        elif task["type"] == "tool":
            words = split_parameters(interpolate(task["parameters"], variables))
            steps.append(Step(arguments=[interpolate(task["tool"], variables), *words], folder=folder,
                              stops_on_status=task.get("treatNonZeroResultCodeAsError", False)))
        else:
            raise MenuError(f"a task of type {task['type']}")
    return steps


def read_profiles(text):
    root = ExpressionReader(text).whole()
    if root.get("version") != 1:
        raise MenuError("no profiles of version 1")
    return [Entry(profile["name"], lambda setup, profile=profile: profile_steps(profile, setup))
            for profile in root["profiles"]]


READERS = {".xml": read_build_menu, ".proj": read_project, ".cfg": read_profiles}


def read_menu(path):
    """[Entry, or None for a separator]"""
    path = Path(path)
    if path.suffix not in READERS:
        raise MenuError(f"{path}: expected one of {', '.join(READERS)}")
    return READERS[path.suffix](path.read_text(encoding="utf-8"))
