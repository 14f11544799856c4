"""The live view of an exploration: a map that fills in, or plain lines where there is no terminal."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

from rich.console import Console

from vedette.record.display import Display
from vedette.record.explore.log import ExploreScene, ExploreSnapshot
from vedette.record.explore.screen import screen
from vedette.record.explore.told import progress
from vedette.record.marks import together
from vedette.record.view import states


def explore_display(
    scene: ExploreScene,
    quiet: bool = False,
    console: Console | None = None,
    clock: Callable[[], float] = time.monotonic,
) -> Display[ExploreSnapshot]:
    """Return the live view of a mission; the ``clock`` [s] only limits the pictures a second."""
    return Display(partial(screen, scene), partial(line, scene), quiet, console, clock)


def line(scene: ExploreScene, snapshot: ExploreSnapshot) -> str:
    """Return a snapshot in one line."""
    robots = states(scene.vehicles, snapshot.robots)
    team = "" if snapshot.links is None else f"  {together(snapshot.parts)}"
    joined = "" if snapshot.frames is None else f"  maps {snapshot.frames.told}"
    return f"{snapshot.t:7.1f} s  {_known(snapshot)}  {robots}{team}{joined}"


def _known(snapshot: ExploreSnapshot) -> str:
    if snapshot.coverage is None or snapshot.known_fraction is None:
        return "  ".join(f"{name} {value}" for name, value in progress(snapshot))
    known, covered = 100 * snapshot.known_fraction, 100 * snapshot.coverage
    return f"known {known:5.1f} %  covered {covered:5.1f} %  entropy {snapshot.entropy:.0f} nat"
