"""``vedette merge`` as users run it: its files, its words, and its exit status."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.support.commands import Command, refused
from tests.support.frames import Part, building, part
from tests.support.schemas import valid
from vedette.align import FramePose
from vedette.maps import FREE, UNKNOWN, GridFrame, read_map, write_map

HERE = FramePose(0.0, 0.0, 0.0)


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys, "merge")


def save(name: str, of: Part) -> None:
    Path(name).parent.mkdir(exist_ok=True)
    write_map(name, of.frame, of.classes)


def test_two_maps_leave_a_map_a_picture_and_where_they_lie(vedette: Command) -> None:
    classes = building(1)
    save("east", part(classes, 8.0, 24.0, FramePose.of(4.0, 1.0, 0.5)))
    save("run/map", part(classes, 0.0, 16.0, HERE))  # a run's folder
    ran = vedette("run", "east.yaml", "--out", "both", "--json")
    assert ran.status == 0, ran.err
    told = valid("merge", ran.out)
    assert [each["name"] for each in told["maps"]] == ["run", "east"]
    assert (told["maps"][1]["x_m"], told["maps"][1]["y_m"]) == pytest.approx((4.0, 1.0), abs=0.1)
    assert told["maps"][1]["yaw_deg"] == pytest.approx(28.65, abs=0.3)
    assert sorted(path.name for path in Path("both").iterdir() if path.name[0] != ".") == [
        "map.pgm",
        "map.yaml",
        "merge.json",
        "merge.png",
    ]
    assert read_map("both/map.yaml")[0].cols * 0.1 > 24.0
    assert Image.open("both/merge.png").size[0] == 1200


def test_without_a_safe_match_one_line_says_why_and_nothing_is_written(vedette: Command) -> None:
    save("a", part(building(1), 0.0, 16.0, HERE))
    save("b", part(building(2), 0.0, 16.0, HERE))
    ran = vedette("a.yaml", "b.yaml", "--out", "both")
    assert ran.status == 1
    assert ran.out == ""
    assert ran.err.startswith("vedette: no safe match of b with a: ")
    assert len(ran.err.splitlines()) == 1
    assert not Path("both").exists()


def test_bad_input_is_told_in_one_line(vedette: Command) -> None:
    save("a", part(building(1), 0.0, 16.0, HERE))
    refused(vedette("a.yaml", "--out", "both"), "takes 2 to 20 maps")
    refused(vedette("a.yaml", "gone.yaml", "--out", "both"), "gone.yaml")
    refused(vedette("a.yaml", "a.pgm", "--out", "both"), "resolution")
    refused(vedette("a.yaml", "a.yaml", "--out", "."), "which this command reads")
    frame = GridFrame(0.05, 60, 80)
    for name, content in (("empty", UNKNOWN), ("bare", FREE)):
        write_map(name, frame, np.full(frame.shape, content, np.uint8))
        refused(
            vedette("a.yaml", f"{name}.yaml", "--out", "both"), "so there is nothing to find its place by"
        )
    assert not Path("both").exists()
