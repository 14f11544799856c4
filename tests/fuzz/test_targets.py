"""What robots read from others and from files: honest inputs, inputs that once broke something, random ones.

``python -m tests.fuzz`` looks for more, guided by coverage.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field

import msgspec
import numpy as np
import pytest

from tests.fuzz.fingerprint import fingerprint
from tests.fuzz.limits import MEMORY, Excess, limited_memory, limited_time
from tests.fuzz.mutation import mutate_message, sweep
from tests.fuzz.target import CORPUS, Target
from tests.fuzz.targets import targets

SEEDS = {
    "agent": 2,
    "network": 4,
    "fuse": 8,
    "file": 2,
}  # honest inputs that are tried, by the first part of a target's name
RUNS = {"agent": 4, "network": 6, "fuse": 8, "overlay": 15, "link": 20, "file": 4}  # likewise mutated ones
KEPT = [(name, path.name) for name, target in targets().items() for path in target.kept]


def _some(target: Target) -> list[bytes]:
    """As many honest inputs as there is time for."""
    seeds = target.seeds()
    most = SEEDS.get(target.name.split("-")[0], 16)
    return [seeds[k] for k in np.linspace(0, len(seeds) - 1, min(most, len(seeds)), dtype=int)]


@pytest.mark.parametrize("name", targets())
def test_honest_inputs_are_read_within_the_limits(name: str) -> None:
    for seed in _some(targets()[name]):
        assert targets()[name].check(seed) is None


@pytest.mark.parametrize(("name", "file"), KEPT, ids=[f"{name}-{file}" for name, file in KEPT])
def test_what_once_broke_something_breaks_nothing(name: str, file: str) -> None:
    defect = targets()[name].check((CORPUS / name / file).read_bytes())
    assert defect is None, defect


@pytest.mark.parametrize("name", targets())
def test_mutated_inputs_break_nothing(name: str) -> None:
    target = targets()[name]
    rng = np.random.default_rng(zlib.crc32(name.encode()))
    seeds = _some(target)
    for _ in range(RUNS.get(name.split("-")[0], 40)):
        data = target.mutate(seeds[int(rng.integers(len(seeds)))], rng)
        defect = target.check(data)
        assert defect is None, (defect, data)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in targets() if not name.startswith("file")])
def test_every_field_at_awkward_values_breaks_nothing(name: str) -> None:
    target = targets()[name]
    defects = {
        str(defect) for seed in _some(target) for data in sweep(seed) if (defect := target.check(data, False))
    }
    assert not defects


def test_kept_inputs_belong_to_a_target_and_are_few_and_small() -> None:
    kept = [path for folder in CORPUS.iterdir() for path in folder.iterdir()]
    assert {path.parent.name for path in kept} <= set(targets())
    assert sum(path.stat().st_size for path in kept) < 200_000


# -- the means ---------------------------------------------------------------------------------------


@dataclass
class _Thing:
    numbers: np.ndarray = field(default_factory=lambda: np.zeros(3))
    names: set[str] = field(default_factory=lambda: {"a", "b"})
    count: int = 0
    myself: _Thing | None = None


def test_a_fingerprint_tells_a_change_deep_inside_and_nothing_else() -> None:
    one, other = _Thing(), _Thing()
    one.myself, other.myself = one, other
    other.names = {"b", "a"}
    before = fingerprint([one])
    assert fingerprint([other]) == before
    other.count = 1
    assert fingerprint([other]) != before
    assert fingerprint([other], frozenset({"count"})) == fingerprint([one], frozenset({"count"}))
    one.numbers[1] = 1e-300
    assert fingerprint([one]) != before


def _count_for_ever() -> None:
    count = 0
    while True:
        count += 1


def test_an_input_that_takes_too_long_or_too_much_is_told() -> None:
    with pytest.raises(Excess, match="too long"), limited_time(0.05):
        _count_for_ever()
    with pytest.raises(Excess, match="memory"), limited_memory(1):
        bytearray(2 * MEMORY)


def test_mutated_messages_stay_messages_mostly_and_repeat_from_a_seed() -> None:
    message = msgspec.msgpack.encode([3, 1, 0.5, b"deep", [1, 2, [3]], msgspec.msgpack.encode([1, 2])])

    def mutated() -> list[bytes]:
        rng = np.random.default_rng(1)
        return [mutate_message(message, rng) for _ in range(200)]

    new = mutated()
    assert new == mutated()
    assert sum(data != message for data in new) > 150
    assert sum(_is_list(data) for data in new) > 140


def _is_list(data: bytes) -> bool:
    try:
        return isinstance(msgspec.msgpack.decode(data), list)
    except (ValueError, RecursionError):
        return False
