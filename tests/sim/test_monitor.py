"""Monitoring simulated: who moves where, whose measurements count, and the optimum of each round."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest

from tests.support.monitor_scenes import SMALL, case
from vedette import InputError
from vedette.record.monitor.observer import MonitorReport
from vedette.run import DomainMission
from vedette.sim.domains import domain_of
from vedette.sim.monitor.oracle import check_optimum

MONITOR = domain_of("monitor")


def ran(coordination: str = "negotiated", seed: int = 1, **changes: object) -> MonitorReport:
    mission = DomainMission[MonitorReport](MONITOR, SMALL | changes, seed, coordination=coordination)
    return mission.run(compare=False)


def test_a_robot_on_the_ground_keeps_out_of_what_it_must_not_enter_and_a_flyer_need_not() -> None:
    closed: dict[str, Any] = {"no_go": [[[5, 0], [8, 0], [8, 9], [5, 9]]]}
    for coordination, changes in product(("negotiated", "lawnmower"), (closed, {})):
        log = ran(coordination, duration=40, **changes).log
        places = np.array([[(v.x, v.y) for v in s.vehicles] for s in log.snapshots])
        inside = ((places > (5.01, 0.01)) & (places < (7.99, 8.99))).all(axis=2)
        assert inside.any(axis=0).tolist() == [not changes, True]


def test_who_has_no_energy_left_neither_moves_nor_measures() -> None:
    vehicles = [SMALL["vehicles"][0] | {"budget": {"energy": 10, "per_metre": 1, "per_second": 1}}]
    report = ran(vehicles=vehicles)
    assert report.summary.path_m["rover"] <= 10.0
    alone = report.log.against("entropy")[2]
    assert alone[-1] > alone.min() + 1e-6  # what was seen grows old, and nothing comes after it


def test_the_optimum_is_at_least_as_good_a_round_as_the_negotiated_one_and_refused_where_too_dear() -> None:
    best, agreed, alone = (
        ran(coordination, bearings=4).summary.entropy_mean_nat
        for coordination in ("optimum", "negotiated", "none")
    )
    assert best <= agreed < alone - 1.0
    with pytest.raises(InputError, match="joint choices a round"):
        check_optimum(case(vehicles=SMALL["vehicles"] + [{"start": [5, 5]}, {"start": [6, 6]}]))


def test_both_ways_of_fusion_know_the_same_where_nothing_is_lost() -> None:
    replicated = DomainMission[MonitorReport](MONITOR, SMALL, 1, fusion="replicated").run(compare=False)
    sums = DomainMission[MonitorReport](MONITOR, SMALL, 1, fusion="sums").run(compare=False)
    np.testing.assert_array_equal(replicated.known.information, sums.known.information)
    np.testing.assert_array_equal(replicated.known.mean, sums.known.mean)
