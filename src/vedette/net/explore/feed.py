"""An exploring team on the network, as the operator's window shows it; orders go back the same way."""

from __future__ import annotations

from vedette.agent.orders import Order, encode
from vedette.errors import InputError
from vedette.net.access import Access
from vedette.net.explore.picture import picture_of
from vedette.net.hearing import Hearing
from vedette.net.names import robot_name
from vedette.net.orders import TAKEN, pen_of, written
from vedette.net.transport import Operator
from vedette.record.explore.log import ExploreScene, ExploreSnapshot
from vedette.record.log import LEFT
from vedette.window.picture import Beside, Picture, ordered, picture

LATE = 5.0  # who has been silent for so long may be lost [s]


class TeamFeed:
    """Makes pictures of what an operator's session hears."""

    def __init__(self, operator: Operator, access: Access) -> None:
        """Begin to hear."""
        self.hearing = Hearing(operator)
        self._operator, self._access = operator, access

    def picture(self) -> Picture | None:
        """Return the team as it was heard last; None: nobody was, or it makes no sense."""
        told = self.snapshot()
        silent = {robot: self.hearing.silent(robot) for robot in sorted(self.hearing.reports)}
        return None if told is None else picture(*told, self._beside(silent))

    def snapshot(self) -> tuple[ExploreScene, ExploreSnapshot] | None:
        """Return it as a snapshot, in a scene of its own; None: as above."""
        reports = dict(sorted(self.hearing.reports.items()))
        if not reports:
            return None
        silent = {robot: self.hearing.silent(robot) for robot in reports}
        lost = {
            robot: f"silent, was {report.condition.state}"
            for robot, report in reports.items()
            if silent[robot] > LATE and report.condition.state != LEFT
        }
        try:
            return picture_of(self._access.team, reports, lost)
        except ValueError:
            self.hearing.malformed += 1
            return None

    def give(self, order: Order) -> str:
        """Give the team an order, and say what has come of it."""
        told = [report.condition for report in list(self.hearing.reports.values())]
        mission = next((each.mission for each in told if each.mission), "")
        if not mission:
            return "refused: nobody who takes orders has been heard"
        heard = [each.counter for condition in told for each in condition.orders]
        given = written(order, mission, heard, pen_of(self._access.credentials, mission))
        answers = self._operator.order(encode(given))
        taken = sorted(robot for robot, line in answers.items() if line == TAKEN)
        if taken:
            return f"taken by {', '.join(map(robot_name, taken))}"
        if answers:
            robot, line = sorted(answers.items())[0]
            raise InputError(f"{robot_name(robot)}: {line}")
        return "refused: nobody answered"

    def _beside(self, silent: dict[int, float]) -> Beside:
        told = [report.condition for _, report in sorted(self.hearing.reports.items())]
        orders, areas = ordered(
            (robot_name(each.robot), [order.order for order in each.orders]) for each in told
        )
        return Beside(
            numbers=[robot + 1 for robot in silent],
            silent={robot + 1: age for robot, age in silent.items()},
            orders=orders,
            areas=areas,
            alerts=[
                *(f"{robot_name(each.robot)}: {line}" for each in told for line in each.alerts),
                *(
                    f"{robot_name(each.robot)} of {robot_name(complaint.robot)}: {complaint.what}"
                    for each in told
                    for complaint in each.complaints
                ),
            ],
        )
