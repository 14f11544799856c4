"""What a robot signs in an audit: its own claim, what came over its links, and which sums of that it told."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from msgspec import structs

from vedette.agent.messages import MOST_ANSWERED, PRINT_BYTES, Account, encode
from vedette.agent.mission import Mission
from vedette.agent.promises import weighed
from vedette.fusion.seals import ACCOUNT, Notary

Stamp = tuple[int, int]  # epoch and sequence of a round


@dataclass(frozen=True, eq=False)
class Claimed:
    """What was claimed in the last round that this robot has decided."""

    stamp: Stamp
    belief: Any
    own: Any  # impact
    heard: Mapping[int, Any]  # the sum that came over each link
    told: Mapping[int, Any]  # the sum that went over each last
    halvings: Mapping[int, int]  # by so many halves each that came counted less
    goes_back: bool = False  # the round has ended by strategies of earlier, which those sums are not of


def account_of(claimed: Claimed, mission: Mission[Any, Any, Any], robot: int, boot: int) -> Account:
    """Return a robot's account, not signed yet.

    A sum that it told before something changed is not among those that it answers for.
    """
    pack = mission.codec.encode
    heard = tuple(
        (k, claimed.halvings.get(k, 0), pack(impact)) for k, impact in sorted(claimed.heard.items())
    )
    account = Account(robot, boot, *claimed.stamp, pack(claimed.own), heard, ())
    told = [(k, pack(impact)) for k, impact in sorted(claimed.told.items())]
    stands = tuple((k, print_of(data)) for k, data in told if data == pack(sum_towards(account, mission, k)))
    return structs.replace(account, told=stands[:MOST_ANSWERED])


def sum_towards(account: Account, mission: Mission[Any, Any, Any], link: int) -> Any:
    """Return what a robot should have told over a link, by its own account.

    docs/trust.md (V76)

    Raises:
        ValueError: an impact is none.
    """
    total = mission.codec.decode(account.impact)
    for k, halvings, data in account.links:
        if k != link:
            total = mission.objective.combine(total, weighed(mission, mission.codec.decode(data), halvings))
    return total


def contradicts(account: Account, mission: Mission[Any, Any, Any]) -> bool:
    """Tell whether a robot has signed to have told another sum than that of what it says it was made of."""
    pack = mission.codec.encode
    return any(print_of(pack(sum_towards(account, mission, k))) != told for k, told in account.told)


def print_of(data: bytes) -> bytes:
    """Return the fingerprint of an impact."""
    return hashlib.blake2b(data, digest_size=PRINT_BYTES).digest()


def check(account: Account, notary: Notary) -> None:
    """Raise ValueError unless it is signed by whom it says."""
    notary.check(account.robot, account.signature, *words_of(account))


def words_of(account: Account) -> tuple[str, bytes]:
    """Return what is signed."""
    return ACCOUNT, encode(structs.replace(account, signature=b""))
