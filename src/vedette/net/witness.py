"""What a robot's process sees of itself, for the operator."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple, Protocol, cast

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from vedette.agent import NetworkedAgent
from vedette.agent.body import Body
from vedette.fusion.standing import Signed
from vedette.missions.explore.expected import Expected, Forecaster, Progress
from vedette.net import report as wire
from vedette.net.report import (
    FARTHEST,
    MOST_WORDS,
    Complaint,
    Condition,
    Ending,
    LinkReport,
    OrderReport,
    SpreadReport,
)
from vedette.net.transport import Transport
from vedette.overlay import LinkStatus
from vedette.record.clock import Clock
from vedette.record.summary import Spread as Statistics


class Known(NamedTuple):
    """How much of a map a robot knows."""

    share: float | None  # of the cells of the team's ground; None: nobody knows how large that is
    area: float  # [m^2]
    frontiers: int | None  # where it goes on, as of the latest round; None: there has been none
    beyond: int = 0  # beams, or cells of its own map, that told of ground where there is no room for any
    room: str = ""  # where there is, in words


class Teller(Protocol):
    """What a robot of one domain has to tell the operator beside its condition."""

    @property
    def known(self) -> Known | None:
        """How much of its map it knows; None: it makes none."""

    def path(self, now: float) -> NDArray[np.float64]:
        """Return where it means to go, ``(k, 2)`` [m], team frame; ``now``: mission time [s], as below."""

    def content(self, now: float) -> bytes:
        """Return what it has found out, for the domain's own ``view_of``."""


@dataclass
class Witness:
    """Counts what the process does, and tells of the robot; call it from the agent's thread."""

    node: NetworkedAgent
    body: Body
    transport: Transport
    teller: Teller
    name: str
    mission: str = ""  # that orders have to be for; none: it takes no orders
    clock: Clock = field(default_factory=Clock)
    malformed: int = 0  # of what is told of bodies
    status: bytes = b""  # the latest condition, for any thread
    _known: Known | None = None  # of the latest report
    _forecaster: Forecaster = field(default_factory=Forecaster)
    _rounds: list[float] = field(default_factory=list)  # that this robot began [s]
    _round_began: float | None = None
    _decisions: int = 0
    _decided: float | None = None  # when the latest round ended with a decision [s]
    _began: float | None = None  # mission time at which the robot began [s]

    def note(self, now: float) -> None:
        """Watch the rounds, after every act; ``now`` [s]."""
        rounds = self.node.agent.rounds
        if rounds.decisions != self._decisions and self._round_began is not None:
            self._rounds.append(now - self._round_began)
        if not rounds.busy or rounds.decisions != self._decisions:
            self._round_began = None
        if rounds.busy and self._round_began is None and rounds.tree.parent is None:
            self._round_began = now
        if rounds.decisions != self._decisions:
            self._decisions, self._decided = rounds.decisions, now

    def report(
        self, now: float, mission_time: float, state: str | None, alerts: tuple[str, ...] = ()
    ) -> wire.Report:
        """Return a report; ``state`` takes the place of the agent's own; ``alerts``: of this computer."""
        if self._began is None and self.node.agent.awake:
            self._began = mission_time
        condition = structs.replace(self._condition(now, mission_time), alerts=alerts)
        if state is not None:
            condition = structs.replace(condition, state=state)
        self.status = wire.encode(condition)
        return wire.Report(condition, self.teller.content(mission_time))

    @property
    def remark(self) -> str | None:
        """What whoever watches the process should know of the robot, in a line; None: nothing."""
        known = self._known
        if known is None or not known.beyond:
            return None
        return (
            f"what the robot sees beyond {known.room} is left out: there is no room for more cells; give "
            "explore.area, for where the ground is, or a larger body.resolution"
        )

    def _condition(self, now: float, mission_time: float) -> Condition:
        agent, overlay = self.node.agent, self.node.overlay.status(now)
        x, y, heading = self.body.pose
        path = self.teller.path(mission_time).ravel().tolist()
        counted, known = self.body.figures, self.teller.known
        self._known = known
        return Condition(
            robot=agent.robot,
            boot=agent.boot,
            name=self.name,
            time=mission_time,
            began=self._began,
            state=agent.state.value,
            x=x,
            y=y,
            heading=heading,
            path=tuple(path[-2000:]),
            root=overlay.root,
            epoch=overlay.epoch,
            number=overlay.place.epoch,
            parent=overlay.place.parent,
            neighbours=overlay.place.neighbours,
            size=overlay.place.size,
            age=overlay.age,
            links=tuple(map(_link, overlay.links)),
            digest=agent.mission.fusion.digest,
            known=None if known is None else known.share,
            rounds=agent.rounds.decisions,
            sweeps=agent.rounds.sweeps,
            cuts=agent.rounds.cuts,
            bounded=len(agent.rounds.bound_ratios),
            bound_ratios=float(sum(agent.rounds.bound_ratios)),
            travelled=counted.travelled,
            collisions=counted.collisions,
            min_clearance=counted.min_clearance,
            messages={kind.value: count for kind, count in self.node.messages_sent.items()},
            bytes={kind.value: count for kind, count in self.node.bytes_sent.items()},
            dropped={
                "transport": self.transport.refused + self.transport.inbox.dropped,
                "overlay and links": self.node.malformed,
                "agent": agent.dropped,
                "bodies": self.malformed,
            },
            complaints=tuple(
                Complaint(robot, what[:MOST_WORDS]) for robot, what in sorted(self.node.complaints.items())
            ),
            planning_ms=_spread(self.clock.planning_ms, len(self.clock.planning)),
            answer_ms=_spread(self.clock.answer_ms, len(self.clock.answers)),
            round_ms=_spread(Statistics.of([1e3 * took for took in self._rounds]), len(self._rounds)),
            decided=None if self._decided is None else max(now - self._decided, 0.0),
            ending=cast(Ending, agent.ending.value),
            known_m2=None if known is None else known.area,
            frontiers=None if known is None else known.frontiers,
            beyond=0 if known is None else known.beyond,
            mission=self.mission,
            orders=tuple(OrderReport(each.counter, each.operator, each.order) for each in agent.orders.all),
            expected=self._expected(mission_time, counted.travelled, overlay.place.size),
            signs=agent.signed is not None,
            out=_out(agent.signed),
            pose_error=counted.pose_error,
        )

    def _expected(self, mission_time: float, way: float, team: int) -> Expected | None:
        """Return what is expected of an exploration, by what this robot knows and how far it has come [m]."""
        if self._known is None or self._began is None:
            return None
        t, known = mission_time - self._began, self._known
        return self._forecaster.add(Progress(t, known.area, known.frontiers, way, team))


def _out(signed: Signed | None) -> tuple[int, ...]:
    """Return whom a robot does not believe, by where it keeps what others have signed."""
    return () if signed is None else tuple(sorted(signed.out | signed.standing.gone.keys()))


def _link(link: LinkStatus) -> LinkReport:
    offset = None if link.offset is None else min(max(link.offset, -FARTHEST), FARTHEST)
    round_trip = None if link.round_trip is None else min(link.round_trip, FARTHEST)
    return LinkReport(link.robot, link.role, link.loss, round_trip, offset, link.silent)


def _spread(statistics: Statistics | None, count: int) -> SpreadReport | None:
    return None if statistics is None else SpreadReport(count, statistics.p50, statistics.p95, statistics.max)
