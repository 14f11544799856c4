"""A number that is started twice: the process started first goes on, the other is refused, both are told."""

from __future__ import annotations

from collections.abc import Mapping

from vedette.overlay import Overlay

OLDER, YOUNGER = 5, 9  # boots of the two robots 1


class Doubled:
    """Robot 0 and two processes of robot 1, which hear all that is sent to that number."""

    def __init__(self) -> None:
        self.now = 0.0
        self.zero = Overlay(0, 2, 0.0)
        self.zero.peers([1], 0.0)
        self.ones: dict[int, Overlay] = {}

    def start(self, boot: int) -> None:
        """Start a process of robot 1."""
        self.ones[boot] = Overlay(1, boot, self.now)
        self.ones[boot].peers([0], self.now)

    def run(self, seconds: float) -> None:
        """Let time pass; all hear each other at once."""
        for _ in range(round(seconds / 0.01)):
            self.now += 0.01
            for _, payload in self.zero.tick(self.now):
                for one in self.ones.values():
                    _heard(one, 0, payload, self.now)
            for one in self.ones.values():
                for _, payload in one.tick(self.now):
                    _heard(self.zero, 1, payload, self.now)


def _heard(overlay: Overlay, sender: int, payload: bytes, now: float) -> None:
    try:
        overlay.hear(sender, payload, now)
    except ValueError:  # what was meant for the other process of that number
        return


def complaints(doubled: Doubled) -> Mapping[str, str]:
    """Who complains of robot 1."""
    both = {"older": doubled.ones[OLDER], "younger": doubled.ones[YOUNGER], "zero": doubled.zero}
    return {who: overlay.complaints[1] for who, overlay in both.items() if 1 in overlay.complaints}


def test_a_number_that_is_started_twice_is_named_everywhere_and_the_younger_refused() -> None:
    doubled = Doubled()
    doubled.start(OLDER)
    doubled.run(3.0)
    assert doubled.zero.boot_of(1) == OLDER
    doubled.start(YOUNGER)
    doubled.run(10.0)
    assert doubled.zero.boot_of(1) == OLDER
    assert doubled.zero.place.neighbours == (1,)
    assert doubled.ones[YOUNGER].place.neighbours == ()
    told = complaints(doubled)
    assert "started later is refused" in told["zero"]
    assert "this one is refused" in told["younger"]
    assert "the other, started later, is refused" in told["older"]


def test_a_restart_is_no_double_and_takes_over_at_once() -> None:
    doubled = Doubled()
    doubled.start(OLDER)
    doubled.run(3.0)
    del doubled.ones[OLDER]
    doubled.start(YOUNGER)
    doubled.run(4.0)
    assert doubled.zero.boot_of(1) == YOUNGER
    assert doubled.zero.place.neighbours == (1,)
    assert doubled.zero.complaints == {}


def test_when_the_older_ends_the_younger_takes_its_place() -> None:
    doubled = Doubled()
    doubled.start(OLDER)
    doubled.run(3.0)
    doubled.start(YOUNGER)
    doubled.run(10.0)
    del doubled.ones[OLDER]
    doubled.run(20.0)
    assert doubled.zero.boot_of(1) == YOUNGER
    assert doubled.zero.place.neighbours == (1,)
