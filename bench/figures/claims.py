"""What the documents say of recorded missions and dated reports, made from the figures."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

from bench.figures.missions import FREE_AREA, MISSIONS, TRACK_SEEDS, TRACKED, WAYS
from bench.figures.record import DOCS, Record
from bench.figures.report import cell

README, GALLERY, TRACK = "README.md", "docs/gallery.md", "docs/how-to/track.md"
HELD_OUT = DOCS / "reports" / "2026-11-30-held-out.md"
COUNT = ("none", "one", "two", "three")


@dataclass(frozen=True)
class Claim:
    """Words that stand in a document, however its lines are broken."""

    document: str  # from the project's folder
    text: str

    def places(self, text: str) -> list[tuple[int, int]]:
        """Return from where to where a document's text has the words."""
        return [match.span() for match in self._pattern.finditer(text)]

    def replaced(self, by: Claim, text: str) -> str:
        """Return a document's text with another claim's words in the place of these, in the same lines."""
        old, new = self.text.split(), by.text.split()
        if len(old) != len(new):
            return self._pattern.sub(lambda _: by.text, text)
        return self._pattern.sub(lambda match: _with_words(match[0], new), text)

    @property
    def _pattern(self) -> re.Pattern[str]:
        return re.compile(r"\s+".join(map(re.escape, self.text.split())))


def claims(records: Mapping[str, Record]) -> list[Claim]:
    """Return all claims, always in the same order; none while a mission lacks a record."""
    if not set(MISSIONS) <= set(records):
        return []
    return [
        *(Claim(README, records["office"][line]) for line in ("closing", "left_out")),
        Claim(README, _cost(records["office"])),
        *(Claim(document, _area(records["willow"])) for document in (README, GALLERY)),
        Claim(README, _building(records["willow"])),
        Claim(README, _storm(records["storm"])),
        *(Claim(README, text) for text in _planners()),
        *(Claim(TRACK, text) for text in _tracking(records)),
        *(Claim(GALLERY, f"`{mission.command}`") for mission in MISSIONS.values() if mission.pictures),
    ]


def _cost(record: Record) -> str:
    return f"takes some {record['cpu_s']:.0f} s of CPU time ({record['machine']})"


def _area(record: Record) -> str:
    """Return what can be seen at all, to fifty square metres: what is known is a share of it."""
    visible = record["figures"][FREE_AREA] / record["figures"]["coverage"]
    return f"a real office building of some {50 * round(visible / 50)} m²"


def _building(record: Record) -> str:
    figures = record["figures"]
    return (
        f"90 % after {_seconds(figures['t90_s'])} s, 99 % after {_seconds(figures['t99_s'])} s, and "
        f"{100 * figures['coverage']:.1f} % when they agreed after {_seconds(figures['time_s'])} s"
    )


def _storm(record: Record) -> str:
    states = record["robots"]
    left = ("first", "second", "third")[states.index("done")]
    return f"{COUNT[states.count('dead')]} of its robots stop for good, and the {left} finishes"


def _planners() -> list[str]:
    """Return what is said of the default's times, as ratios to those of `burgard` with their intervals."""
    soon, nearly, done = (
        cell(HELD_OUT, "Three and eight robots", column, "3", "all")
        for column in ("90 %", "99 %", "complete")
    )
    return [
        f"reach 90 % after {soon.replace(' ', ' of the time of `burgard` ')}, 99 % after {nearly}, and are "
        f"complete after {done}"
    ]


def _tracking(records: Mapping[str, Record]) -> list[str]:
    """Return the rows of the table of ways to coordinate, means over the seeds, and what is said of them."""

    def each(way: str, name: str) -> list[float]:
        return [records[f"track-{seed}"]["figures"][f"comparison.{way}.{name}"] for seed in TRACK_SEEDS]

    def mean(way: str, name: str) -> float:
        return round(fmean(each(way, name)), digits[name])  # so that differences are those of the table

    digits = dict(zip(TRACKED, (1, 0, 2, 2), strict=True))
    shared, negotiated, optimum = (mean(way, TRACKED[0]) for way in WAYS[1:])
    gains = sum(a > b for a, b in zip(each(WAYS[1], TRACKED[0]), each(WAYS[2], TRACKED[0]), strict=True))
    return [
        *(
            f"| `{way}` | {' | '.join(f'{mean(way, name):.{n}f}' for name, n in digits.items())} |"
            for way in WAYS
        ),
        f"agreeing on who looks where gains {shared - negotiated:.1f} nat more, in "
        f"{'every one' if gains == len(TRACK_SEEDS) else gains} of these missions, and is within "
        f"{negotiated - optimum:.1f} nat of trying every joint choice",
    ]


def _with_words(text: str, words: Sequence[str]) -> str:
    """Return a text with other words, as many as it has, between the same blanks."""
    left = iter(words)
    return re.sub(r"\S+", lambda _: next(left), text)


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.0f}"
