"""All targets by name."""

from __future__ import annotations

from functools import cache

from tests.fuzz.agents import agents
from tests.fuzz.decoders import decoders
from tests.fuzz.files import files
from tests.fuzz.network import networked
from tests.fuzz.receivers import receivers
from tests.fuzz.target import Target


@cache
def targets() -> dict[str, Target]:
    """Return what can be fuzzed."""
    return {each.name: each for each in (*decoders(), *receivers(), *agents(), *networked(), *files())}
