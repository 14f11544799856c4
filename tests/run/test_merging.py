"""Saved maps become one: in the first one's frame, closed walls, nothing where a match is not safe."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from tests.support.frames import Part, building, off, part
from vedette.align import FramePose
from vedette.errors import InputError
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame, write_map
from vedette.run.merging import SavedMap, merge, read

HERE = FramePose(0.0, 0.0, 0.0)


def saved(name: str, of: Part) -> SavedMap:
    return SavedMap(name, of.frame, of.classes)


@pytest.fixture(scope="module")
def parts() -> list[Part]:
    classes = building(1)
    poses = HERE, FramePose.of(5.0, -3.0, 2.2), FramePose.of(-8.0, 1.0, -0.6)
    return [part(classes, *at, pose) for at, pose in zip(((0, 13), (5, 19), (11, 24)), poses, strict=True)]


def test_three_maps_in_a_chain_become_the_building(parts: list[Part]) -> None:
    merged = merge([saved(str(number), each) for number, each in enumerate(parts)])
    assert merged.joined.whole, merged.joined.doubts
    for each, pose in zip(parts, merged.joined.poses, strict=True):
        assert pose is not None
        assert off(pose, parts[0], each)[0] < 0.1
    truth = building(1)
    rows, cols = truth.shape
    down, right = round(-merged.frame.origin_y / 0.1), round(-merged.frame.origin_x / 0.1)
    own = merged.classes[down : down + rows, right : right + cols]
    free = (truth == FREE) & (own != UNKNOWN)
    assert np.count_nonzero(free) > 0.97 * np.count_nonzero(truth == FREE)
    assert np.count_nonzero(own[free] == FREE) > 0.93 * np.count_nonzero(free)  # walls are thicker by a cell


def test_merging_the_same_maps_again_gives_the_same_bytes(parts: list[Part]) -> None:
    maps = [saved("a", parts[0]), saved("b", parts[1])]
    assert merge(maps).classes.tobytes() == merge(maps).classes.tobytes()


@pytest.mark.parametrize("at", [0, 1, 2])
def test_a_map_of_another_building_is_named_wherever_it_stands_and_the_others_do_not_hide_it(
    parts: list[Part], at: int
) -> None:
    maps = [saved("a", parts[0]), saved("b", parts[1])]
    maps.insert(at, saved("stranger", part(building(2), 0.0, 14.0, HERE)))
    merged = merge(maps)
    assert not merged.joined.whole
    assert [doubt is None for doubt in merged.joined.doubts] == [number != at for number in range(3)]


def test_of_maps_of_which_no_two_match_all_but_the_first_are_doubted() -> None:
    maps = [saved(str(seed), part(building(seed), 0.0, 14.0, HERE)) for seed in (2, 3, 4)]
    assert [doubt is None for doubt in merge(maps).joined.doubts] == [True, False, False]


def test_of_cells_that_two_maps_call_differently_a_wall_counts() -> None:
    frame = GridFrame(0.1, 160, 240)
    classes = building(3)
    altered = classes.copy()
    altered[60:62, 100:102] = OCCUPIED
    merged = merge([SavedMap("a", frame, classes), SavedMap("b", frame, altered)])
    assert merged.joined.whole
    down, right = round(-merged.frame.origin_y / 0.1), round(-merged.frame.origin_x / 0.1)
    spot = merged.classes[down + 59 : down + 63, right + 99 : right + 103]
    assert (spot == OCCUPIED).any()
    assert (merged.whose > 0).sum() == (merged.classes != UNKNOWN).sum()


def test_a_large_map_with_a_small_one_in_it_is_done() -> None:
    """4000 x 4000 cells of 0.05 m, of which a building covers a part."""
    classes = np.full((4000, 4000), UNKNOWN, np.uint8)
    fine = building(1).repeat(2, axis=0).repeat(2, axis=1)
    classes[1000 : 1000 + fine.shape[0], 2000 : 2000 + fine.shape[1]] = fine
    small = part(building(1), 3.0, 18.0, FramePose.of(1.0, 1.0, 1.0))
    merged = merge([SavedMap("large", GridFrame(0.05, 4000, 4000), classes), saved("small", small)])
    assert merged.joined.whole
    pose = merged.joined.poses[1]
    assert pose is not None
    corner = FramePose(100.0, 50.0, 0.0)  # of the building in the large map
    shift, turn = pose.apart(corner.after(small.pose), small.charted.middle)
    assert shift < 0.1
    assert turn < math.radians(0.5)


@pytest.mark.parametrize(("cells", "lacks"), [(FREE, "walls"), (UNKNOWN, "free ground"), (OCCUPIED, "free")])
def test_a_map_with_nothing_to_be_found_by_is_refused_in_one_line(
    tmp_path: Path, cells: int, lacks: str
) -> None:
    write_map(tmp_path / "a", GridFrame(0.1, 160, 240), building(1))
    write_map(tmp_path / "b", GridFrame(0.1, 30, 30), np.full((30, 30), cells, np.uint8))
    with pytest.raises(InputError, match=f"b.yaml has no {lacks}"):
        read([tmp_path / "a.yaml", tmp_path / "b.yaml"])


def test_one_map_is_not_enough(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="takes 2 to 20 maps; got 1"):
        read([tmp_path / "a.yaml"])
