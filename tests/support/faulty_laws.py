"""What no fault may break, checked after everything that any agent of a toy team does."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from itertools import pairwise
from typing import cast

import numpy as np
from numpy.typing import NDArray

from tests.support.faulty_world import FRAME, Belief, Impact, Life, SiteMission, Sites, check, worth
from vedette.agent import Agent, GroundBehaviour, State
from vedette.agent.round import Round as RoundSeen
from vedette.fusion.standing import signed_by
from vedette.fusion.tiles import WORDS, classes_of, codes_of
from vedette.negotiation import RoundOutcome, TokenNode

ROUNDING = 1e-9

Versions = dict[Life, int]
Name = tuple[int, ...]  # of a round: its stamp, and who holds it, if that is one robot alone


def mission_of(agent: Agent) -> SiteMission:
    """Return an agent's mission as the toy it is."""
    return cast(SiteMission, agent.mission)


def versions_of(mission: SiteMission) -> Versions:
    """Return which version of whose evidence a robot holds."""
    return mission.fusion._contributors.known()


@dataclass(eq=False)
class EvidenceLaw:
    """A team map is the sum of what its holder has of each whom it believes, and nobody forgets anything."""

    sites: Sites
    _ledger: dict[tuple[Life, int], tuple[NDArray[np.int32], NDArray[np.int64]]] = field(default_factory=dict)
    _held: defaultdict[Life, Versions] = field(default_factory=lambda: defaultdict(dict))

    def published(self, life: Life, version: int, own: NDArray[np.int8], counts: NDArray[np.int64]) -> None:
        """Note what a robot has published."""
        self._ledger[life, version] = WORDS[codes_of(own)], counts

    def check(self, mission: SiteMission) -> bool:
        """Check a robot's map, if it has changed; tell if so."""
        now, before = versions_of(mission), self._held[mission.life]
        if now == before:
            return False
        check(
            all(now.get(key, 0) >= version for key, version in before.items()),
            "evidence is lost",
            before,
            now,
        )
        self._held[mission.life] = now
        signed = signed_by(mission.fusion)
        out = frozenset[int]() if signed is None else signed.out
        believed = [self._ledger[each] for each in now.items() if each[0][0] not in out]
        words = sum((words for words, _ in believed), np.zeros(FRAME.shape, np.int32))
        counts = sum((counts for _, counts in believed), np.zeros(len(self.sites.cells), np.int64))
        right = np.array_equal(mission.fusion.classes.window(), classes_of(words))
        check(right, "a map is not the sum of its contributors", mission.life, now)
        right = np.array_equal(mission.fusion.counts, counts)
        check(right, "evidence is counted twice or not at all", mission.life, now)
        return True


@dataclass(eq=False)
class RoundLaw:
    """Who decides together has chosen what the round says, on one belief, and no worse than before."""

    missions: dict[Life, SiteMission]
    rounds: int = 0  # decided by a whole team, its value checked
    cut: set[Name] = field(default_factory=set)  # rounds from which somebody was cut
    _exact: defaultdict[Name, set[int]] = field(default_factory=lambda: defaultdict(set))  # digests
    _decided: defaultdict[Name, dict[Life, int]] = field(default_factory=lambda: defaultdict(dict))  # ending
    _ended: defaultdict[Name, list[tuple[RoundOutcome, Impact]]] = field(  # and with what team
        default_factory=lambda: defaultdict(list)
    )
    _turns: defaultdict[Name, list[tuple[int, float]]] = field(default_factory=lambda: defaultdict(list))

    def decided(self, mission: SiteMission, seen: RoundSeen, ended: bool) -> None:
        """Check a decision that a robot has just taken; ``ended``: it was this robot that ended the round."""
        belief, negotiator = mission.last, seen.negotiator
        assert belief is not None
        assert negotiator is not None
        outcome, stamp = negotiator.finished, belief.stamp
        assert outcome is not None
        check(stamp[1] == seen.sequence, "a round ends that never froze", stamp, seen.sequence)
        name = stamp if seen.tree.neighbours else (*stamp, *mission.life)
        if not seen.approximate:
            self._exact[name].add(belief.digest)
            check(len(self._exact[name]) == 1, "two maps are taken for one", mission.life, stamp)
        if isinstance(negotiator, TokenNode):
            self._check_turns(name, negotiator)
            self._check_team(mission, name, outcome, ended)

    def _check_turns(self, name: Name, node: TokenNode[Impact]) -> None:
        """The team's value never falls from turn to turn, unless somebody is cut."""
        self._turns[name] += node.turns
        if name not in self.cut and len(self._exact[name]) == 1:
            values = [value for _, value in sorted(self._turns[name])]
            check(all(b >= a - ROUNDING for a, b in pairwise(values)), "the value falls", values)

    def _check_team(self, mission: SiteMission, name: Name, outcome: RoundOutcome, ended: bool) -> None:
        """When the last one of a team has decided: its choice is worth what the round says."""
        belief, decided = cast(Belief, mission.last), self._decided[name]
        stamp = belief.stamp
        decided[mission.life] = self._ending(mission, name, outcome, ended)
        _, whole = self._ended[name][decided[mission.life]]
        if any(decided.get(life) != decided[mission.life] for life in whole.who):
            return
        team = [self.missions[life] for life in sorted(whole.who)]
        if any(mate.last is None or mate.last.stamp != stamp for mate in team):
            return
        after = np.prod([cast(Impact, mate.present).miss for mate in team], axis=0)
        check(
            np.allclose(after, whole.miss, atol=1e-12),
            "the team's impact is not what its robots chose",
            stamp,
        )
        if len({cast(Belief, mate.last).digest for mate in team}) > 1:
            return
        self.rounds += 1
        value = worth(belief, after)
        check(abs(value - outcome.value) < 1e-6, "the round's value is wrong", stamp, value, outcome)
        before = worth(belief, np.prod([cast(Impact, mate.initial).miss for mate in team], axis=0))
        fell = name not in self.cut and value < before - ROUNDING
        check(not fell, "the value of the team's choice has fallen", stamp, before, value)

    def _ending(self, mission: SiteMission, name: Name, outcome: RoundOutcome, ended: bool) -> int:
        """Return the ending of a round that a robot decides by: the two parts left by a cut have one each."""
        endings = self._ended[name]
        if ended:
            assert mission.whole is not None
            endings.append((outcome, mission.whole))
        its = [k for k, (told, whole) in enumerate(endings) if told == outcome and mission.life in whole.who]
        check(bool(its), "a robot decides that is not in the team", mission.life, endings)
        return its[-1]


def check_strategy(agent: Agent, sites: Sites) -> None:
    """Every robot has a strategy that it can carry out, or a reason to stand."""
    mission, behaviour = mission_of(agent), cast(GroundBehaviour, agent.behaviour)
    drives = behaviour.driver.wanted is not None
    check(drives == (agent.state is State.DRIVING), "a robot drives, or stands, for no reason", agent.state)
    site = mission.strategy
    if not drives or site is None:  # what it drives to may be found out to have been seen
        return
    check(bool(sites.allowed[agent.robot, site]), "a strategy is void", agent.robot, site)
    before = int(sites.before[site])
    known = before < 0 or mission.counts[before] > 0 or sites.is_seen(before, mission.fusion.classes.window())
    check(known, "a robot knows of a site that nobody has told it of", agent.robot, site)
