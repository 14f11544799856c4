"""Fault schedules as files: read, checked, and written for people to read."""

from __future__ import annotations

from pathlib import Path

import msgspec
import yaml

from vedette.errors import InputError
from vedette.record.files import write_text
from vedette.scenario import load_scenario
from vedette.sim.faults.kinds import Fault, Schedule
from vedette.sim.faults.rules import check_faults
from vedette.sim.faults.seeds import faults_from_seed

DURATION = 120.0  # of faults from a seed [s]


def load_faults(file_or_seed: str, robots: int, duration: float = DURATION) -> Schedule:
    """Return the schedule in a file, or the one that follows from a whole number.

    ``duration`` [s]: within which the faults of a seed happen.

    Raises:
        InputError: neither; as :func:`vedette.scenario.load_scenario`; or a fault that this team cannot have.
    """
    text = file_or_seed.strip()
    if text.isascii() and text.isdecimal():
        return faults_from_seed(int(text), robots, duration)
    if not Path(text).is_file():
        raise InputError(
            f"--faults {text}: neither a file that is there nor a seed, a whole number such as 7"
        )
    schedule = load_scenario(text, Schedule, "fault schedule")
    check_faults(schedule, robots, text)
    return schedule


def save_faults(path: Path | str, schedule: Schedule) -> None:
    """Write a schedule as `load_faults` reads it, a line a fault, in order of time.

    Raises:
        InputError: the file cannot be written.
    """
    write_text(path, faults_text(schedule))


def faults_text(schedule: Schedule) -> str:
    """Return a schedule as a file of it says it."""
    lines = [f"  - {_line(fault)}\n" for _, fault in schedule.in_time()]
    return "faults:\n" + "".join(lines) if lines else "faults: []\n"


def _line(fault: Fault) -> str:
    content = {"at": fault.at} | msgspec.to_builtins(fault)
    return yaml.safe_dump(content, default_flow_style=True, sort_keys=False, width=10**9).rstrip("\n")
