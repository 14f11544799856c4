"""Nothing in a picture covers anything or is cut, whatever the size of the team and its names.

The oracle is matplotlib's own renderer: where it puts every text and legend.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from tests.support.search_missions import case
from tests.support.track_scenes import scenario
from vedette.maps import FREE, GridFrame
from vedette.outcome import Outcome
from vedette.record.explore.curves import curves_png
from vedette.record.explore.log import ExploreLog, ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.explore.progress import progress_png
from vedette.record.lettering import shortened, text_width
from vedette.record.log import DEAD, LEFT
from vedette.record.search.curves import Curves
from vedette.record.search.detection import detection_png
from vedette.record.search.log import SearchLog, SearchSample, SearchScene, SearchSnapshot
from vedette.record.search.panel import colours, scale
from vedette.record.search.stages import pdf_png
from vedette.record.search.summary import ended_how
from vedette.record.track.entropy import entropy_png
from vedette.record.track.log import TrackLog, TrackSample, TrackScene, TrackSnapshot
from vedette.record.track.panel import draw
from vedette.record.track.tracks import tracks_png

TEAMS = [(1, False), (3, True), (8, False), (20, False), (40, True)]
WORST = "W" * 64
NOWHERE = np.empty((0, 2))
WORLD = "a-world-with-a-name-so-long-that-no-title-of-any-picture-holds-it-in-one-line-" * 2


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[Figure]:
    """The figures that pictures are made of; they are drawn, but no file is encoded."""
    figures = list[Figure]()

    def keep(canvas: FigureCanvasAgg, path: Path, **_: Any) -> None:
        canvas.draw()  # type: ignore[no-untyped-call]
        Path(path).touch()
        figures.append(canvas.figure)

    monkeypatch.setattr(FigureCanvasAgg, "print_png", keep)
    monkeypatch.chdir(tmp_path)
    return figures


def names(count: int, long: bool) -> list[str]:
    return [f"{WORST[:60]}{i + 1}" if long else f"robot-{i + 1}" for i in range(count)]


def _state(i: int) -> tuple[str, bool]:
    return (DEAD, False) if i == 1 else (LEFT, False) if i == 2 else ("driving", True)


def explored(count: int, long: bool) -> ExploreLog:
    frame = GridFrame(0.1, 200, 300)
    classes = np.full(frame.shape, FREE, np.uint8)
    scene = ExploreScene(name=WORLD if long else "office", vehicles=tuple(names(count, long)), frame=frame,
                         planning=frame.coarse(2))  # fmt: skip
    log = ExploreLog(scene)
    for t in range(0, 30, 3):
        team = tuple(
            RobotSample(
                1.0 + 0.6 * i, 1.0 + 0.3 * t, 0.0, *_state(i), NOWHERE, name, None, 0.5 * t / (1 + 0.1 * i)
            )
            for i, name in enumerate(scene.vehicles)
        )
        log.add(
            ExploreSnapshot(float(t), team, t / 30.0, t / 40.0, 1e5 - t, classes, None, () if t < 9 else None)
        )
    return log


def tracked(count: int, long: bool, targets: int = 6, reach: float = 50.0) -> TrackLog:
    rng = np.random.default_rng(count)
    sensor = {"type": "range-bearing", "range": reach}
    vehicles = [{"start": [20, 20, 0], "sensor": sensor, "name": name} for name in names(count, long)]
    called = [f"{'trawler-of-the-fleet-' * long}{'t' * (not long)}-{i}" for i in range(targets)]
    plain = [{"model": "static", "mean": [30, 30], "sd": [9, 9], "name": name} for name in called]
    log = TrackLog(TrackScene.of(scenario(vehicles=vehicles, targets=plain), WORLD if long else "bay"))
    x0, y0, x1, y1 = log.scene.area
    means = np.zeros((targets, 4))
    means[:, :2] = rng.uniform((x0, y0), (x1, y1), (targets, 2))
    covariances = np.tile(np.diag((4.0, 2.0, 1.0, 1.0)), (targets, 1, 1))
    places = np.concatenate([means[:count, :2] + 0.5, rng.uniform((x0, y0), (x1, y1), (count, 2))])[:count]
    for t in range(6):
        team = tuple(TrackSample(*places[i].tolist(), 0.3 * i, *_state(i), NOWHERE, ()) for i in range(count))
        log.add(TrackSnapshot(float(t), team, 0, means, means, covariances, 50.0 - t, 1.0, 4.0))
    return log


def searched(count: int, long: bool, concentrated: float = 1.0) -> SearchLog:
    """A search whose last pdf is so much more concentrated than the first."""
    found = case(vehicles=[{"start": [100, 100, 60], "name": name} for name in names(count, long)])
    log = SearchLog(SearchScene.of(found, 20.0))
    first = found.pdf.mass.astype(np.float32)
    last = found.pdf.mass**concentrated
    for t, mass in enumerate((first, first, first, (last / last.sum()).astype(np.float32))):
        team = tuple(SearchSample(30.0 * i + 20, 200.0, 0.0, *_state(i), NOWHERE, None) for i in range(count))
        log.add(SearchSnapshot(4.0 * t, team, mass, 6.0, 0.2 * t, (500.0, 300.0)))
    return log


def summary(count: int, long: bool, **more: Any) -> Any:
    """What pictures take of a summary."""
    plain = {
        "world": WORLD if long else "office", "scenario": WORLD if long else "bay", "robots": count,
        "vehicles": count, "planner": "tours", "seed": 2**32 - 1, "apart_s": 1234.5, "t50_s": 1234.5,
        "t90_s": None, "t95_s": 29.0, "t99_s": None, "auc_s": 12345.6, "coverage": 0.96,
        "coordination": "negotiated",
        "outcome": Outcome.COMPLETE, "found_by": names(count, long)[0], "found_s": 12.0, "counted": None,
        "comparison": {}, "declare": None,
    }  # fmt: skip
    return SimpleNamespace(**(plain | more))


def extent(thing: Any) -> Bbox:
    """Where the renderer puts it [pixel]."""
    return thing.get_window_extent(thing.get_figure(root=True).canvas.get_renderer())


def texts(figure: Figure) -> list[Text]:
    """Every text that shows."""
    found = [*figure.texts, *(text for legend in figure.legends for text in legend.get_texts())]
    for axes in figure.axes:
        legend = axes.get_legend()
        found += [*axes.texts, *([] if legend is None else legend.get_texts())]
        found += [axes.title, axes._left_title, axes._right_title, axes.xaxis.label, axes.yaxis.label]
        for labels, limits, k in (
            (axes.get_xticklabels(), axes.get_xlim(), 0), (axes.get_yticklabels(), axes.get_ylim(), 1),
        ):  # fmt: skip
            found += [text for text in labels if min(limits) <= text.get_position()[k] <= max(limits)]
    return [text for text in found if text.get_visible() and text.get_text().strip()]


def within(box: Bbox, room: Any) -> bool:
    return bool((box.min >= room.min - 0.5).all() and (box.max <= room.max + 0.5).all())


def check(figure: Figure) -> None:
    """Every text is inside the picture, and no two meet."""
    boxes = [(text.get_text(), extent(text)) for text in texts(figure)]
    assert [said for said, box in boxes if not within(box, figure.bbox)] == []
    for (one, a), (other, b) in combinations(boxes, 2):
        assert not (a.padded(-1.5).overlaps(b.padded(-1.5))), (one, other)


def check_legends(figure: Figure) -> None:
    """There is a legend, and none lies on axes with data."""
    legends = [*figure.legends, *filter(None, (axes.get_legend() for axes in figure.axes))]
    assert legends
    for legend, axes in product(legends, figure.axes):
        assert not extent(legend).overlaps(axes.get_window_extent().padded(-1)), axes.get_ylabel()


@pytest.mark.parametrize(("count", "long"), TEAMS)
def test_an_exploration(drawn: list[Figure], count: int, long: bool) -> None:
    log = explored(count, long)
    curves_png(log, summary(count, long), "curves.png")
    progress_png(log, "progress.png")
    for figure in drawn:
        check_legends(figure)
    check(drawn[0])
    assert [text.get_text() for text in _unclipped(drawn[1]) if not within(extent(text), drawn[1].bbox)] == []


@pytest.mark.parametrize("targets", [1, 6, 30])
@pytest.mark.parametrize(("count", "long"), TEAMS)
def test_a_tracking_mission(drawn: list[Figure], count: int, long: bool, targets: int) -> None:
    log = tracked(count, long, targets)
    tracks_png(log, "tracks.png")
    entropy_png({"negotiated": log, "none": log}, {"optimum": "would try 10 000 choices " * 9}, "entropy.png")
    tracks, entropy = drawn
    check_legends(tracks)
    check_legends(entropy)
    check(entropy)
    panels = [axes for axes in tracks.axes if axes.get_title(loc="left")]
    assert panels
    for axes in panels:
        _check_labels(axes, log)


def _check_labels(axes: Axes, log: TrackLog) -> None:
    """Labels of targets lie inside the panel, on no vehicle and on no other label."""
    labels = [text for text in axes.texts if not text.get_text().isdigit()]
    boxes = [extent(label) for label in labels]
    panel = axes.get_window_extent()
    last = log.snapshots[-1]
    at = axes.transData.transform([(vehicle.x, vehicle.y) for vehicle in last.vehicles])
    half = 5.0 * min(1.0, (8 / len(at)) ** 0.25) * axes.figure.dpi / 72.0
    for box in boxes:
        assert within(box, panel)
        for x, y in at:
            assert not box.padded(-1).overlaps(Bbox([(x - half, y - half), (x + half, y + half)]).padded(-1))
    for one, other in combinations(boxes, 2):
        assert not one.padded(-1).overlaps(other.padded(-1))
    assert len(labels) >= 0.8 * len(log.scene.targets)


@pytest.mark.parametrize("alarms", [False, True])
@pytest.mark.parametrize(("count", "long"), TEAMS)
def test_a_search(drawn: list[Figure], count: int, long: bool, alarms: bool) -> None:
    pdf_png(searched(count, long), ended_how(vars(summary(count, long))), "pdf.png")
    times = np.linspace(0.0, 60.0, 31)
    low = 0.1 * times / 60.0  # curves that lie where a legend used to
    curves = Curves(times, low * 2, low, {"negotiated": low, "none": low / 2}, low)
    counted = SimpleNamespace(trials=1, of="runs", band=0.1, found=0.5, mistaken=3, missed=2)
    if alarms:
        curves = replace(curves, mistaken=low / 2, outside=low)
    comparison = dict.fromkeys(curves.detection, SimpleNamespace(mean_time_s=1234.0))
    rule = SimpleNamespace(probability=0.95, radius_m=100.0) if alarms else None
    told = summary(count, long, counted=counted, comparison=comparison, found_s=60.0, declare=rule)
    detection_png(curves, told, "detection.png")
    pdf, detection = drawn
    check_legends(pdf)
    check_legends(detection)
    check(detection)
    assert [text.get_text() for text in _unclipped(pdf) if not within(extent(text), pdf.bbox)] == []


def _unclipped(figure: Figure) -> list[Text]:
    """Every text but the numbers of vehicles, which end where the panel does."""
    return [text for text in texts(figure) if not text.get_text().isdigit()]


def test_views_over_the_whole_area_do_not_grey_it() -> None:
    """The background stays as light as under one narrow view, however many and wide they are."""
    shades = []
    for count, reach in ((1, 30.0), (8, 800.0), (40, 800.0)):
        log = tracked(count, False, 1, reach)
        figure = Figure(figsize=(4.0, 3.0), dpi=100)
        canvas = FigureCanvasAgg(figure)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        draw(axes, log, log.snapshots[-1], log.scene.area)
        canvas.draw()  # type: ignore[no-untyped-call]
        shades.append(float(np.median(np.asarray(canvas.buffer_rgba())[..., :3])))  # type: ignore[no-untyped-call]
    assert min(shades) >= 235


@pytest.mark.parametrize("concentrated", [1.0, 2.0, 6.0, 40.0])
def test_colours_tell_likely_from_less_likely_however_concentrated_a_pdf_becomes(concentrated: float) -> None:
    log = searched(2, False, concentrated)
    norm, first, last = scale(log), log.snapshots[0].mass, log.snapshots[-1].mass
    assert norm(last.max()) <= 1.0
    assert float(norm.vmax) >= last.max()  # nothing is cut off: the likeliest place can be told
    assert norm(first.max()) >= 0.2  # and the first pdf does not vanish
    assert np.ptp(np.asarray(colours()(float(norm(first.max())))[:3]) - colours()(0.0)[:3]) > 0.1


@pytest.mark.parametrize("text", ["W", "robot-1", WORST, "ill-lit", "naïve-☃"])
@pytest.mark.parametrize("size", [7.0, 9.0])
def test_a_text_is_at_most_as_wide_as_reckoned(text: str, size: float) -> None:
    figure = Figure(dpi=150)
    FigureCanvasAgg(figure)
    wide = extent(figure.text(0.1, 0.5, text, fontsize=size)).width / 150.0
    assert wide <= text_width(text, size) + 0.02
    assert text_width(text, size) <= 1.15 * wide + 0.02


def test_a_text_that_is_too_long_keeps_its_beginning_and_its_end() -> None:
    whole = "inspection-robot-12-of-the-north-wing"
    assert shortened(whole, 9.0) == whole
    short = shortened(whole, 1.5)
    begin, end = short.split("…")
    assert (whole.startswith(begin), whole.endswith(end)) == (True, True)
    assert min(len(begin), len(end)) >= 3
    assert text_width(short) <= 1.5
    assert shortened(whole, 0.01) == "…"
