"""The scale table as Markdown: in full for the file, its ends for the screen."""

from __future__ import annotations

from collections.abc import Sequence

from bench.scale.series import FIXED, SQUARE, STRIP, Row
from bench.table import figure, markdown

AREAS = {
    FIXED: "fixed area",
    SQUARE: "constant density, a square that grows",
    STRIP: "constant density, a strip four lots wide that grows",
}
HEADER = (
    "tree",
    "n",
    "sweeps",
    "value/bound",
    "CPU, median [ms]",
    "mean",
    "hub",
    "messages",
    "most",
    "hub",
    "bytes",
    "most",
    "hub",
    "link, median [B]",
    "largest",
    "whole, median [B]",
    "largest",
)
NOTES = """
A platform and sweep; the gathering and the stop count as one more sweep. CPU time of one core, coding of
messages included; mean: over the platforms, the hub among them. Most: of any platform but the hub, the one
with most neighbours. Link: the impact that went over a link last, each way. Whole: the same impact with
nothing left out. At constant density the smaller teams are mostly border, with less around them to interact
with, so what is flat rises at first.

What does not stay flat:
- A hub's share. On a star it sends n - 1 messages a sweep, and has to combine, clip and code them.
- Latency. A sweep is 2 (n - 1) hops one after the other, on every tree.
- Whole messages at constant density: the median link carries half the team's impacts.
- Clipped messages over a long border. Any chain through a square has links that part it in two halves, and
  about n^(1/2) platforms reach over the border between those, so its median link grows like that. In a strip,
  and for most branches of a tree cut by space, the border is short; only the few links near the top of such a
  tree carry n^(1/2).
- A random tree. The platforms of a branch are scattered, and all of a large one is within others' reach.
  Most branches are small, so the median link stays short, but the large ones make the mean, which grows.
- A star's links have one platform at their end each, so clipping keeps them short. Its hub remains a hub.
- Search at constant density: valuing an impact walks over the whole pdf, so CPU grows with the area.
- Monitoring at constant density: a value factorises the whole field, so CPU grows with the area.
"""


def full(rows: Sequence[Row]) -> str:
    """Return all rows, a table a domain, area and kind of message."""
    return "\n".join(_section(part) for part in _parts(rows)) + NOTES


def brief(rows: Sequence[Row]) -> str:
    """Return the rows of a few team sizes, whole messages over an area that grows left out."""
    sizes = sorted({row.n for row in rows})
    shown = set(sizes[::-1] if len(sizes) <= 3 else sizes[::-3])
    parts = [part for part in _parts(rows) if part[0].clipped or part[0].area == FIXED]
    return "\n".join(_section([row for row in part if row.n in shown]) for part in parts) + NOTES


def _parts(rows: Sequence[Row]) -> list[list[Row]]:
    parts: dict[tuple[str, str, bool], list[Row]] = {}
    for row in rows:
        parts.setdefault((row.domain, row.area, row.clipped), []).append(row)
    return list(parts.values())


def _section(part: Sequence[Row]) -> str:
    head = part[0]
    messages = "" if head.area == FIXED else ", clipped messages" if head.clipped else ", whole messages"
    title = f"{head.domain}, {AREAS[head.area]}{messages}"
    if head.area == FIXED:
        title += f"; no impact takes more than {head.bound} bytes"
    return f"{title}\n\n{markdown(HEADER, [_cells(row) for row in part], 'l' + 'r' * (len(HEADER) - 1))}"


def _cells(row: Row) -> tuple[str, ...]:
    numbers = (
        (row.share, 3),
        (row.cpu_median, 2),
        (row.cpu_mean, 2),
        (row.cpu_hub, 1),
        (row.messages_mean, 2),
        (row.messages_most, 1),
        (row.messages_hub, 1),
    )
    sizes = (
        row.bytes_mean,
        row.bytes_most,
        row.bytes_hub,
        row.edge_median,
        row.edge_largest,
        row.whole_median,
        row.whole_largest,
    )
    return (
        row.tree,
        str(row.n),
        str(row.sweeps) if row.converged else f">= {row.sweeps}",
        *(f"{number:.{digits}f}" for number, digits in numbers),
        *(figure(None if size is None else round(size)) for size in sizes),
    )
