"""How two maps of unknown frames lie on each other: candidates with what speaks for and against them."""

from vedette.align.candidates import Alignment, Candidate, align
from vedette.align.charted import Charted, charted
from vedette.align.pose import Pose
from vedette.align.verdict import Verdict, judged

__all__ = ["Alignment", "Candidate", "Charted", "Pose", "Verdict", "align", "charted", "judged"]
