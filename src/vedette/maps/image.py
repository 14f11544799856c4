"""Read an image as grey levels, whatever its depth and channels."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageFile, UnidentifiedImageError

from vedette.errors import InputError
from vedette.input_file import open_input

MAX_SIDE = 8000  # accepted [pixels]
_FORMATS = ("PPM", "PNG", "BMP", "JPEG")
_STEPS = {"L;2": 85, "L;4": 17}  # between grey levels of few bits, which Pillow spreads over 0 to 255


@dataclass(frozen=True, eq=False)
class Levels:
    """Grey levels of an image, bottom row first."""

    grey: NDArray[np.uint16]  # (rows, cols)
    full: int  # level of a white pixel: 255 or 65535
    alpha: NDArray[np.uint8] | None  # (rows, cols), 255 opaque; None: the image has no alpha

    def eight_bits(self) -> NDArray[np.uint8]:
        """Return the levels as 0 to 255, ``(rows, cols)``; finer ones are cut, as GraphicsMagick does."""
        return (self.grey // (self.full // 255)).astype(np.uint8)


def read_levels(path: Path) -> Levels:
    """Read a PGM (P2, P5), PNG, BMP or JPEG of 1 to 16 bits a channel, grey or colour, with or without alpha.

    Raises:
        InputError: missing, unreadable, not an image, empty, or more than ``MAX_SIDE`` pixels a side.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # the sides are checked below
            with open_input(path, "map") as file, Image.open(file, formats=_FORMATS) as image:
                _check(path, image)
                return _levels(image)
    except Image.DecompressionBombError as error:
        raise InputError(f"{path} is too large: at most {MAX_SIDE} pixels a side") from error
    except UnidentifiedImageError as error:
        if path.stat().st_size == 0:
            raise InputError(f"{path} is not a map: the file is empty") from error
        raise InputError(f"{path} is not a map: neither a .yaml nor a PGM, PNG, BMP or JPEG image") from error
    except InputError:
        raise
    except (OSError, ValueError, SyntaxError, EOFError) as error:  # Pillow's ways to say: damaged
        reason = getattr(error, "strerror", None) or "the image is damaged"
        raise InputError(f"cannot read map {path}: {reason}") from error


def _check(path: Path, image: Image.Image) -> None:
    width, height = image.size
    if width == 0 or height == 0:
        raise InputError(f"{path} is not a map: the image is empty")
    if max(width, height) > MAX_SIDE:
        raise InputError(f"{path} is too large: {width}x{height}; at most {MAX_SIDE} pixels a side")
    if image.mode == "F":
        raise InputError(f"{path} is not a map: its levels are no whole numbers; save it as PGM or PNG")


def _levels(file: ImageFile.ImageFile) -> Levels:
    image: Image.Image = file
    if image.mode.startswith("I"):  # 16 bits of grey
        wide = np.ascontiguousarray(np.asarray(image)[::-1], np.uint16)
        clear = image.info.get("transparency")  # a PNG's level that stands for no pixel
        alpha = None if clear is None else np.where(wide == clear, 0, 255).astype(np.uint8)
        return Levels(wide, 65535, alpha)
    if image.mode == "L" and isinstance(clear := image.info.get("transparency"), int):
        image.info["transparency"] = clear * _STEPS.get(str(file.tile[0].args), 1)
    alpha = None
    if "A" in image.mode or "transparency" in image.info:
        image = image.convert("RGBA")
        alpha = np.ascontiguousarray(np.asarray(image.getchannel("A"))[::-1])
        image = image.convert("RGB")
    elif image.mode not in ("L", "RGB"):
        image = image.convert("L" if image.mode == "1" else "RGB")
    pixels = np.asarray(image)[::-1]
    return Levels(pixels.astype(np.uint16) if pixels.ndim == 2 else _luma(pixels), 255, alpha)


def _luma(pixels: NDArray[np.uint8]) -> NDArray[np.uint16]:
    """``0.299 R + 0.587 G + 0.114 B`` of each pixel: rounded to 16 bits, cut to 8, as GraphicsMagick does."""
    thousands = np.full(pixels.shape[:2], 500, np.uint32)  # the half that rounds
    for channel, share in enumerate((299, 587, 114)):
        thousands += np.multiply(pixels[..., channel], 257 * share, dtype=np.uint32)
    return (thousands // 1000 // 257).astype(np.uint16)
