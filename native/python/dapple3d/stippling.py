# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures as dots: stipple them, draw the dots, write them to files.

>>> from dapple3d import stippling
>>> dots = stippling.stipple(stippling.read_picture("portrait.png"), 10_000)
>>> stippling.write(dots, "portrait.svg")

Drawing, PNG files and reading need Pillow; SVG and PDF files do not.
"""

import inspect
import os
import struct
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import Context, Report, option_table, separate_inks, stipple_inks
from .reading import BROKEN
from .writing import replacing

__all__ = [
    "COLORS",
    "INKS",
    "SUFFIXES",
    "Dots",
    "draw",
    "encode",
    "read_picture",
    "stipple",
    "to_pdf",
    "to_png",
    "to_svg",
    "write",
]

INKS: Final = ("red", "green", "blue", "cyan", "magenta", "yellow", "black")
"""The classes of a color picture, in order; a gray picture has black only."""

COLORS: Final[dict[str, tuple[int, int, int]]] = {
    "red": (255, 0, 0),
    "green": (0, 255, 0),
    "blue": (0, 0, 255),
    "cyan": (0, 255, 255),
    "magenta": (255, 0, 255),
    "yellow": (255, 255, 0),
    "black": (0, 0, 0),
}
"""Colors of the inks: red, green and blue, from 0 to 255."""

SUFFIXES: Final = (".png", ".svg", ".pdf")
"""Suffixes of the files that write() writes."""

PLACES = 100  # to a pixel, in SVG and PDF files
PARTS = 32  # of a pixel, to which dots are moved in drawings
BAND = 1 << 22  # pixels that are drawn at once
STAMPED = 1 << 25  # pixels of stamps that are kept
PNG = b"\x89PNG\r\n\x1a\n"
PACKING = 3  # level of zlib: 6 saves a third of the bytes and takes twice as long


@dataclass(frozen=True)
class Dots:
    """Dots that render a picture.

    Attributes:
        positions: (n, 2) float64, x and y in pixels of the picture; its pixel [row, column] is
            [column, column + 1] x [row, row + 1], row 0 at the top.
        classes: (n,) int32, indices into inks.
        radius: of each dot, in pixels.
        inks: names of the classes.
        size: width and height of the picture in pixels.
        report: evenness of the dots and cost of the optimization.
    """

    positions: NDArray[np.float64]
    classes: NDArray[np.int32]
    radius: float
    inks: tuple[str, ...]
    size: tuple[int, int]
    report: Report

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def colors(self) -> NDArray[np.uint8]:
        """(n, 3) uint8: red, green and blue of each dot."""
        return np.array([COLORS[name] for name in self.inks], np.uint8)[self.classes]


def stipple(
    image: ArrayLike,
    count: int,
    *,
    counts: Sequence[int] | None = None,
    context: Context | None = None,
    **options: Any,
) -> Dots:
    """Render a picture with exactly count dots; dark places get many.

    Error diffusion, then the planar optimization with density 1 - gray (Chen et al. 2012, section
    5.1). A color picture is separated into seven inks, which are optimized as classes (section
    5.2).

    Args:
        image: (rows, columns) gray, or (rows, columns, 3 or 4) red, green, blue and alpha, over
            white; unsigned integers of the full range, or numbers in [0, 1].
        count: number of dots, >= 1.
        counts: of each of INKS, with the sum count; None: in proportion to the area that each ink
            covers, by largest remainders. For color only.
        context: a Context for progress and cancellation.
        options: those of stipple_inks(). 1.1 times its default radius leaves no gaps in black
            areas.

    Raises:
        ValueError: an option out of range, the first value outside [0, 1], or a white picture.
        Cancelled: through the context.
    """
    picture = _as_picture(image)
    gray = picture.ndim == 2
    if gray and counts is not None:
        raise ValueError("counts is given and the image is gray: it has one ink, black")
    if picture.size == 0:
        raise ValueError(f"image has the shape {picture.shape}: it has no pixel")
    if gray:  # in place: the picture may be large
        np.subtract(1.0, picture, out=picture)
    found = stipple_inks(
        picture[None] if gray else separate_inks(np.moveaxis(picture, 2, 0)),
        count,
        counts=[] if counts is None else list(counts),
        context=context,
        **options,
    )
    return Dots(
        found.positions,
        found.classes,
        found.radius,
        ("black",) if gray else INKS,
        (picture.shape[1], picture.shape[0]),
        found.report,
    )


def _with_options() -> inspect.Signature:
    """The signature of stipple() for help() and editors, with the options that it passes on."""
    types = {"float": float, "int": int, "bool": bool, "str": str}
    options = [
        inspect.Parameter(
            option.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=option.default,
            annotation=types[option.type],
        )
        for option in option_table("stipple_inks")
    ]
    own = inspect.signature(stipple)
    return own.replace(parameters=[*list(own.parameters.values())[:-1], *options])


setattr(stipple, "__signature__", _with_options())  # noqa: B010


def _as_picture(image: ArrayLike) -> NDArray[np.float64]:
    """Numbers in [0, 1], gray or red, green, blue."""
    array = np.asarray(image)
    if array.ndim not in (2, 3) or (array.ndim == 3 and array.shape[2] not in (3, 4)):
        raise ValueError(
            f"image has the shape {array.shape}: (rows, columns) or (rows, columns, 3 or 4) "
            "is needed"
        )
    if array.dtype.kind not in "bfiu":
        raise ValueError(f"image has the dtype {array.dtype}: numbers are needed")
    full = float(np.iinfo(array.dtype).max) if array.dtype.kind == "u" else 1.0
    values = array.astype(np.float64) / full
    outside = ~((values >= 0.0) & (values <= 1.0))
    if outside.any():
        first = tuple(int(k) for k in np.argwhere(outside)[0])
        raise ValueError(f"image{list(first)} is {values[first]:g}: it must be in [0, 1]")
    if values.ndim == 3 and values.shape[2] == 4:
        alpha = values[:, :, 3:]
        values = 1.0 - alpha * (1.0 - values[:, :, :3])
    return values


def read_picture(path: str | os.PathLike[str]) -> NDArray[np.uint8]:
    """Read a picture: (rows, columns) if it is gray, else (rows, columns, 4), all uint8.

    The EXIF orientation is applied. Deeper pictures are reduced to 8 bits: integers of 12, 16 or 32
    bits from the full range of their type (32 bits without a value above 8 or 16 bits count as
    such), floating-point numbers from [0, 1]. Transparent pixels of a gray picture are white.

    Args:
        path: any format that Pillow knows.

    Raises:
        OSError: the file is missing, is not a picture, has more than 179 million pixels, or has a
            pixel below 0 or, as a floating-point number, above 1.
        ImportError: Pillow is not installed.
    """
    from PIL import Image

    from . import _pictures

    name = os.fspath(path)
    try:
        return _pictures.read(path)
    except (Image.DecompressionBombError, *BROKEN) as error:
        raise OSError(f"{name}: could not be read as a picture: {error}") from error
    except OSError as error:
        if error.strerror:  # an error of the system names the file
            raise
        raise OSError(f"{name}: could not be read as a picture: {error}") from error


def draw(dots: Dots, scale: float = 4.0) -> NDArray[np.uint8]:
    """Draw the dots as antialiased discs on white.

    Args:
        dots: from stipple().
        scale: pixels of the drawing per pixel of the picture, > 0; radius * scale should be at
            least 1.

    Returns:
        (rows, columns) uint8 for gray, (rows, columns, 3) for color.

    Raises:
        ImportError: Pillow is not installed.
    """
    width, height = _pixels(dots, scale)
    drawn = np.empty((height, width) if len(dots.inks) == 1 else (height, width, 3), np.uint8)
    start = 0
    for band in _bands(dots, scale):
        drawn[start : start + len(band)] = band
        start += len(band)
    return drawn


def _pixels(dots: Dots, scale: float) -> tuple[int, int]:
    """Width and height of the drawing."""
    if not scale > 0.0:
        raise ValueError(f"scale is {scale:g}: it must be > 0")
    width, height = (max(1, round(int(side) * float(scale))) for side in dots.size)
    return width, height


def _bands(dots: Dots, scale: float) -> Iterator[NDArray[np.uint8]]:
    """Rows of the drawing from the top, some at a time."""
    from PIL import Image

    width, height = _pixels(dots, scale)
    gray = len(dots.inks) == 1
    radius = min(dots.radius * float(scale), float(np.hypot(width, height)))
    stamp, reach = _stamps(radius), _reach(radius)
    layers = list(_layers(dots, float(scale), reach))
    rows = max(1, BAND // width)
    for top in range(0, height, rows):
        size = width, min(rows, height - top)
        band = Image.new("L", size, 255) if gray else Image.new("RGB", size, (255, 255, 255))
        for color, corners, offsets in layers:
            first, last = np.searchsorted(corners[:, 1], [top - 2 * reach, top + size[1]])
            near = zip(corners[first:last].tolist(), offsets[first:last].tolist(), strict=True)
            for (left, above), offset in near:
                band.paste(color[0] if gray else color, (left, above - top), stamp(*offset))
        yield np.asarray(band)


def _layers(
    dots: Dots, scale: float, reach: int
) -> Iterator[tuple[tuple[int, int, int], NDArray[np.int64], NDArray[np.int64]]]:
    """Of each ink its color, and of its dots, from the top, the first pixel of the stamp and how
    far the middle is from the pixel that it is in, in parts."""
    for index, name in enumerate(dots.inks):
        places = np.rint(dots.positions[dots.classes == index] * scale * PARTS).astype(np.int64)
        places = places[np.argsort(places[:, 1], kind="stable")]
        yield COLORS[name], places // PARTS - reach, places % PARTS


def _reach(radius: float) -> int:
    """Pixels on each side of the pixel with the center of a disc."""
    return int(np.ceil(radius + 0.5))


def _stamps(radius: float) -> Callable[[int, int], Any]:
    """Pictures of a disc whose middle is so many parts of a pixel right of and below the corner of
    its middle pixel: how much of each pixel is within the radius."""
    from PIL import Image

    reach = _reach(radius)
    pixels = np.arange(-reach, reach + 1) + 0.5
    side = len(pixels)

    @lru_cache(maxsize=max(1, STAMPED // side**2))
    def stamp(right: int, down: int) -> Any:
        cover = np.empty((side, side), np.uint8)
        step = max(1, BAND // side)
        for start in range(0, side, step):
            rows = pixels[start : start + step, None] - down / PARTS
            distances = np.hypot(pixels - right / PARTS, rows)
            part = np.clip(radius + 0.5 - distances, 0.0, 1.0)
            cover[start : start + step] = 255.0 * part + 0.5
        return Image.fromarray(cover)

    return stamp


def to_svg(dots: Dots) -> str:
    """Write the dots as SVG, one path for each ink: about eleven bytes per dot.

    A dot is a line of length 0 with round ends; positions are rounded to 1/100 pixel.
    """
    width, height = map(int, dots.size)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'width="{width}" height="{height}">\n'
        f'<rect width="{width}" height="{height}" fill="#fff"/>\n'
        f'<g fill="none" stroke-linecap="round" stroke-width="{2.0 * dots.radius:.6g}">\n'
    ]
    for name, places in _by_ink(dots):
        steps = np.diff(places, axis=0, prepend=np.zeros((1, 2), np.int64))
        path = "".join(f"m{_decimal(x)} {_decimal(y)}h0" for x, y in steps.tolist())
        color = "#{:02x}{:02x}{:02x}".format(*COLORS[name])
        parts.append(f'<path stroke="{color}" d="{path}"/>\n')
    parts.append("</g>\n</svg>\n")
    return "".join(parts)


def to_pdf(dots: Dots) -> bytes:
    """Write the dots as a PDF page, one point per pixel: about six bytes per dot.

    Positions are rounded to 1/100 pixel.
    """
    width, height = map(int, dots.size)
    lines = [f"1 J {2.0 * dots.radius:.6g} w"]
    for name, places in _by_ink(dots):
        lines.append("{:g} {:g} {:g} RG".format(*(level / 255 for level in COLORS[name])))
        for x, y in places.tolist():
            place = f"{_decimal(x)} {_decimal(PLACES * height - y)}"
            lines.append(f"{place} m {place} l")
        lines.append("S")
    stream = zlib.compress("\n".join(lines).encode(), 9)
    objects = [
        b"<</Type/Catalog/Pages 2 0 R>>",
        b"<</Type/Pages/Kids[3 0 R]/Count 1>>",
        f"<</Type/Page/Parent 2 0 R/MediaBox[0 0 {width} {height}]/Resources<<>>"
        "/Contents 4 0 R>>".encode(),
        f"<</Length {len(stream)}/Filter/FlateDecode>>\nstream\n".encode()
        + stream
        + b"\nendstream",
    ]
    return _pdf_file(objects)


def _pdf_file(objects: list[bytes]) -> bytes:
    """Objects 1, 2, ... and the table of their offsets; object 1 is the catalog."""
    body = b"%PDF-1.4\n"
    starts = []
    for number, content in enumerate(objects, 1):
        starts.append(len(body))
        body += b"%d 0 obj\n%b\nendobj\n" % (number, content)
    table = b"".join(b"%010d 00000 n \n" % start for start in starts)
    size = len(objects) + 1
    return (
        body
        + b"xref\n0 %d\n0000000000 65535 f \n%b" % (size, table)
        + b"trailer\n<</Size %d/Root 1 0 R>>\nstartxref\n%d\n%%%%EOF\n" % (size, len(body))
    )


def _by_ink(dots: Dots) -> Iterator[tuple[str, NDArray[np.int64]]]:
    """Name and positions, in integers of 1/PLACES pixel, of each ink that has dots."""
    places = np.rint(dots.positions * PLACES).astype(np.int64)
    for index, name in enumerate(dots.inks):
        mine = places[dots.classes == index]
        if len(mine):
            yield name, mine


def _decimal(hundredths: int) -> str:
    """The shortest text of a number."""
    text = f"{abs(hundredths) / PLACES:.2f}".rstrip("0").rstrip(".")
    return ("-" if hundredths < 0 else "") + (text.removeprefix("0") or "0")


def to_png(dots: Dots, scale: float = 4.0) -> bytes:
    """Write the dots as PNG; scale as for draw(). Memory never holds the whole drawing.

    Raises:
        ImportError: Pillow is not installed.
    """
    width, height = _pixels(dots, scale)
    kind = 0 if len(dots.inks) == 1 else 2  # gray, or red, green, blue
    packed = zlib.compressobj(PACKING)
    lines = [packed.compress(_unfiltered(band)) for band in _bands(dots, scale)]
    header = struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)
    content = b"".join([*lines, packed.flush()])
    return PNG + _chunk(b"IHDR", header) + _chunk(b"IDAT", content) + _chunk(b"IEND", b"")


def _unfiltered(band: NDArray[np.uint8]) -> bytes:
    """Rows in the format of PNG, each after the number of its filter: 0 is none."""
    rows = band.reshape(len(band), -1)
    return np.pad(rows, ((0, 0), (1, 0))).tobytes()


def _chunk(name: bytes, content: bytes) -> bytes:
    sum_of = zlib.crc32(content, zlib.crc32(name))
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", sum_of)


def encode(dots: Dots, suffix: str, *, scale: float = 4.0) -> bytes:
    """The content of a file.

    Args:
        dots: from stipple().
        suffix: one of SUFFIXES, in any case.
        scale: of PNG files, as for draw().

    Raises:
        ValueError: another suffix.
    """
    match suffix.lower():
        case ".svg":
            return to_svg(dots).encode("ascii")
        case ".pdf":
            return to_pdf(dots)
        case ".png":
            return to_png(dots, scale)
    raise ValueError(f"suffix is '{suffix}': it must be one of {', '.join(SUFFIXES)}")


def write(dots: Dots, path: str | os.PathLike[str], *, scale: float = 4.0) -> None:
    """Write the dots to a file in the format of its suffix, one of SUFFIXES. See encode().

    The file is complete or not written.
    """
    content = encode(dots, Path(path).suffix, scale=scale)
    with replacing(Path(path)) as file:
        file.write(content)
