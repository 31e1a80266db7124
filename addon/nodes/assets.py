# SPDX-License-Identifier: GPL-3.0-or-later
"""The node groups that are useful alone, behind other nodes, and their descriptions as assets."""

from collections.abc import Iterable
from dataclasses import dataclass

import bpy

from .bound_place import BOUND_POINT
from .builder import Group, ensure
from .detail import DETAIL, VIEWPORT
from .instances import INSTANCES
from .points import POINTS
from .rest_place import REST_POINT
from .scatter import GROUP_NAME, ensure_group

CATALOG = "f8f09e78-8d7a-4b5c-9bdd-e3485973ed0f"  # as in assets/blender_assets.cats.txt
AUTHOR = "Dapple developers"
LICENSE = "CC0-1.0"  # license of the groups, as they become part of other people's files


@dataclass(frozen=True)
class Asset:
    """A group and its description; without a part it is the whole, for one object type."""

    description: str
    tags: tuple[str, ...]
    part: Group | None = None

    @property
    def name(self) -> str:
        """Name of the node group."""
        return self.part.name if self.part else GROUP_NAME

    def build(self) -> bpy.types.NodeTree:
        """The group in the open file; built if necessary."""
        return ensure(self.part) if self.part else ensure_group()


ASSETS = (
    Asset(
        "Plays the points of a scatter on its surface and instances an object, or the objects "
        "of a collection, on them",
        ("scatter", "instances", "blue noise"),
    ),
    Asset(
        "Plays the points of a scatter on its surface: positions, and the attributes rotation, "
        "scale and fade",
        ("scatter", "points", "blue noise"),
        POINTS,
    ),
    Asset(
        "Instances an object, or random objects of a collection, on points, which may carry "
        "rotation, scale, fade and dapple_object_type",
        ("instances",),
        INSTANCES,
    ),
    Asset(
        "Hides a fraction of a scatter's points in the viewport; the others stay even",
        ("points", "viewport"),
        VIEWPORT,
    ),
    Asset(
        "Shows fewer of a scatter's points far from the camera and outside its view; the others "
        "stay even",
        ("points", "camera", "level of detail"),
        DETAIL,
    ),
    Asset(
        "Position and rotation of a place in a triangle of a surface, as it is now",
        ("surface", "position", "rotation"),
        BOUND_POINT,
    ),
    Asset(
        "Position and rotation of a place of a surface's rest_position, as the surface is now",
        ("surface", "position", "rotation"),
        REST_POINT,
    ),
)


def mark(asset: Asset) -> bpy.types.NodeTree:
    """The group, marked as an asset of the catalog Dapple."""
    group = asset.build()
    group.asset_mark()
    data = group.asset_data
    data.description, data.author, data.license = asset.description, AUTHOR, LICENSE
    data.catalog_id = CATALOG
    for tag in asset.tags:
        data.tags.new(tag, skip_if_exists=True)
    return group


def write(path: str, more: Iterable[bpy.types.ID] = ()) -> None:
    """Write all assets with their inner groups, and more data-blocks, to a .blend."""
    groups = {mark(asset) for asset in ASSETS}
    bpy.data.libraries.write(path, {*groups, *more}, fake_user=True)
