# SPDX-License-Identifier: GPL-3.0-or-later
"""Files whose headers promise more than they hold are refused before memory is taken."""

import io
import struct
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
from command_line import refused
from dapple3d import reading, stippling
from dapple3d.cli import ply
from dapple3d.extras import gltf
from dapple3d.extras.distributed import open_surface, track_shot

try:
    import resource
except ModuleNotFoundError:
    resource = None

MANY = 2**31
LEAST = 50_000_000  # bytes of memory that suffice to reject a file
STATUS = Path("/proc/self/statm")


def npy(shape: tuple[int, ...], content: bytes = b"", descr: str = "<f8") -> bytes:
    file = io.BytesIO()
    header = {"descr": descr, "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(file, header)
    return file.getvalue() + content


def npz(path: Path, **entries: bytes) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in entries.items():
            archive.writestr(f"{name}.npy", content)
    return path


def directory_says(path: Path, *, size: int | None = None, packed: int | None = None) -> Path:
    """Change what the archive's directory says of its first entry."""
    content = bytearray(path.read_bytes())
    at = content.index(b"PK\1\2")
    if packed is not None:
        struct.pack_into("<I", content, at + 20, packed)
    if size is not None:
        struct.pack_into("<I", content, at + 24, size)
    path.write_bytes(content)
    return path


@contextmanager
def little_memory() -> Iterator[None]:
    """Nothing in this process may ask for more than LEAST bytes."""
    if resource is None or not STATUS.exists():  # only errors are tested on other systems
        yield
        return
    pages = int(STATUS.read_text().split()[0])
    limits = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + LEAST, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, limits)


@pytest.mark.parametrize("shape", [(MANY, 3), (0, MANY, 3), (1, 3), (2**62, 2**62, 3)])
def test_an_array_of_an_archive_is_as_large_as_it_says(tmp_path, shape):
    path = npz(tmp_path / "mesh.npz", vertices=npy(shape), faces=npy((1, 3), bytes(24)))
    if 0 in shape:
        assert reading.read_npz(path)["vertices"].shape == shape
        return
    with pytest.raises(ValueError, match=r"promises \d+ bytes and has 0"), little_memory():
        reading.read_npz(path)


def test_an_array_of_its_own_is_as_large_as_it_says(tmp_path):
    (tmp_path / "density.npy").write_bytes(npy((MANY,)))
    with pytest.raises(ValueError, match="it promises 17179869184 bytes"), little_memory():
        reading.read_npy(tmp_path / "density.npy")


def test_an_archive_is_as_large_as_its_directory_says(tmp_path):
    good = npy((1, 3), bytes(24))
    path = directory_says(npz(tmp_path / "a.npz", vertices=npy((MANY // 8, 3))), size=2**32 - 2)
    with pytest.raises(ValueError, match="cannot hold 4294967294 bytes in"):
        reading.read_npz(path)
    path = directory_says(npz(tmp_path / "b.npz", vertices=good), size=2**31, packed=2**31)
    with pytest.raises(ValueError, match=r"larger than the \d+ bytes of the file"):
        reading.read_npz(path)


def test_an_archive_that_is_packed_well_is_read(tmp_path):
    np.savez_compressed(tmp_path / "zeros.npz", vertices=np.zeros((100_000, 3)))
    assert reading.read_npz(tmp_path / "zeros.npz")["vertices"].shape == (100_000, 3)


def test_whoever_reads_arrays_refuses_them(tmp_path):
    path = npz(tmp_path / "mesh.npz", vertices=npy((MANY, 3)), faces=npy((1, 3), bytes(24)))
    out = tmp_path / "out.npz"
    for call in (
        ("sample", path, out, "-n", 10),
        ("analyze", npz(tmp_path / "points.npz", positions=npy((MANY, 3)))),
        ("track", npz(tmp_path / "motion.npz", vertices=npy((2, MANY, 3))), out, "-n", 10),
    ):
        assert "promises" in refused(*call)
    with pytest.raises(ValueError, match="promises"):
        track_shot(path, 10)
    with pytest.raises(ValueError, match=r"mesh\.npz"), little_memory():
        open_surface(path, tmp_path / "folder")


BINARY = "ply\nformat binary_little_endian 1.0\nelement vertex {}\n{}end_header\n"
MESHES = {
    "vast.ply": BINARY.format(MANY, "property double x\nproperty double y\nproperty double z\n"),
    "text.ply": BINARY.format(
        MANY, "property double x\nproperty double y\nproperty double z\n"
    ).replace("binary_little_endian", "ascii"),
    "list.ply": BINARY.format(1, "property list int int x\n") + "\xff\xff\xff\x7f",
    "vast.off": f"OFF\n{MANY} {MANY} 0\n0 0 0\n",
    "corners.off": f"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n{MANY} 0 1 2\n",
    "vast.stl": "\0" * 80 + "\xff\xff\xff\x7f",
}


@pytest.mark.parametrize("name", MESHES)
def test_meshes_hold_what_they_say(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(MESHES[name].encode("latin-1"))
    with pytest.raises(dapple.FileError, match=name), little_memory():
        dapple.read_mesh(path)


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
def test_points_of_many_properties_hold_what_they_say(tmp_path, form):
    """The header alone is long enough for as many rows as it promises, not for their columns."""
    columns = "".join(f"property double p{k}\n" for k in range(1000))
    path = tmp_path / "points.ply"
    path.write_text(f"ply\nformat {form} 1.0\nelement vertex 20000\n{columns}end_header\n1 2 3\n")
    with pytest.raises(ValueError, match="is too short for 20000"), little_memory():
        ply.read(path)


def png(width: int, height: int) -> bytes:
    header = b"IHDR" + struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    parts = (header, b"IDAT" + zlib.compress(bytes(100)), b"IEND")
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(part) - 4) + part + struct.pack(">I", zlib.crc32(part))
        for part in parts
    )


def test_pictures_beyond_measure_are_refused(tmp_path):
    path = tmp_path / "vast.png"
    path.write_bytes(png(MANY - 1, MANY - 1))
    with pytest.raises(OSError, match=r"vast\.png"), little_memory():
        stippling.read_picture(path)
    assert "vast.png" in refused("stipple", path, tmp_path / "out.svg", "-n", 10)


@pytest.mark.parametrize("uri", ["/dev/zero", "../../../../../../../../dev/zero", "pipe", "."])
def test_a_buffer_that_is_no_file_is_refused(tmp_path, uri):
    path = tmp_path / "scene.gltf"
    path.write_text(f'{{"asset": {{}}, "buffers": [{{"uri": "{uri}", "byteLength": 9}}]}}')
    with pytest.raises((ValueError, OSError), match=r"scene\.gltf"), little_memory():
        gltf.read(path)
