"""The colours of every picture: after Okabe and Ito, so that colour-blind eyes tell them apart too."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.maps import FREE, OCCUPIED, UNKNOWN

Rgb = tuple[int, int, int]

ROBOTS: tuple[Rgb, ...] = (
    (0, 114, 178),  # blue
    (213, 94, 0),  # vermillion
    (0, 158, 115),  # bluish green
    (204, 121, 167),  # reddish purple
    (86, 180, 233),  # sky blue
    (230, 159, 0),  # orange
    (60, 60, 60),  # near black
    (122, 78, 40),  # brown: Okabe and Ito's yellow is lost on white
)
CLASSES = np.zeros((3, 3), np.uint8)  # (class, rgb)
CLASSES[UNKNOWN] = 216, 219, 222
CLASSES[FREE] = 255, 255, 255
CLASSES[OCCUPIED] = 28, 30, 33
SCREEN = CLASSES.copy()  # the same for a terminal, where the unknown has to recede
SCREEN[UNKNOWN] = 112, 117, 124
IMPACT: Rgb = (255, 183, 0)
IMPACT_OPACITY = 0.85  # of an impact of 1
INK: Rgb = (40, 42, 46)
FAINT: Rgb = (110, 113, 117)  # of ink that explains
GRID: Rgb = (235, 237, 240)


def robot_colour(index: int) -> Rgb:
    """Return the colour of the robot at ``index`` of the team; colours repeat after eight."""
    return ROBOTS[index % len(ROBOTS)]


def text_on(colour: Rgb) -> Rgb:
    """Return black or white, whichever reads better on ``colour``."""
    red, green, blue = colour
    return (0, 0, 0) if 0.299 * red + 0.587 * green + 0.114 * blue > 150 else (255, 255, 255)


def unit(colour: Rgb) -> tuple[float, float, float]:
    """Return a colour with parts in 0..1, as matplotlib takes it."""
    return colour[0] / 255, colour[1] / 255, colour[2] / 255


def blend_impact(base: NDArray[np.uint8], impact: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return ``(..., 3)`` colours with the impact (0..1, one axis less) laid over them."""
    alpha = (IMPACT_OPACITY * np.clip(impact, 0.0, 1.0))[..., None]
    mixed: NDArray[np.float64] = base * (1.0 - alpha) + np.array(IMPACT) * alpha
    return np.rint(mixed).astype(np.uint8)
