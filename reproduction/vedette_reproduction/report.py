"""The reproduction's report: one HTML page that holds everything, pictures included."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from vedette.study.page import heading, page, paragraph, picture
from vedette.study.page import table as html_table
from vedette.study.provenance import Provenance
from vedette_reproduction.content import Section, Table, Value, Verdict

SHORT, MOST_ROWS = 12, 40  # rows of a table: more are folded away; more than that are left to the CSV
PAPER = (
    "G. M. Mathews and H. F. Durrant-Whyte, Scalable Decentralised Control for Multi-Platform Reconnaissance "
    "and Information Gathering Tasks, FUSION 2006."
)
_STYLE = """<style>
.paper { color: #55585e; border-left: 3px solid #c8cbcf; padding-left: .8rem; }
.claims td, .claims th { text-align: left; white-space: normal; vertical-align: top; }
.verdict { border-radius: 3px; padding: .1em .5em; color: #fff; font-size: .8rem; white-space: nowrap; }
.holds { background: #00795a; } .part { background: #9a6400; } .fails { background: #b94700; }
summary { cursor: pointer; font-size: .86rem; font-weight: 600; } details caption { display: none; }
</style>"""
_COLOURS = {Verdict.HOLDS: "holds", Verdict.IN_PART: "part", Verdict.FAILS: "fails"}


@dataclass(frozen=True)
class About:
    """How a report came about."""

    source: Provenance
    seed: int
    seconds: float  # that it took
    missing: tuple[str, ...]  # parts that were interrupted or not begun


def report_html(sections: Sequence[Section], about: About, figures: Path) -> str:
    """Return the whole page; pictures are read from the folder ``figures``."""
    drawn = [section for section in sections if section.verdict is None]
    claims = [section for section in sections if section.verdict is not None]
    parts = [_STYLE, *_about(about)]
    if claims:
        parts += [heading("The claims at a glance"), _glance(claims)]
    for title, some in (("Figures", drawn), ("Claims", claims)):
        if some:
            parts.append(heading(title))
            parts += [_section(section, figures) for section in some]
    return page("The paper, reproduced", parts)


def _about(about: About) -> list[str]:
    source = about.source
    missing = ", ".join(about.missing)
    return [
        paragraph(PAPER),
        *([paragraph(f"Incomplete: interrupted. Missing: {missing}.", warning=True)] if missing else []),
        paragraph(
            f"Every number below was computed when this page was made, by `{source.command}`, seed "
            f"{about.seed}, {source.made}, in {about.seconds:.0f} s: vedette {source.version}, Python "
            f"{source.python}, {source.machine}. The same seed gives the same data on the same machine. The "
            "paper prints no quantitative results to compare with, and its Fig. 5 is a photograph of the "
            "robots. All tables are in `data/` as CSV, wall-clock times in `timing/`."
        ),
    ]


def _glance(claims: Sequence[Section]) -> str:
    rows = "".join(
        f'<tr><td><a href="#{claim.key}">{escape(claim.name)}</a></td><td>{escape(claim.statement)}</td>'
        f"<td>{_verdict(claim)}</td><td>{escape(claim.evidence)}</td></tr>"
        for claim in claims
    )
    head = "<tr><th></th><th>claim of the paper</th><th>verdict</th><th>evidence</th></tr>"
    return f'<div class="scroll"><table class="claims">{head}{rows}</table></div>'


def _verdict(section: Section) -> str:
    if section.verdict is None:
        return ""
    return f'<span class="verdict {_COLOURS[section.verdict]}">{escape(section.judgement)}</span>'


def _section(section: Section, figures: Path) -> str:
    hidden = [f"`data/{each.name}.csv`" for each in section.tables if not each.shown]
    return "\n".join(
        (
            f'<section id="{section.key}"><h3>{escape(section.title)} {_verdict(section)}</h3>',
            f'<div class="paper">{paragraph(f"The paper: {section.paper}")}</div>',
            *(picture(figures / name, "") for name in section.pictures),
            *map(paragraph, section.found),
            *(_table(each) for each in section.tables if each.shown),
            paragraph(f"More data: {', '.join(hidden)}.") if hidden else "",
            "</section>",
        )
    )


def _table(table: Table) -> str:
    place = f"{'timing' if table.wall_clock else 'data'}/{table.name}.csv"
    more = len(table.rows) - MOST_ROWS
    caption = f"{table.title} ({place}{f', with {more} more rows' if more > 0 else ''})"
    rows = [[_cell(value) for value in row] for row in table.rows[:MOST_ROWS]]
    words = max((_leading_words(row) for row in table.rows), default=1)
    body = html_table(table.columns, rows, words, caption)
    if len(table.rows) <= SHORT:
        return body
    return f"<details><summary>{escape(caption)}</summary>{body}</details>"


def _leading_words(row: Sequence[Value]) -> int:
    """Count the columns before the first number."""
    return next((k for k, value in enumerate(row) if isinstance(value, int | float)), len(row))


def _cell(value: Value) -> str:
    """Return a value as the report shows it: numbers to four digits."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}" if abs(value) < 1e4 or not value.is_integer() else f"{value:,.0f}"
    return f"{value:,}" if isinstance(value, int) else value
