"""A robot's own folder: its map, its summary and its record stay there, whatever becomes of the process."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import Any

from vedette.agent.state import State
from vedette.errors import InputError, InputWarning
from vedette.net.explore import content as maps
from vedette.net.feed import Onlooker
from vedette.net.gather import path_of
from vedette.net.names import robot_name
from vedette.net.report import MOST_WORDS, Report
from vedette.net.results import lasted, told, write_results
from vedette.outcome import Outcome
from vedette.record.files import new_directory
from vedette.record.folder import OutputFolder
from vedette.record.log import LEFT, VehicleSample
from vedette.record.mcap import McapFile
from vedette.record.robot import RobotRecorder
from vedette.record.space import space_alerts

PERIOD = 30.0  # of real time, at most, in which what has come to be known is put on disk [s]
RECORD = "run.mcap"


class Keeper:
    """Writes a robot's reports into a folder: every 30 s, when the mission has ended for it, when it stops.

    A folder that cannot be written to is told of once, and the mission goes on; it is tried again each time.
    """

    def __init__(
        self,
        folder: OutputFolder,
        team: str,
        mission: str,
        say: Callable[[str], None],
        onlooker: Onlooker[Any, Any] | None = None,
    ) -> None:
        """Keep in a folder that is this start's alone.

        Args:
            folder: of the results.
            team: its name.
            mission: what the robot does.
            say: tells whoever watches the process.
            onlooker: makes what is recorded of a vehicle's reports; None: the robot explores.
        """
        self._folder, self._team, self._mission, self._say = folder, team, mission, say
        self._onlooker = onlooker
        self._record: McapFile[Any] | None = None
        self._recorded = -inf  # the mission's time of what was recorded last [s]
        self._due: float | None = None  # when to write next [s]
        self._ended: Outcome | None = None  # of the mission, for this robot
        self._failed = ""  # why nothing can be written

    @property
    def alerts(self) -> tuple[str, ...]:
        """What an operator has to know of the folder."""
        lines = self._failed, *space_alerts(self._folder.path)
        return tuple(line[:MOST_WORDS] for line in lines if line)

    def take(self, report: Report, now: float) -> None:
        """Add a report to the record, and write it all if it is time; ``now`` by the process's clock [s]."""
        state, ended = report.condition.state, self._ended
        if state != LEFT:
            self._ended = Outcome.of(report.condition.ending) if state == State.DONE.value else None
        last = state == LEFT
        due = self._due is not None and now >= self._due
        if self._due is None or due:
            self._due = now + PERIOD
        try:
            self._add(report, with_map=due or last)
            if due or last or self._ended is not ended:
                self._write(report, last)
            self._failed = ""
        except (InputError, OSError) as error:
            if not self._failed:
                self._say(f"{error}; the mission goes on")
            self._failed = str(error)

    def _add(self, report: Report, with_map: bool) -> None:
        condition = report.condition
        if self._onlooker is not None:
            return self._add_flight(report, self._onlooker)
        if not isinstance(self._record, RobotRecorder):
            name, facts = robot_name(condition.robot), {"team": self._team, "mission": self._mission}
            self._record = RobotRecorder(lambda: self._folder / RECORD, name, facts)
        at = condition.x, condition.y, condition.heading
        t = max(lasted(condition), 0.0)
        self._record.add(t, VehicleSample(*at, condition.state, True, path_of(condition)))
        if with_map and self._mission == "explore":
            seen = maps.read_content(report.content)
            if seen.rows and seen.cols:
                self._record.add_map(t, maps.frame_of(seen), maps.classes_of(seen))

    def _add_flight(self, report: Report, onlooker: Onlooker[Any, Any]) -> None:
        """Add what a vehicle tells, unless time stands still."""
        scene, snapshot = onlooker.see({report.condition.robot: report}, {})
        if self._record is None:
            self._record = onlooker.recorder(lambda: self._folder / RECORD, scene)
        if snapshot.t > self._recorded:
            self._recorded = snapshot.t
            self._record.update(snapshot)

    def _write(self, report: Report, last: bool) -> None:
        outcome = self._ended or (Outcome.INTERRUPTED if last else None)
        folder = self._folder.path
        summary = write_results(report, folder, self._team, self._mission, outcome)
        if self._record is not None and last:
            self._record.close()
        elif self._record is not None:
            self._record.save(folder / RECORD)
        if outcome is not None:
            self._say(f"{told(summary)}; kept in {folder}")


def folder_of_a_start(out: Path) -> OutputFolder:
    """Return a folder for what one start of a robot finds out: what an earlier one has left stays as it is.

    Raises:
        InputError: it cannot be made or written to.

    Warns:
        InputWarning: there is something in the folder, so that another beside it is made.
    """
    try:
        used = out.is_dir() and any(out.iterdir())
    except OSError as error:
        raise InputError(f"cannot read {out}: {error.strerror or error}; choose another folder") from error
    if not used:
        return OutputFolder.make(out, True, "")
    beside = new_directory(out.parent, out.name)
    text = f"{out} has what an earlier start left; this one's results go to {beside}"
    warnings.warn(text, InputWarning, stacklevel=2)
    return OutputFolder(beside, made=True)
