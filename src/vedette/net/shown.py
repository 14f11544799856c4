"""The vehicles of a scenario as an operator sees them: all, or one alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from vedette.agent.orders import Order
from vedette.net.gather import vehicle_name
from vedette.net.report import Report


class ShownVehicles:
    """What of ``vedette.net.feed.Onlooker`` is alike for all teams of vehicles."""

    def __init__(self, names: Sequence[str], only: int | None) -> None:
        """Show vehicles by their names; ``only``: one of them, by its index."""
        self._names = names
        self._shown = range(len(names)) if only is None else [only]

    def numbers(self, reports: Mapping[int, Report]) -> Sequence[int]:
        """Return all of the scenario."""
        return [i + 1 for i in self._shown]

    def name(self, robot: int) -> str:
        """Return the scenario's word for a vehicle."""
        return vehicle_name(self._names, robot)

    def as_drawn(self, order: Order, reports: Mapping[int, Report]) -> Order:
        """Return an order as it is: all share a frame."""
        return order
