"""Fault schedules: files say what is meant, random ones heal, mistakes are one line, and time plays them."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette.errors import InputError
from vedette.sim.faults import (
    Crashes,
    Freezes,
    Restarts,
    Schedule,
    SkewedClock,
    Skews,
    Thaws,
    Timeline,
    check_faults,
    faults_from_seed,
    load_faults,
    save_faults,
)

EVERYTHING = """\
faults:
  - {at: 0, fault: skew, robot: 2, s: -3.5, ppm: 2e2}
  - {at: 5, fault: loss, share: 0.3, for: 10}
  - {at: 6, fault: delay, between: [0.01, 0.4], for: 2}
  - {at: 6, fault: duplicate, share: 0.1}
  - {at: 10, fault: one-way, from: 1, to: 3, for: 1}
  - {at: 12, fault: cut, robots: [2, 3]}
  - {at: 13, fault: partition, parts: [[1, 2], [3]]}
  - {at: 20, fault: heal}
  - {at: 21, fault: crash, robot: 2}
  - {at: 22.5, fault: restart, robot: 2}
  - {at: 30, fault: freeze, robot: 1, for: 4}
"""
KINDS = 11


def load(folder: Path, text: str, robots: int = 3) -> Schedule:
    path = folder / "storm.yaml"
    path.write_text(text)
    return load_faults(str(path), robots)


def blocked(timeline: Timeline) -> set[tuple[int, int]]:
    """Return sender and receiver of blocked directions, from 1."""
    cut = timeline.weather.blocked
    return set() if cut is None else {(int(i) + 1, int(k) + 1) for i, k in np.argwhere(cut)}


def test_a_file_of_all_kinds_plays_as_it_reads(tmp_path: Path) -> None:
    timeline = Timeline(load(tmp_path, EVERYTHING), 3)
    assert timeline.next_change() == 0.0
    assert timeline.advance(0.0) == [Skews(1, -3.5, 200.0)]
    assert timeline.advance(5.9) == []
    assert (timeline.weather.loss, timeline.weather.delay, timeline.weather.repeat) == (0.3, None, 0.0)
    assert timeline.advance(7.9) == []
    assert (timeline.weather.loss, timeline.weather.delay, timeline.weather.repeat) == (0.3, (0.01, 0.4), 0.1)
    assert (timeline.next_change(), blocked(timeline)) == (8.0, set())
    timeline.advance(10.0)
    assert (timeline.weather.delay, blocked(timeline)) == (None, {(1, 3)})
    timeline.advance(12.0)
    assert blocked(timeline) == {(2, 3), (3, 2)}
    timeline.advance(15.0)
    assert (timeline.weather.loss, blocked(timeline)) == (0.0, {(1, 3), (3, 1), (2, 3), (3, 2)})
    assert timeline.advance(22.5) == [Crashes(1), Restarts(1)]
    assert (timeline.weather.repeat, blocked(timeline)) == (0.0, set())
    assert timeline.advance(33.9) == [Freezes(0)]
    assert timeline.advance(99.0) == [Thaws(0)]
    assert timeline.next_change() == float("inf")


def test_the_weather_is_a_new_one_only_when_it_changes(tmp_path: Path) -> None:
    timeline = Timeline(load(tmp_path, EVERYTHING), 3)
    timeline.advance(5.0)
    weather = timeline.weather
    timeline.advance(5.9)
    assert timeline.weather is weather


def test_of_several_faults_of_a_kind_the_latest_rules_and_the_earlier_comes_back(tmp_path: Path) -> None:
    text = """\
faults:
  - {at: 1, fault: loss, share: 0.3}
  - {at: 2, fault: loss, share: 0.1, for: 2}
  - {at: 9, fault: heal}
"""
    timeline = Timeline(load(tmp_path, text), 3)
    losses = []
    for time in (1.0, 3.0, 4.0, 9.0):
        timeline.advance(time)
        losses.append(timeline.weather.loss)
    assert losses == [0.3, 0.1, 0.3, 0.0]


def test_robots_in_no_part_are_one_part_together(tmp_path: Path) -> None:
    timeline = Timeline(load(tmp_path, "faults: [{at: 0, fault: partition, parts: [[4]]}]", 4), 4)
    timeline.advance(0.0)
    assert blocked(timeline) == {(4, 1), (4, 2), (4, 3), (1, 4), (2, 4), (3, 4)}


def test_a_robot_that_crashes_while_frozen_does_not_thaw(tmp_path: Path) -> None:
    text = """\
faults:
  - {at: 1, fault: freeze, robot: 1, for: 9}
  - {at: 2, fault: crash, robot: 1}
  - {at: 3, fault: restart, robot: 1}
  - {at: 4, fault: freeze, robot: 1, for: 1}
"""
    timeline = Timeline(load(tmp_path, text), 1)
    assert timeline.advance(99.0) == [Freezes(0), Crashes(0), Restarts(0), Freezes(0), Thaws(0)]


def test_a_freeze_may_follow_another_at_once(tmp_path: Path) -> None:
    text = "faults: [{at: 1, fault: freeze, robot: 1, for: 2}, {at: 3, fault: freeze, robot: 1, for: 2}]"
    timeline = Timeline(load(tmp_path, text), 1)
    assert timeline.advance(3.0) == [Freezes(0), Thaws(0), Freezes(0)]


def test_a_clock_shows_a_time_without_jumps_and_says_when_it_will_show_one() -> None:
    clock = SkewedClock().skewed(0.0, -5.0, 1000.0)
    assert clock.shows(0.0) == -5.0
    assert clock.shows(100.0) == pytest.approx(95.1)
    slower = clock.skewed(100.0, 0.0, -1000.0)
    assert slower.shows(100.0) == clock.shows(100.0)
    assert slower.shows(200.0) == pytest.approx(95.1 + 99.9)
    for true in (100.0, 123.4, 5000.0):
        assert slower.when(slower.shows(true)) == pytest.approx(true)


def test_a_file_written_is_read_as_it_was(tmp_path: Path) -> None:
    schedule = load(tmp_path, EVERYTHING)
    save_faults(tmp_path / "again.yaml", schedule)
    assert load_faults(str(tmp_path / "again.yaml"), 3) == schedule
    assert "\n  - {at: 12.0, fault: cut, robots: [2, 3]}\n" in (tmp_path / "again.yaml").read_text()


def test_no_faults_are_a_schedule_too(tmp_path: Path) -> None:
    save_faults(tmp_path / "calm.yaml", Schedule(()))
    assert load_faults(str(tmp_path / "calm.yaml"), 1) == Schedule(())


@settings(deadline=None, max_examples=100)
@given(st.integers(0, 2**63), st.integers(1, 9), st.floats(1.0, 500.0))
def test_a_random_schedule_can_happen_and_heals(seed: int, robots: int, duration: float) -> None:
    schedule = faults_from_seed(seed, robots, duration)
    content = msgspec.to_builtins(schedule)
    assert msgspec.convert(content, Schedule) == schedule, "every field is in its range"
    check_faults(schedule, robots, "seed")
    timeline = Timeline(schedule, robots)
    crashed, frozen, up_always = set(), set(), set(range(robots))
    while timeline.next_change() < float("inf"):
        assert timeline.next_change() <= duration
        for happening in timeline.advance(timeline.next_change()):
            match happening:
                case Crashes(robot):
                    crashed.add(robot)
                    frozen.discard(robot)
                    up_always.discard(robot)
                case Restarts(robot):
                    crashed.remove(robot)
                case Freezes(robot):
                    assert robot not in crashed
                    frozen.add(robot)
                case Thaws(robot):
                    frozen.remove(robot)
    assert up_always
    assert not frozen
    weather = timeline.weather
    assert (weather.loss, weather.repeat, weather.delay, weather.blocked) == (0.0, 0.0, None, None)


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**63))
def test_a_random_schedule_written_is_read_as_it_was(
    tmp_path_factory: pytest.TempPathFactory, seed: int
) -> None:
    path = tmp_path_factory.getbasetemp() / "seed.yaml"
    schedule = faults_from_seed(seed, 4, 60.0)
    save_faults(path, schedule)
    assert load_faults(str(path), 4) == schedule


def test_a_seed_gives_its_schedule_and_seeds_give_all_kinds() -> None:
    schedules = [faults_from_seed(seed, 4, 60.0) for seed in range(100)]
    assert schedules[7] == load_faults("7", 4, 60.0) == faults_from_seed(7, 4, 60.0)
    assert schedules[7] != schedules[8]
    assert len({type(fault) for schedule in schedules for fault in schedule.faults}) == KINDS


MISTAKES = {
    "at: 1, fault: crash, robot: 4": "faults[1].robot: there is no robot 4 in a team of 3",
    "at: 1, fault: crash, robot: 0": "faults[1].robot: must be a whole number >= 1; got 0",
    "at: 1, fault: crahs, robot: 1": "faults[1].fault: unknown fault 'crahs'; did you mean 'crash'?",
    "at: 1, fault: crash, robto: 1": "faults[1]: unknown field 'robto'; did you mean 'robot'?",
    "at: 1, robot: 1": (
        "faults[1]: fault is missing; add it, one of loss, delay, duplicate, one-way, cut, partition, heal, "
        "crash, restart, freeze, skew"
    ),
    "fault: crash, robot: 1": "faults[1]: at is missing; add it, a number from 0 to 86400",
    "at: -1, fault: heal": "faults[1].at: must be a number from 0 to 86400; got -1",
    "at: .inf, fault: heal": "faults[1].at: must be a finite number; got inf",
    "at: 1, fault: loss, share: 1.5": "faults[1].share: must be a number from 0 to 1; got 1.5",
    "at: 1, fault: loss, share: 0.5, for: 0": "faults[1].for: must be a number > 0 and <= 86400; got 0",
    "at: 1, fault: delay, between: [0.3, 0.1]": (
        "faults[1].between: shortest and longest delay in this order; it is [0.3, 0.1]"
    ),
    "at: 1, fault: one-way, from: 4, to: 1": "faults[1].from: there is no robot 4 in a team of 3",
    "at: 1, fault: one-way, from: 2, to: 2": "faults[1].to: must be another robot than from; both are 2",
    "at: 1, fault: cut, robots: [3, 3]": "faults[1].robots: must be two robots; both are 3",
    "at: 1, fault: partition, parts: [[1], [9]]": ("faults[1].parts[1]: there is no robot 9 in a team of 3"),
    "at: 1, fault: partition, parts: [[1, 2], [3, 1]]": (
        "faults[1].parts[1]: robot 1 is named twice; a robot is in one part"
    ),
    "at: 1, fault: partition, parts: [[1, 2, 3], []]": (
        "faults[1].parts: the whole team is in one part; name robots of two parts"
    ),
    "at: 4, fault: crash, robot: 2": "faults[1].robot: robot 2 has crashed already by 4 s; restart it first",
    "at: 2, fault: restart, robot: 2": (
        "faults[1].robot: robot 2 is up at 2 s; only a robot that has crashed restarts"
    ),
    "at: 4, fault: freeze, robot: 2, for: 1": (
        "faults[1].robot: robot 2 has crashed by 4 s; only one that is up freezes"
    ),
    "at: 7, fault: freeze, robot: 3, for: 1": (
        "faults[1].robot: robot 3 is frozen until 8 s; freeze it after that"
    ),
    "at: 1, fault: freeze, robot: 3": "faults[1]: for is missing; add it, a number > 0 and <= 86400",
    "at: 1, fault: skew, robot: 3, s: 2": (
        "faults[1].s: a running clock does not jump; give s at 0 s, or ppm alone (at is 1 s)"
    ),
}


@pytest.mark.parametrize("fault", MISTAKES)
def test_a_mistake_is_told_in_one_line(tmp_path: Path, fault: str) -> None:
    text = f"""\
faults:
  - {{at: 3, fault: crash, robot: 2}}
  - {{{fault}}}
  - {{at: 5, fault: freeze, robot: 3, for: 3}}
"""
    with pytest.raises(InputError) as caught:
        load(tmp_path, text)
    assert str(caught.value) == f"{tmp_path / 'storm.yaml'}: {MISTAKES[fault]}"


def test_what_is_neither_file_nor_seed_is_told_in_one_line(tmp_path: Path) -> None:
    for text in ("storm.yaml", "-3", "1.5", "", str(tmp_path)):
        with pytest.raises(InputError, match=r"--faults .*: neither a file that is there nor a seed"):
            load_faults(text, 3)
    with pytest.raises(
        InputError, match=r"storm.yaml: faults is missing; add it, a list of at most 10000 entries"
    ):
        load(tmp_path, "")
    with pytest.raises(InputError, match=r"the duration of random faults must be 1 to 86400 s; got 0.5"):
        load_faults("7", 3, 0.5)
