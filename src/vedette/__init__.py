"""Vedette: a team of platforms gathers information together, with no central computer."""

from vedette.errors import InputError
from vedette.negotiation import Negotiation, Tree, negotiate
from vedette.problem import (
    Clippable,
    Codec,
    CountedCoverage,
    Coverage,
    Exhaustive,
    Invertible,
    LogDet,
    Objective,
    Platform,
    bound,
    counted,
    exhaustive,
)

__all__ = [
    "Clippable",
    "Codec",
    "CountedCoverage",
    "Coverage",
    "Exhaustive",
    "InputError",
    "Invertible",
    "LogDet",
    "Negotiation",
    "Objective",
    "Platform",
    "Tree",
    "bound",
    "counted",
    "exhaustive",
    "negotiate",
]
