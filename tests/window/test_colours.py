"""The page's colours: eyes that lack a kind of cones tell them apart."""

from __future__ import annotations

import re
from importlib.resources import files
from itertools import combinations

import numpy as np
import pytest
from numpy.typing import NDArray

from vedette.record import palette

LEAST = 12.0  # CIELAB distance: ten times what is just noticeable side by side
SIGHT = {  # Machado, Oliveira and Fernandes (2009), severity 1: linear RGB as it is seen
    "all cones": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    "protanopia": (
        (0.152286, 1.052583, -0.204868),
        (0.114503, 0.786281, 0.099216),
        (-0.003882, -0.048116, 1.051998),
    ),
    "deuteranopia": (
        (0.367322, 0.860646, -0.227968),
        (0.280085, 0.672501, 0.047413),
        (-0.011820, 0.042940, 0.968881),
    ),
    "tritanopia": (
        (1.255528, -0.076749, -0.178779),
        (-0.078411, 0.930809, 0.147602),
        (0.004733, 0.691367, 0.303900),
    ),
}
XYZ = np.array(((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505)))
WHITE = XYZ.sum(axis=1)


def lab(colour: tuple[int, int, int], sight: str) -> NDArray[np.float64]:
    """A colour of sRGB in CIELAB, as it is seen."""
    part = np.array(colour) / 255.0
    linear = np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)
    x, y, z = np.cbrt(np.maximum(XYZ @ np.clip(np.array(SIGHT[sight]) @ linear, 0.0, 1.0) / WHITE, 1e-9))
    return np.array((116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)))


def page_colours() -> dict[str, tuple[int, int, int]]:
    """What the page draws the map, frontiers and areas in."""
    page = files("vedette.window").joinpath("page.html").read_text(encoding="utf-8")
    three = r"\[([\d, ]+)\]"
    pattern = rf"const COLOURS = \[{three}, {three}, {three}\], AMBER = {three}, FRONTIER = {three};"
    kinds = re.search(pattern, page)
    areas = re.search(r'"no-go" \? "#(\w{6})" : "#(\w{6})"', page)
    assert kinds is not None
    assert areas is not None
    names = ("unknown", "free", "wall", "about to be seen", "frontier")
    told = {name: tuple(map(int, each.split(", "))) for name, each in zip(names, kinds.groups(), strict=True)}
    told |= {
        name: tuple(bytes.fromhex(each))
        for name, each in zip(("no-go", "priority"), areas.groups(), strict=True)
    }
    return {name: (each[0], each[1], each[2]) for name, each in told.items()}


@pytest.mark.parametrize("sight", SIGHT)
def test_what_is_on_the_map_is_told_apart_without_a_kind_of_cones(sight: str) -> None:
    seen = {name: lab(colour, sight) for name, colour in page_colours().items()}
    assert len(seen) == 7
    near = {pair: float(np.linalg.norm(seen[pair[0]] - seen[pair[1]])) for pair in combinations(seen, 2)}
    assert {pair: away for pair, away in near.items() if away < LEAST} == {}


@pytest.mark.parametrize("sight", SIGHT)
def test_robots_are_told_apart_without_a_kind_of_cones(sight: str) -> None:
    seen = [lab(colour, sight) for colour in palette.ROBOTS]
    near = [float(np.linalg.norm(one - other)) for one, other in combinations(seen, 2)]
    assert min(near) >= LEAST
