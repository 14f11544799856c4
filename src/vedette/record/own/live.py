"""The live view of an own domain, and its run record."""

from __future__ import annotations

from functools import partial

from rich.console import Console, RenderableType
from rich.style import Style

from vedette.record.board import Board, fitted
from vedette.record.display import Display
from vedette.record.mcap import McapFile, Medium, Place, stamp_of
from vedette.record.own.observer import OwnScene, OwnSnapshot
from vedette.record.ros import RosMessages, ros_names
from vedette.record.scenes import facts_of_scene
from vedette.record.view import Size, TeamTable, arranged, explained, figure, flowing, states

_GROUND = Style(color="grey82", bgcolor="grey11")
_MARKS = (("∙∙∙", Style(bold=True), "planned"), (" × ", Style(bold=True), "lost"))


def own_display(scene: OwnScene, quiet: bool = False, console: Console | None = None) -> Display[OwnSnapshot]:
    """Return the live view."""
    return Display(partial(screen, scene), partial(line, scene), quiet, console)


def line(scene: OwnScene, snapshot: OwnSnapshot) -> str:
    """Return a snapshot in one line."""
    figures = "".join(f"  {name} {value:9.4g}" for name, value in snapshot.figures.items())
    return f"{snapshot.t:7.1f} s{figures}  {states(scene.vehicles, snapshot.vehicles)}"


def screen(scene: OwnScene, console: Console, snapshot: OwnSnapshot) -> RenderableType:
    """Return the picture of a snapshot, fitted to the console."""
    told = [figure("time", f"{snapshot.t:.1f} s")]
    told += [figure(name, f"{value:.4g}") for name, value in snapshot.figures.items()]

    def picture(room: Size) -> RenderableType:
        board = Board(scene.area, *room, _GROUND)
        board.put_vehicles(snapshot.vehicles)
        return board.text()

    width = console.width - 4
    team = TeamTable("vehicle", scene, snapshot.vehicles, [])
    head, below = [flowing(told, width)], explained(_MARKS, width)
    return arranged(console, scene, head, picture, partial(fitted, scene.area), team, below)


class OwnMcapWriter(McapFile[RosMessages]):
    """Write each snapshot: a context manager, and a ``Sink``; ``docs/outputs.md`` lists the topics."""

    def __init__(self, place: Place | Medium, scene: OwnScene) -> None:
        """Open the file."""
        self._names = ros_names(scene.vehicles)
        pairs = zip(scene.vehicles, self._names, strict=True)
        facts = {"scenario": scene.name} | {f"vehicle {name}": ros for name, ros in pairs}
        super().__init__(place, RosMessages(), facts | facts_of_scene("own", scene))

    def update(self, snapshot: OwnSnapshot) -> None:
        """Write one snapshot."""
        stamp = stamp_of(snapshot)
        vehicles = list(zip(self._names, snapshot.vehicles, strict=True))
        self._write_frames(stamp, vehicles)
        for name, vehicle in vehicles:
            self._write_flight(stamp, name, vehicle)
        for name, value in snapshot.figures.items():
            self._write(f"/metrics/{name}", stamp, self._ros.number(value))
