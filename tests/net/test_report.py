"""What robots report is data: nothing in it can act on the operator's terminal."""

from __future__ import annotations

import pytest
from msgspec import structs

from tests.fuzz.decoders import conditions
from vedette.net.report import Complaint, encode, read_condition


@pytest.mark.parametrize("text", ["\x1b[2J", "robot\n", "[red]robot[/red]", "\x9bH", "x" * 65])
@pytest.mark.parametrize("field", ["name", "state"])
def test_a_word_that_a_terminal_would_obey_is_refused(field: str, text: str) -> None:
    (condition,) = conditions()
    assert read_condition(encode(condition)) == condition
    with pytest.raises(ValueError, match="malformed"):
        read_condition(encode(structs.replace(condition, **{field: text})))


def test_a_complaint_is_told_in_printable_words() -> None:
    (condition,) = conditions()
    complaint = Complaint(2, "its link is refused: map.resolution: 0.1 there, 0.05 here")
    told = structs.replace(condition, complaints=(complaint,))
    assert read_condition(encode(told)) == told
    for what in ("\x1b]0;title\x07", "[red]", "x" * 501):
        with pytest.raises(ValueError, match="malformed"):
            read_condition(encode(structs.replace(told, complaints=(Complaint(2, what),))))
