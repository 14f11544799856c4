"""Inputs for what has a state: one of some prepared states, and the messages that come to it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from tests.fuzz.fingerprint import Digest, fingerprint
from tests.fuzz.keep import Kept
from tests.fuzz.mutation import mutate_message
from tests.fuzz.target import Broken, Target

MOST_MESSAGES = 8


class Told(msgspec.Struct, frozen=True, array_like=True):
    """A message and who sent it."""

    sender: Annotated[int, Meta(ge=0, lt=2**16)]
    payload: bytes


class Script(msgspec.Struct, frozen=True, array_like=True):
    """What comes to which state; a number beyond the last state begins again at the first."""

    scene: Annotated[int, Meta(ge=0)]
    told: Annotated[tuple[Told, ...], Meta(max_length=MOST_MESSAGES)]


@dataclass(frozen=True, eq=False)
class Stage:
    """States to begin with, and honest scripts."""

    scenes: Sequence[Kept]
    scripts: Sequence[Script]


_DECODER = msgspec.msgpack.Decoder(Script)
_ENCODER = msgspec.msgpack.Encoder()


def script_of(data: bytes) -> Script:
    """Return the script that the bytes are; any others are a message from robot 0 to the first state."""
    try:
        return _DECODER.decode(data)
    except (ValueError, RecursionError):
        return Script(0, (Told(0, data),))


def scripted(
    name: str,
    make: Callable[[], Stage],
    hear: Callable[[Any, int, bytes], bool],
    go_on: Callable[[Any], None],
    leave_out: frozenset[str] = frozenset(),
    ready: Callable[[Any], None] = lambda state: None,
    blame: Callable[[Any, int], None] = lambda state, sender: None,
) -> Target:
    """A target with a state.

    Args:
        name: of the target.
        make: prepares the states; called when first needed.
        hear: lets a state take in a message from a sender; tells whether it refused it.
        go_on: does with a state that has taken in messages what is done with it anyway.
        leave_out: fields that a refused message may change.
        ready: does with a state what is due, before a message comes.
        blame: does with a state all that a refused message may do: what its sender has deserved.
    """
    stage = cache(make)

    def read(data: bytes) -> None:
        script = script_of(data)
        scenes = stage().scenes
        scene = scenes[script.scene % len(scenes)]
        state, taken = scene.copy(), False
        for i, told in enumerate(script.told):
            ready(state)
            before = fingerprint(state, leave_out)
            refused = hear(state, told.sender, told.payload)
            after = fingerprint(state, leave_out) if refused else before
            if after != before and after != blamed(scene.copy(), script.told[:i], told.sender):
                raise Broken(f"{name}: a message was refused and has changed something")
            taken |= not refused
        if taken:
            go_on(state)

    def blamed(state: Any, told: Sequence[Told], sender: int) -> Digest:
        """Return what a state is like that has heard messages, and of one only that it is bad."""
        for each in told:
            ready(state)
            hear(state, each.sender, each.payload)
        ready(state)
        blame(state, sender)
        return fingerprint(state, leave_out)

    return Target(name, lambda: [_ENCODER.encode(script) for script in stage().scripts], read, mutate_message)
