"""How much is known, in words: a share of ground that is known, else how much, how fast, what is left."""

from __future__ import annotations

from collections.abc import Iterator

from vedette.missions.explore.expected import Expected, Span
from vedette.record.explore.log import ExploreSnapshot


def caption(snapshot: ExploreSnapshot) -> str:
    """Return what stands over a picture of a snapshot."""
    share = snapshot.coverage
    known = f"{snapshot.known_m2:.0f} m² known" if share is None else f"{100 * share:.1f} % covered"
    return f"{snapshot.t:.0f} s    {known}"


def outlook(expected: Expected, now: float) -> Iterator[tuple[str, str]]:
    """Yield what is expected at a time [s], name and value: four in five come to lie in each span."""
    known, ended = expected.known, expected.ended
    yield (
        "90 % known",
        "passed, most likely" if known.high < now else f"{known.middle:.0f} s ({_span(known)})",
    )
    yield "end", f"{ended.middle:.0f} s ({_span(ended)})"


def _span(span: Span) -> str:
    return f"{span.low:.0f} to {span.high:.0f}"


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
        yield from outlook(snapshot.expected, snapshot.t)
