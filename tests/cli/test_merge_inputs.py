"""What ``vedette merge`` makes of maps as people have them: joined rightly, or one line and no file."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from tests.support.commands import Command, refused
from tests.support.frames import Part, building, off, part
from tests.support.schemas import valid
from vedette.align import FramePose
from vedette.maps import FREE, OCCUPIED, UNKNOWN, write_map

HERE = FramePose(0.0, 0.0, 0.0)
EAST = FramePose.of(4.0, -2.0, 2.5)

GREYS = {  # of UNKNOWN, FREE and OCCUPIED, as map savers write them
    "trinary": (205, 254, 0),
    "scale": (0, 255, 0),  # unknown by its alpha
    "raw": (255, 0, 100),
}


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys, "merge")


@pytest.fixture
def west(vedette: Command) -> Part:
    made = part(building(1), 0.0, 16.0, HERE)
    write_map("west", made.frame, made.classes)
    return made


def test_maps_that_have_the_same_name_are_told_apart(vedette: Command, west: Part) -> None:
    for folder, other in (("one", building(2)), ("two", building(3))):
        Path(folder).mkdir()
        made = part(other, 0.0, 16.0, HERE)
        write_map(f"{folder}/floor", made.frame, made.classes)
    ran = vedette("one/floor.yaml", "two/floor.yaml", "--out", "both")
    assert (ran.status, ran.out) == (1, "")
    assert ran.err.startswith("vedette: no safe match of two/floor.yaml with one/floor.yaml: ")


def saver_writes(name: str, of: Part, mode: str, **more: object) -> None:
    """Write a pair as ROS's map_saver does in a mode: an image, and a ``.yaml`` with its words."""
    grey = np.array(GREYS[mode], np.uint8)[of.classes[::-1]]
    image: Image.Image = Image.fromarray(grey)
    if mode == "scale":
        alpha = np.where(of.classes[::-1] == UNKNOWN, 0, 255).astype(np.uint8)
        image = Image.merge("LA", (image, Image.fromarray(alpha)))
    image.save(f"{name}.png")
    words = {
        "image": f"{name}.png",
        "mode": mode,
        "resolution": of.frame.resolution,
        "origin": [of.frame.origin_x, of.frame.origin_y, 0],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.196,
    } | more
    Path(f"{name}.yaml").write_text("".join(f"{key}: {value}\n" for key, value in words.items()))


def told_of(vedette: Command, *maps: str) -> dict[str, Any]:
    """Return where the second map came to lie."""
    ran = vedette(*maps, "--out", "both", "--json")
    assert ran.status == 0, ran.err
    placed: dict[str, Any] = valid("merge", ran.out)["maps"][1]
    return placed


def right(placed: dict[str, Any], a: Part, b: Part) -> None:
    found = FramePose.of(placed["x_m"], placed["y_m"], math.radians(placed["yaw_deg"]))
    shift, turn = off(found, a, b)
    assert shift <= 0.1
    assert turn <= math.radians(0.5)


@pytest.mark.parametrize("mode", sorted(GREYS))
def test_each_mode_of_map_saver_is_merged(vedette: Command, west: Part, mode: str) -> None:
    east = part(building(1), 8.0, 24.0, EAST)
    saver_writes("east", east, mode)
    right(told_of(vedette, "west.yaml", "east.yaml"), west, east)


@pytest.mark.parametrize("resolution", [0.05, 0.07, 0.2])
def test_maps_of_other_cells_are_merged_in_those_of_the_first(
    vedette: Command, west: Part, resolution: float
) -> None:
    east = part(building(1), 8.0, 24.0, EAST, resolution)
    write_map("east", east.frame, east.classes)
    right(told_of(vedette, "west.yaml", "east.yaml"), west, east)


def test_thresholds_under_which_all_that_is_unknown_is_free_do_not_mislead(
    vedette: Command, west: Part
) -> None:
    east = part(building(1), 8.0, 24.0, EAST)
    saver_writes("east", east, "trinary", free_thresh=0.25)
    ran = vedette("west.yaml", "east.yaml", "--out", "both")
    assert ran.status == 1
    warned, doubt = ran.err.splitlines()
    assert "set free_thresh to 0.196" in warned
    assert doubt.startswith("vedette: no safe match of east with west: ")
    assert not Path("both").exists()


def test_a_map_with_itself_lies_where_it_is(vedette: Command, west: Part) -> None:
    placed = told_of(vedette, "west.yaml", "west.yaml")
    assert (placed["x_m"], placed["y_m"], placed["yaw_deg"]) == pytest.approx((0.0, 0.0, 0.0), abs=0.01)


def test_a_map_that_lies_upside_down_is_turned_back(vedette: Command, west: Part) -> None:
    """Once by the yaw of its origin, in the first one's frame, and once by its pixels alone."""
    turned = np.ascontiguousarray(west.classes[::-1, ::-1])
    width, height = west.frame.cols * 0.1, west.frame.rows * 0.1
    x, y = west.frame.origin_x + width, west.frame.origin_y + height
    saver_writes("yawed", Part(west.frame, turned, HERE), "trinary", origin=[x, y, math.pi])
    placed = told_of(vedette, "west.yaml", "yawed.yaml")
    assert (placed["x_m"], placed["y_m"], placed["yaw_deg"]) == pytest.approx((0.0, 0.0, 0.0), abs=0.05)
    write_map("turned", west.frame, turned)
    ran = vedette("west.yaml", "turned.yaml", "--out", "again", "--json")
    placed = valid("merge", ran.out)["maps"][1]
    assert abs(placed["yaw_deg"]) == pytest.approx(180.0, abs=0.1)
    assert placed["x_m"] == pytest.approx(x + west.frame.origin_x, abs=0.05)
    assert placed["y_m"] == pytest.approx(y + west.frame.origin_y, abs=0.05)


def test_a_map_that_cannot_be_read_is_named_in_one_line(vedette: Command, west: Part) -> None:
    Path("cut.pgm").write_bytes(Path("west.pgm").read_bytes()[:200])
    Path("cut.yaml").write_text(Path("west.yaml").read_text().replace("west", "cut"))
    Path("noise.pgm").write_bytes(bytes(range(256)))
    Path("noise.yaml").write_text(Path("west.yaml").read_text().replace("west", "noise"))
    Path("words.yaml").write_text("these are: [no map\n")
    for name in ("cut", "noise", "words"):
        refused(vedette("west.yaml", f"{name}.yaml", "--out", "both"), name)
    assert not Path("both").exists()


@pytest.mark.parametrize("cells", [UNKNOWN, FREE, OCCUPIED])
def test_4000_x_4000_cells_of_one_kind_are_refused_in_one_line(
    vedette: Command, west: Part, cells: int
) -> None:
    pixels: NDArray[np.uint8] = np.full((4000, 4000), GREYS["trinary"][cells], np.uint8)
    Image.fromarray(pixels).save("large.png")
    Path("large.yaml").write_text(Path("west.yaml").read_text().replace("west.pgm", "large.png"))
    refused(vedette("west.yaml", "large.yaml", "--out", "both"), "large.yaml has no")
    assert not Path("both").exists()
