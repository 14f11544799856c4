"""Beacons where there are keys: whoever passes them on cannot say where another robot is."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from tests.support.agent_team import FRAME, toy_agent
from tests.support.notaries import certified
from vedette.agent import Agent, beacons, messages, step
from vedette.agent.effects import Send, Shun, TrafficKind
from vedette.agent.events import CertificatesRevoked, Message, Pose, TreeChanged
from vedette.agent.messages import Beacon, Vouched
from vedette.fusion.particulars import Capabilities
from vedette.fusion.signed import SignedEvidence
from vedette.kernels.tiles import TiledGrid


def agent(robot: int, neighbours: tuple[int, ...]) -> Agent:
    """A robot that signs."""
    made = toy_agent(robot, [], None)  # type: ignore[arg-type]
    notary, limits = certified(robot, lambda: 100.0), Capabilities(0.1, 8.0, 0.5)
    made.mission.fusion = SignedEvidence(robot, 1, FRAME.shape, 4, notary=notary, limits=limits)
    step(made, [TreeChanged(1, None, neighbours, 3)], 0.0)
    return made


def evidence(robot: Agent) -> SignedEvidence:
    """What it has signed, and holds."""
    assert isinstance(robot.mission.fusion, SignedEvidence)
    return robot.mission.fusion


def told(robot: Agent, x: float, n: int = 1) -> bytes:
    """Return the n-th next beacon of a robot that stands there."""
    for _ in range(n):
        payload = beacons.tell(robot, Pose(x, 1.0, 0.0))
    return payload


@pytest.fixture
def chain() -> tuple[Agent, Agent, Agent]:
    """Three robots on a chain."""
    return agent(0, (1,)), agent(1, (0, 2)), agent(2, (1,))


def place(hearer: Agent, robot: int) -> float | None:
    return next((mate.x for mate in hearer.mates.all() if mate.robot == robot), None)


def test_a_signed_beacon_is_believed_whoever_passes_it_on(chain: tuple[Agent, Agent, Agent]) -> None:
    maker, relay, hearer = chain
    payload = told(maker, 3.0)
    assert isinstance(messages.decode(payload), Vouched)
    assert beacons.hear(relay, 0, payload, 1.0) == []
    (passed,) = relay.relay.pass_on()
    assert passed == Send(2, TrafficKind.BEACONS, payload)
    assert beacons.hear(hearer, 1, payload, 1.1) == []
    assert place(hearer, 0) == 3.0


def test_who_changes_a_signed_beacon_is_shunned_and_named(chain: tuple[Agent, Agent, Agent]) -> None:
    maker, _, hearer = chain
    vouched = messages.decode(told(maker, 3.0))
    assert isinstance(vouched, Vouched)
    beacon = messages.decode_beacon(vouched.beacon)
    moved = messages.encode(msgspec.structs.replace(beacon, x=900))
    forged = messages.encode(msgspec.structs.replace(vouched, beacon=moved))
    assert beacons.hear(hearer, 1, forged, 1.0) == [Shun(1)]
    assert place(hearer, 0) is None
    assert "robot-1" in hearer.signed.complaints[1]  # type: ignore[union-attr]


def test_an_old_signed_beacon_that_is_said_again_is_no_news(chain: tuple[Agent, Agent, Agent]) -> None:
    maker, _, hearer = chain
    old, new = told(maker, 3.0), told(maker, 4.0)
    beacons.hear(hearer, 1, old, 0.5)
    beacons.hear(hearer, 1, new, 1.0)
    beacons.hear(hearer, 1, old, 60.0)
    assert place(hearer, 0) == 4.0


@pytest.mark.parametrize(
    ("x", "sequence", "after", "believed"),
    [
        (3.3, 2, 0.5, True),
        (3.0, 9, 0.5, True),
        (6.0, 2, 0.5, False),
        (3.1, 1000, 0.5, False),
        (3.1, 2, 9.0, False),
    ],
)
def test_an_unsigned_beacon_is_passed_on_within_what_its_robot_can_have_driven(
    x: float, sequence: int, after: float, believed: bool, chain: tuple[Agent, Agent, Agent]
) -> None:
    maker, _, hearer = chain
    beacons.hear(hearer, 1, told(maker, 3.0), 1.0)
    unsigned = Beacon(0, 1, sequence, round(100 * x), 100, 0, 0, 20, 50, ())
    beacons.hear(hearer, 1, messages.encode(unsigned), 1.0 + after)
    assert place(hearer, 0) == (x if believed else 3.0)


def test_one_beacon_in_eight_is_signed_and_a_lie_between_does_not_hide_the_next(
    chain: tuple[Agent, Agent, Agent],
) -> None:
    maker, _, hearer = chain
    said = [told(maker, 3.0) for _ in range(16)]
    beacons.hear(hearer, 1, said[0], 0.5)
    kinds = [type(messages.decode(payload)) for payload in said]
    assert kinds == [Vouched] * 4 + [Beacon] * 3 + [Vouched] + [Beacon] * 7 + [Vouched]
    maker.beacons = 96
    beacons.hear(hearer, 1, told(maker, 3.0, 8), 1.0)
    beacons.hear(hearer, 1, messages.encode(Beacon(0, 1, 127, 330, 100, 0, 0, 20, 50, ())), 1.2)
    beacons.hear(hearer, 1, told(maker, 3.1, 8), 2.0)
    assert place(hearer, 0) == pytest.approx(3.1)


def test_nobody_believes_a_beacon_of_a_robot_that_is_revoked(chain: tuple[Agent, Agent, Agent]) -> None:
    maker, _, hearer = chain
    step(hearer, [CertificatesRevoked(frozenset({0}))], 0.5)
    assert beacons.hear(hearer, 1, told(maker, 3.0), 1.0) == []
    assert place(hearer, 0) is None
    assert set(hearer.complaints) == {0}


def test_where_a_robot_is_goes_with_its_evidence_and_then_beacons_need_no_signature(
    chain: tuple[Agent, Agent, Agent],
) -> None:
    maker, _, hearer = chain
    beacons.hear(hearer, 1, told(maker, 3.0), 1.0)
    maker.beacons = 22
    told(maker, 6.0)
    evidence(maker).set_out(10, 30)
    evidence(maker).publish(TiledGrid.of(np.full(FRAME.shape, -20, np.int8)), None, None)
    for k in range(3):
        for a, b in ((maker, hearer), (hearer, maker)):
            evidence(a).set_neighbours([b.robot])
            data = evidence(a).outgoing(b.robot, float(k))
            step(b, [TreeChanged(1, None, (a.robot, 1), 3)], 8.0)
            if data is not None:
                step(b, [Message(a.robot, messages.encode(messages.Evidence(data)))], 8.0)
    plain = told(maker, 6.4)
    assert isinstance(messages.decode(plain), Beacon)
    far = messages.encode(Beacon(0, 1, 25, 900, 100, 0, 0, 20, 50, ()))
    beacons.hear(hearer, 1, far, 8.5)
    assert place(hearer, 0) == 3.0
    beacons.hear(hearer, 1, plain, 8.5)
    assert place(hearer, 0) == 6.4
