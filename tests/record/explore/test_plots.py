"""Pictures and film show the map, survive odd shapes, and are the same for the same log."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from tests.support.record_mission import recorded, rooms, scene
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.outcome import Outcome
from vedette.record import palette
from vedette.record.explore.curves import curves_png
from vedette.record.explore.film import explore_gif
from vedette.record.explore.log import ExploreLog, ExploreSnapshot, RobotSample
from vedette.record.explore.progress import progress_png
from vedette.record.explore.raster import enlarge, fit, known_window, paint, pool
from vedette.record.explore.summary import ExploreSummary
from vedette.record.explore.told import caption
from vedette.record.links import Link
from vedette.record.summary import Traffic


@pytest.fixture(scope="module")
def log() -> ExploreLog:
    return recorded(rooms(80, 120), 2, 4, (3.0, 3.0), limit=30.0, kill=(1, 20.0), reach=2.5)


def _summary(log: ExploreLog, **changes: object) -> ExploreSummary:
    names = list(log.scene.vehicles)
    traffic = {name: Traffic() for name in names}
    figures: dict[str, object] = {
        "completed": True, "outcome": Outcome.COMPLETE, "lost": (), "left": (), "seed": 3,
        "robots": len(names), "planner": "tours",
        "scheme": "token", "fusion": "evidence", "world": log.scene.name, "radio": None, "faults": None,
        "apart_s": 0.0, "time_s": float(log.times[-1]),
        "t50_s": 5.0, "t90_s": 12.0, "t95_s": 15.0, "t99_s": None, "auc_s": 12.0, "coverage": 0.98,
        "known_m2": 90.0, "rate_m2_s": 3.0, "frontiers": 2, "beyond": 0, "no_go_m2": 0.0, "cut_off_m2": 0.0,
        "expected": None,
        "turned_back": (),
        "map_errors": 0, "map_error_share": 0.0, "pose_error_m": None,
        "path_m": dict.fromkeys(names, 1.0), "overlap": 0.2,
        "collisions": 0, "min_clearance_m": 0.06, "rounds": 12, "sweeps": 30, "bound_ratio": None,
        "messages": traffic, "bytes": traffic, "maps": (), "left_out": (),
    }  # fmt: skip
    return ExploreSummary(**(figures | changes))  # type: ignore[arg-type]


def _still(rows: int, cols: int, robots: int) -> ExploreLog:
    """Return a log of a single moment before anything is known."""
    frame = GridFrame(0.1, rows, cols)
    names = [f"robot-{i}" for i in range(robots)]
    log = ExploreLog(scene("dark", frame, frame.coarse(2), names))
    team = tuple(
        RobotSample(0.1 * i, 0.1, 0.0, "idle", True, np.empty((0, 2)), name, None)
        for i, name in enumerate(names)
    )
    log.add(ExploreSnapshot(0.0, team, 0.0, 0.0, 1.0, np.zeros(frame.shape, np.uint8), None))
    return log


def test_pooling_keeps_walls_and_covers_every_cell_once() -> None:
    rng = np.random.default_rng(1)
    classes = rng.choice([UNKNOWN, FREE, OCCUPIED], (37, 53), p=[0.6, 0.37, 0.03]).astype(np.uint8)
    pixels = pool(classes, 10, 17)
    assert pixels.shape == (10, 17)
    for i in range(10):
        for j in range(17):
            block = classes[i * 37 // 10 : (i + 1) * 37 // 10, j * 53 // 17 : (j + 1) * 53 // 17]
            assert pixels[i, j] == block.max()
    np.testing.assert_array_equal(pool(classes, 99, 99), classes)


@pytest.mark.parametrize("shape", [(10, 4000), (4000, 10), (300, 200), (5, 5), (1, 1)])
def test_a_fit_keeps_proportions_within_the_limit(shape: tuple[int, int]) -> None:
    rows, cols = fit(shape, (48, 70))
    assert 1 <= rows <= min(48, shape[0])
    assert 1 <= cols <= min(70, shape[1])
    assert (rows, cols) == shape or rows == 48 or cols == 70  # the largest there is
    assert abs(rows * shape[1] - cols * shape[0]) <= max(shape)  # to the row and the column


def test_the_window_is_what_is_known_and_a_margin() -> None:
    classes = np.zeros((100, 200), np.uint8)
    classes[30:40, 2:150] = FREE
    window = known_window(GridFrame(0.1, 100, 200, -3.0, 5.0), classes, margin=0.5)
    assert (window.rows, window.cols) == (slice(25, 45), slice(0, 155))
    assert window.frame == GridFrame(0.1, 20, 155, -3.0, 7.5)


def test_impact_colours_the_unknown_alone_and_at_its_place() -> None:
    frame = GridFrame(0.1, 6, 8)
    classes = np.zeros(frame.shape, np.uint8)
    classes[:, 6:] = FREE
    impact = np.zeros(frame.coarse(2).shape, np.float32)
    impact[1, 2:] = 1.0
    colours = paint(
        ExploreSnapshot(0.0, (), 0, 0, 0, classes, impact),
        frame.coarse(2),
        known_window(frame, classes, margin=9.0),
        (100, 100),
    )
    plain = palette.CLASSES[classes]
    touched = (colours != plain).any(axis=2)
    expected = np.zeros(frame.shape, bool)
    expected[2:4, 4:6] = True
    np.testing.assert_array_equal(touched, expected)


def test_enlarging_makes_every_wall_equally_dark() -> None:
    stripes = np.full((1, 7, 3), 255, np.uint8)
    stripes[:, ::2] = 0
    wide = np.asarray(enlarge(stripes, (100, 3)))[0, :, 0].astype(float)
    darkness = [255 - wide[round(k * 100 / 7) : round((k + 1) * 100 / 7)].mean() for k in (0, 2, 4, 6)]
    assert min(darkness) > 0.9 * 255
    assert wide.shape == (100,)


def test_the_same_log_gives_the_same_bytes(log: ExploreLog, tmp_path: Path) -> None:
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        progress_png(log, tmp_path / name / "progress.png")
        curves_png(log, _summary(log), tmp_path / name / "curves.png")
        explore_gif(log, tmp_path / name / "mission.gif", frames=5)
        matplotlib.rcParams["font.size"] = 30  # a user's settings must not matter
    matplotlib.rcdefaults()
    files = sorted(file.name for file in (tmp_path / "one").iterdir())
    assert files == ["curves.png", "mission.gif", "progress.png"]
    for file in files:
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()


def test_the_last_stage_shows_the_final_map(log: ExploreLog, tmp_path: Path) -> None:
    progress_png(log, tmp_path / "progress.png")
    image = np.asarray(Image.open(tmp_path / "progress.png").convert("RGB"))
    assert image.shape[1] > 1500
    for colour in (*palette.CLASSES, np.array(palette.ROBOTS[0]), np.array(palette.ROBOTS[1])):
        assert _share(image, colour) > 1e-4


def _share(image: NDArray[np.uint8], colour: NDArray[np.generic]) -> float:
    return float((np.abs(image.astype(int) - colour).max(axis=2) <= 2).mean())


@pytest.mark.parametrize(("rows", "cols", "robots"), [(400, 30, 1), (20, 500, 8), (3, 3, 2), (100, 100, 12)])
def test_odd_shapes_and_an_unknown_world_are_drawn(rows: int, cols: int, robots: int, tmp_path: Path) -> None:
    log = _still(rows, cols, robots)
    progress_png(log, tmp_path / "progress.png")
    explore_gif(log, tmp_path / "mission.gif")
    nothing = {"t50_s": None, "t90_s": None, "t95_s": None}
    curves_png(log, _summary(log, **nothing), tmp_path / "curves.png")
    for name in ("progress.png", "mission.gif", "curves.png"):
        with Image.open(tmp_path / name) as image:
            assert max(image.size) <= 2400


def test_of_ground_that_nobody_knows_pictures_say_no_share(log: ExploreLog, tmp_path: Path) -> None:
    """And are drawn, though no round has been and though there are only figures that nobody has."""
    nobody_knows = {"coverage": None, "known_fraction": None, "entropy": None}
    open_ended = ExploreLog(log.scene)
    for snapshot in log.snapshots():
        frontiers = None if snapshot.t < 3.0 else 4
        open_ended.add(replace(snapshot, **nobody_knows, known_m2=snapshot.t, frontiers=frontiers))
    summary = _summary(log, coverage=None, auc_s=None, t50_s=None, t90_s=None, t95_s=None, t99_s=None)
    progress_png(open_ended, tmp_path / "progress.png")
    curves_png(open_ended, summary, tmp_path / "curves.png")
    explore_gif(open_ended, tmp_path / "mission.gif")
    assert caption(open_ended.last) == f"{log.times[-1]:.0f} s    {log.times[-1]:.0f} m² known"
    with Image.open(tmp_path / "curves.png") as image, Image.open(tmp_path / "progress.png") as stages:
        assert min(*image.size, *stages.size) > 300


def _linked(links: tuple[Link, ...] | None) -> ExploreLog:
    """Return a log of three robots far from each other in the dark."""
    frame = GridFrame(0.1, 60, 90)
    places = ((1.0, 1.0), (8.0, 1.0), (4.5, 5.0))
    log = ExploreLog(scene("dark", frame, frame.coarse(2), ("robot-0", "robot-1", "robot-2")))
    team = tuple(
        RobotSample(*place, 0.0, "idle", True, np.empty((0, 2)), name, None)
        for name, place in zip(log.scene.vehicles, places, strict=True)
    )
    for t in (0.0, 1.0, 2.0):
        log.add(ExploreSnapshot(t, team, 0.0, 0.0, 1.0, np.full(frame.shape, FREE, np.uint8), None, links))
    return log


def _darkness(path: Path, links: tuple[Link, ...] | None) -> tuple[float, tuple[int, int]]:
    """Return how dark progress.png is in all, and its size."""
    progress_png(_linked(links), path)
    with Image.open(path) as image:
        return float((255 - np.asarray(image.convert("L")).astype(float)).sum()), image.size


def test_links_on_the_tree_are_drawn_dark_and_others_faint_and_the_legend_explains_them(
    tmp_path: Path,
) -> None:
    path = tmp_path / "progress.png"
    _, ideal = _darkness(path, None)
    alone, size = _darkness(path, ())
    faint, _ = _darkness(path, (Link(0, 1, False, 0.0),))
    dark, _ = _darkness(path, (Link(0, 1, True, 0.0),))
    assert alone + 1e4 < faint < dark
    assert size[0] == ideal[0]
    assert size[1] > ideal[1]  # by a line of the legend


def test_a_film_shows_links(tmp_path: Path) -> None:
    frames = []
    for name, links in (("without", None), ("with", (Link(0, 1, True, 0.0), Link(1, 2, False, 0.0)))):
        explore_gif(_linked(links), tmp_path / f"{name}.gif")
        with Image.open(tmp_path / f"{name}.gif") as film:
            frames.append(np.asarray(film.convert("RGB")).astype(int))
    changed = np.abs(frames[0] - frames[1]).max(axis=2) > 30
    rows, cols = np.nonzero(changed)
    assert rows.max() - rows.min() > 0.5 * changed.shape[0]
    assert cols.max() - cols.min() > 0.7 * changed.shape[1]


def test_times_apart_are_shaded_in_the_curves(tmp_path: Path) -> None:
    shares = []
    for links in (None, ()):
        log = _linked(links)
        curves_png(log, _summary(log, apart_s=2.0), tmp_path / "curves.png")
        with Image.open(tmp_path / "curves.png") as image:
            red, _, blue = np.moveaxis(np.asarray(image.convert("RGB")).astype(int), -1, 0)
            shares.append(float((red > blue + 20).mean()))
    assert shares[0] < 0.2 < shares[1]


def test_the_film_is_short_small_and_ends_slowly(log: ExploreLog, tmp_path: Path) -> None:
    explore_gif(log, tmp_path / "mission.gif", frames=6)
    with Image.open(tmp_path / "mission.gif") as film:
        assert film.n_frames == 6  # type: ignore[attr-defined]
        assert max(film.size) <= 800
        assert film.info["duration"] == 100
        film.seek(5)
        assert film.info["duration"] > 1000
        last = np.asarray(film.convert("RGB"))
    assert _share(last, palette.CLASSES[FREE]) > 0.3
    assert _share(last, palette.CLASSES[OCCUPIED]) > 0.005
