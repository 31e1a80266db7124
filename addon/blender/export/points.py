# SPDX-License-Identifier: GPL-3.0-or-later
"""Export of scatters: instances of one or several frames, with the instanced meshes."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy

from ...core.export import SceneInfo, check_path, skewed, write
from ..scatter.shown_instances import Collector, as_rendered
from ..surface.reading import frame_kept
from .prototypes import check_installed, meshes_beside, references


@dataclass(frozen=True)
class Written:
    """The result of an export.

    files: written files.

    instances: number of instances of all scatters on the first frame.

    skewed: number of instances that were written without their skew, which files cannot store.

    left_out: names of objects that are not meshes.
    """

    files: list[Path]
    instances: int
    skewed: int
    left_out: list[str]


def export_points(
    path: str | Path, scatters: Sequence[bpy.types.Object], frames: Sequence[int] = ()
) -> Written:
    """Write the instances of scatters, as renders show them, to a file for other programs.

    Args:
        path: ends with .usd, .usda, .usdc, .glb, .gltf, .tscn, .csv or .npz. Tables hold one
            scatter: several get a file each, whose names have that of the scatter before the
            ending.
        scatters: objects that Dapple has made, in the scene.
        frames: numbers of frames with the same step; none are the one that the scene shows.

    Raises:
        ScatterError: it names what cannot be exported, and why.
    """
    target, scene = Path(path), bpy.context.scene
    check_path(target, len(frames))
    check_installed(target.suffix.lower())
    times = [float(frame) for frame in frames] or [float(scene.frame_current)]
    scene_info = SceneInfo(
        times, scene.render.fps / scene.render.fps_base, scene.unit_settings.scale_length
    )
    collector = Collector(scatters)
    try:
        with as_rendered(scatters), frame_kept(scene):
            for frame in frames or [scene.frame_current]:
                if frames:
                    scene.frame_set(frame)
                collector.read()
        collector.check()
        return _written(target, collector, scene_info)
    finally:
        collector.free()


def _written(target: Path, collector: Collector, scene_info: SceneInfo) -> Written:
    exported = collector.exported
    with tempfile.TemporaryDirectory() as folder:
        found = references(collector.meshes, target, Path(folder), scene_info.meters_per_unit)
        for one, prototypes in zip(exported, found, strict=True):
            one.prototypes = prototypes
        with meshes_beside(target, Path(folder)):
            files = write(target, exported, scene_info)
    count = sum(len(one.frames[0].ids) for one in exported)
    return Written(files, count, skewed(exported), sorted(collector.left_out))
