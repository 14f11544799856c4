"""Pictures of a mission of vehicles drawn anew from its record.

Those that lack what is not recorded, as the ways of coordination that it was compared with, have a name of
their own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import singledispatch
from pathlib import Path
from typing import Any, TypeAlias

from vedette.errors import InputError
from vedette.record.flights import FlightLog, FlightScene
from vedette.record.flown import snapshots_of
from vedette.record.monitor.log import MonitorLog, MonitorScene
from vedette.record.own.observer import OwnScene
from vedette.record.search.log import SearchLog, SearchScene
from vedette.record.search.summary import ended_how
from vedette.record.track.log import TrackLog, TrackScene

Draw: TypeAlias = Callable[[Path], None]  # writes a picture there


def flight_pictures(record: Path, scene: FlightScene, figures: Mapping[str, Any]) -> dict[str, Draw]:
    """Return who draws the pictures of a mission of vehicles, by the names of their files, the film last.

    ``figures``: of its summary.

    Raises:
        InputError: the record cannot be read, or nothing happens in it.
    """
    log = _log(scene)
    for snapshot in snapshots_of(record, scene):
        log.add(snapshot)
    if not log.snapshots:
        raise InputError(f"{record}: nothing happens in it; nothing can be drawn")
    return _pictures(scene, log, figures)


def _log(scene: FlightScene) -> FlightLog[Any, Any]:
    kinds = {TrackScene: TrackLog, SearchScene: SearchLog, MonitorScene: MonitorLog}
    kind: type[FlightLog[Any, Any]] = kinds.get(type(scene), FlightLog)
    return kind(scene)


@singledispatch
def _pictures(scene: FlightScene, log: Any, figures: Mapping[str, Any]) -> dict[str, Draw]:
    raise TypeError(f"no pictures of {type(scene).__name__}")


@_pictures.register
def _(scene: TrackScene, log: TrackLog, figures: Mapping[str, Any]) -> dict[str, Draw]:
    from vedette.record.track.entropy import entropy_png  # drawing takes a second to import
    from vedette.record.track.panel import track_gif
    from vedette.record.track.tracks import tracks_png

    drawn: dict[str, Draw] = {"tracks.png": lambda path: tracks_png(log, path)}
    if "coordination" in figures:  # a robot's own knows no errors
        logs = {figures["coordination"]: log}
        drawn["entropy-recorded.png"] = lambda path: entropy_png(logs, {}, path)
    return drawn | {"mission.gif": lambda path: track_gif(log, path)}


@_pictures.register
def _(scene: SearchScene, log: SearchLog, figures: Mapping[str, Any]) -> dict[str, Draw]:
    from vedette.record.search.panel import search_gif
    from vedette.record.search.stages import pdf_png

    return {
        "pdf.png": lambda path: pdf_png(log, ended_how(figures), path),
        "mission.gif": lambda path: search_gif(log, path),
    }


@_pictures.register
def _(scene: MonitorScene, log: MonitorLog, figures: Mapping[str, Any]) -> dict[str, Draw]:
    from vedette.record.monitor.curves import curves_png
    from vedette.record.monitor.panels import monitor_gif, stages_png

    drawn: dict[str, Draw] = {"field-recorded.png": lambda path: stages_png(log, path)}
    if log.measured:  # a robot's own knows no errors
        logs = {figures["coordination"]: log}
        drawn["curves-recorded.png"] = lambda path: curves_png(logs, figures["seed"], path)
        drawn["mission.gif"] = lambda path: monitor_gif(log, path)
    return drawn


@_pictures.register
def _(scene: OwnScene, log: FlightLog[Any, Any], figures: Mapping[str, Any]) -> dict[str, Draw]:
    from vedette.record.own.pictures import curves_png, draw_ways, film

    drawn: dict[str, Draw] = {
        "ways-recorded.png": lambda path: draw_ways(log, None, ended_how(figures), path)
    }
    if log.snapshots[0].figures:  # a robot's own knows none
        logs = {figures["coordination"]: log}
        drawn["curves-recorded.png"] = lambda path: curves_png(logs, path)
    return drawn | {"mission.gif": lambda path: film(log, None, path)}
