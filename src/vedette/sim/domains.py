"""The domains that are declared in one place each: what a command's help says, and where the rest is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vedette.errors import check_word
from vedette.parts import is_reference, look_in, named

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
OWN = "vedette.sim.own.domain:OwnDomain"
DOMAINS: Mapping[str, DomainEntry] = {each.name: each for each in _ALL}


def own_domain(name: str) -> bool:
    """Tell whether a word names a domain of somebody's own; this folder may have its module."""
    if is_reference(name):
        look_in(Path())
        return True
    return name in named("missions")


def entry_of(name: str) -> DomainEntry:
    """Return the entry of a domain by its name; ``module:NAME`` and entry points are somebody's own.

    Raises:
        InputError: there is none of that name.
    """
    if name in DOMAINS:
        return DOMAINS[name]
    if not (is_reference(name) or name in named("missions")):
        check_word("domain", name, (*DOMAINS, *named("missions")))
    # imported now: who asks for an own domain waits for it
    theory = import_module("vedette.missions.own.theory").MISSION.find(name)
    about = " ".join((theory.__doc__ or name).split())
    line = about.partition(". ")[0].rstrip(".") + "."
    return DomainEntry(name, line, about, "what is there, and all chance", OWN)


def domain_of(name: str) -> Domain[Any, Any, Any, Any, Any]:
    """Return a domain by its name; it is imported when it is asked for.

    Raises:
        InputError: there is none of that name.
    """
    return entry_of(name).load()
