# GPL-2.0-or-later. Finds places in source text by names and patterns, and puts lines there.
"""An edit says where its lines belong: after or before the statement that matches a pattern, at the start of a function,
or instead of what matches. Patterns are regular expressions; they are searched in one function or type, or in the whole
file, and never in comments. So an edit fits every version of a file that has the names it looks for."""

import re
from dataclasses import dataclass

C_LIKE = (".c", ".h", ".glsl")
COMMENT_OR_STRING = re.compile(r"""//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])'""", re.S)


@dataclass(frozen=True)
class Edit:
    """One place. kind: after, before, start, replace, need. pick: which match, if there may be several."""
    kind: str
    pattern: str
    lines: str
    pick: str = "only"


@dataclass(frozen=True)
class In:
    """Edits of a file. scope: name of the function or type that holds the places, empty for the whole file."""
    file: str
    scope: str
    edits: tuple

    def __init__(self, file, scope, *edits):
        for name, value in (("file", file), ("scope", scope), ("edits", edits)):
            object.__setattr__(self, name, value)


def after(pattern, lines, pick="only"):
    """Lines after the statement, with its block, or after the line of a list or of the preprocessor."""
    return Edit("after", pattern, lines, pick)


def before(pattern, lines, pick="only"):
    """Lines before the line that matches and the comments right above it."""
    return Edit("before", pattern, lines, pick)


def start(lines):
    """Lines at the start of a function."""
    return Edit("start", "", lines)


def replace(pattern, lines):
    """Text instead of what matches. \\g<0> in it is the match, \\g<1> its first group."""
    return Edit("replace", pattern, lines)


def need(pattern, why):
    """Something that our sources use. why: a sentence about it."""
    return Edit("need", pattern, why, "first")


class Missing(Exception):
    """A place is not there, or is there more than once."""


def without_comments(text, strings=False):
    """The text with blanks for comments, and for strings if wanted. Positions stay the same."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match[0]) if strings or match[0][0] == "/" else match[0]
    return COMMENT_OR_STRING.sub(blank, text)


def closing(code, at):
    """Position of the bracket that closes the one at a position, or the end of the text."""
    depth = 0
    for i in range(at, len(code)):
        depth += {"(": 1, "{": 1, ")": -1, "}": -1}.get(code[i], 0)
        if depth == 0:
            return i
    return len(code)


class Source:
    """A file of the tree. Line ends are \\n here."""

    def __init__(self, name, text):
        self.text = text
        self.is_c = name.endswith(C_LIKE)
        self.searched = without_comments(text) if self.is_c else text
        self.code = without_comments(text, strings=True) if self.is_c else text

    def spans(self, scope):
        """Where the bodies of a function or type are; a function may be there twice, for the preprocessor to choose.
        They end at a brace in the first column, since branches of the preprocessor can upset the count of braces."""
        if not scope:
            return [(0, len(self.text))]
        found = []
        for head in re.finditer(rf"\b{scope}\s*\(", self.code):
            body = re.compile(r"\s*\{").match(self.code, closing(self.code, head.end() - 1) + 1)
            tail = body and re.compile(r"^\}", re.M).search(self.code, body.end())
            if tail:
                found.append((body.end(), tail.start()))
        for tail in re.finditer(rf"^\}}\s*{scope}\s*;", self.code, re.M):
            found.append((self.code.rfind("\ntypedef", 0, tail.start()) + 1, tail.start()))
        return found

    def find(self, scope, edit):
        """The match of an edit's pattern."""
        spans = self.spans(scope)
        if not spans:
            raise Missing(f"there is no {scope}")
        if edit.kind == "start":
            if len(spans) > 1:
                raise Missing(f"{scope} is there {len(spans)} times")
            return spans[0]
        pattern = re.compile(edit.pattern, re.M)
        matches = [match for begin, end in spans for match in pattern.finditer(self.searched, begin, end)]
        if not matches:
            raise Missing(f"nothing matches {edit.pattern}")
        if edit.pick == "only" and len(matches) > 1:
            raise Missing(f"{len(matches)} places match {edit.pattern}")
        return matches[-1 if edit.pick == "last" else 0]

    def line_start(self, at):
        return self.text.rfind("\n", 0, at) + 1

    def line_end(self, at):
        """Position after the end of the line."""
        return self.text.find("\n", at) + 1 or len(self.text)

    def statement_end(self, at):
        """Position after the line in which the statement around a position ends."""
        if not self.is_c or self.code[self.line_start(at):].lstrip(" \t").startswith("#"):
            return self.line_end(at)
        depth = 0
        while at < len(self.code):
            if depth <= 0 and self.code[at] == "{":
                return self.line_end(closing(self.code, at))
            if depth <= 0 and self.code[at] == ";":
                break
            depth += {"(": 1, ")": -1}.get(self.code[at], 0)
            at += 1
        return self.line_end(at)

    def above_comments(self, at):
        """The start of a line, or of the first of the comment lines right above it."""
        at = self.line_start(at)
        while at:
            above = self.line_start(at - 1)
            if self.code[above:at].strip() or not self.text[above:at].strip():
                break
            at = above
        return at

    def change(self, scope, edit):
        """(begin, end, text): what an edit puts between two positions of the text."""
        place = self.find(scope, edit)
        if edit.kind == "need":
            return 0, 0, ""
        if edit.kind == "start":
            at = self.line_end(place[0])
            return at, at, indented(edit.lines, "\t") + "\n"
        indent = re.compile(r"[ \t]*").match(self.text, self.line_start(place.start()))[0]
        if edit.kind == "replace":
            return *place.span(), indented(place.expand(edit.lines), indent).removeprefix(indent)
        at = self.statement_end(place.start()) if edit.kind == "after" else self.above_comments(place.start())
        return at, at, indented(edit.lines, indent) + "\n"


def indented(lines, indent):
    """Lines with the indentation of their place, but for those of the preprocessor."""
    return "\n".join(line if not line or line.lstrip().startswith("#") else indent + line for line in lines.split("\n"))


def edited(text, changes):
    """The text with changes of Source.change; those at the same position stay in order."""
    done, at = [], 0
    for begin, end, new in sorted(changes, key=lambda change: change[0]):
        done += [text[at:begin], new]
        at = end
    return "".join(done) + text[at:]
