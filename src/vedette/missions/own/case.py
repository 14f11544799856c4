"""A mission of an own domain made ready: its scenario read, its theory checked as it is used."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vedette.errors import brief
from vedette.fusion.steps.elements import MOST_ENTRY
from vedette.missions.own.scenario import OwnScenario, read_scenario
from vedette.missions.own.theory import Theory
from vedette.number import is_whole
from vedette.parts import number, telling, told
from vedette.problem import Objective


@dataclass(frozen=True, eq=False)
class OwnCase:
    """A mission of an own domain; ``vedette.missions.flights.DomainCase``."""

    name: str
    scenario: OwnScenario
    theory: Theory[Any, Any]
    where: str  # the domain, as messages have it
    files: tuple[Path, ...] = ()

    @classmethod
    def of(
        cls, domain: str, theory: type[Theory[Any, Any]], scenario: Path | Mapping[str, Any] | None
    ) -> OwnCase:
        """Return the mission of a scenario: a file, its fields, or None for the theory's example.

        Raises:
            InputError: it cannot be used, or the theory refuses it.
        """
        name, read = read_scenario(theory.example if scenario is None else scenario, theory.scenario_type)
        where = f"domain {domain}"
        with telling(where):
            made = theory(read)
            _check(made)
        return cls(theory.__name__.lower() if scenario is None else name, read, _told(made, where), where)

    @property
    def names(self) -> list[str]:
        """Of the vehicles."""
        return self.scenario.vehicle_names

    def truth(self, seed: int) -> Any:
        """Return what is there; whoever simulates a part of the mission has the same."""
        return self.theory.truth(np.random.default_rng([seed, 3]))


MOST_SIZE = 1 << 22  # numbers that evidence adds up


def _check(theory: Theory[Any, Any]) -> None:
    """Raise TypeError or ValueError for a size, an objective or a codec that is none."""
    size, objective, codec = theory.size, theory.objective, theory.codec
    if not (is_whole(size) and 1 <= size <= MOST_SIZE):
        raise ValueError(f"size is {size!r}; a whole number from 1 to {MOST_SIZE} is asked for")
    if not isinstance(objective, Objective):
        raise TypeError(f"objective is {brief(objective)}; an Objective is asked for")
    if isinstance(codec, type) or not all(callable(getattr(codec, of, None)) for of in ("encode", "decode")):
        raise TypeError(f"codec is {brief(codec)}; something with encode and decode is asked for")


def _told(theory: Theory[Any, Any], where: str) -> Theory[Any, Any]:
    """Return the theory, of which whatever it does wrong is told in a line."""
    size = theory.size

    def evidence(returned: Any) -> None:
        places, numbers = (np.asarray(each) for each in returned)
        if places.ndim != 1 or places.shape != numbers.shape:
            raise ValueError(f"gives places {places.shape} and numbers {numbers.shape}; give (M,) of both")
        if len(places) and (places.dtype.kind not in "iu" or numbers.dtype.kind not in "iu"):
            raise TypeError("gives places or numbers that are no whole numbers")
        if len(numbers) and int(np.abs(numbers).max()) > MOST_ENTRY:
            raise ValueError(f"gives {int(np.abs(numbers).max())}; numbers up to 2^50 are asked for")
        if len(places) and not (places[0] >= 0 and places[-1] < size and (np.diff(places) > 0).all()):
            raise ValueError(f"gives places that do not increase within 0 to {size - 1}")

    def figures(returned: Any) -> None:
        for each in dict(returned).values():
            number(each)

    def image(returned: Any) -> None:
        if returned is not None and np.ndim(returned) != 2:
            raise ValueError(f"gives {np.shape(returned)}; numbers (R, C) are asked for")

    anything = {name: lambda returned: None for name in ("truth", "sense", "belief")}
    checks = {"evidence": evidence, "figures": figures, "image": image, "impacts": _sequence}
    return told(theory, {**anything, **checks}, where)


def _sequence(returned: Any) -> None:
    if not isinstance(returned, Sequence | np.ndarray):
        raise TypeError(f"gives {type(returned).__name__}; a list of impacts is asked for")
