"""The live view of tracking: vehicles and tracks over the area in characters, and a table of the team."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import numpy as np
from rich.console import Console, RenderableType
from rich.style import Style

from vedette.record.board import Board, fitted
from vedette.record.display import Display
from vedette.record.track.ellipse import SIGMA
from vedette.record.track.letters import letter
from vedette.record.track.log import TrackScene, TrackSnapshot
from vedette.record.view import Size, TeamTable, arranged, explained, figure, flowing, states

_ROUND = 48  # points of an ellipse
_GROUND = Style(bgcolor="grey11")
_SEES = 36  # characters that tell what a vehicle sees, at most
_MARKS = (
    (" a ", Style(color="bright_white", bold=True), "target seen"),
    (" a ", Style(color="grey62", bold=True), "not seen"),
    ("···", Style(color="grey62"), "95 % of where it may be"),
    ("∙∙∙", Style(bold=True), "planned"),
    (" × ", Style(bold=True), "lost"),
)


def track_display(
    scene: TrackScene, quiet: bool = False, console: Console | None = None
) -> Display[TrackSnapshot]:
    """Return the live view of a mission."""
    return Display(partial(screen, scene), partial(line, scene), quiet, console)


def line(scene: TrackScene, snapshot: TrackSnapshot) -> str:
    """Return a snapshot in one line."""
    team = states(scene.vehicles, snapshot.vehicles)
    error = math.sqrt(snapshot.squared_error)
    return f"{snapshot.t:7.1f} s  entropy {snapshot.entropy:6.1f} nat  error {error:5.1f} m  {team}"


def screen(scene: TrackScene, console: Console, snapshot: TrackSnapshot) -> RenderableType:
    """Return the picture of a snapshot, fitted to the console: dots are 95 % ellipses, letters targets."""
    figures = (
        figure("time", f"{snapshot.t:.1f} s"),
        figure("entropy", f"{snapshot.entropy:.1f} nat"),
        figure("error", f"{math.sqrt(snapshot.squared_error):.1f} m"),
        figure("NEES", f"{snapshot.nees:.2f}"),
    )
    sees = [_seen(scene, vehicle.seen) for vehicle in snapshot.vehicles]
    columns = [("sees", sees), ("sensor", scene.sensors)]

    def picture(room: Size) -> RenderableType:
        drawn = Board(scene.area, *room, _GROUND)
        _put_targets(drawn, snapshot)
        drawn.put_vehicles(snapshot.vehicles)
        return drawn.text()

    width = console.width - 4
    return arranged(
        console, scene, [flowing(figures, width)], picture, partial(fitted, scene.area),
        TeamTable("vehicle", scene, snapshot.vehicles, columns), explained(_MARKS, width),
    )  # fmt: skip


def _seen(scene: TrackScene, targets: Sequence[int]) -> str:
    """Return which targets a vehicle sees, by their letters; with their names if these are short."""
    named = " ".join(f"{letter(t)}:{scene.targets[t]}" for t in targets)
    text = named if len(named) <= _SEES else " ".join(map(letter, targets))
    return text if len(text) <= _SEES else f"{text[: _SEES - 1]}…"


def _put_targets(picture: Board, snapshot: TrackSnapshot) -> None:
    turns = np.linspace(0.0, 2.0 * np.pi, _ROUND)
    circle = SIGMA * np.stack([np.cos(turns), np.sin(turns)])
    seen = {target for vehicle in snapshot.vehicles for target in vehicle.seen}
    for mean, covariance in zip(snapshot.means, snapshot.covariances, strict=True):
        for x, y in (mean[:2, None] + np.linalg.cholesky(covariance[:2, :2]) @ circle).T.tolist():
            picture.put(x, y, "·", Style(color="grey62"))
    for t, mean in enumerate(snapshot.means):
        colour = "bright_white" if t in seen else "grey62"
        picture.put(float(mean[0]), float(mean[1]), letter(t), Style(color=colour, bold=True))
