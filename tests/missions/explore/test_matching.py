"""When a robot looks at a pair of maps, and by which rule: maps that grow, and those that do not."""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
import pytest

from tests.support.frames import Part, building, off, part
from vedette.align import Charted, FramePose
from vedette.fusion.link import Key
from vedette.maps.transform import IDENTITY
from vedette.missions.explore.frames import matching
from vedette.missions.explore.frames.charts import Charts, pose_of
from vedette.missions.explore.frames.graph import Graph, Placed
from vedette.missions.explore.frames.matching import Matcher

A, B = (0, 5), (1, 6)
APART: Graph = {A: Placed(A, IDENTITY), B: Placed(B, IDENTITY)}
HERE = FramePose(0.0, 0.0, 0.0)
THERE = FramePose.of(3.0, -8.0, 2.0)


class Given:
    """Charts that are given, by contributor."""

    def __init__(self, **parts: Part) -> None:
        self.charts = {A: parts["a"].charted, B: parts["b"].charted}

    def of(self, key: Key) -> Charted:
        return self.charts[key]

    def ground(self, key: Key) -> float:
        return len(self.charts[key].free) * self.charts[key].cell ** 2

    def name(self, key: Key) -> bytes:
        return self.charts[key].classes.tobytes()

    def versions(self, *keys: Key) -> int:
        return 7


def matcher(a: Part, b: Part) -> tuple[Matcher, Given]:
    given = Given(a=a, b=b)
    return Matcher(0, cast(Charts, cast(Any, given))), given


def look(one: Matcher, begin: int, end: int) -> list[int]:
    """Do its errands for so long; return when there were any [s]."""
    times = []
    for now in range(begin, end):
        job = one.errand(APART, {0, 1}, float(now))
        if job is not None:
            times.append(now)
            job()
            one.take()
    return times


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_maps_that_do_not_grow_are_joined_where_they_are_by_the_rule_of_saved_ones(seed: int) -> None:
    whole = building(seed)
    a, b = part(whole, 0.0, 16.0, HERE), part(whole, 8.0, 24.0, THERE)
    one, _ = matcher(a, b)
    assert look(one, 0, 20) == [0]
    assert not one.found
    assert look(one, 20, 200) == [20]
    (found,) = one.found.values()
    shift, turn = off(pose_of(found.there), a, b)
    assert shift <= 0.05
    assert turn <= math.radians(0.3)


def test_maps_that_do_not_grow_and_do_not_fit_are_judged_once_and_again_when_they_have_changed() -> None:
    a, b = part(building(1), 0.0, 16.0, HERE), part(building(2), 0.0, 16.0, THERE)
    one, given = matcher(a, b)
    assert look(one, 0, 300) == [0, 20]
    assert one.looked == 2
    changed = np.array(b.classes)
    row, col = np.argwhere(changed == 1)[50]
    changed[row, col] = 0
    given.charts[B] = Part(b.frame, changed, b.pose).charted
    assert look(one, 300, 400) == [300]
    assert not one.found


def test_maps_that_grow_are_not_judged_as_if_they_were_saved(monkeypatch: pytest.MonkeyPatch) -> None:
    judgements = []
    rule = matching.judged
    monkeypatch.setattr(matching, "judged", lambda *maps: judgements.append(maps) or rule(*maps))
    a, other = part(building(1), 0.0, 16.0, HERE), building(2)
    one, given = matcher(a, part(other, 0.0, 10.0, THERE))
    for step in range(8):
        given.charts[B] = part(other, 0.0, 10.0 + 0.6 * step, THERE).charted  # some 2 % more of both
        look(one, 15 * step, 15 * (step + 1))
    assert not judgements
    look(one, 120, 200)
    assert len(judgements) == 1


def test_what_evidence_has_contradicted_is_not_judged_again_as_it_is() -> None:
    whole = building(1)
    one, _ = matcher(part(whole, 0.0, 16.0, HERE), part(whole, 8.0, 24.0, THERE))
    look(one, 0, 30)
    assert one.found
    one.drop((A, B))
    look(one, 30, 300)
    assert not one.found


def test_who_tells_of_many_starts_takes_nobodys_turn() -> None:
    one, _ = matcher(part(building(1), 0.0, 9.0, HERE), part(building(2), 0.0, 9.0, THERE))
    keys: list[Key] = [(0, boot) for boot in range(5)] + [(1, 6), (2, 7)]
    graph = {key: Placed(key, IDENTITY) for key in keys}
    pairs = list(one._mine(graph, {0, 1, 2}))
    assert set(pairs[:2]) == {((0, 4), (1, 6)), ((0, 4), (2, 7))}
    assert len(pairs) == 5 * 4 // 2 + 5 * 2
