"""A team on the network, as the operator's window shows it; orders go back the same way."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol, TypeVar

from vedette.agent.orders import Order
from vedette.net.access import Access
from vedette.net.gather import links_among
from vedette.net.giving import Giving
from vedette.net.hearing import Hearing
from vedette.net.report import Report
from vedette.net.transport import Operator
from vedette.record.log import LEFT
from vedette.record.mcap import McapFile, Medium, Place
from vedette.record.space import space_alerts
from vedette.window.foxglove import FoxgloveServer
from vedette.window.hub import Hub
from vedette.window.picture import Beside, Picture, ordered

LATE = 5.0  # who has been silent for so long may be lost [s]
LISTENING = 0.1  # between two pictures [s]
SceneT = TypeVar("SceneT")
SnapshotT = TypeVar("SnapshotT")


class Onlooker(Protocol[SceneT, SnapshotT]):
    """What an operator, who does not know the truth, makes of the reports of one mission's robots."""

    def numbers(self, reports: Mapping[int, Report]) -> Sequence[int]:
        """Return the numbers of the robots that are shown, from 1, in order."""

    def name(self, robot: int) -> str:
        """Return what a robot is called, by its index."""

    def see(self, reports: Mapping[int, Report], states: Mapping[int, str]) -> tuple[SceneT, SnapshotT]:
        """Return the mission by each robot's latest report; ``states`` take the place of robots' own.

        Raises:
            ValueError: a report is malformed.
        """

    def as_drawn(self, order: Order, reports: Mapping[int, Report]) -> Order:
        """Return an order, whose places were taken from the picture, with the frame that they are drawn in.

        Raises:
            ValueError: a report is malformed.
        """

    def draw(self, scene: SceneT, snapshot: SnapshotT, beside: Beside) -> Picture:
        """Return it as the page shows it."""

    def recorder(self, place: Place | Medium, scene: SceneT) -> McapFile[Any]:
        """Return what tells it in messages, in a file or to a medium: a ``Sink`` too."""


class TeamFeed:
    """Makes pictures of what an operator's session hears."""

    def __init__(
        self, operator: Operator, access: Access, onlooker: Onlooker[Any, Any], folder: Path | None = None
    ) -> None:
        """Begin to hear; ``folder``: where what is heard is kept, whose disk may be full."""
        self.hearing, self._folder = Hearing(operator), folder
        self._onlooker, self._giving = onlooker, Giving(operator, access, onlooker.name)

    def picture(self) -> Picture | None:
        """Return the team as it was heard last; None: nobody was, or it makes no sense."""
        told = self.snapshot()
        return None if told is None else self._onlooker.draw(*told, self._beside())

    def snapshot(self) -> tuple[Any, Any] | None:
        """Return it as a snapshot, in a scene of its own; None: as above."""
        reports = dict(sorted(self.hearing.reports.items()))
        if not reports:
            return None
        lost = {
            robot: f"silent, was {report.condition.state}"
            for robot, report in reports.items()
            if self.hearing.silent(robot) > LATE and report.condition.state != LEFT
        }
        try:
            return self._onlooker.see(reports, lost)
        except ValueError:
            self.hearing.malformed += 1
            return None

    def give(self, order: Order) -> str:
        """Give the team an order with places as the picture shows them, and say what has come of it."""
        reports = dict(sorted(self.hearing.reports.items()))
        try:
            order = self._onlooker.as_drawn(order, reports)
        except ValueError as error:
            return f"refused: {error}"
        return self._giving.give(order, [report.condition for report in reports.values()])

    def follow(self, hub: Hub, ended: threading.Event, served: FoxgloveServer | None = None) -> None:
        """Show the team until it has ended; ``served``: in Foxglove as well."""
        while not ended.is_set():
            began = time.monotonic()
            self.hearing.listen(LISTENING)
            if (shown := self.picture()) is not None:
                hub.show(shown)
            if served is not None and (told := self.snapshot()) is not None:
                served.show(*told)
            ended.wait(max(began + LISTENING - time.monotonic(), 0.0))

    @contextmanager
    def followed(self, hub: Hub) -> Iterator[None]:
        """Show the team, from a thread of its own, for as long as it is entered."""
        ended = threading.Event()
        thread = threading.Thread(target=self.follow, args=(hub, ended), name="feed", daemon=True)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()
            hub.close()

    def _beside(self) -> Beside:
        reports, name = dict(sorted(self.hearing.reports.items())), self._onlooker.name
        told = [report.condition for report in reports.values()]
        orders, areas = ordered((name(each.robot), [order.order for order in each.orders]) for each in told)
        numbers = self._onlooker.numbers(reports)
        return Beside(
            numbers=numbers,
            silent={robot + 1: self.hearing.silent(robot) for robot in reports},
            links=links_among(reports, numbers),
            orders=orders,
            areas=areas,
            counts={each.robot + 1: (each.rounds, sum(each.bytes.values())) for each in told},
            alerts=[
                *(space_alerts(self._folder) if self._folder is not None else ()),
                *(f"{name(each.robot)}: {line}" for each in told for line in each.alerts),
                *(
                    f"{name(each.robot)} of {name(complaint.robot)}: {complaint.what}"
                    for each in told
                    for complaint in each.complaints
                ),
            ],
        )
