"""What a robot has found out, as files: its map, tracks, pdf or what else it tells, and ``summary.json``."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vedette.maps import GridFrame, write_map
from vedette.net.explore import content as maps
from vedette.net.names import robot_name
from vedette.net.report import Condition, Report
from vedette.net.search import content as pdfs
from vedette.net.status import numbered
from vedette.net.track import content as tracks
from vedette.number import many
from vedette.outcome import Outcome
from vedette.record.explore.summary import LeftOut
from vedette.record.files import atomic_path
from vedette.record.summary import Figures

MAP, TRACKS, PDF, TOLD = "map", "tracks.json", "pdf.npy", "told.msgpack"


@dataclass(frozen=True)
class TrackFound:
    """Where a target is, as a vehicle has it."""

    target: int  # from 1
    mean: tuple[float, ...]  # x, y, and their rates [m, m, m/s, m/s], team frame
    covariance: tuple[tuple[float, ...], ...]  # (4, 4)


@dataclass(frozen=True, kw_only=True)
class TracksFound(Figures):
    """``tracks.json``: what a vehicle knows of all targets at a time."""

    time_s: float
    tracks: tuple[TrackFound, ...]


@dataclass(frozen=True)
class PdfFound:
    """What goes with ``pdf.npy``, probabilities ``(R, C)`` of the target's being in each cell, bottom up."""

    extent: tuple[float, float, float, float]  # lowest x, lowest y, highest x, highest y [m]
    outside: float  # probability that the target has left the area
    declared: tuple[float, float] | None  # where the target is declared to be [m]


@dataclass(frozen=True, kw_only=True)
class RobotSummary(Figures):
    """``summary.json`` beside what one robot has found out."""

    team: str
    mission: str  # explore, track, search or domain
    robot: str
    outcome: Outcome | None  # how the mission ended for it; None: it goes on
    time_s: float  # of the mission
    coverage: float | None  # share of the ground that it knows; None: nobody knows how much there is
    known_m2: float | None  # None: no map is made
    left_out: tuple[LeftOut, ...]  # frontiers that it leaves
    pdf: PdfFound | None  # of a search
    condition: Condition  # all else that it says of itself, robots by their numbers


@dataclass(frozen=True)
class Found:
    """What the files tell beside their own contents."""

    left_out: tuple[LeftOut, ...] = ()
    pdf: PdfFound | None = None


def write_results(
    report: Report, folder: Path, team: str, mission: str, outcome: Outcome | None
) -> RobotSummary:
    """Write what a robot reports, each file whole, ``summary.json`` last.

    Raises:
        InputError: a file cannot be written.
        ValueError: the report is malformed.
    """
    condition = report.condition
    found = WRITERS[mission](report, folder)
    summary = RobotSummary(
        team=team,
        mission=mission,
        robot=robot_name(condition.robot),
        outcome=outcome,
        time_s=lasted(condition),
        coverage=condition.known,
        known_m2=condition.known_m2,
        left_out=found.left_out,
        pdf=found.pdf,
        condition=numbered(condition),
    )
    summary.write(folder / "summary.json")
    return summary


def lasted(condition: Condition) -> float:
    """Return for how long the mission has gone on for a robot [s]."""
    return condition.time if condition.began is None else condition.time - condition.began


def told(summary: RobotSummary) -> str:
    """Say in a line how the mission has ended, or how far it is, and what was left out."""
    word = "so far" if summary.outcome is None else summary.outcome.said
    known = "" if summary.known_m2 is None else f"{summary.known_m2:.1f} m2 known, "
    spots = Counter(spot.why for spot in summary.left_out)
    left = ", ".join(f"{number} {why.replace('_', ' ')}" for why, number in spots.items())
    left_out = f"; frontiers left out: {left}" if left else ""
    rounds = many(summary.condition.rounds, "round")
    return f"{word}: {known}{summary.time_s:.0f} s, {rounds}{left_out}"


def _write_map(report: Report, folder: Path) -> Found:
    seen = maps.read_content(report.content)
    by = robot_name(report.condition.robot)
    if seen.rows and seen.cols:
        write_map(folder / MAP, maps.frame_of(seen), maps.classes_of(seen))
    return Found(tuple(LeftOut(*spot, by) for spot in seen.left_out))


def _write_tracks(report: Report, folder: Path) -> Found:
    known = tracks.read_content(report.content)
    means, covariances = tracks.moments(known)
    found = tuple(
        TrackFound(i + 1, tuple(mean), tuple(map(tuple, covariance)))
        for i, (mean, covariance) in enumerate(zip(means.tolist(), covariances.tolist(), strict=True))
    )
    TracksFound(time_s=known.step * known.dt, tracks=found).write(folder / TRACKS)
    return Found()


def _write_pdf(report: Report, folder: Path) -> Found:
    pdf = pdfs.read_content(report.content)
    with atomic_path(folder / PDF) as part, part.open("wb") as file:
        np.save(file, pdfs.mass_of(pdf))
    declared = None if pdf.declared is None else (pdf.declared.x, pdf.declared.y)
    return Found(pdf=PdfFound(_extent(pdfs.frame_of(pdf)), pdf.outside, declared))


def _write_told(report: Report, folder: Path) -> Found:
    with atomic_path(folder / TOLD) as part:
        part.write_bytes(report.content)
    return Found()


def _extent(frame: GridFrame) -> tuple[float, float, float, float]:
    x_min, x_max, y_min, y_max = frame.extent
    return x_min, y_min, x_max, y_max


WRITERS: Mapping[str, Callable[[Report, Path], Found]] = {
    "explore": _write_map,
    "track": _write_tracks,
    "search": _write_pdf,
    "domain": _write_told,
}
