"""The film of an exploration: painted straight into pixels, as maps are large."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from vedette.maps import UNKNOWN
from vedette.record import palette
from vedette.record.explore.log import ExploreLog, ExploreSnapshot, RobotSample
from vedette.record.explore.raster import enlarge, known_window, paint
from vedette.record.explore.told import caption
from vedette.record.film import write_gif
from vedette.record.log import evenly

_SIDE = 800  # most pixels a side, caption included
_CAPTION = 30  # height of the caption [px]
_DISC = 9.0  # radius of a robot's sign [px]
_FAINT = 180, 180, 180  # a link that is not on the tree
_FINE = 4  # sub-pixels a side of a pixel of a robot's sign


def explore_gif(log: ExploreLog, path: Path | str, frames: int = 200) -> None:
    """Write at most ``frames`` stored snapshots of a log that is not empty, evenly chosen."""
    chosen = evenly(log.stored(), frames)
    write_gif(_Film(log).pictures(chosen), len(chosen), path)


class _Film:
    """Everything that stays the same from frame to frame."""

    def __init__(self, log: ExploreLog) -> None:
        self._log = log
        self._window = known_window(log.scene.frame, log.last.classes)
        part = self._window.frame
        scale = min(_SIDE / part.cols, (_SIDE - _CAPTION) / part.rows)  # pixels a cell
        self._size = max(1, int(part.cols * scale)), max(1, int(part.rows * scale))
        self._palette = _Palette()
        self._fonts = _font(15), _font(12 * _FINE)
        self._times = log.times
        self._trails = self._pixels(log.poses[:, :, :2])

    def pictures(self, chosen: list[int]) -> Iterator[Image.Image]:
        """Yield the frames in the film's palette."""
        wanted = set(chosen)
        for i, snapshot in enumerate(self._log.snapshots()):
            if i in wanted:
                yield self._palette.reduce(self._frame(snapshot))

    def _pixels(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``(..., 2)`` points [m] as pixels of the frame, y downwards."""
        x_min, x_max, y_min, y_max = self._window.frame.extent
        width, height = self._size
        x = (points[..., 0] - x_min) / (x_max - x_min) * width
        y = (y_max - points[..., 1]) / (y_max - y_min) * height + _CAPTION
        return np.stack((x, y), axis=-1)

    def _frame(self, snapshot: ExploreSnapshot) -> Image.Image:
        width, height = self._size
        image = Image.new("RGB", (max(width, 260), height + _CAPTION), (255, 255, 255))
        colours = paint(snapshot, self._log.scene.planning, self._window, self._size[::-1])[::-1]
        image.paste(enlarge(np.ascontiguousarray(colours), self._size), (0, _CAPTION))
        draw = ImageDraw.Draw(image)
        draw.text((8, _CAPTION / 2), caption(snapshot), palette.INK, self._fonts[0], anchor="lm")
        self._draw_links(draw, snapshot)
        so_far = int(np.searchsorted(self._times, snapshot.t, side="right"))
        for i, robot in enumerate(snapshot.robots):
            colour = palette.robot_colour(i)
            _line(draw, self._trails[:so_far, i], colour, 2)
            if robot.alive and robot.goal is not None:
                _dashes(draw, self._pixels(np.asarray(robot.path).reshape(-1, 2)), colour)
                x, y = self._pixels(np.array(robot.goal))
                draw.rectangle((x - 5, y - 5, x + 5, y + 5), (255, 255, 255), colour, 2)
        for i, robot in enumerate(snapshot.robots):
            sign = self._sign(i, robot)
            x, y = self._pixels(np.array((robot.x, robot.y)))
            image.paste(sign, (round(x - sign.width / 2), round(y - sign.height / 2)), sign)
        return image

    def _draw_links(self, draw: ImageDraw.ImageDraw, snapshot: ExploreSnapshot) -> None:
        """Draw lines between robots: on the team's tree dark, other links faint."""
        places = self._pixels(np.array([(robot.x, robot.y) for robot in snapshot.robots]))
        for link in sorted(snapshot.links or (), key=lambda link: link.on_tree):
            ends = places[[link.a, link.b]]
            if link.on_tree:
                _line(draw, ends, (255, 255, 255), 5)  # to be seen on walls
            _line(draw, ends, palette.INK if link.on_tree else _FAINT, 2)

    def _sign(self, index: int, robot: RobotSample) -> Image.Image:
        """Draw a robot's disc with its number and a nose ahead, or a cross if it is lost."""
        side = int(3.4 * _DISC) * _FINE
        sign = Image.new("RGBA", (side, side), (255, 255, 255, 0))
        draw = ImageDraw.Draw(sign)
        colour, centre, r = palette.robot_colour(index), side / 2, _DISC * _FINE
        if robot.alive:
            spread = np.array((-0.42, 0.0, 0.42)) - robot.heading  # image rows go down
            reach = np.array((1.05, 1.6, 1.05)) * r
            corners = np.column_stack((centre + reach * np.cos(spread), centre + reach * np.sin(spread)))
            draw.polygon([tuple(corner) for corner in corners], colour)
            draw.ellipse((centre - r, centre - r, centre + r, centre + r), colour, (255, 255, 255), _FINE)
            ink = palette.text_on(colour)
            draw.text((centre, centre), str(index + 1), ink, self._fonts[1], anchor="mm")
        else:
            for way in (-1, 1):
                ends = (centre - 0.7 * r, centre - 0.7 * r * way, centre + 0.7 * r, centre + 0.7 * r * way)
                draw.line(ends, colour, 4 * _FINE)
        return sign.resize((side // _FINE, side // _FINE), Image.Resampling.BOX)


def _line(draw: ImageDraw.ImageDraw, points: NDArray[np.float64], colour: palette.Rgb, width: int) -> None:
    if len(points) > 1:
        draw.line([tuple(point) for point in points], colour, width, joint="curve")


def _dashes(draw: ImageDraw.ImageDraw, points: NDArray[np.float64], colour: palette.Rgb) -> None:
    """Draw a polyline as dashes of 6 pixels with gaps of 4."""
    if len(points) < 2:
        return
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    for start in np.arange(0.0, along[-1], 10.0):
        ends = np.array((start, min(start + 6.0, along[-1])))
        _line(draw, np.column_stack([np.interp(ends, along, points[:, k]) for k in (0, 1)]), colour, 2)


def _font(size: int) -> ImageFont.FreeTypeFont:
    """Return the font of the other pictures, which comes with matplotlib."""
    return ImageFont.truetype(str(Path(matplotlib.get_data_path()) / "fonts/ttf/DejaVuSans-Bold.ttf"), size)


class _Palette:
    """At most 256 colours that suffice for a film, and each colour's nearest among them."""

    def __init__(self) -> None:
        """Take the classes, the impacts, greys for the edges of walls, and the robots' colours on white."""
        share = np.linspace(0.0, 1.0, 24, dtype=np.float32)
        impacts = palette.blend_impact(np.broadcast_to(palette.CLASSES[UNKNOWN], (24, 3)), share)
        greys = np.arange(0, 256, 15)[:, None].repeat(3, axis=1)
        team = np.array((*palette.ROBOTS, palette.INK))
        pale = [255 + (team - 255) * strength for strength in (1.0, 0.7, 0.4)]
        self.colours = np.concatenate((palette.CLASSES, impacts, greys, *pale)).round().astype(np.uint8)
        middles = np.arange(4, 256, 8)  # of the 32 levels that a part of a colour is looked up by
        cube = np.stack(np.meshgrid(middles, middles, middles, indexing="ij"), axis=-1).reshape(-1, 1, 3)
        distance = np.square(cube - self.colours.astype(np.int32)).sum(axis=2)
        self._nearest = distance.argmin(axis=1).astype(np.uint8)

    def reduce(self, image: Image.Image) -> Image.Image:
        """Return an RGB image in the palette; Pillow's own search is ten times as slow on detailed maps."""
        level = np.asarray(image).astype(np.uint16) >> 3
        nearest = self._nearest[(level[..., 0] << 10) | (level[..., 1] << 5) | level[..., 2]]
        reduced = Image.frombytes("P", image.size, nearest.tobytes())
        reduced.putpalette(self.colours.tobytes())
        return reduced
