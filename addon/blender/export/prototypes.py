# SPDX-License-Identifier: GPL-3.0-or-later
"""Instanced meshes with their materials, in files that Blender's own exporters write."""

import importlib.util
import shutil
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from uuid import uuid4

import addon_utils
import bpy

from ...core.base.errors import ScatterError
from ...core.export import GLTF, GODOT, USD, identifiers, reference

_ROOT = "objects"
_MESHES = "meshes"  # the folder of those of Godot
_NO_USD = (
    "This Blender was built without USD: export .glb, .csv or .npz, or use a Blender from "
    "blender.org"
)
_NO_OBJ = "This Blender was built without OBJ: export .usd, .glb, .csv or .npz"
_NO_GLTF = "Blender's glTF exporter is missing: export .usd, .csv or .npz"


def check_installed(suffix: str) -> None:
    """ScatterError if this Blender cannot write files with this ending."""
    if suffix in USD and not (bpy.app.build_options.usd and has_pxr()):
        raise ScatterError(_NO_USD)
    if suffix in GODOT and not bpy.app.build_options.io_wavefront_obj:
        raise ScatterError(_NO_OBJ)
    if suffix in GLTF and not _has_gltf():
        raise ScatterError(_NO_GLTF)


def references(
    meshes: Sequence[Sequence[bpy.types.Mesh]], target: Path, folder: Path, meters_per_unit: float
) -> list[list[Any]]:
    """Prototypes for dapple3d, in the order of each scatter's meshes, from files in a folder.

    Images of their materials are stored beside the target if its format cannot contain them; so
    meshes_beside() does with meshes.
    """
    suffix = target.suffix.lower()
    if suffix in USD:
        return [_usd(of_one, folder / f"{k}.usdc", target) for k, of_one in enumerate(meshes)]
    if suffix in GLTF:
        return [_gltf(of_one, folder / f"{k}.glb") for k, of_one in enumerate(meshes)]
    if suffix in GODOT:
        return _obj(meshes, target, folder, meters_per_unit)
    return [[] for _ in meshes]


def _usd(meshes: Sequence[bpy.types.Mesh], path: Path, target: Path) -> list[Any]:
    with _scene_of(meshes) as objects, _exporter_errors("USD"):
        bpy.ops.wm.usd_export(
            filepath=str(path),
            export_animation=False,
            root_prim_path=f"/{_ROOT}",
            relative_paths=False,
        )
        names = identifiers(_names(objects))
    made, kept = path.parent / "textures", target.with_name(f"{target.stem}_textures")
    with _beside(target, made, kept):
        if made.is_dir():
            _use_images_of(path, made, kept)
    return [reference(path, f"/{_ROOT}/{name}") for name in names]


@contextmanager
def meshes_beside(target: Path, folder: Path) -> Iterator[None]:
    """Store the meshes that references() has left in the folder once the body has succeeded.

    Their bytes are on the disk of the target before.
    """
    with _beside(target, folder / _MESHES, target.with_name(f"{target.stem}_{_MESHES}")):
        yield


@contextmanager
def _beside(target: Path, made: Path, kept: Path) -> Iterator[None]:
    """Copy the files of a folder, if it is there; they get their places after the body."""
    files = [one for one in made.iterdir() if one.is_file()] if made.is_dir() else []
    part = kept.with_name(f".{uuid4().hex}.part")
    try:
        if files:
            part.mkdir()
        for file in files:
            shutil.copyfile(file, part / file.name)
        yield
        if files:
            kept.mkdir(exist_ok=True)
        for file in files:
            (part / file.name).replace(kept / file.name)
    except OSError as error:
        why = f"for '{target.name}': {error.strerror}"
        raise ScatterError(f"'{kept}' could not be written {why}") from error
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _use_images_of(path: Path, made: Path, kept: Path) -> None:
    """Make a USD file use images from another folder."""
    sdf, utils = (importlib.import_module(f"pxr.{name}") for name in ("Sdf", "UsdUtils"))
    layer = sdf.Layer.FindOrOpen(str(path))

    def found(asset: str) -> str:
        picture = path.parent / asset
        return str(kept.absolute() / picture.name) if picture.parent == made else asset

    utils.ModifyAssetPaths(layer, found)
    layer.Save()


def _gltf(meshes: Sequence[bpy.types.Mesh], path: Path) -> list[Any]:
    with _some_window(), _scene_of(meshes) as objects, _exporter_errors("glTF"):
        bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLB", use_active_scene=True)
        return [reference(path, name) for name in _names(objects)]


def _obj(
    meshes: Sequence[Sequence[bpy.types.Mesh]], target: Path, folder: Path, meters_per_unit: float
) -> list[list[Any]]:
    """A file for each mesh, in meters with y up, with its materials."""
    made, kept = folder / _MESHES, target.with_name(f"{target.stem}_{_MESHES}")
    made.mkdir()
    found = []
    for k, of_one in enumerate(meshes):
        names = identifiers(mesh.name for mesh in of_one)
        files = [f"{k}_{number}_{name}.obj" for number, name in enumerate(names)]
        for mesh, name in zip(of_one, files, strict=True):
            _write_obj(mesh, made / name, meters_per_unit)
        found.append([reference(kept / name, "") for name in files])
    return found


def _write_obj(mesh: bpy.types.Mesh, path: Path, meters_per_unit: float) -> None:
    with _scene_of([mesh]), _exporter_errors("OBJ"):
        bpy.ops.wm.obj_export(
            filepath=str(path),
            forward_axis="NEGATIVE_Z",
            up_axis="Y",
            global_scale=meters_per_unit,
            export_triangulated_mesh=True,
            path_mode="COPY",
        )


@contextmanager
def _exporter_errors(exporter: str) -> Iterator[None]:
    """Convert an error of one of Blender's exporters to a ScatterError with its last line."""
    try:
        yield
    except RuntimeError as error:
        lines = [one for one in str(error).splitlines() if one and not one.startswith("Location:")]
        what = lines[-1] if lines else "it does not say why"
        raise ScatterError(f"Blender's {exporter} exporter failed: {what}") from error


def _names(objects: Sequence[bpy.types.Object]) -> list[str]:
    """Names of objects, as Blender may have numbered them."""
    return [obj.name for obj in objects]


@contextmanager
def _some_window() -> Iterator[None]:
    """Make a window the current one, which the glTF exporter needs; `blender --command`
    has none.
    """
    windows = bpy.context.window_manager.windows
    if bpy.context.window or not windows:
        yield
        return
    with bpy.context.temp_override(window=windows[0]):
        yield


@contextmanager
def _scene_of(meshes: Sequence[bpy.types.Mesh]) -> Iterator[list[bpy.types.Object]]:
    """A temporary scene that contains only the meshes, at its origin."""
    scene = bpy.data.scenes.new("Dapple Export")
    names = identifiers(mesh.name for mesh in meshes)
    objects = [bpy.data.objects.new(*pair) for pair in zip(names, meshes, strict=True)]
    window = bpy.context.window
    shown = window.scene if window else None
    try:
        for obj in objects:
            scene.collection.objects.link(obj)
        with bpy.context.temp_override(scene=scene, view_layer=scene.view_layers[0]):
            yield objects
    finally:
        if window:
            window.scene = shown  # glTF's exporter changes it
        for obj in objects:
            bpy.data.objects.remove(obj)
        bpy.data.scenes.remove(scene)


def has_pxr() -> bool:
    """Whether Blender's Python finds USD; in bpy the path has to be added first."""
    if importlib.util.find_spec("pxr"):
        return True
    before = list(sys.path)
    try:
        bpy.utils.expose_bundled_modules()
        importlib.import_module("pxr")  # later imports find its parts
    except ModuleNotFoundError:
        return False
    finally:
        sys.path[:] = before
    return True


def _has_gltf() -> bool:
    enabled = addon_utils.check("io_scene_gltf2")[1]
    return enabled or addon_utils.enable("io_scene_gltf2") is not None
