"""An audit: everybody signs what it has claimed in a round, so that who lies has a name.

Rounds sum claims up, which keeps them as short for many robots as for few, and anonymous. An audit costs as
many messages as there are robots, and is held only when something is wrong. docs/trust.md (V76)
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from msgspec import structs

from vedette.agent.account import Claimed, Stamp, account_of, check, contradicts, words_of
from vedette.agent.effects import Effect, Send, TrafficKind
from vedette.agent.messages import Account, Audit, encode
from vedette.agent.mission import Mission, Promising
from vedette.agent.promises import LEAST, Suspicion, weighed
from vedette.fusion.contradictions import Accounted, SignedWord, Twice
from vedette.fusion.standing import Standing

EVERY = 5.0  # audits are at least so far apart [s]
WANTED = 60.0  # and go on for so long after the last cause [s]
WAITS = 1.0  # for the accounts of those that can give one [s]
LEFT_OUT = 60.0  # who is caught is planned without for so long, twice as long each time [s]
MOST_AWAY = 8  # rounds that an account may be older than the last


@dataclass
class Auditor:
    """One robot's part in audits, and whom it has caught."""

    robot: int
    boot: int
    mission: Mission[Any, Any, Any]
    standing: Standing
    caught: dict[int, str] = field(default_factory=dict)  # by robot: at what
    promises: Suspicion = field(default_factory=Suspicion)  # of robots, by their accounts
    _until: dict[int, float] = field(default_factory=dict)  # planned without until [s]
    _times: Counter[int] = field(default_factory=Counter)  # that each was caught
    _wanted: float = -1e9  # until [s]
    _asked: float = -1e9  # when the last audit began [s]
    _claimed: Claimed | None = None
    _accounts: dict[Stamp, dict[int, Account]] = field(default_factory=dict)
    _answered: set[Stamp] = field(default_factory=set)
    _due: tuple[Stamp, float] | None = None  # what is to be judged, and when [s]
    _unlike: Counter[int] = field(default_factory=Counter)  # audits in a row in which a link's sum was wrong

    def want(self, now: float) -> None:
        """Ask for audits for a while: something is wrong."""
        self._wanted = now + WANTED

    def left_out(self, now: float) -> frozenset[int]:
        """Return the robots that this one plans without for now."""
        return frozenset(robot for robot, until in self._until.items() if now < until)

    def decided(self, claimed: Claimed, neighbours: tuple[int, ...], now: float) -> list[Effect]:
        """Note what was claimed in a round; begin an audit of it, if one is wanted."""
        self._claimed = claimed
        if now > self._wanted or now < self._asked + EVERY:
            return []
        return self.ask(-1, Audit(*claimed.stamp), neighbours, now)

    def ask(self, sender: int, audit: Audit, neighbours: tuple[int, ...], now: float) -> list[Effect]:
        """Hand on that an audit is held, and give account, if this robot has decided that round."""
        stamp = audit.epoch, audit.sequence
        if self._claimed is None or self._claimed.stamp != stamp or stamp in self._answered:
            return []
        self._answered.add(stamp)  # for good: who has two accounts of one round could prove a lie
        self._asked, self._due = now, (stamp, now + WAITS)
        others = [k for k in neighbours if k != sender]
        return [*_to(others, audit), *self.hear(self.robot, self._own_account(self._claimed), neighbours)]

    def _own_account(self, claimed: Claimed) -> Account:
        account = account_of(claimed, self.mission, self.robot, self.boot)
        return structs.replace(account, signature=self.standing.notary.sign(*words_of(account)))

    def hear(self, sender: int, account: Account, neighbours: tuple[int, ...]) -> list[Effect]:
        """Keep an account and hand it on; ValueError if it is not by whom it says.

        Of itself this robot hears nothing from others: what they say first would stand in its own one's way.
        """
        if account.robot == self.robot != sender:
            return []
        stamp = account.epoch, account.sequence
        held = self._accounts.get(stamp, {})
        known = held.get(account.robot)
        if self._claimed is None or stamp != self._claimed.stamp or account == known:
            return []
        if account.robot != self.robot:
            check(account, self.standing.notary)
        if known is not None:
            words = (SignedWord(words_of(each), each.signature) for each in (known, account))
            self.standing.catch(account.robot, Twice(*words))
            return []
        self._accounts = {stamp: held | {account.robot: account}}
        return _to([k for k in neighbours if k != sender], account)

    def tick(self, now: float) -> None:
        """Judge an audit whose accounts have had time to come."""
        if self._due is None or now < self._due[1]:
            return
        stamp, self._due = self._due[0], None
        claimed = self._claimed
        if claimed is not None and claimed.stamp == stamp:
            self._judge(claimed, self._accounts.get(stamp, {}), now)

    def _judge(self, claimed: Claimed, accounts: Mapping[int, Account], now: float) -> None:
        impacts: dict[int, Any] = {}
        for robot, account in accounts.items():
            try:
                impacts[robot] = self.mission.codec.decode(account.impact)
                self.mission.admit(claimed.belief, impacts[robot], 1)
            except ValueError as error:
                self._catch(robot, f"what it has signed cannot be: {error}", now)
                continue
            self._check_sums(account)
        others = {robot: impact for robot, impact in impacts.items() if robot != self.robot}
        for robot in self.promises.note(self.mission, claimed.belief, others, now):
            self._catch(robot, "less than half of what it has signed to see comes true", now)
        for link, told in claimed.heard.items() if not claimed.goes_back else ():
            self._compare(link, told, claimed, accounts, impacts, now)

    def _check_sums(self, account: Account) -> None:
        """Find out whether somebody has told another sum than that of what it says to have added up."""
        try:
            is_false = contradicts(account, self.mission)
        except ValueError:
            return  # what came over a link is none: its own fault, or that of who is there
        if is_false:
            self.standing.catch(account.robot, Accounted(encode(account)))

    def _compare(
        self,
        link: int,
        told: Any,
        claimed: Claimed,
        accounts: Mapping[int, Account],
        impacts: Mapping[int, Any],
        now: float,
    ) -> None:
        """Check the sum that came over a link; the nearest to who has changed it finds out first.

        A round that ends with its last change leaves old sums on some links: one audit alone proves nothing.
        """
        part = _Part(self.mission, accounts, impacts)
        signed = part.sum(link, self.robot)
        if signed is None or not isinstance(self.mission, Promising):
            return
        seen, covered = (self.mission.promised(claimed.belief, impact)[0] for impact in (told, signed))
        price = self.mission.objective.price
        costs_as_signed = price(told) == price(signed)
        if costs_as_signed and len(np.setdiff1d(seen, covered, assume_unique=True)) < LEAST:
            self._unlike.pop(link, None)
            return
        self._unlike[link] += 1
        if self._unlike[link] > part.depth:
            self._catch(link, "the sum that it tells is not that of what those behind it have signed", now)

    def _catch(self, robot: int, at: str, now: float) -> None:
        if robot == self.robot:
            return
        self.caught[robot] = f"{at}: rounds go on without it"
        self._until[robot] = now + LEFT_OUT * 2 ** min(self._times[robot], 5)
        self._times[robot] += 1
        self._unlike.pop(robot, None)


@dataclass
class _Part:
    """What a part of the tree should have said, by the accounts of those in it."""

    mission: Mission[Any, Any, Any]
    accounts: Mapping[int, Account]
    impacts: Mapping[int, Any]
    depth: int = 0  # links, the first one included
    met: set[int] = field(default_factory=set)  # robots: on a tree each is come by once

    def sum(self, robot: int, towards: int, away: int = 1) -> Any | None:
        """Return the impact of all from a robot on, as it says it.

        None: not all have given account, or the links that they tell of make no tree.
        """
        self.depth = max(self.depth, away)
        if robot not in self.impacts or robot in self.met:
            return None
        self.met.add(robot)
        total = self.impacts[robot]
        for k, halvings, _ in self.accounts[robot].links:
            if k == towards:
                continue
            more = self.sum(k, robot, away + 1)
            if more is None:
                return None
            total = self.mission.objective.combine(total, weighed(self.mission, more, halvings))
        return total


def _to(neighbours: list[int], message: Audit | Account) -> list[Effect]:
    return [Send(k, TrafficKind.NEGOTIATION, encode(message)) for k in neighbours]
