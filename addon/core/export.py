# SPDX-License-Identifier: GPL-3.0-or-later
"""What an export writes: instances of scatters, frame by frame, in the format of an ending."""

import importlib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .base.errors import ScatterError
from .base.native import PACKAGE, package
from .surface.arrays import Floats, Ints

LongInts = NDArray[np.int64]
USD = (".usdc", ".usda", ".usd")
GLTF = (".glb", ".gltf")
GODOT = (".tscn",)
STILL = (*GLTF, *GODOT)  # of a single frame
TABLES = (".csv", ".npz")
SUFFIXES = (*USD, *STILL, *TABLES)
_PART = 32  # bits that an id has; above them which object of a collection it is


@dataclass(frozen=True)
class Placed:
    """The instances of a scatter on one frame: matrices of column vectors, in world space."""

    matrices: Floats  # (n, 4, 4)
    ids: LongInts  # of the points
    classes: Ints  # object types
    prototypes: Ints  # indices of the instanced meshes


@dataclass(frozen=True)
class SceneInfo:
    """Data that all files of an export have in common."""

    times: list[float]  # numbers of the frames
    fps: float
    meters_per_unit: float


@dataclass
class Exported:
    """A scatter with its frames."""

    name: str
    frames: list[Placed] = field(default_factory=list)
    objects: list[str] = field(default_factory=list)  # names of the instanced objects
    prototypes: Sequence[Any] = ()  # references of dapple3d, in the same order


def check_path(path: Path, frames: int) -> None:
    """ScatterError unless so many frames can be written there."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        known = ", ".join(SUFFIXES)
        raise ScatterError(f"'{path.name}' has an unknown file extension; known are {known}")
    if not path.parent.is_dir():
        raise ScatterError(f"'{path.parent}': the folder does not exist")
    if suffix in STILL and frames > 1:
        format_name = "glTF" if suffix in GLTF else "a scene of Godot"
        raise ScatterError(f"{format_name} cannot move instances: export a single frame, or USD")


def write(path: Path, scatters: Sequence[Exported], scene_info: SceneInfo) -> list[Path]:
    """Write all scatters into a file; tables contain a single scatter, so several scatters get a
    file each.
    """
    try:
        if path.suffix.lower() in TABLES:
            return _write_tables(path, scatters, scene_info)
        _write_scene(path, scatters, scene_info)
    except (OSError, ValueError, ImportError) as error:
        raise ScatterError(f"'{path}' could not be written: {error}") from error
    return [path]


def skewed(scatters: Iterable[Exported]) -> int:
    """Number of instances with a skew, caused by the scale of a parent; files cannot store it."""
    part = _part("instances")
    frames = (frame for one in scatters for frame in one.frames[:1])
    return sum(int(part.of_matrices(frame.matrices)[1].sum()) for frame in frames)


def identifiers(names: Iterable[str]) -> list[str]:
    """Names of letters, digits and _ that differ."""
    found: list[str] = []
    for name in names:
        plain = re.sub(r"\W", "_", name, flags=re.ASCII)
        plain = base = f"_{plain}" if plain[:1].isdigit() or not plain else plain
        count = 1
        while plain in found:
            count += 1
            plain = f"{base}_{count}"
        found.append(plain)
    return found


def reference(path: Path, prim: str) -> Any:
    """A prototype that is stored in the written file, or beside a scene of Godot."""
    return _part("instances").Reference(path, prim, held=True)


def _part(name: str) -> Any:
    package()  # says why it is missing
    return importlib.import_module(f"{PACKAGE}.{name}")


def _write_scene(path: Path, scatters: Sequence[Exported], scene_info: SceneInfo) -> None:
    part = _part("instances")
    listed = [
        part.Scatter(name, _instances(one, scene_info), one.prototypes)
        for name, one in zip(identifiers(one.name for one in scatters), scatters, strict=True)
    ]
    suffix = path.suffix.lower()
    if suffix in STILL:
        module = _part("extras.gltf" if suffix in GLTF else "extras.godot")
        module.write_scatters(path, listed, meters_per_unit=scene_info.meters_per_unit)
    else:
        times = scene_info.times if len(scene_info.times) > 1 else None
        given = {"fps": scene_info.fps, "meters_per_unit": scene_info.meters_per_unit}
        _part("extras.usd").write_scatters(path, listed, times=times, **given)


def _write_tables(path: Path, scatters: Sequence[Exported], scene_info: SceneInfo) -> list[Path]:
    paths = [path]
    if len(scatters) > 1:
        names = identifiers(one.name for one in scatters)
        paths = [path.with_name(f"{path.stem}.{name}{path.suffix}") for name in names]
    times = scene_info.times if len(scene_info.times) > 1 else None
    for to, one in zip(paths, scatters, strict=True):
        frames = _instances(one, scene_info)
        _part("tables").write(to, frames, times=times, names=one.objects)
    return paths


def _instances(one: Exported, scene_info: SceneInfo) -> list[Any]:
    """Instances for dapple3d, with velocities if there are several frames."""
    part = _part("instances")
    found = [
        part.of_matrices(
            frame.matrices,
            ids=_own_ids(frame),
            classes=frame.classes,
            prototypes=frame.prototypes,
        )[0]
        for frame in one.frames
    ]
    step = scene_info.times[1] - scene_info.times[0] if len(found) > 1 else 1.0
    moved: list[Any] = (
        part.with_velocities(found, scene_info.fps / step) if len(found) > 1 else found
    )
    return moved


def _own_ids(frame: Placed) -> LongInts:
    """Distinct ids where several objects of a collection are at one point."""
    order = np.argsort(frame.ids, kind="stable")
    ordered = frame.ids[order]
    first = np.searchsorted(ordered, ordered)
    ids = np.empty(len(order), np.int64)
    ids[order] = ordered + ((np.arange(len(order)) - first) << _PART)
    return ids
