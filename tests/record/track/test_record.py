"""What a tracking mission leaves: summary, record, pictures, film, live view."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from PIL import Image
from rich.console import Console
from rosbags.typesys import Stores, get_typestore

from tests.support.places import ROOT
from tests.support.track_scenes import flown, scenario
from vedette.record.display import Display
from vedette.record.track.ellipse import SIGMA, ellipse_axes
from vedette.record.track.entropy import entropy_png
from vedette.record.track.live import line, screen, track_display
from vedette.record.track.log import TrackLog, TrackSnapshot
from vedette.record.track.mcap import TrackMcapWriter
from vedette.record.track.observer import TrackReport
from vedette.record.track.panel import track_gif
from vedette.record.track.summary import TrackSummary
from vedette.record.track.tracks import tracks_png


@pytest.fixture(scope="module")
def report() -> TrackReport:
    """A short mission in which a vehicle is lost."""
    return flown(scenario(duration=12), kills=((1, 7.0),))[1]


def test_every_field_of_the_summary_is_documented_in_its_order(report: TrackReport) -> None:
    figures = json.loads(report.summary.to_json())
    text = (ROOT / "docs" / "outputs.md").read_text(encoding="utf-8")
    section = text.partition("### `summary.json` of `vedette track`")[2].partition("\n## ")[0]
    documented = re.findall(r"^\| `(\w+)` \|", section, flags=re.MULTILINE)
    assert documented[: len(figures)] == list(figures)
    assert figures["schema_version"] == 3
    assert set(figures["messages"]["vehicle-1"]) == {"negotiation", "fusion", "beacons", "overlay"}
    assert 0.0 < figures["bound_ratio"] <= 1.0


def test_the_record_holds_poses_plans_tracks_truth_and_metrics(report: TrackReport, tmp_path: Path) -> None:
    with TrackMcapWriter(tmp_path / "run.mcap", report.log.scene) as writer:
        for snapshot in report.log.snapshots:
            writer.update(snapshot)
    store = get_typestore(Stores.ROS2_HUMBLE)
    count: dict[str, int] = {}
    last = {}
    with (tmp_path / "run.mcap").open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None
            count[channel.topic] = count.get(channel.topic, 0) + 1
            last[channel.topic] = store.deserialize_cdr(message.data, schema.name)
    steps = len(report.log.snapshots)
    assert count["/tf"] == count["/metrics/entropy"] == count["/targets/target_1/truth"] == steps
    assert count["/vehicle_2/pose"] < steps == count["/vehicle_1/pose"] == count["/vehicle_1/path"]
    final = report.log.snapshots[-1]
    track = last["/targets/target_1/track"].pose
    assert track.pose.position.x == pytest.approx(final.means[0, 0])
    covariance = np.array(track.covariance).reshape(6, 6)
    np.testing.assert_allclose(covariance[:2, :2], final.covariances[0, :2, :2])
    assert np.linalg.eigvalsh(covariance[np.ix_([0, 1, 3, 4, 5], [0, 1, 3, 4, 5])]).min() > 0.0
    assert last["/vehicle_2/state"].data == "dead"


def test_pictures_and_film_load_and_are_the_same_for_the_same_log(
    report: TrackReport, tmp_path: Path
) -> None:
    for number in (1, 2):
        tracks_png(report.log, tmp_path / f"tracks-{number}.png")
        entropy_png({"negotiated": report.log}, {"optimum": "too many"}, tmp_path / f"entropy-{number}.png")
    for stem in ("tracks", "entropy"):
        first, second = ((tmp_path / f"{stem}-{number}.png").read_bytes() for number in (1, 2))
        assert first == second
        with Image.open(tmp_path / f"{stem}-1.png") as image:
            assert min(image.size) > 500
    track_gif(report.log, tmp_path / "mission.gif", frames=3)
    with Image.open(tmp_path / "mission.gif") as film:
        assert film.n_frames == 3  # type: ignore[attr-defined]


@pytest.mark.parametrize("area", [(0, 0, 3000, 260), (0, 0, 300, 2600)])
def test_odd_shapes_and_a_single_step_can_be_drawn(
    area: tuple[float, float, float, float], tmp_path: Path
) -> None:
    _, report = flown(scenario(duration=1, area=list(area)))
    assert len(report.log.snapshots) == 1
    tracks_png(report.log, tmp_path / "tracks.png")
    entropy_png({"none": report.log}, {}, tmp_path / "entropy.png")
    with Image.open(tmp_path / "tracks.png") as image:
        assert max(image.size) < 4000


def test_an_ellipse_holds_nineteen_in_twenty() -> None:
    covariance = np.array([[90.0, 40.0], [40.0, 30.0]])
    width, height, angle = ellipse_axes(covariance)
    points = np.random.default_rng(0).multivariate_normal([0, 0], covariance, 50_000)
    turned = np.exp(-1j * np.radians(angle)) * (points[:, 0] + 1j * points[:, 1])
    inside = (turned.real / (width / 2)) ** 2 + (turned.imag / (height / 2)) ** 2 <= 1.0
    assert inside.mean() == pytest.approx(0.95, abs=0.003)
    assert pytest.approx(2.4477, abs=1e-4) == SIGMA


# -- live -----------------------------------------------------------------------------------------------


def terminal(width: int = 100, height: int = 40) -> Console:
    """A terminal of this size that keeps what it is sent."""
    return Console(
        file=io.StringIO(), force_terminal=True, width=width, height=height, legacy_windows=False,
        color_system="truecolor", _environ={"TERM": "xterm-256color"},
    )  # fmt: skip


def sent(console: Console) -> str:
    """Return what a console was sent, without colours and cursor moves."""
    assert isinstance(console.file, io.StringIO)
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", console.file.getvalue())


def test_without_a_terminal_there_is_a_line_every_ten_seconds_and_at_last(report: TrackReport) -> None:
    console = Console(file=io.StringIO(), width=300)
    with track_display(report.log.scene, console=console) as view:
        for snapshot in report.log.snapshots:
            view.update(snapshot)
    lines = sent(console).splitlines()
    assert [text.split()[0] for text in lines] == ["0.0", "10.0", "11.0"]
    assert "vehicle-2 dead" in lines[-1]
    assert lines[-1] == line(report.log.scene, report.log.snapshots[-1])


@pytest.mark.parametrize("size", [(100, 40), (60, 14), (20, 10), (200, 60)])
def test_a_picture_fits_its_terminal_and_shows_everybody(report: TrackReport, size: tuple[int, int]) -> None:
    console = terminal(*size)
    console.print(screen(report.log.scene, console, report.log.snapshots[-1]))
    lines = sent(console).splitlines()
    assert max(map(len, lines)) <= size[0]
    assert len(lines) <= max(size[1], 9)
    if size[0] >= 60:
        text = "\n".join(lines)
        assert all(name in text for name in report.log.scene.vehicles)
        assert "entropy" in text


def test_a_quiet_display_says_nothing_and_a_live_one_draws_now_and_then(report: TrackReport) -> None:
    quiet = terminal()
    with track_display(report.log.scene, quiet=True, console=quiet) as view:
        view.update(report.log.snapshots[0])
        view.say("a line")
    assert sent(quiet) == ""
    drawn: list[float] = []

    def picture(console: Console, snapshot: TrackSnapshot) -> str:
        drawn.append(snapshot.t)
        return "picture"

    clock = iter(np.arange(0.0, 100.0, 0.04))
    with Display(picture, lambda s: "line", console=terminal(), clock=lambda: float(next(clock))) as live:
        for snapshot in report.log.snapshots:
            live.update(snapshot)
    assert drawn[0] == 0.0
    assert drawn[-1] == 11.0
    assert 2 <= len(drawn) < 12


def test_a_log_hands_on_and_keeps_everything(report: TrackReport) -> None:
    heard: list[TrackSnapshot] = []

    class Sink:
        def update(self, snapshot: TrackSnapshot) -> None:
            heard.append(snapshot)

    log = TrackLog(report.log.scene, (Sink(),))
    for snapshot in report.log.snapshots:
        log.add(snapshot)
    assert heard == log.snapshots
    assert log.stages((0.0, 1.0)) == [heard[0], heard[-1]]
    assert log.trails(3.0).shape == (4, 3, 2)
    seen = [{target for vehicle in each.vehicles for target in vehicle.seen} for each in log.snapshots]
    shares = [sum(k in targets for targets in seen) / len(seen) for k in range(len(log.scene.targets))]
    assert log.in_view().tolist() == pytest.approx(shares)
    assert max(shares) > 0.0
    assert isinstance(report.summary, TrackSummary)
