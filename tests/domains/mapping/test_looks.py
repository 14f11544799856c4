"""Looks at one belief from one place are worked out once, and are what each would be by itself."""

from __future__ import annotations

import numpy as np
import pytest

from vedette.domains.mapping import stops
from vedette.domains.mapping.belief import MapBelief, freeze
from vedette.domains.mapping.layers import rate
from vedette.domains.mapping.looks import Aim, LooksTaken
from vedette.domains.mapping.prior import Shares
from vedette.domains.mapping.sightings import SightingModel, beam_model, empty_counts
from vedette.kernels import coverage
from vedette.maps import FREE, GridFrame
from vedette.team import PlatformSpec

FRAME = GridFrame(0.1, 60, 80)
LOOKS: list[Aim] = [(1610, 1.5), (1625, 1.5), (1610, -2.0)]


def belief() -> MapBelief:
    classes = np.zeros(FRAME.shape, np.uint8)
    classes[10:30, 5:40] = FREE
    counts = empty_counts()
    return freeze(classes, FRAME, reach=1.0, extent=2.5, hidden=1.0, layers=rate(), counts=counts)


def counted(
    frozen: MapBelief, looks: list[Aim], spec: PlatformSpec, monkeypatch: pytest.MonkeyPatch
) -> tuple[Shares, int]:
    """Return what is found from some places, and from how many of them rays were cast."""
    cast = 0
    real = coverage.footprints

    def footprints(classes: object, berths: object, views: np.ndarray, *rest: object) -> Shares:
        nonlocal cast
        cast += len(views)
        return real(classes, berths, views, *rest)  # type: ignore[arg-type]

    views, toward = np.array([view for view, _ in looks]), np.array([way for _, way in looks])
    with monkeypatch.context() as patched:
        patched.setattr(stops.coverage, "footprints", footprints)
        return stops._footprints(frozen, frozen.classes, spec, model(), views, toward), cast


def model() -> SightingModel:
    return beam_model(40)


def alone(frozen: MapBelief, look: Aim, spec: PlatformSpec) -> Shares:
    """Cast the rays of one look, whatever has been looked at before."""
    view, toward = look
    rays, width = stops._rays(spec, frozen.frame.resolution), float(np.radians(spec.view))
    return coverage.footprints(
        frozen.classes, frozen.berths, np.array([view]), np.array([toward]), spec.range / 0.1, width,
        model().table, model().by_distance, rays, frozen.factor, stops.MIN_SHARE,
    )  # fmt: skip


def test_mates_on_one_belief_cast_each_look_once_and_all_get_what_they_would_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    frozen, spec = belief(), PlatformSpec(range=4.0, view=120.0)
    _, cast = counted(frozen, LOOKS[:2], spec, monkeypatch)
    assert cast == 2
    looks = [LOOKS[2], LOOKS[1], LOOKS[0], LOOKS[1]]
    (starts, cells, shares), cast = counted(frozen, looks, spec, monkeypatch)
    assert cast == 1
    for row, look in enumerate(looks):
        _, own_cells, own_shares = alone(frozen, look, spec)
        assert len(own_cells) > 0
        np.testing.assert_array_equal(cells[starts[row] : starts[row + 1]], own_cells)
        np.testing.assert_array_equal(shares[starts[row] : starts[row + 1]], own_shares)


def test_another_lidar_and_another_belief_look_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    frozen = belief()
    for spec in (PlatformSpec(range=4.0), PlatformSpec(range=3.0), PlatformSpec(range=4.0, view=90.0)):
        assert counted(frozen, LOOKS, spec, monkeypatch)[1] == len(LOOKS)
    assert counted(frozen, LOOKS, PlatformSpec(range=4.0), monkeypatch)[1] == 0
    other = belief()
    assert counted(other, LOOKS, PlatformSpec(range=4.0), monkeypatch)[1] == len(LOOKS)


def test_no_looks_reveal_nothing() -> None:
    starts, cells, shares = LooksTaken.at(belief()).reveal(
        "lidar", [], lambda new: pytest.fail("nothing is new")
    )
    assert starts.tolist() == [0]
    assert len(cells) == len(shares) == 0
