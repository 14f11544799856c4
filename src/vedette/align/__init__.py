"""How two maps of unknown frames lie on each other: candidates with what speaks for and against them."""

from vedette.align.candidates import Alignment, PossibleJoin, align
from vedette.align.charted import Charted, charted
from vedette.align.pose import FramePose
from vedette.align.verdict import JoinVerdict, judged

__all__ = ["Alignment", "Charted", "FramePose", "JoinVerdict", "PossibleJoin", "align", "charted", "judged"]
