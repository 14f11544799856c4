"""The live view of monitoring: the field in characters with the vehicles on it, and a table of the team."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray
from rich.console import Console, RenderableType
from rich.style import Style

from vedette.number import short
from vedette.record.board import Board, fitted
from vedette.record.display import Display
from vedette.record.monitor.log import MonitorScene, MonitorSnapshot
from vedette.record.view import Size, TeamTable, arranged, explained, figure, flowing, states

_SHADES = " ·░▒▓█"
_GROUND = Style(color="grey82", bgcolor="grey11")
_MARKS = (
    ("░▒▓█", _GROUND, "the field as it is taken to be: the brighter, the higher"),
    ("∙∙∙", Style(bold=True), "planned"),
    (" × ", Style(bold=True), "lost"),
)


def monitor_display(
    scene: MonitorScene, quiet: bool = False, console: Console | None = None
) -> Display[MonitorSnapshot]:
    """Return the live view of monitoring."""
    latest = _Latest()
    return Display(partial(screen, scene, latest), partial(line, scene, latest), quiet, console)


class _Latest:
    """The last snapshot at which the field was worked out."""

    def __init__(self) -> None:
        self.snapshot: MonitorSnapshot | None = None

    def of(self, snapshot: MonitorSnapshot) -> MonitorSnapshot:
        if snapshot.mean is not None or self.snapshot is None:
            self.snapshot = snapshot
        return self.snapshot


def line(scene: MonitorScene, latest: _Latest, snapshot: MonitorSnapshot) -> str:
    """Return a snapshot in one line."""
    known = latest.of(snapshot)
    error = "" if known.rmse is None else f"  error {short(known.rmse):>7} (rms)"
    team = states(scene.vehicles, snapshot.vehicles)
    return f"{snapshot.t:7.1f} s{error}  last looked at {snapshot.mean_age:4.0f} s ago  {team}"


def screen(
    scene: MonitorScene, latest: _Latest, console: Console, snapshot: MonitorSnapshot
) -> RenderableType:
    """Return the picture of a snapshot, fitted to the console."""
    known = latest.of(snapshot)
    figures = [figure("time", f"{snapshot.t:.1f} s")]
    if known.rmse is not None and known.entropy is not None:
        figures += [figure("error", short(known.rmse)), figure("entropy", f"{known.entropy:.0f} nat")]
    figures.append(
        figure("last looked at", f"{snapshot.mean_age:.0f} s ago, {snapshot.worst_age:.0f} s at worst")
    )
    x0, x1, y0, y1 = scene.frame.extent
    area = x0, y0, x1, y1

    def picture(room: Size) -> RenderableType:
        drawn = Board(area, *room, _GROUND)
        if known.mean is not None:
            shades = _shades(known.mean, drawn.lines, drawn.columns)
            drawn.fill(["".join(_SHADES[k] for k in row) for row in shades[::-1].tolist()])
        drawn.put_vehicles(snapshot.vehicles)
        return drawn.text()

    width = console.width - 4
    team = TeamTable("vehicle", scene, snapshot.vehicles, [])
    head = [flowing(figures, width)]
    return arranged(console, scene, head, picture, partial(fitted, area), team, explained(_MARKS, width))


def _shades(mean: NDArray[np.float32], lines: int, columns: int) -> NDArray[np.int64]:
    """Return the shade (lines, columns) of each character, the lowest line first: that of its middle cell."""
    rows = (np.arange(lines) * 2 + 1) * mean.shape[0] // (2 * lines)
    cols = (np.arange(columns) * 2 + 1) * mean.shape[1] // (2 * columns)
    some = mean[np.ix_(rows, cols)].astype(np.float64)
    share = (some - some.min()) / max(float(np.ptp(some)), 1e-300)
    return np.asarray(np.minimum((share * len(_SHADES)).astype(np.int64), len(_SHADES) - 1))
