# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of Godot 4: instances as MultiMeshInstance3D nodes, for this game engine.

>>> from dapple3d import instances
>>> from dapple3d.extras import godot
>>> godot.write("points.tscn", instances.of_samples(samples))

A scene is text, in meters with y up, that refers to meshes in other files. Its numbers have 32
bits. https://docs.godotengine.org/en/stable/engine_details/file_formats/tscn.html, and
RenderingServer.multimesh_set_buffer() there for the order of the numbers.
"""

import json
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from .._native import write_mesh
from ..instances import Instances, Mesh, Reference, Scatter, Up
from ..writing import naming, replacing
from ._spaces import check_space, matrices_of, single, single_frame, standing, with_y_up

__all__ = ["MESHES", "SUFFIXES", "write", "write_scatters"]

SUFFIXES: Final = (".tscn",)
"""Suffix of the files that write() knows."""
MESHES: Final = (".obj", ".res", ".tres", ".mesh")
"""Suffixes of the files that Godot loads as one mesh; those of glTF it loads as scenes."""

PROJECT: Final = "res://"  # how paths in a project of Godot begin
NAME = re.compile(r"[A-Za-z0-9_]+")
ROOT = "dapple"
SEGMENTS, RINGS = 16, 8  # of a ball


def write(
    path: str | os.PathLike[str],
    instances: Instances,
    *,
    up: Up = "Z",
    meters_per_unit: float = 1.0,
    prototypes: Sequence[Reference | Mesh] = (),
    name: str = "points",
) -> None:
    """Write instances as a scene with a MultiMeshInstance3D for each prototype.

    The order of the instances of a prototype is kept; their ids are the node's metadata `ids`.
    Velocities, normals and classes that differ from prototypes are not written.

    Args:
        path: ends with one of SUFFIXES.
        instances: of one time.
        up: the axis that points up; it becomes y, as in Godot.
        meters_per_unit: length of a unit of the positions and of each Mesh.
        prototypes: the prototypes of classes 0, 1, ..., or those that the instances refer to. A
            Reference is a file that ends with one of MESHES, of which the scene holds the path
            from its own folder, or a path "res://..." of the Godot project; it is not rotated or
            scaled. A Mesh is written as .obj into a folder beside the scene, trees_meshes for
            trees.tscn. Empty: a small ball for each class.
        name: of the node above all others of these instances: letters, digits and _.

    Raises:
        ValueError: an argument is wrong; it names the first offender.
        OSError: naming the file.
    """
    scatter = Scatter(name, [instances], prototypes)
    write_scatters(path, [scatter], up=up, meters_per_unit=meters_per_unit)


def write_scatters(
    path: str | os.PathLike[str],
    scatters: Sequence[Scatter],
    *,
    up: Up = "Z",
    meters_per_unit: float = 1.0,
) -> None:
    """Write several scatters into one scene, below a node for each; see write().

    Raises:
        ValueError: an argument is wrong, or a scatter has several frames.
        OSError: naming the file.
    """
    target = Path(path)
    if target.suffix.lower() not in SUFFIXES:
        raise ValueError(f"{target}: a scene of Godot ends with {', '.join(SUFFIXES)}")
    check_space(up, meters_per_unit)
    _check_names([scatter.name for scatter in scatters])
    scene = _Scene(target, up, meters_per_unit)
    for scatter in scatters:
        scene.add(scatter)
    content = scene.text().encode()
    scene.write_meshes()
    with replacing(target) as file:
        file.write(content)


def _check_names(names: Sequence[str]) -> None:
    for k, name in enumerate(names):
        if not NAME.fullmatch(name):
            raise ValueError(f"name is {name!r}: letters, digits and _ are needed")
        if name in names[:k]:
            raise ValueError(f"name is {name!r}, which another scatter has too")


@dataclass
class _Scene:
    """Sections of a scene that is being written."""

    target: Path
    up: Up
    factor: float  # meters per unit
    external: dict[str, str] = field(default_factory=dict)  # ids of files by their paths
    internal: list[str] = field(default_factory=list)
    nodes: list[str] = field(default_factory=list)
    meshes: dict[Path, Mesh] = field(default_factory=dict)  # files to be written

    def add(self, scatter: Scatter) -> None:
        found = single_frame(scatter, "a scene of Godot")
        moved = standing(found, self.up, self.factor)
        self.nodes.append(_section("node", name=scatter.name, type="Node3D", parent="."))
        ball = "" if scatter.prototypes else self._ball(scatter)
        for k in scatter.used.tolist() if len(found) else ():
            mesh = ball or self._prototype(scatter.prototypes[k], f"{scatter.name}_{k}")
            self._add_instances(f"{scatter.name}_{k}", scatter.name, moved, found.placed == k, mesh)

    def _add_instances(
        self, name: str, parent: str, found: Instances, which: NDArray, mesh: str
    ) -> None:
        values = {
            "transform_format": "1",  # of 3D; Godot needs it first, then the count
            "instance_count": str(int(which.sum())),
            "mesh": mesh,
            "buffer": _packed("PackedFloat32Array", _rows(found)[which]),
        }
        self.internal.append(_section("sub_resource", values, type="MultiMesh", id=name))
        values = {"multimesh": f'SubResource("{name}")'}
        if found.ids is not None:
            values["metadata/ids"] = _packed("PackedInt64Array", found.ids[which])
        node = {"name": name, "type": "MultiMeshInstance3D", "parent": parent}
        self.nodes.append(_section("node", values, **node))

    def _ball(self, scatter: Scatter) -> str:
        """A reference to a sphere that is part of the scene."""
        radius = single("radius", np.array([scatter.radius * self.factor]))[0]
        values = {
            "radius": str(radius),
            "height": str(radius + radius),
            "radial_segments": str(SEGMENTS),
            "rings": str(RINGS),
        }
        name = f"{scatter.name}_ball"
        self.internal.append(_section("sub_resource", values, type="SphereMesh", id=name))
        return f'SubResource("{name}")'

    def _prototype(self, shape: Reference | Mesh, name: str) -> str:
        """A reference to a file."""
        if isinstance(shape, Mesh):
            place = f"{self.target.stem}_meshes/{name}.obj"
            self.meshes[self.target.parent / place] = shape
        else:
            place = _place(shape, self.target)
        number = self.external.setdefault(place, f"mesh_{len(self.external)}")
        return f'ExtResource("{number}")'

    def text(self) -> str:
        """The sections in the order that Godot needs."""
        steps = len(self.external) + len(self.internal) + 1
        external = [
            _section("ext_resource", type="Mesh", path=path, id=number)
            for path, number in self.external.items()
        ]
        root = _section("node", name=ROOT, type="Node3D")
        head = f"[gd_scene load_steps={steps} format=3]\n"
        return "\n".join([head, *external, *self.internal, root, *self.nodes])

    def write_meshes(self) -> None:
        """The files of all meshes, in meters with y up."""
        for path, mesh in self.meshes.items():
            with naming(path.parent):
                path.parent.mkdir(exist_ok=True)
            vertices = mesh.vertices * self.factor
            if self.up == "Z":
                vertices = with_y_up(vertices)
            write_mesh(path, single("vertices", vertices), mesh.faces)


def _place(reference: Reference, target: Path) -> str:
    """The path of a mesh as the scene holds it."""
    path = Path(reference.path)
    if path.suffix.lower() not in MESHES:
        raise ValueError(f"{path}: Godot loads meshes from {', '.join(MESHES)}")
    if reference.prim:
        raise ValueError(f"{path}: is one mesh, so it has no {reference.prim!r}")
    place, root = path.as_posix(), PROJECT.removesuffix("/")  # a Path keeps one of two slashes
    if place.startswith(root):
        place = PROJECT + place.removeprefix(root)
    else:
        place = Path(os.path.relpath(path.resolve(), target.resolve().parent)).as_posix()
    try:
        place.encode()
    except UnicodeEncodeError as error:
        raise ValueError(f"{place!r}: a scene of Godot is Unicode, this path is not") from error
    return place


def _section(kind: str, values: dict[str, str] | None = None, **keys: str) -> str:
    heading = "".join(f" {key}={json.dumps(one, ensure_ascii=False)}" for key, one in keys.items())
    lines = "".join(f"{key} = {one}\n" for key, one in (values or {}).items())
    return f"[{kind}{heading}]\n{lines}"


def _packed(kind: str, values: NDArray) -> str:
    """Shortest decimal numbers that are the same in the type of the values."""
    return f"{kind}({', '.join(values.ravel().astype(np.str_).tolist())})"


def _rows(found: Instances) -> NDArray[np.float32]:
    """The rows of the matrices, (n, 3, 4): axes as columns, then the position."""
    rows = matrices_of(found.positions, found.orientations, found.scales)[:, :3]
    return single("scales", rows) + np.float32(0.0)  # no negative zeros
