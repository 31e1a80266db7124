# SPDX-License-Identifier: GPL-3.0-or-later
import re
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
from checks import check_array
from dapple3d import stippling
from PIL import Image
from skimage import data

sys.path.insert(0, str(Path(__file__).parents[2]))

from benchmarks.stipple.measure import error_diffusion, quality

WAVES = 0.5 + 0.5 * np.sin(0.2 * np.arange(40))[:, None] * np.cos(0.15 * np.arange(60))
COLORED = np.stack([WAVES, WAVES[::-1], WAVES[:, ::-1]], axis=2)


@pytest.fixture(scope="module")
def gray() -> dapple.Dots:
    return dapple.stipple(WAVES, 500)


@pytest.fixture(scope="module")
def colored() -> dapple.Dots:
    return dapple.stipple(COLORED, 700)


def test_has_exactly_as_many_dots(gray, colored):
    for dots, count in ((gray, 500), (colored, 700)):
        assert len(dots) == dots.report.count == count
        check_array(dots.positions, np.float64, (count, 2))
        check_array(dots.classes, np.int32, (count,))
        assert dots.colors.shape == (count, 3)
        assert dots.size == (60, 40)
        assert (dots.positions >= 0).all()
        assert (dots.positions <= (60, 40)).all()
    assert gray.inks == ("black",)
    assert not gray.colors.any()


def test_takes_several_kinds_of_numbers():
    base = dapple.stipple(np.rint(255 * WAVES) / 255, 100)
    for image in (
        np.rint(255 * WAVES).astype(np.uint8),
        (257 * np.rint(255 * WAVES)).astype(np.uint16),
    ):
        np.testing.assert_allclose(dapple.stipple(image, 100).positions, base.positions, atol=1e-6)


@pytest.mark.parametrize("kind", [np.float64, np.float32, np.uint8])
def test_leaves_the_picture_as_it_is(kind):
    image = WAVES.astype(kind)
    before = image.copy()
    dapple.stipple(image, 20)
    np.testing.assert_array_equal(image, before)


def test_alpha_lets_white_paper_through():
    image = np.zeros((20, 20, 4))
    image[:, 10:, 3] = 1.0
    dots = dapple.stipple(image, 60)
    assert (dots.positions[:, 0] >= 10).all()
    assert set(dots.classes) == {stippling.INKS.index("black")}


@pytest.mark.parametrize("image", [WAVES, COLORED], ids=["gray", "color"])
def test_gives_the_same_bytes_for_any_threads(image):
    base = dapple.stipple(image, 300, seed=3, threads=1)
    again = dapple.stipple(image, 300, seed=3, threads=2)
    assert again.positions.tobytes() == base.positions.tobytes()
    assert again.classes.tobytes() == base.classes.tobytes()
    assert dapple.stipple(image, 300, seed=4).positions.tobytes() != base.positions.tobytes()


def test_row_0_is_at_y_0():
    image = np.ones((10, 20))
    image[:3] = 0.0
    assert dapple.stipple(image, 50).positions[:, 1].max() <= 3.0


def test_dots_have_the_area_of_the_ink(gray):
    assert len(gray) * np.pi * gray.radius**2 == pytest.approx((1 - WAVES).sum())
    assert dapple.stipple(WAVES, 50, radius=2.5).radius == 2.5


def test_inks_have_their_shares(colored):
    inks = dapple.separate_inks(np.moveaxis(COLORED, 2, 0))
    share = inks.sum(axis=(1, 2)) / inks.sum()
    found = np.bincount(colored.classes, minlength=7)
    assert np.abs(found - 700 * share).max() < 1.0
    counts = [10, 20, 30, 40, 50, 60, 490]
    dots = dapple.stipple(COLORED, 700, counts=counts)
    assert np.bincount(dots.classes, minlength=7).tolist() == counts


def test_inks_mix_to_the_picture():
    inks = dapple.separate_inks(np.moveaxis(COLORED, 2, 0))
    assert inks.min() >= 0
    assert inks.sum(axis=0).max() <= 1
    np.testing.assert_allclose(dapple.mix_inks(inks), np.moveaxis(COLORED, 2, 0), atol=1e-12)


def test_renders_the_camera_better_than_error_diffusion():
    image = data.camera() / 255.0
    dots = dapple.stipple(image, 4000)
    ours = quality(image, dots.positions)
    theirs = quality(image, error_diffusion(image, 4000))
    print(ours, theirs)
    assert ours.psnr > theirs.psnr + 5.0
    assert ours.psnr > 25.0
    assert ours.ssim > theirs.ssim


@pytest.mark.parametrize(
    ("image", "count", "match"),
    [
        (np.ones((4, 5)), 10, "white"),
        (np.ones((4, 5, 3)), 10, "white"),
        (WAVES, 0, "count is 0"),
        (WAVES, -3, "count is -3"),
        (np.array([[0.5, np.nan]]), 10, r"image\[0, 1\] is nan"),
        (np.array([[0.5], [1.5]]), 10, r"image\[1, 0\] is 1.5.*\[0, 1\]"),
        (np.full((2, 2, 3), -1), 10, r"image\[0, 0, 0\] is -1"),
        (np.zeros((0, 4)), 10, "no pixel"),
        (np.zeros(7), 10, r"shape \(7,\)"),
        (np.zeros((3, 3, 2)), 10, r"shape \(3, 3, 2\)"),
        (np.array([["a"]]), 10, "dtype"),
    ],
)
def test_names_what_is_wrong(image, count, match):
    with pytest.raises(ValueError, match=match):
        dapple.stipple(image, count)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"radius": -1.0}, "radius is -1"),
        ({"tolerance": np.nan}, "tolerance is nan"),
        ({"counts": [1, 2, 3]}, "counts has 3"),
        ({"counts": [1, 2, 3, 4, 5, 6, 7]}, "counts sum to 28"),
    ],
)
def test_names_the_option(options, match):
    with pytest.raises(ValueError, match=match):
        dapple.stipple(COLORED, 700, **options)


def test_gray_has_no_counts():
    with pytest.raises(ValueError, match="counts is given and the image is gray"):
        dapple.stipple(WAVES, 10, counts=[10])


def test_black_and_tiny_pictures():
    black = dapple.stipple(np.zeros((20, 30)), 200)
    assert black.report.capacity_variation < 0.02
    assert len(dapple.stipple(np.zeros((1, 1)), 25)) == 25
    assert len(dapple.stipple(np.zeros((1, 1, 3)), 1)) == 1


def test_svg_holds_every_dot(colored):
    text = stippling.to_svg(colored)
    found = {}
    for color, path in re.findall(r'<path stroke="#(\w{6})" d="([^"]*)"', text):
        steps = re.findall(r"m(-?[\d.]+) (-?[\d.]+)h0", path)
        assert len("".join(f"m{x} {y}h0" for x, y in steps)) == len(path)
        found[color] = np.cumsum(np.array(steps, float), axis=0)
    assert sum(map(len, found.values())) == len(colored)
    black = colored.positions[colored.classes == stippling.INKS.index("black")]
    np.testing.assert_allclose(found["000000"], black, atol=0.0051)
    assert len(text) < 14 * len(colored) + 1000


def test_pdf_holds_every_dot(gray):
    data = stippling.to_pdf(gray)
    start, end = data.index(b"stream\n") + 7, data.index(b"\nendstream")
    page = zlib.decompress(data[start:end]).decode()
    dots = re.findall(r"^(\S+) (\S+) m \1 \2 l$", page, re.MULTILINE)
    flipped = gray.positions * (1, -1) + (0, 40)
    np.testing.assert_allclose(np.array(dots, float), flipped, atol=0.0051)
    table = int(data.rsplit(b"startxref\n", 1)[1].split()[0])
    assert data[table:].startswith(b"xref\n0 5\n")
    for number, line in enumerate(data[table:].splitlines()[3:7], 1):
        assert data[int(line[:10]) :].startswith(b"%d 0 obj" % number)


def test_draws_discs_of_the_area(gray):
    drawn = stippling.draw(dapple.stipple(WAVES, 20, radius=1.5), scale=8.0)
    assert drawn.shape == (320, 480)
    assert (255 - drawn).sum() / 255 / 64 == pytest.approx(20 * np.pi * 1.5**2, rel=0.02)
    np.testing.assert_allclose(stippling.draw(gray).mean() / 255, WAVES.mean(), atol=0.06)


def test_draws_colors(colored):
    drawn = stippling.draw(colored)
    assert drawn.shape == (160, 240, 3)
    np.testing.assert_allclose(drawn.mean(axis=(0, 1)) / 255, COLORED.mean(axis=(0, 1)), atol=0.06)


def few(places, radius, *, size=(20, 15), inks=("black",), classes=None):
    """Dots at places that are given."""
    report = dapple.stipple(WAVES, 2, max_evaluations=1).report
    kinds = np.zeros(len(places), np.int32) if classes is None else np.array(classes, np.int32)
    return stippling.Dots(np.array(places, float), kinds, radius, inks, size, report)


def exact(dots, scale, parts=16):
    """Gray from the share of so many parts of each pixel, along x and y, that discs cover."""
    width, height = (round(side * scale) * parts for side in dots.size)
    y, x = (axis + 0.5 for axis in np.ogrid[:height, :width])
    covered = np.zeros((height, width), bool)
    for place in dots.positions * scale * parts:
        covered |= (x - place[0]) ** 2 + (y - place[1]) ** 2 <= (dots.radius * scale * parts) ** 2
    return 255 * (1 - covered.reshape(height // parts, parts, width // parts, parts).mean((1, 3)))


@pytest.mark.parametrize(("scale", "error"), [(4.0, 4), (2.0, 6), (0.8, 15)])
def test_drawn_discs_are_smooth_at_their_rims(scale, error):
    places = np.random.default_rng(3).uniform(-1, [21, 16], (60, 2))
    dots = few(places, 1.3)
    off = stippling.draw(dots, scale) - exact(dots, scale)
    assert np.sqrt((off**2).mean()) < error
    assert abs(off.mean()) < 0.5 * error


def test_a_disc_is_drawn_where_it_is_to_a_part_of_a_pixel():
    for x, y in ((10.0, 7.5), (9.87, 7.13), (3.02, 11.99)):
        drawn = 255.0 - stippling.draw(few([[x, y]], 2.5), 4.0)
        middle = [(drawn.sum(axis=axis) @ (np.arange(drawn.shape[1 - axis]) + 0.5)) / drawn.sum()
                  for axis in (0, 1)]  # fmt: skip
        np.testing.assert_allclose(middle, [4 * x, 4 * y], atol=1 / 32)


def test_bands_and_stamps_that_are_forgotten_change_no_pixel(monkeypatch, colored):
    whole = stippling.draw(colored)
    monkeypatch.setattr(stippling, "BAND", 1000)
    monkeypatch.setattr(stippling, "STAMPED", 1)
    np.testing.assert_array_equal(stippling.draw(colored), whole)


def test_inks_lie_on_each_other_in_their_order():
    drawn = stippling.draw(
        few([[8, 8], [10, 8]], 4.0, inks=("red", "blue"), classes=[1, 0]), scale=2.0
    )
    assert drawn[16, 18].tolist() == [0, 0, 255]
    assert drawn[16, 26].tolist() == [255, 0, 0]
    assert drawn[0, 0].tolist() == [255, 255, 255]


def test_dots_beside_the_picture_and_larger_ones_are_drawn():
    assert (stippling.draw(few([[-50, -50], [90, 3]], 2.0)) == 255).all()
    assert (stippling.draw(few([[10, 7]], 1e9)) == 0).all()
    drawn = stippling.draw(few([[0, 7.5]], 4.0))
    assert drawn[30, 0] == 0
    assert drawn[30, 20] == 255


@pytest.mark.parametrize("inks", [1, 7])
def test_a_large_picture_is_drawn_in_little_memory(tmp_path, inks, monkeypatch):
    """8192 x 8192 pixels, which take 1.6 GB as numbers of 64 bits in three channels."""
    code = f"""
import resource
import numpy as np
from dapple3d import stippling
random = np.random.default_rng(0)
places, classes = 2048 * random.random((12_500, 2)), random.integers(0, {inks}, 12_500)
dots = stippling.Dots(places, classes, 8.0, stippling.INKS[-{inks}:], (2048, 2048), None)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
stippling.write(dots, {str(tmp_path / "large.png")!r})
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""
    pytest.importorskip("resource")
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert int(found.stdout) < 250_000  # kB
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", None)  # others may have lowered it
    with Image.open(tmp_path / "large.png") as picture:
        assert picture.size == (8192, 8192)
        assert picture.mode == ("L" if inks == 1 else "RGB")


@pytest.mark.parametrize("suffix", ["png", "svg", "PDF"])
def test_writes_files(gray, tmp_path, suffix):
    path = tmp_path / f"dots.{suffix}"
    stippling.write(gray, path, scale=3.0)
    if suffix == "png":
        np.testing.assert_array_equal(stippling.read_picture(path), stippling.draw(gray, 3.0))
    else:
        written = path.read_bytes()
        assert written in (stippling.to_svg(gray).encode(), stippling.to_pdf(gray))


def test_refuses_other_files(gray, tmp_path):
    with pytest.raises(ValueError, match=r"suffix is '.gif': it must be one of .png, .svg, .pdf"):
        stippling.write(gray, tmp_path / "dots.gif")
    with pytest.raises(ValueError, match="scale is 0"):
        stippling.draw(gray, 0.0)


def test_a_picture_of_more_pixels_than_memory_is_refused(tmp_path):
    image = pytest.importorskip("PIL.Image")
    path = tmp_path / "bomb.png"
    image.fromarray(np.zeros((4, 4), np.uint8)).save(path)
    content = bytearray(path.read_bytes())
    content[16:24] = struct.pack(">II", 2**18, 2**18)
    content[29:33] = struct.pack(">I", zlib.crc32(content[12:29]))
    path.write_bytes(content)
    with pytest.raises(OSError, match=r"bomb\.png: could not be read as a picture"):
        stippling.read_picture(path)


def test_reads_gray_color_and_deep_pictures(tmp_path):
    image = pytest.importorskip("PIL.Image")
    gray = np.arange(12, dtype=np.uint8).reshape(3, 4) * 20
    color = np.stack([gray, gray, gray + 1, np.full_like(gray, 255)], axis=2)
    for name, pixels, expected in (
        ("gray", gray, gray),
        ("same", np.repeat(gray[..., None], 3, axis=2), gray),
        ("color", color[..., :3], color),
        ("deep", gray.astype(np.uint16) * 257, gray),
    ):
        path = tmp_path / f"{name}.png"
        image.fromarray(pixels).save(path)
        np.testing.assert_array_equal(stippling.read_picture(path), expected)
