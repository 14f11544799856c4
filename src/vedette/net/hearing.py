"""What an operator's session hears: the latest report of each robot, and how long ago it came."""

from __future__ import annotations

import time
from collections.abc import Callable

from vedette.net.inbox import Inbox
from vedette.net.names import Topic
from vedette.net.report import Report, read_report
from vedette.net.transport import Operator, Published


class Hearing:
    """Keeps the latest report of each robot that a session reaches; whoever falls silent stays in it."""

    def __init__(self, operator: Operator, clock: Callable[[], float] = time.monotonic) -> None:
        """Begin to hear; ``clock`` [s]."""
        self.reports: dict[int, Report] = {}
        self.malformed = 0
        self._clock = clock
        self._times: dict[int, float] = {}  # when each was heard last [s]
        self._inbox = Inbox()
        operator.subscribe(Topic.REPORT, self._inbox.put)

    def listen(self, seconds: float, enough: Callable[[], bool] = lambda: False) -> None:
        """Take what comes within a time [s], or until it is enough."""
        end = self._clock() + seconds
        while not enough() and (left := end - self._clock()) > 0.0:
            event = self._inbox.get(left)
            if isinstance(event, Published):
                self._take(event)

    def silent(self, robot: int) -> float:
        """Return for how long nothing has been heard of a robot [s]."""
        return self._clock() - self._times[robot]

    def _take(self, event: Published) -> None:
        try:
            report = read_report(event.payload)
            if report.condition.robot != event.robot:
                raise ValueError(f"report in the name of robot {report.condition.robot} from {event.robot}")
        except ValueError:
            self.malformed += 1
            return
        self.reports[event.robot] = report
        self._times[event.robot] = event.time
