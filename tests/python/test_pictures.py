# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures as they come: turned, deep, transparent, or not to be understood."""

import struct

import numpy as np
import pytest
from click.testing import CliRunner
from dapple3d import stippling
from dapple3d.cli.app import main

Image = pytest.importorskip("PIL.Image")

UPRIGHT = np.arange(12, dtype=np.uint8).reshape(3, 4) * 20
# Images as a camera stores them, one for each orientation, which all show the same picture once
# rotated.
STORED = {
    1: UPRIGHT,
    2: UPRIGHT[:, ::-1],
    3: UPRIGHT[::-1, ::-1],
    4: UPRIGHT[::-1],
    5: UPRIGHT.T,
    6: UPRIGHT.T[::-1],
    7: UPRIGHT.T[::-1, ::-1],
    8: UPRIGHT.T[:, ::-1],
}
RAMP = np.linspace(0.0, 1.0, 256).reshape(16, 16)
EIGHT = np.rint(255 * RAMP).astype(np.uint8)


def saved(path, pixels, **how):
    Image.fromarray(np.ascontiguousarray(pixels)).save(path, **how)
    return path


def tiff(path, pixels, *, bits, kind, photometric=1, order="<"):
    """A TIFF of one channel without compression: unsigned (1), signed (2), floating (3) samples."""
    rows, columns = pixels.shape
    if bits == 12:
        rows_of_bits = ("".join(f"{value:012b}" for value in row) for row in pixels)
        padded = [row.ljust(-(-len(row) // 8) * 8, "0") for row in rows_of_bits]
        data = b"".join(int(row, 2).to_bytes(len(row) // 8, "big") for row in padded)
    else:
        data = pixels.astype(f"{order}{'_uif'[kind]}{bits // 8}").tobytes()
    sizes = {256: columns, 257: rows, 278: rows, 279: len(data), 273: 8}
    tags = sizes | {258: bits, 259: 1, 262: photometric, 277: 1, 339: kind}
    entries = b"".join(
        struct.pack(f"{order}HHII", tag, 4, 1, value)
        if tag in sizes
        else struct.pack(f"{order}HHIHH", tag, 3, 1, value, 0)
        for tag, value in sorted(tags.items())
    )
    start = {"<": b"II", ">": b"MM"}[order] + struct.pack(f"{order}HI", 42, 8 + len(data))
    path.write_bytes(
        start + data + struct.pack(f"{order}H", len(tags)) + entries + struct.pack("<I", 0)
    )
    return path


def refused(path):
    """The error, which names the file and what is wrong, in Python and of the command."""
    with pytest.raises(OSError, match="could not be read as a picture") as caught:
        stippling.read_picture(path)
    found = CliRunner().invoke(main, ["stipple", str(path), str(path) + ".svg", "-n", "5"])
    assert found.exit_code == 1
    assert found.stderr == f"Error: {caught.value}\n"
    assert str(caught.value).startswith(f"{path}: ")
    return str(caught.value)


# Orientation


@pytest.mark.parametrize("suffix", ["png", "jpg", "tif", "webp"])
@pytest.mark.parametrize("orientation", STORED)
def test_a_photo_stands_as_its_camera_was_held(tmp_path, suffix, orientation):
    exif = Image.Exif()
    exif[0x0112] = orientation
    large = np.kron(STORED[orientation], np.ones((8, 8), np.uint8))
    options = {"jpg": {"quality": 100}, "webp": {"lossless": True}}.get(suffix, {})
    path = saved(tmp_path / f"photo.{suffix}", large, exif=exif, **options)
    found = stippling.read_picture(path).astype(int)
    np.testing.assert_allclose(found[4::8, 4::8], UPRIGHT, atol=2)


def test_a_deep_picture_is_turned_too(tmp_path):
    exif = Image.Exif()
    exif[0x0112] = 6
    for suffix in ("png", "tif"):
        path = saved(tmp_path / f"photo.{suffix}", STORED[6].astype(np.uint16) * 257, exif=exif)
        np.testing.assert_array_equal(stippling.read_picture(path), UPRIGHT)


# Range


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(
    ("bits", "kind", "top"),
    [
        (8, 1, 255),
        (8, 2, 127),
        (12, 1, 4095),
        (16, 1, 65535),
        (16, 2, 32767),
        (32, 2, 2**31 - 1),
        (32, 2, 65535),
        (32, 2, 255),
        (32, 3, 1),
    ],
)
def test_pictures_of_all_depths_have_their_full_range(tmp_path, bits, kind, top, order):
    values = RAMP if kind == 3 else np.rint(RAMP * top).astype(np.int64)
    path = tiff(tmp_path / "ramp.tif", values, bits=bits, kind=kind, order=order)
    if order == ">" and bits in (12, 32) and kind != 3:
        pytest.skip("Pillow knows fewer kinds in this order of bytes")
    found = stippling.read_picture(path).astype(int)
    np.testing.assert_allclose(found, EIGHT, atol=1)


def test_unsigned_32_bits_do_not_wrap(tmp_path):
    values = np.rint(RAMP * (2**32 - 1)).astype(np.uint32)
    path = tiff(tmp_path / "ramp.tif", values, bits=32, kind=1)
    np.testing.assert_allclose(stippling.read_picture(path).astype(int), EIGHT, atol=1)


@pytest.mark.parametrize(("bits", "kind", "top"), [(16, 1, 65535), (32, 3, 1)])
def test_a_deep_picture_whose_zero_is_white_is_no_negative(tmp_path, bits, kind, top):
    values = RAMP if kind == 3 else np.rint(RAMP * top).astype(np.int64)
    path = tiff(tmp_path / "ramp.tif", values, bits=bits, kind=kind, photometric=0)
    np.testing.assert_allclose(stippling.read_picture(path).astype(int), 255 - EIGHT, atol=1)


def test_gray_maps_have_the_range_that_they_name(tmp_path):
    path = tmp_path / "ramp.pgm"
    values = np.rint(RAMP * 4095).astype(">u2")
    path.write_bytes(b"P5 16 16 4095\n" + values.tobytes())
    np.testing.assert_allclose(stippling.read_picture(path).astype(int), EIGHT, atol=1)
    path = tmp_path / "ramp.pfm"  # from the bottom up
    path.write_bytes(b"Pf\n16 16\n-1.0\n" + RAMP[::-1].astype("<f4").tobytes())
    np.testing.assert_allclose(stippling.read_picture(path).astype(int), EIGHT, atol=1)


# Transparency


def test_what_is_transparent_in_a_gray_picture_is_paper(tmp_path):
    gray = np.zeros((4, 4, 2), np.uint8)
    gray[:2, :, 1] = 255
    gray[2, :, 1] = 127
    expected = np.repeat([0, 0, 128, 255], 4).reshape(4, 4)
    for name, pixels in (("la", gray), ("rgba", gray[..., [0, 0, 0, 1]])):
        found = stippling.read_picture(saved(tmp_path / f"{name}.png", pixels))
        np.testing.assert_array_equal(found, expected)
    hidden = gray[..., [0, 0, 0, 1]].copy()
    hidden[3, :, 0] = 200  # the colors of transparent pixels
    found = stippling.read_picture(saved(tmp_path / "hidden.png", hidden))
    np.testing.assert_array_equal(found, expected)


def test_a_gray_level_that_is_named_transparent_is_paper(tmp_path):
    for factor, kind in ((1, np.uint8), (257, np.uint16)):
        pixels = UPRIGHT.astype(kind) * factor
        path = saved(tmp_path / "named.png", pixels, transparency=40 * factor)
        expected = np.where(UPRIGHT == 40, 255, UPRIGHT)
        np.testing.assert_array_equal(stippling.read_picture(path), expected)


def test_color_keeps_its_alpha(tmp_path):
    pixels = np.zeros((2, 2, 4), np.uint8)
    pixels[0, 0] = (255, 0, 0, 255)
    path = saved(tmp_path / "color.png", pixels)
    np.testing.assert_array_equal(stippling.read_picture(path), pixels)


# Refusal


def test_a_picture_that_cannot_be_understood_is_refused_by_name_and_rule(tmp_path):
    bright = tiff(tmp_path / "bright.tif", RAMP * 255, bits=32, kind=3)
    assert "pixel [0, 2] is 2: brightness as a floating-point number is in [0, 1]" in refused(
        bright
    )
    holes = RAMP.copy()
    holes[1, 2] = np.nan
    assert "pixel [1, 2] is nan" in refused(tiff(tmp_path / "nan.tif", holes, bits=32, kind=3))
    for bits in (8, 16, 32):
        below = tiff(tmp_path / "below.tif", EIGHT.astype(int) - 128, bits=bits, kind=2)
        assert "pixel [0, 0] is -128: brightness is not negative" in refused(below)
    text = tmp_path / "text.png"
    text.write_text("no picture")
    assert "Pillow knows no such kind" in refused(text)
    whole = saved(tmp_path / "whole.png", np.arange(10_000, dtype=np.uint16).reshape(100, 100))
    cut = tmp_path / "cut.png"
    cut.write_bytes(whole.read_bytes()[:200])
    refused(cut)
