"""How processes that share no frame find each other's, as the operator sees it, who put them in theirs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from vedette.align import FramePose
from vedette.net.explore.content import MapContent, read_content
from vedette.net.explore.plan import ExplorePlan
from vedette.net.report import Condition
from vedette.net.simulated import as_meant
from vedette.record.explore.frames import FramesFound
from vedette.record.explore.joins import JoinWatch, TrueFrame, Whereabouts
from vedette.record.explore.turned import view_turned
from vedette.record.explore.views import RobotView


class FramesSeen:
    """Lays what robots report in their own frames on the world, and sees who is joined with whom."""

    def __init__(self, plan: ExplorePlan) -> None:
        self._plan = plan
        self._joins = JoinWatch([spec.name for spec in plan.specs])
        self._told: dict[int, MapContent] = {}  # the latest, by robot
        self._true: dict[tuple[int, int], FramePose] = {}  # by robot and boot
        self._boots: dict[int, int] = {}

    def take(self, condition: Condition, content: bytes) -> None:
        """Take a robot's report; of each of its starts the frame is known that it was put in."""
        robot = condition.robot
        self._boots[robot] = condition.boot
        self._true.setdefault((robot, condition.boot), self._plan.frames[robot])
        self._told[robot] = read_content(content)

    def in_world(self, views: Sequence[RobotView]) -> list[RobotView]:
        """Return robots' latest views as they lie in the world; who has told nothing is there already."""
        world = self._plan.world.frame
        return [
            view_turned(self._with_orders(view), self._true[robot, self._boots[robot]], world)
            if robot in self._boots
            else view
            for robot, view in enumerate(views)
        ]

    def _with_orders(self, view: RobotView) -> RobotView:
        """Return a view whose orders name places of the world."""
        orders = tuple(as_meant(order, self._plan.frames) for order in view.sample.orders)
        return replace(view, sample=replace(view.sample, orders=orders))

    def look(self, now: float, views: Sequence[RobotView], living: Sequence[int]) -> FramesFound | None:
        """Return who is joined by now [s], as the first of the living that was heard says; None: nobody was.

        ``views``: as they lie in the world.
        """
        told = next((self._told[robot] for robot in living if robot in self._told), None)
        if told is None:
            return None
        graph = {
            each.robot: Whereabouts(each.boot, each.anchor, each.there, each.met)
            for each in sorted(told.found.graph)
            if (each.robot, each.boot) in self._true
        }
        true = [
            TrueFrame(
                self._true.get((robot, graph[robot].boot if robot in graph else 0), self._plan.frames[robot]),
                (view.sample.x, view.sample.y),
            )
            for robot, view in enumerate(views)
        ]
        refused = sum((Counter(each.found.refused) for each in self._told.values()), Counter[str]())
        return self._joins.look(now, graph, true, living, refused)
