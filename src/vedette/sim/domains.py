"""The domains that are declared in one place each: what a command's help says, and where the rest is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

from vedette.errors import check_word

if TYPE_CHECKING:  # whoever asks for help does not wait for the domain itself
    from vedette.sim.domain import Domain


@dataclass(frozen=True)
class DomainEntry:
    """A domain, as far as a command's help needs it."""

    name: str  # of its command, and in robots' files
    line: str  # what its command does
    about: str  # the same in some sentences
    seeds: str  # what the seed decides
    at: str  # "package.module:CLASS", a ``vedette.sim.domain.Domain``
    coordinations: tuple[str, ...] = ("none", "shared", "negotiated")
    simulated: tuple[str, ...] = ()  # of these, those that only a simulator can have

    def load(self) -> Domain[Any, Any, Any, Any, Any]:
        """Return the domain itself."""
        module, _, name = self.at.partition(":")
        domain: Domain[Any, Any, Any, Any, Any] = getattr(import_module(module), name)(self)
        return domain


_ALL = (
    DomainEntry(
        "monitor",
        "Let a team of robots and flyers keep a field known in simulation.",
        "Let a team of robots and flyers keep a field known in simulation: every one runs its own agent.\n\n"
        "SCENARIO is a YAML file; without it, two robots and a flyer measure the elevation of a terrain. "
        "Afterwards the same is done with every other way of coordination, to compare.",
        "a field that is drawn, and all chance",
        "vedette.sim.monitor.domain:Monitor",
        ("none", "shared", "negotiated", "optimum", "lawnmower", "random"),
        ("optimum",),
    ),
)
DOMAINS: Mapping[str, DomainEntry] = {each.name: each for each in _ALL}


def domain_of(name: str) -> Domain[Any, Any, Any, Any, Any]:
    """Return a domain by its name; it is imported when it is asked for.

    Raises:
        InputError: there is none of that name.
    """
    check_word("domain", name, DOMAINS)
    return DOMAINS[name].load()
