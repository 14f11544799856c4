"""What robots report is data: nothing in it can act on the operator's terminal."""

from __future__ import annotations

import pytest
from msgspec import structs

from tests.fuzz.decoders import conditions
from vedette.net.report import encode, read_condition


@pytest.mark.parametrize("text", ["\x1b[2J", "robot\n", "[red]robot[/red]", "\x9bH", "x" * 65])
@pytest.mark.parametrize("field", ["name", "state"])
def test_a_word_that_a_terminal_would_obey_is_refused(field: str, text: str) -> None:
    (condition,) = conditions()
    assert read_condition(encode(condition)) == condition
    with pytest.raises(ValueError, match="malformed"):
        read_condition(encode(structs.replace(condition, **{field: text})))


def test_a_refusal_is_told_in_printable_words() -> None:
    (condition,) = conditions()
    told = structs.replace(condition, refusal="robot 2 has heard more of boot 7 than this robot has said")
    assert read_condition(encode(told)) == told
    with pytest.raises(ValueError, match="malformed"):
        read_condition(encode(structs.replace(told, refusal="\x1b]0;title\x07")))
