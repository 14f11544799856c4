"""Vehicles that turn at once and may stand: they move as told, exactly, and their way is what they went."""

from __future__ import annotations

import numpy as np
import pytest

from vedette.agent.effects import Fly
from vedette.agent.flight import FlightPlan, Itinerary, MovePlan
from vedette.sim.vehicles import Vehicles


def movers() -> Vehicles:
    """Two of 2 m/s, at the origin."""
    return Vehicles(np.zeros((2, 3)), 2.0, None, 1.0, lambda i, pose, now: None)


def test_a_mover_goes_along_its_velocities_and_then_stands() -> None:
    vehicles = movers()
    vehicles.carry_out(0, Fly(MovePlan(1.0, 2.0, np.array([[2.0, 0.0], [0.0, -1.0]]))), 0.0)
    for tick in range(1, 81):
        vehicles.advance(0.1 * tick, 0.1)
    np.testing.assert_allclose(vehicles.poses[0], (4.0, -2.0, -np.pi / 2), atol=1e-9)
    np.testing.assert_array_equal(vehicles.poses[1], np.zeros(3))
    np.testing.assert_allclose(vehicles.travelled, (6.0, 0.0), atol=1e-9)


def test_a_mover_that_died_and_lives_again_stands_until_it_is_told_otherwise() -> None:
    vehicles = movers()
    vehicles.carry_out(0, Fly(MovePlan(0.0, 1.0, np.full((9, 2), 1.0))), 0.0)
    vehicles.advance(1.0, 1.0)
    vehicles.kill(0)
    vehicles.advance(3.0, 2.0)
    vehicles.revive(0, 3.0)
    vehicles.advance(5.0, 2.0)
    np.testing.assert_allclose(vehicles.poses[0, :2], (1.0, 1.0))
    np.testing.assert_allclose(vehicles.travelled[0], np.sqrt(2.0))


def test_a_plan_that_a_vehicle_cannot_carry_out_is_refused() -> None:
    vehicles = movers()
    with pytest.raises(ValueError, match="2 m/s at most"):
        vehicles.carry_out(0, Fly(MovePlan(0.0, 1.0, np.array([[2.0, 1.0]]))), 0.0)
    with pytest.raises(ValueError, match="turns at most"):
        vehicles.carry_out(0, Fly(FlightPlan(0.0, 1.0, np.array([0.1]))), 0.0)
    turning = Vehicles(np.zeros((1, 3)), 2.0, 0.2, 1.0, lambda i, pose, now: None)
    with pytest.raises(ValueError, match="2 m/s at most"):
        turning.carry_out(0, Fly(MovePlan(0.0, 1.0, np.array([[1.0, 0.0]]))), 0.0)


def test_what_is_ahead_is_where_the_plans_lead() -> None:
    flight = Itinerary(None).joined(MovePlan(2.0, 1.0, np.array([[1.0, 0.0], [0.0, 1.0]])), 0.0)
    ahead = flight.ahead((5.0, 5.0, 0.0), 1.0, 1.0, 1.0)
    np.testing.assert_allclose(ahead, [(5, 5), (5, 5), (6, 5), (6, 6)])
