# SPDX-License-Identifier: GPL-3.0-or-later
"""USD files: instances as a PointInstancer, on one frame or many; needs usd-core.

>>> from dapple3d import instances
>>> from dapple3d.extras import usd
>>> usd.write("points.usda", instances.of_samples(samples))
>>> usd.read("points.usda").frames[0].positions

USD stores floating-point numbers in 32 bits: values that are read back are rounded to that.
"""

import errno
import os
import re
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..instances import Instances, Mesh, Reference, Scatter, Up
from ..writing import replacing

__all__ = ["SUFFIXES", "Contents", "check_installed", "read", "write", "write_scatters"]

SUFFIXES: Final = (".usd", ".usda", ".usdc")
"""Suffixes of the files that write() and read() know: binary, text, binary."""

VECTORS = {
    "positions": "positions",
    "scales": "scales",
    "velocities": "velocities",
    "normals": "primvars:normals",
}
ALIGNED = ("positions", "velocities")  # USD uses velocities at the times of the positions alone
OTHERS = ("protoIndices", "primvars:classes", "ids", "orientations", "orientationsf")
CLASS = re.compile(r"class_[0-9]{1,10}")
MISSING = "USD files need the module pxr, which is missing: pip install usd-core"


@dataclass(frozen=True)
class Contents:
    """What a file holds.

    Attributes:
        frames: the instances, in the order of the times.
        times: (frames,) float64, time codes: numbers of frames; a file without time samples has
            one frame at 0.
        fps: time codes per second.
        up: the axis that points up.
        meters_per_unit: length of a unit of the positions.
        prototypes: paths of the prototype prims.
    """

    frames: list[Instances]
    times: NDArray[np.float64]
    fps: float
    up: Up
    meters_per_unit: float
    prototypes: tuple[str, ...]


@cache
def _pxr() -> SimpleNamespace:
    try:
        from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdUtils, Vt
    except ModuleNotFoundError as error:
        raise ImportError(MISSING) from error
    modules = (Gf, Sdf, Tf, Usd, UsdGeom, UsdUtils, Vt)
    return SimpleNamespace(**{one.__name__.rpartition(".")[2]: one for one in modules})


def check_installed() -> None:
    """Raise ImportError before long work if usd-core is missing.

    Raises:
        ImportError: usd-core is not installed.
    """
    _pxr()


# Writing


def write(
    path: str | os.PathLike[str],
    frames: Instances | Sequence[Instances],
    *,
    times: ArrayLike | None = None,
    fps: float = 24.0,
    up: Up = "Z",
    meters_per_unit: float = 1.0,
    prototypes: Sequence[Reference | Mesh] = (),
    name: str = "points",
) -> None:
    """Write instances as a UsdGeom PointInstancer; the file is complete or not written.

    Orientations are written twice: as `orientations`, 16-bit floats that every reader knows, and
    as `orientationsf`, 32-bit floats that newer ones take instead. Normals become a primvar, and
    so do classes if they differ from the prototypes. Constant attributes are written once.

    Args:
        path: ends with one of SUFFIXES.
        frames: the instances, or those of several frames; their number may change.
        times: (frames,) increasing time codes; by default 1, 2, ...; a single frame without a time
            is constant.
        fps: time codes per second.
        up: the axis that points up. Nothing is rotated.
        meters_per_unit: length of a unit of the positions.
        prototypes: the prototypes of classes 0, 1, ..., or those that the instances refer to; the
            file refers to those of a Reference. Empty: a small ball for each class.
        name: of the PointInstancer.

    Raises:
        ValueError: an argument is wrong; it names the first offender.
        OSError: naming the file.
        ImportError: usd-core is not installed.
    """
    listed = [frames] if isinstance(frames, Instances) else list(frames)
    scatter = Scatter(name, listed, prototypes)
    write_scatters(path, [scatter], times=times, fps=fps, up=up, meters_per_unit=meters_per_unit)


def write_scatters(
    path: str | os.PathLike[str],
    scatters: Sequence[Scatter],
    *,
    times: ArrayLike | None = None,
    fps: float = 24.0,
    up: Up = "Z",
    meters_per_unit: float = 1.0,
) -> None:
    """Write a PointInstancer for each scatter, in one file; see write().

    Raises:
        ValueError: an argument is wrong; it names the first offender.
        OSError: naming the file.
        ImportError: usd-core is not installed.
    """
    target = Path(path)
    if target.suffix.lower() not in SUFFIXES:
        raise ValueError(f"{target}: a USD file ends with {', '.join(SUFFIXES)}")
    counts = {len(scatter.frames) for scatter in scatters}
    if len(counts) != 1:
        raise ValueError(f"scatters have {sorted(counts)} frames: the same number is needed")
    codes = _codes(counts.pop(), times)
    stage = _stage(codes, fps, up, meters_per_unit)
    for scatter in scatters:
        _add_instancer(stage, scatter, codes)
    _save(stage, target)


def _codes(count: int, times: ArrayLike | None) -> list[float] | None:
    if times is None:
        return [k + 1.0 for k in range(count)] if count > 1 else None
    codes = np.asarray(times, np.float64)
    if codes.shape != (count,) or not np.isfinite(codes).all() or (np.diff(codes) <= 0).any():
        raise ValueError(f"times is {codes.tolist()}: {count} growing numbers are needed")
    return codes.tolist()


def _stage(codes: list[float] | None, fps: float, up: Up, meters_per_unit: float) -> Any:
    pxr = _pxr()
    if up not in ("Y", "Z"):
        raise ValueError(f"up is {up!r}: Y or Z is needed")
    for name, value in (("fps", fps), ("meters_per_unit", meters_per_unit)):
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} is {value}: a number > 0 is needed")
    stage = pxr.Usd.Stage.CreateInMemory()
    pxr.UsdGeom.SetStageUpAxis(stage, up)
    pxr.UsdGeom.SetStageMetersPerUnit(stage, float(meters_per_unit))
    stage.SetTimeCodesPerSecond(float(fps))
    stage.SetFramesPerSecond(float(fps))
    if codes:
        stage.SetStartTimeCode(codes[0])
        stage.SetEndTimeCode(codes[-1])
    root = pxr.UsdGeom.Xform.Define(stage, "/dapple")
    pxr.Usd.ModelAPI(root).SetKind("component")
    stage.SetDefaultPrim(root.GetPrim())
    return stage


def _add_instancer(stage: Any, scatter: Scatter, codes: list[float] | None) -> None:
    pxr, name = _pxr(), scatter.name
    if not pxr.Sdf.Path.IsValidIdentifier(name):
        raise ValueError(f"name is {name!r}: letters, digits and _ are needed, no digit first")
    path = f"/dapple/{name}"
    if stage.GetPrimAtPath(path):
        raise ValueError(f"name is {name!r}, which another scatter has too")
    instancer = pxr.UsdGeom.PointInstancer.Define(stage, path)
    below = str(pxr.UsdGeom.Scope.Define(stage, f"{path}/prototypes").GetPath())
    shapes: dict[int, Reference | Mesh | float] = dict(enumerate(scatter.prototypes))
    if not shapes:
        shapes = dict.fromkeys(scatter.used.tolist(), scatter.radius)
    paths = [_add_prototype(stage, below, k, one) for k, one in shapes.items()]
    if len(set(paths)) < len(paths):
        twice = next(one for one in paths if paths.count(one) > 1)
        raise ValueError(f"prototypes has {Path(twice).name} twice: a file holds it once")
    instancer.GetPrototypesRel().SetTargets(paths)
    _add_arrays(
        instancer.GetPrim(), [_numbered(one, list(shapes)) for one in scatter.frames], codes
    )
    for code in codes or [pxr.Usd.TimeCode.Default()]:
        extent = instancer.ComputeExtentAtTime(code, code)
        instancer.GetExtentAttr().Set(extent, code)


def _numbered(frame: Instances, numbers: list[int]) -> Instances:
    """Instances with the indices of the prototypes that are written."""
    if numbers == list(range(len(numbers))):
        return frame
    places = np.searchsorted(numbers, frame.placed).astype(np.int32)
    classes = frame.placed if frame.classes is None else frame.classes
    return replace(frame, classes=classes, prototypes=places)


def _add_prototype(stage: Any, below: str, k: int, shape: Reference | Mesh | float) -> str:
    """The path of the prototype prim of class k."""
    path, geometry = f"{below}/class_{k}", _pxr().UsdGeom
    if isinstance(shape, Reference):
        if shape.held:
            return _add_copy(stage, below, shape)
        prim = geometry.Xform.Define(stage, path).GetPrim()
        prim.GetReferences().AddReference(*_checked_reference(shape))
    elif isinstance(shape, Mesh):
        mesh = geometry.Mesh.Define(stage, path)
        faces = np.ascontiguousarray(shape.faces, np.int32)
        mesh.GetPointsAttr().Set(_vectors("vertices", shape.vertices))
        mesh.GetFaceVertexCountsAttr().Set([3] * len(faces))
        mesh.GetFaceVertexIndicesAttr().Set(_pxr().Vt.IntArray.FromNumpy(faces.ravel()))
        mesh.GetSubdivisionSchemeAttr().Set(geometry.Tokens.none)
        mesh.GetExtentAttr().Set(geometry.PointBased.ComputeExtent(mesh.GetPointsAttr().Get()))
    else:
        ball = geometry.Sphere.Define(stage, path)
        ball.GetRadiusAttr().Set(shape)
        ball.GetExtentAttr().Set([(-shape,) * 3, (shape,) * 3])
    return path


def _add_copy(stage: Any, below: str, reference: Reference) -> str:
    """Copy the default prim of a file with its materials, once."""
    pxr = _pxr()
    with _opened(Path(reference.path).resolve()) as other:
        source = _prim_of(other, Reference(reference.path))
        wanted = _prim_of(other, reference).GetPath()
        target = pxr.Sdf.Path(below).AppendChild(source.GetName())
        if not stage.GetPrimAtPath(target):
            pxr.Sdf.CopySpec(other.Flatten(), source.GetPath(), stage.GetRootLayer(), target)
        return str(wanted.ReplacePrefix(source.GetPath(), target))


def _checked_reference(reference: Reference) -> tuple[str, ...]:
    """Absolute path and prim of a reference, both checked to exist."""
    path = Path(reference.path).resolve()
    with _opened(path) as stage:
        _prim_of(stage, reference)
    return (path.as_posix(), reference.prim) if reference.prim else (path.as_posix(),)


def _prim_of(stage: Any, reference: Reference) -> Any:
    prim = stage.GetPrimAtPath(reference.prim) if reference.prim else stage.GetDefaultPrim()
    if not prim:
        missing = f"no prim {reference.prim}" if reference.prim else "no default prim: name one"
        raise ValueError(f"{reference.path}: has {missing}")
    for below in _pxr().Usd.PrimRange(prim):
        if below.IsA(_pxr().UsdGeom.Mesh):
            _check_topology(reference, _pxr().UsdGeom.Mesh(below))
    return prim


def _check_topology(reference: Reference, mesh: Any) -> None:
    """Raise ValueError if the faces of a mesh are not among its points."""
    first = _pxr().Usd.TimeCode.EarliestTime()
    corners, counts, points = (
        found.Get(first) or []
        for found in (
            mesh.GetFaceVertexIndicesAttr(),
            mesh.GetFaceVertexCountsAttr(),
            mesh.GetPointsAttr(),
        )
    )
    valid, reason = mesh.ValidateTopology(corners, counts, len(points))
    if not valid:
        raise ValueError(f"{reference.path}: {mesh.GetPath()}: {' '.join(reason.split())}")


def _add_arrays(prim: Any, frames: Sequence[Instances], codes: list[float] | None) -> None:
    """Set attributes that are constant once, others at times; velocities at those of positions."""
    pxr = _pxr()
    primvars, types = pxr.UsdGeom.PrimvarsAPI(prim), pxr.Sdf.ValueTypeNames
    kinds = {"normals": types.Normal3fArray, "classes": types.IntArray}
    rows = [_values(frame) for frame in frames]
    for name, first in rows[0].items():
        head, _, tail = name.partition(":")
        if head == "primvars":
            primvars.CreatePrimvar(tail, kinds[tail], pxr.UsdGeom.Tokens.vertex)
        attribute = prim.GetAttribute(name)
        together = ALIGNED if name in ALIGNED else (name,)
        if all(row.get(one) == rows[0].get(one) for row in rows for one in together):
            attribute.Set(first)
            continue
        for code, row in zip(codes or [], rows, strict=True):
            attribute.Set(row[name], code)


def _values(frame: Instances) -> dict[str, Any]:
    """Arrays of USD by the names of their attributes."""
    vt, turns = _pxr().Vt, frame.orientations
    found = {"protoIndices": vt.IntArray.FromNumpy(frame.placed)}
    if frame.classes is not None and frame.prototypes is not None:
        found["primvars:classes"] = vt.IntArray.FromNumpy(frame.classes)
    for name, attribute in VECTORS.items():
        values = getattr(frame, name)
        if values is not None:
            found[attribute] = _vectors(name, values)
    if turns is not None:
        turns = np.roll(turns, -1, axis=1)  # in memory they are x, y, z, w
        found["orientations"] = vt.QuathArray.FromNumpy(turns.astype(np.float16))
        found["orientationsf"] = vt.QuatfArray.FromNumpy(turns.astype(np.float32))
    if frame.ids is not None:
        found["ids"] = vt.Int64Array.FromNumpy(frame.ids)
    return found


def _vectors(name: str, values: NDArray) -> Any:
    with np.errstate(over="ignore"):
        single = np.ascontiguousarray(values, np.float32)
    if not np.isfinite(single).all():
        k = int((~np.isfinite(single).all(axis=1)).argmax())
        raise ValueError(f"{name}[{k}] is no 32-bit float: {values[k].tolist()}")
    return _pxr().Vt.Vec3fArray.FromNumpy(single)


def _save(stage: Any, path: Path) -> None:
    """Write to a temporary file first, because USD writes only files that it opens itself."""
    pxr, folder = _pxr(), path.resolve().parent
    layer = pxr.Sdf.Layer.CreateAnonymous()
    layer.TransferContent(stage.GetRootLayer())  # the stage would resolve the relative paths
    pxr.UsdUtils.ModifyAssetPaths(layer, lambda asset: _relative(asset, folder))
    with tempfile.TemporaryDirectory() as elsewhere, replacing(path) as file:
        made = Path(elsewhere, f"whole{path.suffix.lower()}")
        with _telling(path, ""):
            layer.Export(str(made))
        with made.open("rb") as whole:
            shutil.copyfileobj(whole, file)


def _relative(asset: str, folder: Path) -> str:
    try:
        found = Path(os.path.relpath(asset, folder)).as_posix()
    except ValueError:  # on another drive
        return asset
    return found if found.startswith(".") else f"./{found}"


@contextmanager
def _telling(path: Path, before: str) -> Iterator[None]:
    """Raise USD's message on one line."""
    try:
        yield
    except _pxr().Tf.ErrorException as error:
        reason = error.args[0].commentary.removeprefix("Error occurred writing file: ")
        raise OSError(None, before + reason, str(path)) from error


# Reading


def read(path: str | os.PathLike[str], prim: str | None = None) -> Contents:
    """Read a PointInstancer in its own space, without the transforms of its parents.

    Args:
        path: ends with one of SUFFIXES.
        prim: path of the PointInstancer; needed if the file has several.

    Raises:
        ValueError: there is none, there are several, or its arrays do not belong together.
        OSError: naming the file, which is missing or no USD file.
        ImportError: usd-core is not installed.
    """
    geometry = _pxr().UsdGeom
    with _opened(Path(path)) as stage:
        instancer = _found(stage, prim)
        times = _times(instancer)
        return Contents(
            [_frame(instancer, time) for time in times],
            np.array(times),
            stage.GetTimeCodesPerSecond(),
            geometry.GetStageUpAxis(stage),
            geometry.GetStageMetersPerUnit(stage),
            tuple(map(str, geometry.PointInstancer(instancer).GetPrototypesRel().GetTargets())),
        )


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    if not path.exists():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    with _telling(path, "could not be read as USD: "):
        stage = _pxr().Usd.Stage.Open(str(path))
    yield stage


def _found(stage: Any, path: str | None) -> Any:
    there = list(_outermost(stage))
    names = ", ".join(str(prim.GetPath()) for prim in there)
    chosen = [prim for prim in there if path in (None, str(prim.GetPath()))]
    if len(chosen) == 1:
        return chosen[0]
    if not there:
        raise ValueError("has no PointInstancer")
    if path is None:
        raise ValueError(f"has {len(there)} PointInstancers, name one of them: {names}")
    raise ValueError(f"has no PointInstancer {path}, but {names}")


def _outermost(stage: Any) -> Iterator[Any]:
    """The PointInstancers that are not prototypes of another one."""
    prims = iter(stage.Traverse())
    for prim in prims:
        if prim.IsA(_pxr().UsdGeom.PointInstancer):
            prims.PruneChildren()
            yield prim


def _times(prim: Any) -> list[float]:
    """Those of the arrays; of arrays that stay the same those of the extent."""
    for names in ((*OTHERS, *VECTORS.values()), ("extent",)):
        attributes = [prim.GetAttribute(name) for name in names]
        samples = [attribute.GetTimeSamples() for attribute in attributes if attribute]
        if any(samples):
            return sorted({time for times in samples for time in times})
    return [0.0]


def _stand_at(prim: Any, placed: NDArray, classes: NDArray) -> bool:
    """Whether prototypes are missing, and the names of those present are those of classes."""
    targets = _pxr().UsdGeom.PointInstancer(prim).GetPrototypesRel().GetTargets()
    names = [target.name for target in targets]
    numbers = [int(name[6:]) if CLASS.fullmatch(name) else -1 for name in names]
    if numbers == list(range(len(numbers))) or ((placed < 0) | (placed >= len(numbers))).any():
        return False
    return np.array_equal(np.array(numbers, np.int64)[placed], classes)


def _frame(prim: Any, time: float) -> Instances:
    def array(name: str) -> NDArray | None:
        attribute = prim.GetAttribute(name)
        values = attribute.Get(time) if attribute else None
        return None if values is None else np.array(values)

    turns = array("orientationsf")
    if turns is None or len(turns) == 0:
        turns = array("orientations")
    found = {name: array(attribute) for name, attribute in VECTORS.items()}
    positions = found.pop("positions")
    if positions is None:
        raise ValueError(f"{prim.GetPath()} has no positions")
    placed, classes = array("protoIndices"), array("primvars:classes")
    if placed is not None and classes is not None and _stand_at(prim, placed, classes):
        placed, classes = classes, None
    return Instances(
        positions,
        None if turns is None else np.roll(turns, 1, axis=1),
        ids=array("ids"),
        classes=placed if classes is None else classes,
        prototypes=None if classes is None else placed,
        **found,
    )
