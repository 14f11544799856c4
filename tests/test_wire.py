"""Whatever bytes a robot is sent, decoding them ends in a message or in one ValueError of one line."""

from __future__ import annotations

import zlib
from collections.abc import Callable

import msgspec
import pytest

from vedette import wire
from vedette.agent import messages as agent
from vedette.domains.mapping.impact import MapImpactCodec
from vedette.fusion.gaussian import wire as tracks
from vedette.fusion.steps import wire as steps
from vedette.negotiation import messages as negotiation
from vedette.net import report
from vedette.net.explore import content
from vedette.overlay import hello, packet
from vedette.sim import shown

DECODERS: dict[str, Callable[[bytes], object]] = {
    "agent message": agent.decode,
    "packet": packet.decode,
    "negotiation message": lambda data: negotiation.decode(data, MapImpactCodec(9)),
    "step evidence": steps.decode,
    "track payload": tracks.decode,
    "body report": shown.decode,
    "report": report.read_report,
}


class Named(msgspec.Struct, array_like=True):
    name: str


NAMED = msgspec.msgpack.Decoder(Named)
PACKED = zlib.compress(bytes(100), wbits=-15)
HOSTILE = {
    "nothing": b"",
    "no array": b"\x2a",
    "cut short": b"\x92\xa3ab",
    "no UTF-8": b"\x91\xa2\xff\xfe",
    "arrays within arrays": b"\x92\xa1a" + b"\x91" * 3000 + b"\x00",
}


@pytest.mark.parametrize("data", HOSTILE.values(), ids=HOSTILE)
def test_what_is_no_message_is_told_in_one_line_that_says_what_it_should_have_been(data: bytes) -> None:
    with pytest.raises(ValueError, match=rf"^thing of {len(data)} bytes is malformed: ") as caught:
        wire.decode(NAMED, data, "thing")
    assert "\n" not in str(caught.value)


def test_what_is_a_message_comes_back() -> None:
    assert wire.decode(NAMED, msgspec.msgpack.encode(Named("n")), "thing") == Named("n")


@pytest.mark.parametrize("data", [b"", PACKED[:-1], PACKED + b"x", b"\xff" * 20], ids=str)
def test_what_does_not_inflate_to_the_end_is_refused(data: bytes) -> None:
    assert wire.inflate(PACKED, 100, "thing") == bytes(100)
    with pytest.raises(ValueError, match=r"^thing (is cut short|does not inflate)"):
        wire.inflate(data, 100, "thing")


def test_what_inflates_to_more_than_is_taken_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^thing is cut short or too large"):
        wire.inflate(PACKED, 99, "thing")


@pytest.mark.parametrize("what", DECODERS)
def test_every_reader_of_messages_refuses_arrays_nested_without_end(what: str) -> None:
    for tag in range(8):
        data = b"\xdc\x00\x60" + bytes([tag]) + b"\x91" * 4000 + b"\x00" * 95
        with pytest.raises(ValueError, match=rf"^{what} of {len(data)} bytes is malformed"):
            DECODERS[what](data)


def test_a_hello_is_too_short_to_nest_anything() -> None:
    with pytest.raises(ValueError, match="at most 128 are taken"):
        hello.decode(3, b"\x91" * 200)


def test_a_report_of_a_small_packet_never_becomes_a_large_grid() -> None:
    side = 1 << 26
    huge = content.MapContent(0, 0, side, side, b"", b"", None, 0.1, 0.0, 0.0, (side, side))
    for read in (content.classes_of, content.seen_of):
        with pytest.raises(ValueError, match=rf"a map of {side**2} cells; at most"):
            read(huge)
