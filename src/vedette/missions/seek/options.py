"""How a team looks for somebody in a building that it does not know."""

from __future__ import annotations

from dataclasses import dataclass

from vedette.domains.search.detectors import DefiniteRange
from vedette.errors import check_word

ORDERS = ("map-first", "together")
WORTH = 2.0  # of finding somebody, in what knowing the whole ground is worth
LATER = 1e-3  # of that, where the map comes first
LOOK_PERIOD = 0.5  # between two looks for somebody [s]


@dataclass(frozen=True)
class SeekOptions:
    """The same for the whole team.

    Raises:
        InputError: an order that is none, or no detector can be so.
    """

    order: str = "map-first"  # of ORDERS
    reach: float = 3.0  # within which somebody is seen [m]
    detection: float = 0.8  # probability of seeing somebody in reach, a look

    def __post_init__(self) -> None:
        check_word("order", self.order, ORDERS)
        _ = self.detector

    @property
    def detector(self) -> DefiniteRange:
        """What every robot looks with."""
        return DefiniteRange(detection=self.detection, range=self.reach, noise=0.0)

    @property
    def worth(self) -> float:
        """Of finding somebody, in what knowing the whole ground is worth."""
        return WORTH if self.order == "together" else WORTH * LATER
