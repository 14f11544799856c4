"""Faults staged on real processes: a schedule's crashes, restarts and freezes, done by signals."""

from __future__ import annotations

import signal

from vedette.net.launch import TeamProcesses
from vedette.net.team import TeamWatch
from vedette.sim.faults import Crashes, Freezes, Restarts, Schedule, Thaws, Timeline


class Stage:
    """Does to a team's processes what a schedule says; each process does what befalls its links itself."""

    def __init__(self, schedule: Schedule, team: TeamProcesses, watch: TeamWatch[object]) -> None:
        """Begin before the first fault."""
        self._timeline = Timeline(schedule, team.plan.size)
        self._team, self._watch = team, watch

    def befall(self, now: float) -> None:
        """Let happen what is due by a time of the schedule [s]."""
        for happening in self._timeline.advance(now):
            robot = happening.robot
            match happening:
                case Crashes():
                    self._team.signal(robot, signal.SIGKILL)
                case Restarts():
                    told = self._watch.conditions.get(robot)
                    self._team.restart(robot, None if told is None else (told.x, told.y, told.heading))
                case Freezes():
                    self._team.signal(robot, signal.SIGSTOP)
                case Thaws():
                    self._team.signal(robot, signal.SIGCONT)
