"""Proofs of lies on their way through the team: who has caught somebody lets all others check it.

A proof is what a robot has signed itself and cannot both be so. Each robot checks it, keeps one of each name,
leaves that name out, and passes the proof on. docs/trust.md
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from vedette.agent.account import check, contradicts
from vedette.agent.effects import Effect, Send, TrafficKind
from vedette.agent.messages import Proof, Proven, decode_account, decode_beacon, encode
from vedette.agent.mission import Mission
from vedette.fusion import contradictions, proofs
from vedette.fusion.contradictions import MOST_BYTES, Contradiction, Histories, Twice, Words
from vedette.fusion.seals import ACCOUNT, BEACON
from vedette.fusion.standing import Signed

AGAIN = 10.0  # neighbours are told so often of whom there are proofs [s]


def _said(words: Words) -> bytes:
    _, data = words
    if not isinstance(data, bytes):
        raise ValueError("a word that is no message")
    return data


def _of_beacon(words: Words) -> tuple[Any, ...]:
    beacon = decode_beacon(_said(words))
    return beacon.robot, BEACON, beacon.boot, beacon.sequence


def _of_account(words: Words) -> tuple[Any, ...]:
    account = decode_account(_said(words))
    return account.robot, ACCOUNT, account.boot, account.epoch, account.sequence


SUBJECTS: Mapping[str, proofs.Subject] = {**proofs.SUBJECTS, BEACON: _of_beacon, ACCOUNT: _of_account}


@dataclass
class Proofs:
    """One robot's, by the name of whom they convict."""

    mission: Mission[Any, Any, Any]
    signed: Signed
    _held: dict[int, Proof] = field(default_factory=dict)
    _told: float = -1e9  # when neighbours were told of them last [s]

    def take_found(self, neighbours: tuple[int, ...]) -> list[Effect]:
        """Take up what this robot has found out itself, and let everybody know.

        It is checked like anybody's: of a signature others can make another, that is under the same words.
        """
        found, self.signed.standing.found = self.signed.standing.found, []
        effects: list[Effect] = []
        for robot, proof in found:
            data = contradictions.encode(proof)
            with suppress(ValueError):
                self._check(robot, proof)
                if len(data) <= MOST_BYTES and robot not in self._held:
                    certificate = self.signed.standing.notary.certificate_of(robot)
                    effects += self._keep(Proof(robot, certificate, data), proof, neighbours)
        return effects

    def hear(self, sender: int, told: Proof, neighbours: tuple[int, ...]) -> list[Effect]:
        """Check a proof, keep it and hand it on.

        Raises:
            ValueError: it proves nothing.
        """
        if told.robot in self._held:
            return []
        standing, proof = self.signed.standing, contradictions.decode(told.data)
        try:
            standing.notary.admit(told.robot, told.certificate)
            self._check(told.robot, proof)
        except ValueError as error:
            standing.complaints[sender] = (
                f"what it says to prove of robot-{told.robot + 1} is no proof: {error}"
            )
            raise
        return self._keep(told, proof, tuple(k for k in neighbours if k != sender))

    def _check(self, robot: int, proof: Contradiction) -> None:
        notary = self.signed.standing.notary
        match proof:
            case Twice():
                proofs.check_twice(proof, notary, robot, SUBJECTS)
            case Histories():
                proofs.check_histories(proof, notary, robot)
            case _:
                account = decode_account(proof.account)
                if account.robot != robot or not contradicts(account, self.mission):
                    raise ValueError(proofs.NOTHING)
                check(account, notary)

    def _keep(self, told: Proof, proof: Contradiction, neighbours: tuple[int, ...]) -> list[Effect]:
        self._held[told.robot] = told
        self.signed.standing.convict(told.robot, _lie_of(proof))
        self.signed.heed()
        return [_say(k, told) for k in neighbours]

    def hear_proven(self, sender: int, told: Proven) -> list[Effect]:
        """Give a neighbour the proofs that it lacks, and ask for those that this robot lacks."""
        lacks = self._held.keys() - set(told.robots)
        asks = [] if self._held.keys() >= set(told.robots) else [_say(sender, self._proven)]
        return [*(_say(sender, self._held[robot]) for robot in sorted(lacks)), *asks]

    def tick(self, neighbours: tuple[int, ...], now: float) -> list[Effect]:
        """Tell neighbours now and then of whom there are proofs: some may have come later."""
        effects = self.take_found(neighbours)
        if self._held and now >= self._told + AGAIN:
            self._told = now
            effects += [_say(k, self._proven) for k in neighbours]
        return effects

    @property
    def _proven(self) -> Proven:
        return Proven(tuple(sorted(self._held)))


def _lie_of(proof: Contradiction) -> str:
    match proof:
        case Twice():
            return "it has signed two different things of one number"
        case Histories():
            return "it has signed two histories of what it has seen"
        case _:
            return "it has told another sum than that of what it says to have heard"


def _say(to: int, message: Proof | Proven) -> Effect:
    return Send(to, TrafficKind.NEGOTIATION, encode(message))
