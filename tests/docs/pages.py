#!/usr/bin/env python3
# GPL-2.0-or-later. Checks how the pages of the manual are written: length of lines, links, anchors, and habits of style.
"""usage: pages.py SOURCE_FOLDER

Prose stands one sentence to a line, of at most LINE characters. Links lead to files and headings that exist, with the
anchors that GitHub gives them. HABITS are phrases that make text hard to read; they are also looked for in the messages
of the program, the string literals of its sources.
"""

import re
import sys
from collections import Counter
from pathlib import Path

LINE, ROW = 200, 300      # characters of a line of prose, and of a row of a table
SEMICOLON_WORDS = 150     # a page may have a semicolon for so many words

# What to write instead.
HABITS = {
    r"\balone\b": "only",
    r"\bshall\b": "must, should or will",
    r"\banew\b": "again",
    r"\bbeside\b": "next to",
    r"\bin place of\b": "instead of",
    r"\bbut for\b": "except",
    r"\bin the mean\b": "on average",
    r"(?<!here )\b(?:is|are|was|were) no (?!more|less|longer|shorter|better|worse|fewer|larger|smaller|brighter|darker|slower|faster|lower|higher|wider|nearer|closer)": "is not a, or there is no",
    r"\b[Ee]stablished program|\b(?:[Oo]lder|[Oo]riginal|[Ss]tock) (?:program|compiler|q3map2)": "NetRadiant's q3map2",
    r"\bof 255\b": "levels",
    r"\bshin(?:e|es|ing)\b": "emit",
    r"\b[Ss]hares? of\b": "fraction of",
    r"\bburnt out\b": "blown out",
    r"\bfull bright\b": "fullbright",
    r"\blevel shot\b": "levelshot",
    r"\bphotometric\b": "lighting model",
    r"\bOne hop\b": "Where to look",
    r"\bat hand\b": "available",
    r"\b[Ss]ays where (?:it )?was\b": "lists",
    r"\d (?:[a-z-]+ )?(?:bytes|rays|samples|lights|levels|coefficients|texels|numbers|records) an? "
    r"(?:point|luxel|light|map|cell|texel|surface|leaf|face|pixel|node|vertex)\b": "per",
}
SENTENCES = re.compile(r"[\w)\]*`]\. [A-Z\[`]")
# Former names of pages: each says where the page went.
MOVED = re.compile(r"This page moved to ")


def prose_lines(text):
    """Number, text and whether it is in a table, of lines outside of code."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced and not re.match(r"(?: {4}|\t)(?![ ]*[-*] |\s*\S.*\]\()", line) and not line.startswith("<!--"):
            yield number, line


def without_code(line):
    return re.sub(r"`[^`]*`", "`code`", line)


def without_targets(line):
    """The line as it is read: links without their targets."""
    return re.sub(r"\]\([^)]*\)", "]", line)


def anchors(text):
    """Anchors of the headings, as GitHub makes them."""
    found, seen = set(re.findall(r'<a (?:id|name)="([^"]+)"', text)), Counter()
    for _, line in prose_lines(text):
        if heading := re.match(r"#{1,6} +(.*?) *#*$", line):
            plain = re.sub(r"[`*]", "", without_targets(heading.group(1)).replace("[", "").replace("]", ""))
            slug = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
            found.add(f"{slug}-{seen[slug]}" if seen[slug] else slug)
            seen[slug] += 1
    return found


class Pages:
    def __init__(self, source):
        self.source, self.faults, self.known = source, [], {}

    def fault(self, page, number, what):
        self.faults.append(f"{page.relative_to(self.source)}:{number}: {what}")

    def anchors_of(self, path):
        if path not in self.known:
            self.known[path] = anchors(path.read_text())
        return self.known[path]

    def check_links(self, page, text):
        for number, line in prose_lines(text):
            for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", line)):
                if re.match(r"https?:|mailto:", target):
                    continue
                name, _, anchor = target.partition("#")
                path = (page.parent / name).resolve() if name else page
                if not path.exists():
                    self.fault(page, number, f"there is no {target}")
                elif MOVED.match(path.read_text()) if path.suffix == ".md" else False:
                    self.fault(page, number, f"{target} has moved")
                elif anchor and path.suffix == ".md" and anchor not in self.anchors_of(path):
                    self.fault(page, number, f"{name or page.name} has no heading #{anchor}")

    def check_habits(self, page, number, line):
        for habit, instead in HABITS.items():
            if found := re.search(habit, line):
                self.fault(page, number, f'"{found.group()}": write {instead}')

    def check_style(self, page, text):
        words = semicolons = 0
        for number, line in prose_lines(text):
            shown = without_targets(line)
            limit = ROW if line.lstrip().startswith("|") else LINE
            if len(shown) > limit:
                self.fault(page, number, f"{len(shown)} characters; at most {limit}")
            plain = without_code(shown)
            self.check_habits(page, number, plain)
            if not line.startswith(("#", "|")) and SENTENCES.search(re.sub(r"^\s*(?:\d+\.|[-*]) ", "", plain)):
                self.fault(page, number, "more than one sentence on a line")
            words += len(plain.split())
            semicolons += len(re.findall(r"\w; ", plain))
        if semicolons > 2 + words / SEMICOLON_WORDS:
            self.fault(page, 1, f"{semicolons} semicolons in {words} words: write sentences")

    def check_messages(self, path):
        """String literals of a source of the program."""
        for number, line in enumerate(path.read_text().splitlines(), 1):
            code = re.sub(r"//.*", "", line)
            for literal in re.findall(r'"((?:[^"\\]|\\.)*)"', code):
                if " " in literal:
                    self.check_habits(path, number, re.sub(r"`[^`]*`", "", literal))


def main():
    source = Path(sys.argv[1]).resolve()
    pages = Pages(source)
    manual = [source / name for name in ("README.md", "CONTRIBUTING.md", "tools/engines/README.md", "tools/engines/ioquake3/README.md",
                                         "tools/viewer/README.md")]
    manual += sorted((source / "docs").rglob("*.md"))
    for page in manual:
        text = page.read_text()
        pages.check_links(page, text)
        if not MOVED.match(text):
            pages.check_style(page, text)
    for page in [source / "CHANGELOG.md", *sorted((source / "libs").glob("*/README.md"))]:
        pages.check_links(page, page.read_text())
    sources = [path for folder in ("common", "q3map2") for suffix in ("*.cpp", "*.h")
               for path in sorted((source / folder).rglob(suffix))]
    for path in sources:
        pages.check_messages(path)
    print("\n".join(pages.faults) or f"{len(manual)} pages and the messages of {len(sources)} sources: no faults")
    if len(manual) < 50 or len(sources) < 300:
        print("the pages or sources are not where they are expected")
        return 1
    return 1 if pages.faults else 0


if __name__ == "__main__":
    sys.exit(main())
