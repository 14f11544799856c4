"""The live view of tracking: vehicles and tracks over the area in characters, and a table of the team."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
from rich.console import Console, RenderableType
from rich.style import Style
from rich.text import Text

from vedette.record.board import Board, board, figures_line, framed, states, team_table
from vedette.record.display import Display
from vedette.record.track.ellipse import SIGMA
from vedette.record.track.log import TrackScene, TrackSnapshot

_NAMES = "abcdefghijklmnopqrstuvwxyz"
_ROUND = 48  # points of an ellipse
_GROUND = Style(bgcolor="grey11")


def track_display(
    scene: TrackScene, quiet: bool = False, console: Console | None = None
) -> Display[TrackSnapshot]:
    """Return the live view of a mission."""
    return Display(partial(screen, scene), partial(line, scene), quiet, console)


def line(scene: TrackScene, snapshot: TrackSnapshot) -> str:
    """Return a snapshot in one line."""
    team = states(scene, snapshot.vehicles)
    error = math.sqrt(snapshot.squared_error)
    return f"{snapshot.t:7.1f} s  entropy {snapshot.entropy:6.1f} nat  error {error:5.1f} m  {team}"


def screen(scene: TrackScene, console: Console, snapshot: TrackSnapshot) -> RenderableType:
    """Return the picture of a snapshot, fitted to the console: dots are 95 % ellipses, letters targets."""
    head = figures_line(
        ("time", f"{snapshot.t:6.1f} s"),
        ("entropy", f"{snapshot.entropy:.1f} nat"),
        ("error", f"{math.sqrt(snapshot.squared_error):.1f} m"),
        ("NEES", f"{snapshot.nees:.2f}"),
    )
    sees = [
        " ".join(f"{_NAMES[t % len(_NAMES)]}:{scene.targets[t]}" for t in vehicle.seen)
        for vehicle in snapshot.vehicles
    ]
    table = team_table("vehicle", scene, snapshot.vehicles, [("sensor", scene.sensors), ("sees", sees)])
    picture = board(console, scene, scene.area, _GROUND, [head])
    if picture is None:
        return framed(scene, head, table)
    _put_targets(picture, snapshot)
    picture.put_vehicles(snapshot.vehicles)
    return framed(scene, head, picture.text(), Text(""), table)


def _put_targets(picture: Board, snapshot: TrackSnapshot) -> None:
    turns = np.linspace(0.0, 2.0 * np.pi, _ROUND)
    circle = SIGMA * np.stack([np.cos(turns), np.sin(turns)])
    seen = {target for vehicle in snapshot.vehicles for target in vehicle.seen}
    for mean, covariance in zip(snapshot.means, snapshot.covariances, strict=True):
        for x, y in (mean[:2, None] + np.linalg.cholesky(covariance[:2, :2]) @ circle).T.tolist():
            picture.put(x, y, "·", Style(color="grey62"))
    for t, mean in enumerate(snapshot.means):
        colour = "bright_white" if t in seen else "grey62"
        letter = _NAMES[t % len(_NAMES)]
        picture.put(float(mean[0]), float(mean[1]), letter, Style(color=colour, bold=True))
