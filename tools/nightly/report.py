# GPL-2.0-or-later. The page about a night: one HTML file, light or dark as the reader's system, without a server.
import base64
import html
import os
import re
import time
from collections import Counter
from dataclasses import dataclass

from lumps import changed_lumps
from pictures import final_bsp

NUMBERS = re.compile(r"(?<=Entity )\d+|(?<=Brush )\d+|(?<=\.map:)\d+")
STYLE = """
:root { color-scheme: light dark; --line: light-dark(#ccc, #444); --bad: light-dark(#b00020, #ff7b86);
  --good: light-dark(#1b6e2d, #7ed491); --quiet: light-dark(#666, #999); --new: light-dark(#8a5a00, #f0b95a); }
body { font: 15px/1.45 system-ui, sans-serif; margin: 1.5em auto; max-width: 76em; padding: 0 1em;
  background: light-dark(#fff, #181818); color: light-dark(#1a1a1a, #e4e4e4); }
table { border-collapse: collapse; margin: .6em 0; } th, td { padding: .2em .7em; border-bottom: 1px solid var(--line); }
th { text-align: left; } td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
.bad { color: var(--bad); font-weight: 600; } .good { color: var(--good); } .quiet { color: var(--quiet); }
.new { color: var(--new); } .scroll { overflow-x: auto; }
.summary { border: 1px solid var(--line); border-radius: 6px; padding: .2em 1em; }
figure { display: inline-grid; grid-template-columns: 1fr 1fr; gap: 2px; margin: .5em .8em .5em 0; width: min(100%, 36em); }
figure img { width: 100%; display: block; } figcaption { grid-column: 1 / 3; color: var(--quiet); }
h2 { margin-top: 2em; border-top: 1px solid var(--line); padding-top: .6em; } ul { padding-left: 1.2em; }
"""


@dataclass
class MapState:
    """What the page says about a map. ran: stages of this night; news, gone: warnings compared with the night before;
    sizes: bytes of the .bsp before and now, if it changed; lumps: those that changed."""
    name: str
    status: str
    error: str
    ran: list
    cpu: float
    cpu_before: float
    peak: int
    size: int
    warnings: int
    news: list
    gone: list
    sizes: tuple
    lumps: list


@dataclass
class Summary:
    text: str
    states: list
    cpu: float
    failed: int
    new_warnings: int


def by_subject(warnings):
    """Texts of warnings by what they are about: without numbers that change when something else in the map does."""
    found = {}
    for _, text in warnings:
        found.setdefault(NUMBERS.sub("", text), []).append(text)
    return found


def compared(result):
    """(new warnings, gone warnings) of a stage that ran, against the run before."""
    if not result["before"]:
        return [], []
    now, before = by_subject(result["warnings"]), by_subject(result["before"]["warnings"])

    def only(here, there):
        return [text for subject, texts in here.items() for text in texts[len(there.get(subject, [])):]]
    return only(now, before), only(before, now)


def state_of(store, one):
    """The state of a map, read from its results and files."""
    results = {stage: result for stage in one.stages if (result := store.result(one.name, stage))}
    ran = [stage for stage, result in results.items() if result["night"] == store.night]
    bad = next((stage for stage in ran if results[stage]["status"] != "done"), None)
    good = [results[stage] for stage in ran if results[stage]["status"] == "done"]
    status = results[bad]["status"] if bad else "done" if ran else "unchanged"
    news, gone = [], []
    for result in good:
        new, old = compared(result)
        news, gone = news + new, gone + old
    now, before = final_bsp(store, one), final_bsp(store, one, before=True)
    sizes, lumps = (), []
    if now and before and good and ran[-1] == list(one.stages)[-1] and not bad and results[ran[-1]]["before"]:
        old, new = before.read_bytes(), now.read_bytes()
        if old != new:
            sizes, lumps = (len(old), len(new)), changed_lumps(old, new)
    return MapState(one.name, status, f"{bad}: {results[bad]['error']}" if bad else "", ran,
                    sum(results[stage]["cpu"] for stage in ran),
                    sum(result["before"]["cpu"] for result in good if result["before"]),
                    max((results[stage]["peak"] for stage in ran), default=0), now.stat().st_size if now else 0,
                    sum(len(result["warnings"]) for result in results.values()), news, gone, sizes, lumps)


def counted(number, what):
    return f"{number} {what}{'' if number == 1 else 's'}"


def summary_of(store):
    """The states of all maps, and a line about them."""
    states = [state_of(store, one) for one in store.manifest.maps]
    count = Counter(state.status for state in states)
    failed, new = count["failed"] + count["timeout"], sum(len(state.news) for state in states)
    parts = [f"{counted(len(states), 'map')}: {count['done']} made, {count['unchanged']} unchanged, "
             f"{count['failed']} failed, {count['timeout']} over the time limit", f"{sum(bool(state.sizes) for state in states)} with other bytes",
             counted(new, "new warning"), f"{counted(sum(len(state.gone) for state in states), 'warning')} gone"]
    return Summary(", ".join(parts), states, sum(state.cpu for state in states), failed, new)


# ---- HTML ----

def megabytes(size):
    return f"{size / 1e6:.2f}"


def row(state):
    link = html.escape(state.name)
    if details(state):
        link = f'<a href="#{link}">{link}</a>'
    kind = {"done": "good", "unchanged": "quiet"}.get(state.status, "bad")
    used = [f"{state.cpu:.1f}", f"{state.cpu_before:.1f}" if state.cpu_before else "", f"{state.peak / 1e6:.0f}"]
    news = f'<span class="new">+{len(state.news)}</span>' if state.news else ""
    change = f"{state.sizes[1] - state.sizes[0]:+d}" if state.sizes else ""
    cells = [megabytes(state.size) if state.size else "", change, *(used if state.ran else ["", "", ""]),
             f"{state.warnings} {news} {f'−{len(state.gone)}' if state.gone else ''}"]
    return (f'<tr><td>{link}</td><td class="{kind}">{state.status}</td><td>{" ".join(state.ran)}</td>'
            + "".join(f'<td class="n">{cell}</td>' for cell in cells) + "</tr>")


def details(state):
    return state.error or state.news or state.gone or state.sizes


def warning_list(title, texts, kind):
    if not texts:
        return ""
    return (f'<p class="{kind}">{title}</p><ul>' + "".join(f"<li>{html.escape(text)}</li>" for text in texts) + "</ul>")


def lump_table(state):
    if not state.sizes:
        return ""
    rows = "".join(f'<tr><td>{html.escape(name)}</td><td class="n">{old}</td><td class="n">{new}</td>'
                   f'<td class="n">{different}</td></tr>' for name, old, new, different in state.lumps)
    return (f"<p>The .bsp had {state.sizes[0]} bytes and has {state.sizes[1]}.</p>"
            '<table><tr><th>lump</th><th class="n">bytes before</th><th class="n">now</th>'
            f'<th class="n">bytes that differ</th></tr>{rows}</table>')


def figures(taken):
    def image(data, name):
        return f'<img alt="{name}" src="data:image/jpeg;base64,{base64.b64encode(data).decode()}">'
    return "".join(
        f'<figure>{image(old, "before")}{image(new, "now")}<figcaption>before, now: '
        + (f'{difference["mean"]:.2f} levels on average, at most {difference["largest"]}'
           if difference["largest"] else "no difference") + "</figcaption></figure>"
        for old, new, difference in taken)


def section(state, pictures):
    if not details(state):
        return ""
    error = f'<p class="bad">{html.escape(state.error)}</p>' if state.error else ""
    taken = pictures.by_map.get(state.name, [])
    shown = figures(taken)
    if state.sizes and not taken:
        why = pictures.why or "the map has no places, or the viewer failed"
        shown = f'<p class="quiet">No pictures: {html.escape(why)}.</p>'
    return (f'<h2 id="{html.escape(state.name)}">{html.escape(state.name)}</h2>{error}'
            + warning_list("New warnings", state.news, "new") + warning_list("Warnings that went", state.gone, "good")
            + lump_table(state) + shown)


def page(store, summary, pictures):
    started = time.strftime("%Y-%m-%d %H:%M", time.localtime(store.state["started"]))
    head = "".join(f'<th class="{kind}">{name}</th>' for name, kind in (
        ("map", ""), ("status", ""), ("stages", ""), ("MB", "n"), ("bytes ±", "n"), ("CPU s", "n"), ("before", "n"),
        ("peak MB", "n"), ("warnings", "n")))
    order = {"failed": 0, "timeout": 0, "done": 1, "unchanged": 2}
    states = sorted(summary.states, key=lambda state: (order[state.status], not state.news, not state.sizes, state.name))
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Night {store.night}</title><style>{STYLE}</style></head><body>
<h1>Night {store.night}</h1>
<div class="summary"><p class="{'bad' if summary.failed else 'good'}">{html.escape(summary.text)}</p>
<p class="quiet">Started {started}. {summary.cpu:.1f} CPU seconds in jobs.
{html.escape(str(store.manifest.program))}, SHA-256 {store.program_hash[:16]}.</p></div>
<div class="scroll"><table><tr>{head}</tr>
{chr(10).join(map(row, states))}
</table></div>
{"".join(section(state, pictures) for state in states)}
</body></html>
"""


def write_report(store, summary, pictures):
    """report.html in the work folder, and a copy for each night. Its path."""
    text, reports = page(store, summary, pictures), store.folder / "reports"
    reports.mkdir(exist_ok=True)
    for path in (reports / f"night{store.night}.html", store.folder / "report.html"):
        path.with_suffix(".new").write_text(text, encoding="utf-8")
        os.replace(path.with_suffix(".new"), path)
    return store.folder / "report.html"
