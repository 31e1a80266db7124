# SPDX-License-Identifier: GPL-3.0-or-later
"""The meshes of a motion: several files, a folder of them, or one npz."""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click
import numpy as np

from dapple3d.cli import meshes
from dapple3d.cli.files import Arrays, load_npz
from dapple3d.cli.meshes import Mesh

Frames = list[tuple[str, Mesh]]  # with the name of each
SUFFIXES = (".ply", ".obj", ".stl", ".off", ".npz")
NUMBERED = re.compile(r"vertices_(\d+)")


def files_of(paths: Sequence[Path]) -> list[Path]:
    """The files, or those meshes that a folder holds, by the numbers in their names.

    Raises:
        ClickException: a folder beside others, or without meshes.
    """
    if not any(path.is_dir() for path in paths):
        return list(paths)
    if len(paths) > 1:
        raise click.ClickException(f"{paths[0]}: a folder is all frames, so it comes alone")
    found = [path for path in paths[0].iterdir() if path.suffix.lower() in SUFFIXES]
    if not found:
        raise click.ClickException(f"{paths[0]}: holds no {', '.join(SUFFIXES)} file")
    return sorted(found, key=_by_number)


def _by_number(path: Path) -> list[tuple[int, str]]:
    """frame_9 comes before frame_10."""
    parts = re.findall(r"\d+|\D+", path.name)
    return [(int(part), "") if part.isdigit() else (-1, part) for part in parts]


def read(files: Sequence[Path]) -> Frames:
    """All frames.

    Raises:
        ClickException: naming the file and what is wrong with it.
    """
    if len(files) > 1:
        return [(str(path), meshes.read_mesh(path)) for path in files]
    if files[0].suffix.lower() == ".npz":
        arrays = load_npz(files[0])
        if any(NUMBERED.fullmatch(name) for name in arrays):
            return _numbered(files[0], arrays)
    first = meshes.read_mesh(files[0])
    if np.ndim(first.vertices) != 3 or len(first.vertices) == 0:
        raise click.ClickException(
            f"{first.path}: 'vertices' has the shape {np.shape(first.vertices)}: "
            "(frames, v, 3) is needed, or more files"
        )
    return [
        (f"{first.path}[{k}]", replace(first, vertices=frame))
        for k, frame in enumerate(first.vertices)
    ]


def _numbered(path: Path, arrays: Arrays) -> Frames:
    """Of vertices_0, faces_0, vertices_1 and so on; faces are those before where there are none."""
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


def check_same_faces(frames: Frames) -> None:
    """Raise ClickException, naming the first frame and face that differs."""
    first, faces = frames[0][0], frames[0][1].faces
    advice = "all frames need the same faces, or --keep-density"
    for name, mesh in frames[1:]:
        if mesh.faces is faces:
            continue
        if mesh.faces.shape != faces.shape:
            raise click.ClickException(
                f"{name}: has faces {mesh.faces.shape}, but {first} {faces.shape}: {advice}"
            )
        different = np.flatnonzero((mesh.faces != faces).any(axis=1))
        if len(different):
            k = different[0]
            raise click.ClickException(
                f"{name}: faces[{k}] is {mesh.faces[k].tolist()}, but in {first} "
                f"{faces[k].tolist()}: {advice}"
            )
