"""What a member that lies says, of its own or in others' names: the honest program, but for that."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from tests.support import bad_member, misbehaving
from tests.support.bad_member import Make
from vedette.agent import NetworkedAgent, messages
from vedette.agent.effects import Send
from vedette.agent.messages import Evidence, Negotiate
from vedette.agent.networked import Output
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.price import LATEST
from vedette.domains.mapping.sightings import BINS, ROWS
from vedette.domains.mapping.views import MOST_STOPS
from vedette.fusion.seals import BEACON
from vedette.fusion.signed import SignedEvidence
from vedette.kernels.coverage import LAYERS
from vedette.maps.disc import cells_under
from vedette.maps.swept import most_cells_swept
from vedette.missions.explore.evidence import CLAMP
from vedette.missions.explore.exploring import Exploring
from vedette.negotiation import messages as negotiation
from vedette.team import Most

HOUR = 36_000  # [0.1 s]
SLOW = (0.7, 2.0, 5.0)  # a slow member takes for every job [s]


class Liar(Exploring):
    """Says what is not so of all that is within its lidar's range."""

    says = 0  # log-odds

    def publish(self, now: float) -> None:
        """Lie, and publish."""
        near = cells_under(self.frame, *self._at, self.spec.range) if np.isfinite(self._at[0]) else ()
        lies = self._lies(np.asarray(near, np.int64))
        if len(lies):
            self.own.log_odds.put(lies, np.full(len(lies), self.says, np.int8))
            self.own._note(lies)
        super().publish(now)

    def _lies(self, near: NDArray[np.int64]) -> NDArray[np.int64]:
        lies: NDArray[np.int64] = near[self.own.log_odds.take(near) != self.says]
        return lies


class Occupied(Liar):
    """Everything is a wall, but for where somebody may stand."""

    says = CLAMP


class Free(Liar):
    """There are no walls."""

    says = -CLAMP


class Far(Liar):
    """There is a free place far away."""

    says = -CLAMP

    def _lies(self, near: NDArray[np.int64]) -> NDArray[np.int64]:
        there = near + 300 * self.frame.cols
        return super()._lies(there[there < self.frame.rows * self.frame.cols])


class Misdated(Free):
    """There are no walls, as of an hour ahead; what clock it says to have is the right one."""

    def __post_init__(self) -> None:
        super().__post_init__()
        assert isinstance(self.fusion, SignedEvidence)
        notary: Any = self.fusion.standing.notary
        clock = notary.now
        notary.now = lambda: clock() + HOUR


class Notes(Exploring):
    """All frontiers have been visited in vain."""

    def _own_notes(self) -> list[tuple[int, int, int]]:
        belief = getattr(self, "_belief", None)
        if belief is None:
            return []
        starts = belief.frontier_starts
        middles = belief.frame.centres(belief.frontier_cells[(starts[:-1] + starts[1:]) // 2])
        return [(round(100 * x), round(100 * y), self._unknown_at(np.array((x, y)))) for x, y in middles]

    def freeze(self, t0: float) -> Any:
        """Remember where there are frontiers."""
        self._belief = super().freeze(t0)
        return self._belief


class Counts(Exploring):
    """It has looked at everything, more often than anybody, and scans hardly ever show anything."""

    tried = 1 << 53

    def _own_counts(self) -> NDArray[np.int64]:
        counts = super()._own_counts()
        sightings = counts[: ROWS * BINS].reshape(ROWS, BINS)
        sightings[0::2], sightings[1::2] = self.tried, 0
        return counts


class FewerCounts(Counts):
    """Likewise, but no more often than somebody could."""

    tried = 10**8


class Claims(Exploring):
    """It will soon see as much as can be believed of it: the whole of what is worth most."""

    def __post_init__(self) -> None:
        super().__post_init__()
        honest = self.platform.impact

        def impact(belief: Any, strategy: Any) -> Any:
            honest(belief, strategy)
            assert self.most is not None, "the team is known"
            return largest_claim(belief, self.most)

        self.platform.impact = impact  # type: ignore[method-assign]


def largest_claim(belief: Any, most: Most) -> Impact:
    """Return the planning cells of most worth, as many and as early as one robot may claim."""
    side, edges = belief.planning.resolution, belief.layers.edges
    worth = belief.weights.window
    order = np.argsort(-worth.ravel(), kind="stable")
    order = order[worth.ravel()[order] > 0]
    discs = MOST_STOPS * most_cells_swept(most.range, 0.0, side)
    by = np.minimum(most_cells_swept(most.range, most.speed * edges, side), discs).astype(int)
    chosen = order[: by[-1]]
    layer = np.searchsorted(by, np.arange(len(chosen)), side="right")
    row, col = np.divmod(chosen, worth.shape[1])
    cells = (row + belief.first[0]) * belief.planning.cols + col + belief.first[1]
    keys = (cells * LAYERS + layer).astype(np.uint32)
    at = np.argsort(keys)
    return Impact(keys[at], np.full(len(keys), 64, np.uint8))


class BoastingObjective(MappingObjective):
    """Adds the largest claim there can be to whatever is added up."""

    belief: Any = None
    most: Most | None = None

    def combine(self, a: Any, b: Any) -> Any:
        """Add up too much."""
        added = super().combine(a, b)
        if self.belief is None or self.most is None:
            return added
        return super().combine(added, largest_claim(self.belief, self.most))


class Sums(Exploring):
    """Tells more than the sum of what it has heard, and signs that it is the sum."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.objective = self._boast = BoastingObjective()
        self._boast.most = self.most

    def freeze(self, t0: float) -> Any:
        """Boast of what is to be seen in this round."""
        self._boast.belief = super().freeze(t0)
        return self._boast.belief


class Inflating(NetworkedAgent):
    """Tells more than the sum, and signs an account by which it has told nothing that can be checked."""

    def _say(self, send: Send, now: float) -> list[Output]:
        message, rounds = messages.decode(send.payload), self.agent.rounds
        if isinstance(message, Negotiate) and rounds.round is not None:
            mission: Any = self.agent.mission
            belief = rounds.round.belief
            said: Any = negotiation.decode(message.data, mission.codec)
            if getattr(said, "mu", None) is not None:
                other = self._instead(mission, belief, said.mu)
                data = negotiation.encode(structs.replace(said, mu=other), mission.codec)
                send = replace(send, payload=messages.encode(structs.replace(message, data=data)))
        return super()._say(send, now)

    def _instead(self, mission: Any, belief: Any, mu: Any) -> Any:
        return mission.objective.combine(mu, largest_claim(belief, mission.most))


class Overcharging(Inflating):
    """Tells of a higher price than that of the sum, as high as can be believed of one more robot."""

    def _instead(self, mission: Any, belief: Any, mu: Any) -> Any:
        return replace(mu, price=mu.price + belief.end_price.of(LATEST) // 2)


class Underselling(Inflating):
    """Tells of half the price of the sum."""

    def _instead(self, mission: Any, belief: Any, mu: Any) -> Any:
        return replace(mu, price=mu.price // 2)


class Unpriced(Exploring):
    """Its tours cost nothing, it says and signs, whenever they end."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.platform.price = lambda belief, strategy: 0  # type: ignore[method-assign]


class Priceless(Exploring):
    """Whatever it does costs as much as can be believed."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.platform.price = lambda belief, strategy: belief.end_price.of(LATEST)  # type: ignore[method-assign]


class Poisoning(NetworkedAgent):
    """Changes what it passes on of others."""

    def _say(self, send: Send, now: float) -> list[Output]:
        message = messages.decode(send.payload)
        if isinstance(message, Evidence):
            fusion: Any = self.agent.mission.fusion
            codec = fusion._codec
            payload = codec.decode(message.data)
            sections = [
                (key, replace(delta, values=5 - delta.values) if key[0] != self.agent.robot else delta)
                for key, delta in payload.sections
            ]
            data = codec.encode(replace(payload, sections=sections))
            send = replace(send, payload=messages.encode(Evidence(data)))
        return super()._say(send, now)


class Blocking(NetworkedAgent):
    """Says in its beacons to stand in the way of who is nearest, whoever that is."""

    _said: tuple[bytes, bytes] = b"", b""  # its honest beacon, and what it says

    def _say(self, send: Send, now: float) -> list[Output]:
        told = messages.decode(send.payload)
        own = messages.decode_beacon(told.beacon) if isinstance(told, messages.Vouched) else told
        if isinstance(own, messages.Beacon) and own.robot == self.agent.robot:
            if self._said[0] != send.payload:
                self._said = send.payload, self._blocks(told, own)
            send = replace(send, payload=self._said[1])
        return super()._say(send, now)

    def _blocks(self, told: Any, own: messages.Beacon) -> bytes:
        here = np.array((own.x, own.y)) / 100.0
        ways = [np.vstack(((mate.x, mate.y), mate.path)) for mate in self.agent.mates.heard]
        way = min(ways, key=lambda way: float(np.hypot(*(way[0] - here))), default=here[None])
        x, y = np.rint(100.0 * way[min(2, len(way) - 1)]).astype(int).tolist()
        data = messages.encode(structs.replace(own, x=x, y=y, path=()))
        if not isinstance(told, messages.Vouched):
            return data
        assert self.agent.signed is not None
        signature = self.agent.signed.standing.notary.sign(BEACON, data)
        return messages.encode(structs.replace(told, beacon=data, signature=signature))


@dataclass(frozen=True)
class Mode:
    """What one member does."""

    explorer: type[Exploring] = Exploring
    program: Make = lambda rng: NetworkedAgent
    unbounded: bool = False
    between: bool = False  # others, on a chain: a lie of one who has something to add up
    doubled: bool = False


LIES: Mapping[str, Mode] = {
    "occupied": Mode(Occupied),
    "free": Mode(Free),
    "far": Mode(Far, unbounded=True),
    "notes": Mode(Notes),
    "counts": Mode(Counts),
    "claim": Mode(Claims),
    "poison": Mode(program=lambda rng: Poisoning),
    "sum": Mode(Sums, between=True),
    "inflate": Mode(program=lambda rng: Inflating, between=True),
}

PRICES: Mapping[str, Mode] = {  # where tours have any
    "overcharge": Mode(program=lambda rng: Overcharging),
    "undersell": Mode(program=lambda rng: Underselling),
    "unpriced": Mode(Unpriced),
    "priceless": Mode(Priceless),
}

MODES: Mapping[str, Mode] = {
    "dead": Mode(program=lambda rng: misbehaving.Dead),
    "dead between": Mode(program=lambda rng: misbehaving.Dead, between=True),
    "honest": Mode(),
    "misdated": Mode(Misdated),
    **LIES,
    **{mode: Mode(program=make) for mode, make in bad_member.MODES.items()},
    "slow": Mode(program=lambda rng: partial(misbehaving.Slow, takes=float(rng.choice(SLOW)))),
    "double": Mode(doubled=True),
    "in the way": Mode(program=lambda rng: Blocking),
    **PRICES,
}
