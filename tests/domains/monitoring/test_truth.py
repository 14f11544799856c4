"""True fields: elevations that come with matplotlib, rasters where they lie, plumes, and models learned."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.cbook import get_sample_data

from tests.support.monitor_scenes import SMALL, case
from vedette import InputError
from vedette.domains.monitoring.scenario import Plume
from vedette.domains.monitoring.truth import averaged, plume
from vedette.maps import GridFrame

FRAME = GridFrame(2.0, 3, 4, 10.0, 20.0)  # x 10 to 18, y 20 to 26


@pytest.mark.parametrize(("name", "low", "high"), [("jacksboro", 236, 1076), ("topobathy", -1437, 2205)])
def test_elevations_that_come_with_matplotlib_are_stretched_over_the_area(
    name: str, low: float, high: float
) -> None:
    field = case(field={"type": name}, model={}, sensor={"noise": 1}, vehicles=SMALL["vehicles"][:1])
    numbers = field.truth(0).at(5)
    assert numbers.shape == (12, 16)
    assert low < numbers.min() < numbers.max() < high
    assert field.model.mean == pytest.approx(numbers.mean(), abs=numbers.std())
    assert 0.3 < field.model.deviation / numbers.std() < 3.0


def test_north_is_up_in_both_elevations() -> None:
    wide: dict[str, Any] = {"area": [0, 0, 40, 30], "model": {}, "vehicles": SMALL["vehicles"][:1]}
    jacksboro = case(field={"type": "jacksboro"}, **wide).truth(0).at(0)
    assert jacksboro[:10, 25:].mean() < jacksboro[20:, :15].mean()  # the valley is in the south-east
    with np.load(str(get_sample_data("topobathy.npz", asfileobj=False))) as data:
        assert data["latitude"][0] < data["latitude"][-1]
        north = data["topo"][-9:].mean()
    topobathy = case(field={"type": "topobathy"}, **wide).truth(0).at(0)
    assert topobathy[-3:].mean() == pytest.approx(north, abs=20.0)


def test_a_raster_is_averaged_over_each_cell_where_it_lies() -> None:
    values = np.arange(8 * 10, dtype=np.float64).reshape(8, 10)  # pixels of 1 m from x 9, y 19
    field = averaged(FRAME, values, (9.0, 19.0, 19.0, 27.0), "it")
    expected = values[1:7, 1:9].reshape(3, 2, 4, 2).mean(axis=(1, 3))
    np.testing.assert_allclose(field, expected)
    np.testing.assert_allclose(averaged(FRAME, expected, None, "it"), expected)
    values[1, 1] = np.nan
    hole = averaged(FRAME, values, (9.0, 19.0, 19.0, 27.0), "it")
    assert hole[0, 0] == pytest.approx(values[1:3, 1:3][~np.isnan(values[1:3, 1:3])].mean())
    with pytest.raises(InputError, match="does not cover"):
        averaged(FRAME, values, (11.0, 19.0, 19.0, 27.0), "it")


def test_a_plume_goes_with_the_wind_and_is_the_same_whoever_asks_first() -> None:
    frame = GridFrame(1.0, 40, 60)
    of = Plume(source=(20.0, 20.0), wind=(1.0, -0.5), wander=0.0, spreading=0.0)
    puffs = plume(frame, of, 1.0, np.random.default_rng(1))
    np.testing.assert_allclose(puffs.at(10)[:-5, 10:], puffs.first[5:, :-10], atol=1e-9)
    grown = plume(frame, Plume(source=(30.0, 20.0), spreading=0.5), 1.0, np.random.default_rng(1))
    assert grown.at(10).max() < grown.first.max()
    assert grown.at(10).sum() == pytest.approx(grown.first.sum(), rel=0.02)
    one, other = (plume(frame, Plume(source=(5.0, 20.0)), 1.0, np.random.default_rng(1)) for _ in range(2))
    late = one.at(7)
    other.at(3)
    np.testing.assert_array_equal(late, other.at(7))
    assert not np.array_equal(late, one.at(6))


def test_what_the_model_says_is_kept_and_only_the_rest_is_learned(tmp_path: Path) -> None:
    x = np.arange(16) * 0.7
    np.save(tmp_path / "own.npy", 30.0 + 4.0 * np.sin(x)[None, :] * np.ones((12, 1)))
    field = {"type": "file", "file": str(tmp_path / "own.npy")}
    learned = case(field=field, model={}, sensor={"noise": 0.1}).model
    assert learned.mean == pytest.approx(30.0, abs=2.0)
    given = case(field=field, model={"mean": 7.0, "length": 4.0}, sensor={"noise": 0.1}).model
    assert (given.mean, given.length) == (7.0, 4.0)
    assert given.deviation > 0.0
