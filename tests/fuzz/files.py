# SPDX-License-Identifier: GPL-3.0-or-later
"""Damages files and reads them: each is read, or refused by an error that the command line tells.

    python tests/fuzz/files.py [--seconds N] [--seed N] [--only NAME] [--findings FOLDER]

What USD files hold is read by Pixar's library, which nothing here damages.
"""

import argparse
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

import click
import dapple3d as dapple
import DracoPy
import numpy as np
from damage import damaged
from dapple3d import stippling
from dapple3d.cli import files, meshes, motions, points
from dapple3d.cli.attributes import with_attributes
from dapple3d.extras import _gltf_draco as draco
from dapple3d.extras import gltf
from dapple3d.extras._gltf_files import Document, encoded
from dapple3d.extras.distributed import streams
from dapple3d.instances import Instances, Mesh, Reference
from dapple3d.reading import BROKEN
from PIL import Image

TOLD = (click.ClickException, ValueError, OSError, MemoryError)  # dapple3d.cli.app has a sentence
SLOW = 20  # seconds
Image.MAX_IMAGE_PIXELS = 1_000_000  # more takes time and shows nothing


@dataclass(frozen=True)
class Reader:
    """What reads files of some endings, and expects of what it has read what always holds."""

    name: str
    read: Callable[[Path], Any]
    files: dict[str, Callable[[Path], None]]


def read_points(path: Path) -> None:
    for frame in motions.read(path).frames:
        count = len(frame.positions)
        assert frame.positions.dtype == np.float64
        assert frame.positions.shape[1:] in ((2,), (3,))
        for name, values in frame.arrays().items():
            assert len(values) == count, f"{name} has {len(values)} rows, positions {count}"
            assert values.dtype == (np.int32 if name in points.WHOLE else np.float64), name


def read_surface(path: Path) -> None:
    loaded = meshes.load(meshes.read_mesh(path))
    assert loaded.surface.area > 0.0
    if loaded.mesh.said is not None:
        samples = dapple.Samples(loaded.surface, [0], [[0.25, 0.25, 0.5]])
        with_attributes(loaded.mesh, samples, points.points_of(samples))
    if loaded.density.values is not None:
        assert np.isfinite(loaded.surface.density).all()


def read_density(path: Path) -> None:
    mesh = meshes.read_mesh(path)
    meshes.read_density(mesh, "fur")


def read_stream(path: Path) -> None:
    try:
        stream = streams.open_stream(path)
        columns = [column for column in (stream.vertices, stream.faces, stream.density) if column]
        counts = [sum(len(chunk) for chunk in column.chunks()) for column in columns]
    except BROKEN as error:
        raise ValueError from error
    assert counts == [column.rows for column in columns]


def read_prototype(path: Path) -> None:
    gltf.write(path.with_name("out.glb"), Instances(np.eye(3)), prototypes=[Reference(str(path))])


def read_picture(path: Path) -> None:
    picture = stippling.read_picture(path)
    assert picture.dtype == np.uint8
    assert picture.ndim in (2, 3)


POINTS = points.Points(
    np.linspace(-1.0, 2.0, 9).reshape(3, 3),
    normals=np.eye(3),
    ids=np.array([4, 0, 7], np.int32),
    classes=np.array([0, 1, 0], np.int32),
)
VERTICES = np.vstack([np.eye(3), -np.eye(3)])
FACES = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5]], np.int32)


def write_points(path: Path) -> None:
    points.write_points(path, POINTS)


def write_frames(path: Path) -> None:
    arrays = POINTS.arrays()
    still = {name: arrays[name] for name in ("ids", "classes")}
    moving = {name: np.stack([arrays[name]] * 2) for name in ("positions", "normals")}
    np.savez(path, times=np.arange(2.0), **still, **moving)


def write_table(path: Path) -> None:
    path.write_text("frame,id,x,y,z,object\n1,5,0,0.5,1,a\n1,6,1,1,1,b\n2,5,0.25,1e-3,2,a\n")


def write_text_ply(path: Path) -> None:
    header = "ply\nformat ascii 1.0\nelement vertex 2\nproperty int id\nproperty float x\n"
    path.write_text(
        f"{header}property double y\nproperty uchar class\nend_header\n1 0 2 3\n2 1 1 0\n"
    )


def write_mesh(path: Path) -> None:
    dapple.write_mesh(path, VERTICES, FACES)


COLORED_PLY = (
    "ply\nformat ascii 1.0\nelement vertex 4\n"
    + "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz", "s", "t"))
    + "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int64 age\n"
    "element face 1\nproperty list uchar int vertex_indices\nproperty float fur\nend_header\n"
    "0 0 0 0 0 1 0 0 9 8 7 1\n2 0 0 0 0 1 1 0 9 8 7 2\n0.5 0.5 0 0 0 1 1 1 9 8 7 3\n"
    "0 2 0 0 0 1 0 1 9 8 7 4\n4 0 1 2 3 0.5\n"
)


def write_colored_ply(path: Path) -> None:
    path.write_text(COLORED_PLY)


def write_other_table(path: Path) -> None:
    path.write_bytes("sep=;\r\nX;Y;ID\r\n0,5;0,25;3\r\n1;2;4\r\n".encode("utf-16"))


def write_scene(path: Path) -> None:
    gltf.write(path, Instances(np.eye(3)), prototypes=[Mesh(VERTICES, FACES)])


def write_compressed(path: Path) -> None:
    block = DracoPy.encode(VERTICES, FACES.astype(np.uint32), compression_level=7)
    number = DracoPy.decode(block).attributes[0]["unique_id"]
    document = Document({"asset": {"version": "2.0"}})
    position = {"componentType": 5126, "count": len(VERTICES), "type": "VEC3"}
    corners = {"componentType": 5125, "count": FACES.size, "type": "SCALAR"}
    view = document.add_view(np.frombuffer(block, np.uint8))
    extension = {draco.EXTENSION: {"bufferView": view, "attributes": {"POSITION": number}}}
    primitive = {"attributes": {"POSITION": document.add("accessors", position)}}
    primitive |= {"indices": document.add("accessors", corners), "extensions": extension}
    document.add("meshes", {"primitives": [primitive]})
    document.add("nodes", {"mesh": 0})
    document.tree |= {"scenes": [{"nodes": [0]}], "extensionsRequired": [draco.EXTENSION]}
    path.write_bytes(encoded(document, path.suffix))


def write_arrays(path: Path) -> None:
    np.savez(path, vertices=VERTICES, faces=FACES, density=np.arange(1.0, 7.0), fur=np.ones((6, 3)))


def picture(mode: str) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        values = np.arange(48).reshape(4, 12)
        gray = Image.fromarray((5 * values).astype(np.uint8))
        deep = Image.fromarray((1300 * values).astype(np.uint16))
        (deep if mode == "I;16" else gray.convert(mode)).save(path)

    return write


READERS = (
    Reader(
        "points",
        read_points,
        {
            **{f"points{end}": write_points for end in (".ply", ".csv", ".npz", ".obj", ".off")},
            **{f"scene{end}": write_points for end in (".glb", ".gltf")},
            **{"frames.npz": write_frames, "table.csv": write_table, "text.ply": write_text_ply},
            **{"other.csv": write_other_table, "colored.ply": write_colored_ply},
        },
    ),
    Reader(
        "surface",
        read_surface,
        {"mesh.npz": write_arrays, "colored.ply": write_colored_ply}
        | {f"mesh.{end}": write_mesh for end in ("ply", "obj", "off", "stl")}
        | {f"scene.{end}": write_scene for end in ("glb", "gltf")}
        | {f"compressed.{end}": write_compressed for end in ("glb", "gltf")},
    ),
    Reader("density", read_density, {"mesh.npz": write_arrays, "mesh.ply": write_mesh}),
    Reader(
        "prototype",
        read_prototype,
        {f"mesh{end}": write_points for end in (".glb", ".gltf")}
        | {"compressed.glb": write_compressed},
    ),
    Reader("stream", read_stream, {"mesh.npz": write_arrays, "mesh.ply": write_mesh}),
    Reader(
        "array",
        files.load_npy,
        {"values.npy": lambda path: np.save(path, np.arange(6.0).reshape(2, 3))},
    ),
    Reader(
        "picture",
        read_picture,
        {
            f"{mode.replace(';', '')}.png": picture(mode)
            for mode in ("1", "L", "RGB", "RGBA", "P", "I;16")
        },
    ),
)


def whole_files(folder: Path) -> Iterator[tuple[Reader, str, bytes]]:
    """What is damaged: files as they are written, each of which is read without an error."""
    for reader in READERS:
        for name, write in reader.files.items():
            path = folder / f"{reader.name}-{name}"
            write(path)
            if reader.name != "density" or path.suffix != ".ply":  # its mesh has none
                reader.read(path)
            yield reader, name, path.read_bytes()


def trouble(reader: Reader, path: Path) -> str:
    """What is wrong with how a file is read; nothing if it is read or refused."""
    try:
        reader.read(path)
    except TOLD:
        return ""
    except Exception:
        return traceback.format_exc()
    return ""


def too_slow(*_: object) -> None:
    raise RuntimeError(f"takes more than {SLOW} seconds")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", choices=[reader.name for reader in READERS])
    parser.add_argument("--findings", type=Path, default=Path("build/fuzz/findings"))
    given = parser.parse_args()
    signal.signal(signal.SIGALRM, too_slow)
    runs, found = run(given)
    print(f"{runs} runs, {time.process_time():.0f} s of processor, {found} findings")
    sys.exit(found > 0)


def run(given: argparse.Namespace) -> tuple[int, int]:
    """Numbers of files read and of different troubles, each of which is kept and shown once."""
    random, end, runs = Random(given.seed), time.monotonic() + given.seconds, 0
    known = set[str]()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        chosen = [row for row in whole_files(folder) if given.only in (None, row[0].name)]
        while time.monotonic() < end:
            reader, file, content = random.choice(chosen)
            path = folder / f"damaged{Path(file).suffix}"
            path.write_bytes(damaged(content, path.suffix, random))
            signal.alarm(SLOW)
            told = trouble(reader, path)
            signal.alarm(0)
            runs += 1
            if told and (where := "\n".join(told.splitlines()[-4:-1])) not in known:
                known.add(where)
                given.findings.mkdir(parents=True, exist_ok=True)
                kept = given.findings / f"files-{reader.name}-{len(known)}{path.suffix}"
                kept.write_bytes(path.read_bytes())
                print(f"{kept}:\n{told}", flush=True)
    return runs, len(known)


if __name__ == "__main__":
    main()
