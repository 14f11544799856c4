"""A whole negotiation: codecs, sizes, schemes, determinism."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from tests.support.random_teams import Float, misses
from vedette import Coverage, InputError, Objective, Tree, exhaustive, negotiate
from vedette.negotiation import SCHEMES, Message, decode, encode
from vedette.negotiation.messages import (
    Down,
    Fork,
    Gather,
    Joined,
    Offer,
    RoundOutcome,
    Settled,
    Stop,
    Tally,
    Tidings,
    Token,
    Up,
    plain_size,
)


class Plain:
    """Float64 arrays as their bytes."""

    def encode(self, impact: Float) -> bytes:
        return impact.tobytes()

    def decode(self, data: bytes) -> Float:
        return np.frombuffer(data)


class Tiles(Objective[None, frozenset[int]]):
    """Tiles seen, joined by union: no inverse."""

    monotone = submodular = True

    def nothing(self, belief: None) -> frozenset[int]:
        return frozenset()

    def combine(self, a: frozenset[int], b: frozenset[int]) -> frozenset[int]:
        return a | b

    def value(self, belief: None, impact: frozenset[int]) -> float:
        return float(len(impact))


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_codec_changes_neither_the_choice_nor_the_messages_and_counts_real_bytes(scheme: str) -> None:
    rng = np.random.default_rng(0)
    run = (Coverage(), rng.uniform(size=12), misses(rng, 6, 4), Tree.random(6, seed=1), scheme)
    plain, coded = negotiate(*run), negotiate(*run, codec=Plain())
    assert coded.history == plain.history
    assert (coded.choice, coded.messages) == (plain.choice, plain.messages)
    assert coded.bytes == plain.bytes  # the plain size of an array is that of its bytes


@pytest.mark.parametrize("scheme", SCHEMES)
def test_any_commutative_monoid_will_do_even_sets(scheme: str) -> None:
    candidates = [[frozenset({1, 2}), frozenset({3})], [frozenset({1, 2}), frozenset({3, 4, 5})]]
    result = negotiate(Tiles(), None, candidates, Tree.chain(2), scheme)
    assert (result.choice, result.value) == ((0, 1), 5.0)
    assert exhaustive(Tiles(), None, candidates).choice == result.choice


def test_a_message_survives_its_bytes() -> None:
    tally, outcome = Tally(3, 2, 1.5, float("inf"), 9, 4.0), RoundOutcome(1.0, None, 2, True, 0)
    mu = np.array([0.5, 0.0])
    sent: list[Message[Float]] = [
        Gather(mu, 4, 2.0, 1.5),
        Token(mu, tally),
        Token(None, tally),
        Up(mu, 1.0, float("inf"), (0, 2)),
        Down(None),
        Stop(outcome, 3),
        Fork(mu, False),
        Joined(None, 1.0, float("inf"), 3, 2.0, 1, True),
        Settled(outcome, False, True),
        Offer(mu, 3, 2, False, True, 1.0, float("inf"), 4, 2.0, 1, False),
        Tidings(mu, 3, 1, False),
    ]
    for message in sent:
        back = decode(encode(message, Plain()), Plain())
        assert type(back) is type(message)
        for field in message.__struct_fields__:
            one, two = getattr(message, field), getattr(back, field)
            assert np.array_equal(one, two) if isinstance(one, np.ndarray) else one == two


def test_a_message_without_its_impact_takes_at_most_sixty_bytes() -> None:
    most = 2**16
    tally = Tally(most, most, 1e300, 1e300, most, 1e300)
    assert len(encode(Token(None, tally), Plain())) <= 60
    assert len(encode(Gather(None, most, 1e300, 1e300), Plain())) <= 60
    assert len(encode(Stop(RoundOutcome(1e300, 1e300, most, False, most), most), Plain())) <= 60


def test_malformed_bytes_are_refused() -> None:
    rng = np.random.default_rng(1)
    good = encode(Gather(np.ones(3), 4, 2.0, 1.5), Plain())
    negative = encode(Gather(np.ones(3), -4, 2.0, 1.5), Plain())
    junk = [good[:-3], good + b"\0", negative, b"", *(rng.bytes(int(k)) for k in rng.integers(40, size=300))]
    for data in junk:
        with pytest.raises(InputError, match="malformed"):
            decode(data, Plain())


def test_plain_sizes() -> None:
    @dataclass
    class Impact:
        cells: Float
        name: str

    assert plain_size(np.zeros(3)) == 24
    assert plain_size(2.5) == plain_size(True) == 8
    assert plain_size((1.0, [2, 3], b"abc", {4: "x"}, frozenset({(1, 2)}))) == 8 + 16 + 3 + 9 + 16
    assert plain_size(Impact(np.zeros(2), "abc")) == 19


@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_same_problem_gives_the_same_negotiation(scheme: str) -> None:
    rng = np.random.default_rng(2)
    weights, candidates = rng.uniform(size=12), misses(rng, 9, 4)
    one, two = (negotiate(Coverage(), weights, candidates, Tree.random(9, seed=4), scheme) for _ in range(2))
    assert one == two


@pytest.mark.parametrize("scheme", SCHEMES)
def test_candidates_may_be_one_array(scheme: str) -> None:
    rng = np.random.default_rng(3)
    candidates = misses(rng, 4, 3)
    run = (rng.uniform(size=12), Tree.star(4), scheme)
    lists = negotiate(Coverage(), run[0], candidates, *run[1:])
    array = negotiate(Coverage(), run[0], np.array(candidates), *run[1:])  # type: ignore[arg-type]
    assert lists == array
