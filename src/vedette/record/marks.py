"""How robots and vehicles are marked in a terminal: a sign and its colours each."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from rich.color import Color
from rich.style import Style

from vedette.record import palette
from vedette.record.log import VehicleSample

_SIGNS = "123456789ABCDEFGHIJKLMNOPQRSTUVWXYZαβγδεζηθικλμνξπρστφχψω"
LOST, LEFT = "×", "○"


def sign(index: int, vehicle: VehicleSample | None = None) -> str:
    """Return a robot's sign, one character; None: it takes part."""
    if vehicle is None or vehicle.alive:
        return _SIGNS[index % len(_SIGNS)]
    return LEFT if vehicle.left else LOST


def badge(index: int) -> Style:
    """Return its style: its colour as the ground, under an ink that can be read on it."""
    ground = palette.robot_colour(index)
    return two_colours(palette.text_on(ground), ground, True)


def together(parts: Sequence[Sequence[int]]) -> str:
    """Say whether a team is together, or which robots are, by their signs: ``apart: {1,2} {3}``."""
    if len(parts) < 2:
        return "together"
    return "apart: " + " ".join("{" + ",".join(sign(i) for i in part) + "}" for part in parts)


@lru_cache(maxsize=4096)
def two_colours(ink: tuple[int, ...], ground: tuple[int, ...], bold: bool = False) -> Style:
    """Return a style of two colours; making one is slow, and a map needs few different ones."""
    return Style(color=Color.from_rgb(*ink), bgcolor=Color.from_rgb(*ground), bold=bold)
