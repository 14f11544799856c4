"""How much is known, in words: a share of ground that is known, else how much, how fast, what is left."""

from __future__ import annotations

from collections.abc import Iterator

from vedette.missions.explore.expected import Expected, Span
from vedette.record.explore.log import ExploreSnapshot

KNOWN_SHARE = 0.9


def caption(snapshot: ExploreSnapshot) -> str:
    """Return what stands over a picture of a snapshot: where frames are unknown, whose maps are joined."""
    share = snapshot.coverage
    known = f"{snapshot.known_m2:.0f} m² known" if share is None else f"{100 * share:.1f} % covered"
    joined = "" if snapshot.frames is None else f"    maps {snapshot.frames.told}"
    return f"{snapshot.t:.0f} s    {known}{joined}"


def outlook(expected: Expected, now: float, share: float | None = None) -> Iterator[tuple[str, str]]:
    """Yield what is expected at a time [s], name and value: four in five come to lie in each span.

    ``share``: of the ground that is known, where somebody knows how much there is.
    """
    known, ended = expected.known, expected.ended
    if share is not None and share < KNOWN_SHARE:
        yield "90 % known", _span(known, now)
    elif share is None and known.high >= now:
        yield "90 % known", _span(known, 0.0)
    else:
        yield "90 % known", "passed, most likely" if share is None else "passed"
    yield "end", _span(ended, now)


def _span(span: Span, least: float) -> str:
    low, middle, high = (max(each, least) for each in (span.low, span.middle, span.high))
    return f"{middle:.0f} s ({low:.0f} to {high:.0f})"


def progress(snapshot: ExploreSnapshot) -> Iterator[tuple[str, str]]:
    """Yield figures of a snapshot, name and value."""
    if snapshot.known_fraction is not None and snapshot.entropy is not None:
        yield "known", f"{100 * snapshot.known_fraction:.1f} %"
        yield "entropy", f"{snapshot.entropy:,.0f} nat"
    else:
        yield "known", f"{snapshot.known_m2:.1f} m²"
        yield "rate", f"{snapshot.rate_m2_s:.2f} m²/s"
        if snapshot.frontiers is not None:
            yield "frontiers left", str(snapshot.frontiers)
    if snapshot.expected is not None:
        yield from outlook(snapshot.expected, snapshot.t, snapshot.coverage)
