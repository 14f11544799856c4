"""Domains of somebody's own: what their theory says comes true, and what it does wrong is told in a line."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support.commands import Command, refused
from tests.support.own_parts import example, installed, module
from vedette import InputError, parts
from vedette.missions.own.case import OwnCase
from vedette.missions.own.check import check_theory
from vedette.missions.own.codec import FloatsCodec
from vedette.missions.own.skeleton import SEES, Skeleton
from vedette.missions.own.theory import Theory
from vedette.parts import look_in
from vedette.record.own.observer import content_of, total_of
from vedette.run import DomainMission
from vedette.sim.domains import domain_of
from vedette.testing import LawBroken
from vedette.vehicle import drive

SKELETON = "vedette.missions.own.skeleton:Skeleton"


def test_the_skeleton_and_the_example_keep_the_laws(tmp_path: Path) -> None:
    look_in(tmp_path)
    check_theory(Skeleton)
    check_theory(importlib.import_module(example("sound", tmp_path)).Sound)


def test_a_mission_of_the_skeleton_sees_all_sites_and_the_same_seed_gives_the_same_bytes() -> None:
    ends = [DomainMission(domain_of(SKELETON), seed=3).run(compare=False).summary for _ in range(2)]
    assert ends[0].to_json() == ends[1].to_json()
    assert ends[0].figures == {"unseen": 0.0}
    assert ends[0].mean_figures["unseen"] > 0.5
    assert ends[0].completed


@pytest.mark.parametrize(
    "options", [{"fusion": "sums"}, {"scheme": "fork"}, {"link_loss": 0.1}, {"kills": [(1, 20.0)]}]
)
def test_own_domains_have_the_ways_of_fusing_the_schemes_and_the_faults_of_all(
    options: dict[str, Any],
) -> None:
    report = DomainMission(domain_of(SKELETON), max_time=60.0, **options).run(compare=False)
    assert report.summary.figures["unseen"] < 5.0
    assert report.summary.lost == (("vehicle-1",) if "kills" in options else ())


def test_what_everybody_knows_is_the_sum_of_what_all_have_seen() -> None:
    mission = DomainMission(domain_of(SKELETON), seed=1)
    own = [np.zeros(5, np.int64), np.zeros(5, np.int64)]
    truth: Any = mission.case.truth(1)
    while mission.step() is None and mission.now < 80.0:
        for i, events in mission.simulation.sensed.items():
            for event in events:
                if type(event).__name__ == "Sensed":
                    places, numbers = mission.case.theory.evidence(i, event.data.pose, event.data.reading)
                    own[i][places] += numbers
    assert truth.shape == (5,)
    for share in mission.simulation.missions:
        assert share.total(38).sum() > 0
        assert (share.total(38) <= sum(own)).all()
    first, second = (share.total(36) for share in mission.simulation.missions)
    np.testing.assert_array_equal(first, second)


def test_a_vehicle_takes_the_course_of_most_worth_by_brute_force() -> None:
    case = OwnCase.of(SKELETON, Skeleton, None)
    mission = DomainMission(domain_of(SKELETON))
    while mission.step() is None and mission.now < 6.0:
        pass
    share = mission.simulation.missions[0]
    known = share.freeze(mission.now)
    vehicle, pose = share.vehicle, np.array([100.0, 150.0, 0.3])
    vehicle.prepare(known, pose, share.strategy)
    reply = vehicle.reply(known, share.objective.nothing(known), vehicle.courses[0])
    sites, worth = np.array(case.scenario.sites), known.belief  # type: ignore[attr-defined]
    gains = []
    for course in vehicle.courses:
        x, y, _ = drive(pose, np.array(course.rates), 10.0, case.scenario.step).T
        looks = (np.hypot(sites[:, 0] - x[:, None], sites[:, 1] - y[:, None]) <= 40.0).sum(axis=0)
        gains.append(float(worth @ (1.0 - (1.0 - SEES) ** looks)))
    assert gains[vehicle.courses.index(reply)] == pytest.approx(max(gains))
    assert len(vehicle.courses) >= 3**4
    assert vehicle.slack(known, share.objective.nothing(known)) == pytest.approx(max(gains))


def test_a_sound_is_found_where_it_is(tmp_path: Path) -> None:
    look_in(tmp_path)
    name = f"{example('sound', tmp_path)}:Sound"
    for seed in (0, 1):
        summary = DomainMission(domain_of(name), seed=seed).run(compare=False).summary
        assert summary.figures["error_m"] < 20.0
        assert summary.figures["deviation_m"] < 20.0


def test_bearings_from_two_places_cross_where_the_sound_is(tmp_path: Path) -> None:
    look_in(tmp_path)
    sound = importlib.import_module(example("sound", tmp_path))
    theory = sound.Sound(OwnCase.of("sound", sound.Sound, None).scenario)
    total = np.zeros(theory.size, np.int64)
    for pose, bearing in ((np.array([200.0, 100.0, 0.0]), np.pi / 2), (np.array([100.0, 200.0, 0.0]), 0.0)):
        places, numbers = theory.evidence(0, pose, bearing)
        total[places] += numbers
    belief = theory.belief(total)
    assert np.hypot(*(belief.mean - (200.0, 200.0))) < 15.0
    across = theory.impacts(belief, 0, np.array([[[200.0, 100.0, 0.0]]]))[0]
    assert across[0, 0] > 100.0 * abs(across[1, 1])  # a bearing from the south tells of x


def test_sums_of_evidence_travel_as_they_are_and_others_are_refused() -> None:
    total = np.array([0, -3, 2**40, 0, 7], np.int64)
    assert total_of(content_of(total), 5).tolist() == total.tolist()
    with pytest.raises(ValueError, match="outside the vector"):
        total_of(content_of(total), 4)


def test_arrays_travel_to_the_bit_and_others_are_refused() -> None:
    codec = FloatsCodec((2, 2), 0.0, 1.0)
    numbers = np.array([[0.0, 1.0], [1 / 3, 1e-300]])
    assert codec.decode(codec.encode(numbers)).tolist() == numbers.tolist()
    for data in (
        b"",
        codec.encode(numbers)[:-1],
        codec.encode(numbers + 1.0),
        codec.encode(numbers * np.nan),
    ):
        with pytest.raises(ValueError, match=r"bytes are no array|a number is none"):
            codec.decode(data)


# -- what can be wrong with one -----------------------------------------------------------------------

OWN = """
import numpy as np
from vedette.missions.own.codec import FloatsCodec
from vedette.missions.own.skeleton import Skeleton
from vedette.missions.own.theory import Theory
from vedette.problem import Coverage

class Half(Theory):
    def truth(self, rng): pass

class Gone(Skeleton):
    def sense(self, truth, i, pose, rng): raise OSError("no\\nmicrophone")

class Twice(Skeleton):
    def evidence(self, i, pose, told): return np.array([1, 1]), np.array([1, 1])

class Parts(Skeleton):
    def evidence(self, i, pose, told): return told, 0.5 * np.ones(len(told))

class Few(Skeleton):
    def impacts(self, belief, i, poses): return super().impacts(belief, i, poses)[:3]

class Names(Skeleton):
    def figures(self, belief, truth): return {f"unseen {belief.sum():.0f}": 1.0}

class Nan(Skeleton):
    def figures(self, belief, truth): return {"unseen": np.nan}

class Choosy(Skeleton):
    def __init__(self, scenario): raise ValueError("sites: too few")

class Lies(Skeleton):
    def impacts(self, belief, i, poses): return [1.5 - each for each in super().impacts(belief, i, poses)]

class Moody(Skeleton):
    count = 0
    def evidence(self, i, pose, told):
        Moody.count += 1
        return told[:1], np.full(1, Moody.count)

class Shapes(Skeleton):
    def belief(self, total): return np.ones(99)

class Codecless(Skeleton):
    codec = None

class Narrow(Skeleton):
    codec = FloatsCodec((4,), 0.0, 1.0)

class Aimless(Skeleton):
    objective = Coverage

class Vast(Skeleton):
    size = 10**12

class Untyped(Skeleton):
    scenario_type = dict

class Raw(Coverage):
    def wrong_impact(self, belief, own): return None

class Blind(Skeleton):
    objective = Raw()
    def impacts(self, belief, i, poses): return [None] * len(poses)

class Mute(Skeleton):
    def sense(self, truth, i, pose, rng): return None
"""


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A module of odd theories in the folder where commands run."""
    monkeypatch.chdir(tmp_path)
    return module(tmp_path, OWN)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("Gone", "sense: OSError: no microphone (own_part_"),
        ("Twice", "evidence: ValueError: gives places that do not increase within 0 to 4"),
        ("Parts", "evidence: TypeError: gives places or numbers that are no whole numbers"),
        ("Names", "figures: has other names than at first"),
        ("Nan", "figures: ValueError: gives nan; a finite number is asked for"),
        ("Choosy", "ValueError: sites: too few (own_part_"),
        ("Shapes", "impacts[0]: miss probabilities must have shape (99,); got (5,)"),
        ("Codecless", "TypeError: codec is None; something with encode and decode is asked for"),
        ("Narrow", "codec: ValueError: 40 bytes are no array (4,)"),
        ("Aimless", "TypeError: objective is <class 'vedette.problem.coverage.Coverage'>; an Objective"),
        ("Vast", "ValueError: size is 1000000000000; a whole number from 1 to 4194304 is asked for"),
        ("Untyped", "has <class 'dict'> as scenario_type, not a class of OwnScenario; see docs"),
        ("Blind", "objective: TypeError: unsupported operand type(s)"),
        (
            "Half",
            "lacks belief, codec, evidence, figures, impacts, objective, sense, size, example; see docs",
        ),
    ],
)
def test_what_a_theory_does_wrong_is_told_in_a_line(
    own: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], name: str, said: str
) -> None:
    ran = Command(monkeypatch, capsys)(f"{own}:{name}", "--no-compare", "--out", "out")
    assert ran.status == 2
    assert ran.err.splitlines()[-1].startswith(f"vedette: domain {own}:{name}: {said}")
    assert "Traceback" not in ran.err
    assert not Path("out").exists(), "nothing is left of half a mission"


def test_too_few_impacts_are_told_in_a_line(
    own: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ran = Command(monkeypatch, capsys)(f"{own}:Few", "--no-compare", "--out", "out")
    assert ran.status == 2
    assert "Few: impacts: gives 3 for 8" in ran.err


@pytest.mark.parametrize(
    ("name", "law"),
    [
        ("Lies", "miss probabilities must be in"),
        ("Moody", "another thing of the same reading"),
        ("Mute", "tells nothing"),
    ],
)
def test_a_theory_that_breaks_a_law_is_caught_by_its_first_test(own: str, name: str, law: str) -> None:
    look_in(Path())
    with pytest.raises((LawBroken, InputError), match=law):
        check_theory(getattr(importlib.import_module(own), name))


@pytest.mark.parametrize(
    ("scenario", "said"),
    [
        ("sites: []", "sites: must be a list of 1 or more"),
        ("sits: [[1, 1]]", "unknown field 'sits'; did you mean 'sites'?"),
        ("sites: [[1, 1]]\nstep: 0.25", "step: must be a multiple of the simulator's tick"),
        ("sites: [[1, 1]]\nrange: -1", "range: must be"),
        (
            "sites: [[1, 1]]\nvehicles: [{start: [900, 1, 0]}]",
            "vehicles[0].start: 900, 1 is outside the area",
        ),
        ("sites: [[1, 1]]\nhorizon: 2", "horizon: a round of 1 vehicle takes"),
    ],
)
def test_bad_scenarios_are_told_in_a_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    scenario: str,
    said: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    fields = "" if "vehicles" in scenario else "vehicles: [{start: [9, 9, 0]}]\n"
    Path("bad.yaml").write_text(f"area: [0, 0, 100, 100]\n{fields}{scenario}\n")
    refused(Command(monkeypatch, capsys)(SKELETON, "bad.yaml"), "vedette: ", said)


@pytest.mark.parametrize("words", [("geese",), ("team", "geese")])
def test_a_domain_by_an_entry_point_is_a_command(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    parts._entries.cache_clear()
    installed(tmp_path, "missions", monkeypatch, geese=SKELETON)
    vedette = Command(monkeypatch, capsys)
    said = vedette(*words, "--help").out
    assert ("mission of `vedette geese` by a team" if "team" in words else "Let a team look at sites") in said
    assert "geese" in vedette("--help").out
    assert vedette("gese").err == "vedette: unknown command 'gese'; did you mean 'geese'?\n"
    parts._entries.cache_clear()


def test_a_part_that_is_no_theory_is_told_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    vedette = Command(monkeypatch, capsys)
    refused(
        vedette("math:pi"), "domain math:pi: is float, not a class of Theory; see docs/how-to/own-domain.md"
    )
    refused(vedette("nowhere_at_all:X"), "domain: cannot import nowhere_at_all: ModuleNotFoundError")
    refused(vedette("team", "math:sin"), "domain math:sin: is builtin_function_or_method")
    assert issubclass(Skeleton, Theory)
