"""Records of missions in the operator's window."""

from __future__ import annotations

from pathlib import Path

from vedette.record.explore.read import read_scene, read_snapshots
from vedette.record.flown import scene_of, snapshots_of
from vedette.window.declared import pictures
from vedette.window.hub import Hub
from vedette.window.picture import picture


def recorded(path: Path) -> Hub:
    """Return a hub with all that a mission's record holds.

    Raises:
        InputError: it cannot be read, or is of no mission that can be shown.
    """
    flown = scene_of(path)
    if flown is not None:
        hub, draw = Hub(flown.name, live=False), pictures(flown)
        for snapshot in snapshots_of(path, flown):
            hub.show(draw(snapshot))
        return hub
    scene = read_scene(path)
    hub = Hub(scene.name, live=False)
    for each in read_snapshots(path, scene):
        hub.show(picture(scene, each))
    return hub
