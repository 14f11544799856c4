"""Play what may befall a team, and write the page that shows it: ``theatre.py docs/theatre.html``.

With ``--kept`` after it the page is today's, and what it plays stays as it is.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from tests.support.liars import MODES, LyingTeam
from vedette.record.explore.log import ExploreScene
from vedette.run import Explore
from vedette.sim.explore.run import observer_of, views
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.faults import Schedule
from vedette.sim.worlds import office
from vedette.team import PlatformSpec
from vedette.window.explore import Shower
from vedette.window.export import Show, export_page, page_with, records_in
from vedette.window.hub import Hub
from vedette.window.picture import picture

STORMS = {
    "The team is cut in two for a minute": (
        4, None, "faults:\n  - {at: 20, fault: partition, parts: [[1, 2], [3, 4]], for: 60}\n",
        [(20.0, "robots 1 and 2 hear nothing of 3 and 4"), (80.0, "the links are whole again")],
    ),
    "A robot's program crashes, and starts anew with an empty memory": (
        3, None, "faults:\n  - {at: 15, fault: crash, robot: 2}\n  - {at: 55, fault: restart, robot: 2}\n",
        [(15.0, "robot-2 crashes"), (55.0, "robot-2 starts anew and gets the map back")],
    ),
    "Radios reach four metres: parts meet and part again": (4, "4,6", None, []),
}  # fmt: skip
SEED = 4


def _world(seed: int) -> object:
    return office(np.random.default_rng([seed, 5]), 14.0, 12.0)


def storm(name: str) -> Show:
    """Return a mission that a schedule or a radio befalls."""
    robots, radio, schedule, entries = STORMS[name]
    hub = Hub(name, live=False)
    with TemporaryDirectory() as folder:
        faults = None
        if schedule is not None:
            faults = Path(folder) / "faults.yaml"
            faults.write_text(schedule)
        mission = Explore(_world(SEED), robots, SEED, radio=radio, faults=faults, max_time=240.0)
        for at, what in entries:
            hub.note(what, at)
        mission.play([Shower(hub, partial(picture, mission.scene))])
    return Show(name, hub.history, hub.events(0)[1])


def liar() -> Show:
    """Return a mission in which one member calls everything free, by signed evidence."""
    name, robots = "A member lies: it calls everything around it free", 4
    setup = ExploreSetup(seed=SEED, max_time=240.0, faults=Schedule(()))
    specs = [PlatformSpec(name=f"robot-{i + 1}") for i in range(robots)]
    team: ExploreSimulation = LyingTeam(_world(SEED), specs, setup, MODES["free"], 1)
    hub = Hub(name, live=False)
    hub.note("robot-2 lies from now on", 0.0)
    scene = ExploreScene.of(team.world, [spec.name for spec in specs])
    observer = observer_of(team, [Shower(hub, partial(picture, scene))])
    named: set[tuple[int, int]] = set()

    def look() -> None:
        seen = views(team)
        seen[1] = replace(seen[1], frame=seen[0].frame, classes=seen[0].classes, seen=seen[0].seen)
        observer.look(team.now, seen, team.network.links())  # the map is that of the honest
        for i in team.living:
            for robot, what in team.agents[i].complaints.items():
                if robot == 1 and i != 1 and (i, robot) not in named:
                    named.add((i, robot))
                    hub.note(f"robot-{i + 1} of robot-{robot + 1}: {what}", team.now)

    team.run(look, 0.5)
    return Show(name, hub.history, hub.events(0)[1])


def main(path: Path, *, kept: bool) -> None:
    """Write the page."""
    if kept:
        path.write_text(page_with(records_in(path.read_text(encoding="utf-8"))), encoding="utf-8")
    else:
        export_page([*map(storm, STORMS), liar()], path)
    print(f"{path}: {path.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main(Path(sys.argv[1]), kept="--kept" in sys.argv[2:])
