"""The team's problem: objectives, the exhaustive reference and the bound."""

from vedette.problem.bound import bound, slack
from vedette.problem.controls import Controls
from vedette.problem.coverage import CountedCoverage, Coverage, counted, seen
from vedette.problem.dominance import Dominance, diagonally_dominant
from vedette.problem.exhaustive import Exhaustive, exhaustive
from vedette.problem.logdet import LogDet
from vedette.problem.model import FiniteModel
from vedette.problem.objective import Codec, Invertible, Objective, Platform
from vedette.problem.reach import Box, Clippable, Reach

__all__ = [
    "Box",
    "Clippable",
    "Codec",
    "Controls",
    "CountedCoverage",
    "Coverage",
    "Dominance",
    "Exhaustive",
    "FiniteModel",
    "Invertible",
    "LogDet",
    "Objective",
    "Platform",
    "Reach",
    "bound",
    "counted",
    "diagonally_dominant",
    "exhaustive",
    "seen",
    "slack",
]
