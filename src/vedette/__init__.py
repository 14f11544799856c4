"""Vedette: a team of platforms gathers information together, with no central computer."""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False  # as `typing` has it, whose import takes longer than all else here
if TYPE_CHECKING:
    from vedette.errors import InputError
    from vedette.negotiation import Negotiation, Tree
    from vedette.negotiation.negotiate import negotiate
    from vedette.problem import (
        Clippable,
        Codec,
        Controls,
        CountedCoverage,
        Coverage,
        Exhaustive,
        FiniteModel,
        Invertible,
        LogDet,
        Objective,
        Platform,
        bound,
        counted,
        diagonally_dominant,
        exhaustive,
    )

    __version__: str

__all__ = [
    "Clippable",
    "Codec",
    "Controls",
    "CountedCoverage",
    "Coverage",
    "Exhaustive",
    "FiniteModel",
    "InputError",
    "Invertible",
    "LogDet",
    "Negotiation",
    "Objective",
    "Platform",
    "Tree",
    "__version__",
    "bound",
    "counted",
    "diagonally_dominant",
    "exhaustive",
    "negotiate",
]


def __getattr__(name: str) -> object:
    """Return what the package offers; it is imported when it is asked for, so that commands start at once."""
    if name == "__version__":
        return import_module("importlib.metadata").version("vedette")
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    for part in ("errors", "negotiation", "problem"):
        if hasattr(module := import_module(f"vedette.{part}"), name):
            return getattr(module, name)
    raise AttributeError(name)
