# SPDX-License-Identifier: GPL-3.0-or-later
"""The meshes of a motion: several files, a folder of them, or one npz."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

import click
import numpy as np
from numpy.typing import NDArray

from dapple3d._meshes import SUFFIXES as MESHES
from dapple3d.cli import meshes
from dapple3d.cli.files import Arrays, load_npz
from dapple3d.cli.meshes import Mesh

Frames = list[tuple[str, Mesh]]  # with the name of each
SUFFIXES = (*MESHES, ".npz")
NUMBERED = re.compile(r"vertices_(\d+)")
Key = list[tuple[bool, int, str]]


def files_of(paths: Sequence[Path]) -> list[Path]:
    """The files, or the meshes of a folder, sorted by the numbers in their names.

    What is hidden is left out, as the companions `._name` that macOS writes.

    Raises:
        ClickException: a folder beside others, or without meshes.
    """
    if not any(path.is_dir() for path in paths):
        return list(paths)
    if len(paths) > 1:
        raise click.ClickException(f"{paths[0]}: a folder is all frames, so it comes alone")
    found = [
        path
        for path in paths[0].iterdir()
        if path.suffix.lower() in SUFFIXES and not path.name.startswith(".")
    ]
    if not found:
        raise click.ClickException(f"{paths[0]}: holds no {', '.join(SUFFIXES)} file")
    unsigned = _before_numbers(path.name for path in found)
    return sorted(found, key=lambda path: (_by_number(path.name, unsigned), path.name))


def _before_numbers(names: Iterable[str]) -> set[str]:
    """The text before a number without a minus."""
    return {
        name[: found.start()]
        for name in names
        for found in re.finditer(r"\d+", name)
        if not name[: found.start()].endswith("-")
    }


def _by_number(name: str, unsigned: set[str]) -> Key:
    """frame_9 comes before frame_10, and f-1 before f0.

    A minus is a sign where another name has a number in its place, else a dash: shot-1, shot-2.
    """
    key: Key = []
    end = 0
    for found in re.finditer(r"\d+", name):
        start = found.start()
        signed = name[end:start].endswith("-") and name[: start - 1] in unsigned
        text = name[end : start - signed]
        if text:
            key.append((False, 0, text))
        key.append((True, -int(found[0]) if signed else int(found[0]), ""))
        end = found.end()
    return [*key, (False, 0, name[end:])]


def read(files: Sequence[Path], *, may_be_empty: bool = False) -> Frames:
    """All frames.

    Args:
        files: of one frame each, or one npz of all.
        may_be_empty: whether frames may have no faces.

    Raises:
        ClickException: naming the file and what is wrong with it.
    """
    if len(files) > 1:
        return [(str(path), meshes.read_mesh(path, may_be_empty=may_be_empty)) for path in files]
    if files[0].suffix.lower() == ".npz":
        arrays = load_npz(files[0])
        if any(NUMBERED.fullmatch(name) for name in arrays):
            return _numbered(files[0], arrays)
    first = meshes.read_mesh(files[0])
    if np.ndim(first.vertices) != 3 or len(first.vertices) == 0:
        raise click.ClickException(
            f"{first.path}: holds one frame, vertices {np.shape(first.vertices)}; a motion is "
            "several files, a folder of them, or an .npz with 'vertices' (frames, v, 3)"
        )
    return [
        (f"{first.path}[{k}]", replace(first, vertices=frame))
        for k, frame in enumerate(first.vertices)
    ]


def _numbered(path: Path, arrays: Arrays) -> Frames:
    """Frames of vertices_0, faces_0, vertices_1 and so on; missing faces are those before."""
    numbers = sorted(int(found[1]) for name in arrays if (found := NUMBERED.fullmatch(name)))
    names = {int(found[1]): name for name in arrays if (found := NUMBERED.fullmatch(name))}
    faces = arrays.get("faces")
    frames: Frames = []
    for number in numbers:
        vertices = arrays[names[number]]
        faces = arrays.get(names[number].replace("vertices", "faces"), faces)
        if faces is None:
            raise click.ClickException(f"{path}: has '{names[number]}', but no faces for it")
        if vertices.ndim != 2 or faces.ndim != 2:
            raise click.ClickException(
                f"{path}: '{names[number]}' {vertices.shape} and its faces {faces.shape} are not "
                "(v, 3) and (m, 3)"
            )
        frames.append((f"{path}[{number}]", Mesh(path, vertices, faces)))
    return frames


def first_with_faces(frames: Frames) -> int:
    """The number of the first frame that has faces.

    Raises:
        ClickException: naming the frames, if there is none.
    """
    begin = next((k for k, (_, mesh) in enumerate(frames) if len(mesh.faces)), None)
    if begin is None:
        raise click.ClickException(f"{frames[0][0]}: holds no faces, nor does any later frame")
    return begin


def with_same_faces(frames: Frames) -> Frames:
    """The frames with the faces of the first.

    Polygons may begin at another corner or come in another order. Files of STL have no vertices in
    common: their triangles are those of the first frame, whose places say which hang together.

    Raises:
        ClickException: naming the first frame and face that differs.
    """
    if all(mesh.path.suffix.lower() == ".stl" for _, mesh in frames) and _have_split(frames):
        return [(name, _apart(mesh)) for name, mesh in frames]
    first, start = frames[0]
    done = [frames[0]]
    for name, mesh in frames[1:]:
        if mesh.faces is not start.faces:
            if not same_polygons(mesh, start):
                _refuse(name, mesh, first, start)
            mesh = replace(mesh, faces=start.faces)
        done.append((name, mesh))
    return done


def _have_split(frames: Frames) -> bool:
    """Whether all have as many triangles, but not the same vertices."""
    faces = frames[0][1].faces
    return all(mesh.faces.shape == faces.shape for _, mesh in frames) and any(
        not np.array_equal(mesh.faces, faces) for _, mesh in frames
    )


def _apart(mesh: Mesh) -> Mesh:
    """Each triangle with vertices of its own."""
    corners = mesh.vertices[mesh.faces].reshape(-1, 3)
    return Mesh(mesh.path, corners, np.arange(len(corners), dtype=np.int32).reshape(-1, 3))


def same_polygons(one: Mesh, other: Mesh) -> bool:
    """Whether both have the same polygons, however these are cut and in whatever order."""
    if one.faces.shape != other.faces.shape or len(one.vertices) != len(other.vertices):
        return False
    if np.array_equal(one.faces, other.faces):
        return True
    return np.array_equal(np.sort(_polygon_keys(one)), np.sort(_polygon_keys(other)))


def _polygon_keys(mesh: Mesh) -> NDArray[np.uint64]:
    """A hash of the edges around each polygon; edges between its triangles cancel."""
    ends = mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].astype(np.int64)
    low, high = ends.min(axis=2).astype(np.uint64), ends.max(axis=2).astype(np.uint64)
    mixed = low << np.uint64(32) | high
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):  # SplitMix64
        mixed = (mixed ^ (mixed >> np.uint64(shift))) * np.uint64(factor)
    mixed ^= mixed >> np.uint64(31)
    signed = np.where(ends[:, :, 0] < ends[:, :, 1], mixed, np.uint64(0) - mixed)
    starts = np.flatnonzero(np.diff(mesh.polygons, prepend=-1))
    keys: NDArray[np.uint64] = np.add.reduceat(signed.sum(axis=1, dtype=np.uint64), starts)
    return keys


def _refuse(name: str, mesh: Mesh, first: str, start: Mesh) -> NoReturn:
    advice = "all frames need the same faces, or --keep-density"
    faces = start.faces
    if mesh.faces.shape != faces.shape:
        raise click.ClickException(
            f"{name}: has faces {mesh.faces.shape}, but {first} {faces.shape}: {advice}"
        )
    different = np.flatnonzero((mesh.faces != faces).any(axis=1))
    if not len(different):
        raise click.ClickException(
            f"{name}: has {len(mesh.vertices)} vertices, but {first} {len(start.vertices)}: "
            f"{advice}"
        )
    k = different[0]
    raise click.ClickException(
        f"{name}: faces[{k}] is {mesh.faces[k].tolist()}, but in {first} "
        f"{faces[k].tolist()}: {advice}"
    )
