"""Fig. 1: how impacts flow along a chain of three platforms, drawn from recorded messages."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import reduce

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, Rectangle
from numpy.typing import NDArray

from vedette.negotiation import Tree
from vedette.problem import CountedCoverage, counted, seen
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save
from vedette.record.signs import FAINT, INK
from vedette_reproduction.content import Section, Table, table
from vedette_reproduction.plots import colour
from vedette_reproduction.post import Letter, Recording, record
from vedette_reproduction.run import ReproductionRun

N, CELLS = 3, 8
OBJECTIVE = CountedCoverage()
PICTURE = "figure-1.png"
_APART = 3.0  # platforms in the picture
_STRIP = 1.3, 0.22  # size of a strip of cells in the picture
Counted = NDArray[np.int64]


def figure_1(run: ReproductionRun) -> Section:
    """Record an iterate of the paper's scheme, with the inverse and without, and draw its messages."""
    impacts = _impacts()
    ways = {
        "with the inverse (the paper)": _iterate(impacts, inverse=True),
        "without division (the default)": _iterate(impacts, inverse=False),
    }
    rows = [
        (
            way,
            place,
            letter.sender + 1,
            letter.receiver + 1,
            letter.kind,
            contents(letter, impacts),
            letter.bytes,
        )
        for way, letters in ways.items()
        for place, letter in enumerate(letters, start=1)
    ]
    letters = table(
        "figure_1_messages",
        "Every message of one iterate, in order",
        ("way", "number", "from", "to", "kind", "platforms in it", "bytes"),
        rows,
    )
    with picture():
        figure = Figure(figsize=(10.4, 3.15), dpi=DPI)
        for axes, (way, sent) in zip(figure.subplots(1, 2), ways.items(), strict=True):
            _panel(axes, way, sent, impacts)
        figure.subplots_adjust(0.005, 0.0, 0.995, 0.92, wspace=0.02)
        save(figure, run.figures / PICTURE)
    return Section(
        "fig-1",
        "Figure 1: messages on a chain of three platforms",
        "Platform 1 sends its impact to 2, which adds its own and sends the sum to 3; 3 has the team's "
        "impact and sends it back along the chain. Everybody takes its own impact out again by the inverse "
        "(eq. (31)).",
        (
            "Drawn from a recorded negotiation of three platforms over eight cells. Which platforms' "
            "impacts a message holds was found by comparing it with the combination of every subset of "
            "them. Strips show the probability, white 0 to dark 1, that those platforms will observe each "
            "cell.",
            f"Both ways take {len(rows) // 2} = 2(n − 1) messages of the same kind. The paper's way back "
            "carries the same team impact to everybody, who then divides; without division each platform "
            "is sent the rest of the team as it is, and no inverse is needed. Platform 2 surely sees cell "
            "5 here: its miss probability is 0, and with plain products the paper's division would be 0/0. "
            "The recorded way with the inverse works because certain sightings are counted apart "
            "(docs/theory.md, (V8)).",
        ),
        tables=(letters, _division_table(impacts)),
        pictures=(PICTURE,),
    )


def contents(letter: Letter, impacts: Sequence[Counted]) -> str:
    """Return the numbers of the platforms whose combined impact a message holds, such as ``1,2``."""
    for size in range(1, len(impacts) + 1):
        for some in itertools.combinations(range(len(impacts)), size):
            if np.array_equal(reduce(OBJECTIVE.combine, [impacts[i] for i in some]), letter.impact):
                return ",".join(str(i + 1) for i in some)
    return ""


def _impacts() -> list[Counted]:
    """Return the three platforms' impacts: overlapping, one sighting certain, so that no two sums agree."""
    misses = np.ones((N, CELLS))
    misses[0, 0:4] = 0.2, 0.4, 0.5, 0.7
    misses[1, 2:6] = 0.6, 0.3, 0.0, 0.5
    misses[2, 4:8] = 0.8, 0.5, 0.3, 0.25
    return [counted(miss) for miss in misses]


def _iterate(impacts: Sequence[Counted], inverse: bool) -> list[Letter]:
    """Return the messages of the first iterate that hold impacts; the chain's far end is the root."""
    recording: Recording = record(
        OBJECTIVE,
        [np.ones(CELLS)],
        [[impact] for impact in impacts],
        Tree.chain(N),
        "jacobi",
        start=(0,) * N,
        inverse=inverse,
        root=N - 1,
        max_sweeps=1,
    )
    return [letter for letter in recording.letters if letter.impact is not None][: 2 * (N - 1)]


def _division_table(impacts: Sequence[Counted]) -> Table:
    """Compare three ways in which platform 2 can get the rest of the team, cell by cell."""
    misses = [1.0 - seen(impact) for impact in impacts]
    total = np.prod(misses, axis=0)
    with np.errstate(invalid="ignore"):
        divided = total / misses[1]
    by_count = 1.0 - seen(OBJECTIVE.remove(reduce(OBJECTIVE.combine, impacts), impacts[1]))
    sent = misses[0] * misses[2]
    rows = [
        (cell + 1, sent[cell], by_count[cell], "0/0" if np.isnan(divided[cell]) else float(divided[cell]))
        for cell in range(CELLS)
    ]
    return table(
        "figure_1_division",
        "What platform 2 takes the others to miss, by cell",
        ("cell", "sent without division", "inverse of counted log-misses", "plain division"),
        rows,
    )


def _panel(axes: Axes, title: str, letters: Sequence[Letter], impacts: Sequence[Counted]) -> None:
    axes.set(xlim=(-1.05, 2 * _APART + 1.05), ylim=(-2.15, 1.95))
    axes.set_aspect("equal")
    axes.axis("off")
    axes.set_title(title[0].upper() + title[1:], fontsize=11, fontweight="bold", loc="left", x=0.02)
    for i, impact in enumerate(impacts):
        _platform(axes, i, impact)
    for place, letter in enumerate(letters, start=1):
        _arrow(axes, place, letter, impacts)
    inverse = letters[-1].impact is letters[-2].impact
    for i in range(N):
        rest = reduce(OBJECTIVE.combine, [impact for k, impact in enumerate(impacts) if k != i])
        formula = (
            rf"$^T\!\alpha \ast\, ^{i + 1}\!\alpha^{{-1}}$"
            if inverse
            else rf"$^{{\overline{{{i + 1}}}}}\alpha$"
        )
        _strip(
            axes, i * _APART, -1.62, rest, f"{formula}  {'computed' if inverse else 'as it came'}", below=True
        )


def _platform(axes: Axes, i: int, impact: Counted) -> None:
    axes.add_patch(Circle((i * _APART, 0.0), 0.33, fc=colour(i), ec="white", lw=1.5, zorder=3))
    ink = palette.unit(palette.text_on(palette.robot_colour(i)))
    axes.text(
        i * _APART,
        -0.01,
        str(i + 1),
        color=ink,
        ha="center",
        va="center",
        fontweight="bold",
        fontsize=12,
        zorder=4,
    )
    _strip(axes, i * _APART, 1.3, impact, rf"own $^{i + 1}\!\alpha$")


def _arrow(axes: Axes, place: int, letter: Letter, impacts: Sequence[Counted]) -> None:
    up = letter.receiver > letter.sender
    side = 1 if up else -1
    start, end = letter.sender * _APART + 0.3 * side, letter.receiver * _APART - 0.3 * side
    axes.add_patch(
        FancyArrowPatch(
            (start, 0.2 * side), (end, 0.2 * side), arrowstyle="-|>", mutation_scale=13, lw=1.5,
            color=INK, shrinkA=2, shrinkB=2, connectionstyle="arc3,rad=-0.12",
        )
    )  # fmt: skip
    middle = (letter.sender + letter.receiver) / 2 * _APART
    names = contents(letter, impacts)
    symbol = r"$^T\!\alpha$" if names == "1,2,3" else rf"$^{{{names}}}\!\alpha$"
    _strip(
        axes,
        middle,
        0.62 if up else -0.84,
        letter.impact,
        f"{place}.  {symbol}   {letter.bytes} bytes",
        below=not up,
    )


def _strip(axes: Axes, x: float, y: float, impact: Counted, label: str, below: bool = False) -> None:
    """Draw the probability that each cell will be observed, with a label over or under it."""
    width, height = _STRIP
    side = width / CELLS
    for cell, share in enumerate(seen(impact)):
        shade = 1.0 - 0.85 * float(share)
        corner = x - width / 2 + cell * side, y
        axes.add_patch(Rectangle(corner, side, height, fc=(shade,) * 3, ec=FAINT, lw=0.6, zorder=3))
    at = y - 0.07 if below else y + height + 0.07
    axes.text(x, at, label, ha="center", va="top" if below else "bottom", fontsize=9)
