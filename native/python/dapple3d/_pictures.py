# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures in files as brightness, turned as their metadata says."""

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageOps, UnidentifiedImageError

BITS, SAMPLE_FORMAT, PHOTOMETRIC = 258, 339, 262  # tags of TIFF
UNSIGNED, SIGNED = 1, 2  # sample formats
WHITE_IS_ZERO = 0
UNKNOWN = "Pillow knows no such kind: save it as PNG, JPEG, or TIFF of 8 or 16 bits"


def read(path: str | os.PathLike[str]) -> NDArray[np.uint8]:
    """Gray (rows, columns), or red, green, blue, alpha (rows, columns, 4). Where all that is seen
    is gray, what is transparent is white.

    Raises:
        ValueError: naming the pixel whose number is no brightness, or saying that it is no picture.
        OSError: naming the file if it is missing, saying what is broken in it.
    """
    # Opened here: TIFF files that Pillow opens by name are scrambled where they are to be turned.
    with open(path, "rb") as file:
        try:
            found = Image.open(file)
        except UnidentifiedImageError as error:
            raise ValueError(UNKNOWN) from error
        with found:
            tags = dict(getattr(found, "tag_v2", {}))
            picture = ImageOps.exif_transpose(found)
            if picture.mode.startswith(("I", "F")):
                return _deep(picture, tags, is_scaled=found.format == "PPM")
            if _first(tags, BITS) == 8 and _first(tags, SAMPLE_FORMAT) == SIGNED:
                return _in_8_bits(_in_range(np.asarray(picture).view(np.int8), 8, SIGNED))
            return _shallow(picture)


def _first(tags: dict[int, Any], tag: int) -> int | None:
    """The value of the first channel."""
    value = tags.get(tag)
    return value[0] if isinstance(value, tuple) else value


def _shallow(picture: Image.Image) -> NDArray[np.uint8]:
    """Pixels of a picture of 8 bits: gray if all visible pixels are."""
    if picture.mode in ("1", "L") and not picture.has_transparency_data:
        return np.asarray(picture.convert("L"))
    color = np.asarray(picture.convert("RGBA"))
    alpha = color[..., 3]
    seen = color[alpha > 0, :3]
    if (seen != seen[:, :1]).any():
        return color
    ink = (255 - color[..., 0].astype(np.uint16)) * alpha
    return (255 - (ink + 127) // 255).astype(np.uint8)


def _deep(picture: Image.Image, tags: dict[int, Any], is_scaled: bool) -> NDArray[np.uint8]:
    """Pixels of a gray picture of more than 8 bits; Pillow scales some formats to 16 bits."""
    values = np.asarray(picture)
    if picture.mode == "F":
        gray = _fractions(values)
    else:
        bits = _first(tags, BITS) or (16 if is_scaled or picture.mode != "I" else 32)
        sample_format = _first(tags, SAMPLE_FORMAT) or (UNSIGNED if tags or bits == 16 else SIGNED)
        if values.dtype == np.int32 and sample_format == UNSIGNED:
            values = values.view(np.uint32)
        gray = _in_range(values, bits, sample_format)
    if tags.get(PHOTOMETRIC) == WHITE_IS_ZERO:
        gray = 1.0 - gray
    hidden = picture.info.get("transparency")
    if isinstance(hidden, int):
        gray[values == hidden] = 1.0
    return _in_8_bits(gray)


def _in_8_bits(gray: NDArray[np.float64]) -> NDArray[np.uint8]:
    return (255.0 * gray + 0.5).astype(np.uint8)


def _in_range(values: NDArray, bits: int, sample_format: int) -> NDArray[np.float64]:
    """Integers divided by the largest value of their type."""
    _check(values, values < 0, "brightness is not negative")
    largest = int(values.max(initial=0))
    if bits == 32:  # some programs write pictures of 8 or 16 bits with 32
        bits = next((small for small in (8, 16) if largest < 1 << small), bits)
        signed = bits == 32 and sample_format == SIGNED
    else:
        signed = sample_format == SIGNED
    gray: NDArray[np.float64] = values / float((1 << (bits - signed)) - 1)
    return gray


def _fractions(values: NDArray) -> NDArray[np.float64]:
    _check(
        values,
        ~((values >= 0.0) & (values <= 1.0)),
        "brightness as a floating-point number is in [0, 1]",
    )
    return values.astype(np.float64)


def _check(values: NDArray, wrong: NDArray[np.bool_], rule: str) -> None:
    if wrong.any():
        row, column = (int(k) for k in np.argwhere(wrong)[0])
        raise ValueError(f"pixel [{row}, {column}] is {values[row, column]:g}: {rule}")
