# SPDX-License-Identifier: GPL-3.0-or-later
"""Types of Blender's objects, as far as the add-on's properties need them; all else is Any.

Written by scripts/setting_tables.py.
"""

from collections.abc import Iterator
from typing import Any, Generic, TypeVar

_Group = TypeVar("_Group")

class _Open:
    """A class whose methods are not described here."""

    bl_rna: Any
    id_data: Any
    name: str
    def __getitem__(self, key: str) -> Any: ...
    def __setitem__(self, key: str, value: Any) -> None: ...
    def __delitem__(self, key: str) -> None: ...
    def __contains__(self, key: str) -> bool: ...
    def get(self, key: str, default: Any = ...) -> Any: ...
    def keys(self) -> Any: ...
    def is_property_set(self, name: str) -> bool: ...
    def property_unset(self, name: str) -> None: ...

class _Collection(Generic[_Group]):
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[_Group]: ...
    def __getitem__(self, key: int) -> _Group: ...
    def add(self) -> _Group: ...
    def clear(self) -> None: ...
    def remove(self, index: int) -> None: ...
    def move(self, source: int, target: int) -> None: ...
    def keys(self) -> list[str]: ...

class Object(_Open):
    dapple: DAPPLE_PG_scatter
    def __getattr__(self, name: str) -> Any: ...
    def __setattr__(self, name: str, value: Any) -> None: ...

class Context:
    object: Object
    active_object: Object
    def __getattr__(self, name: str) -> Any: ...

def __getattr__(name: str) -> Any: ...

class DAPPLE_PG_material(_Open):
    material: Any

class DAPPLE_PG_report(_Open):
    count: int
    spacing: float
    alpha_min: float
    alpha_mean: float
    capacity_variation: float
    whole_count_variation: float
    thin_share: float
    doubled_faces: int
    small_parts: int
    evaluations: int
    milliseconds: float
    converged: bool
    key_error_max: float
    key_error_mean: float
    worst_overlap: float
    details: str
    overlap_first: int
    overlap_second: int
    overlap_frame: int
    overlap_between: bool
    type_overlaps: str
    measured: bool

class DAPPLE_PG_density(_Open):
    attribute: str
    blocked_areas: str
    image: Any
    image_channel: str
    uv_map: str
    curvature: float
    use_material: bool
    materials: _Collection[DAPPLE_PG_material]
    material_invert: bool
    material_strength: float
    use_slope: bool
    slope_min: float
    slope_max: float
    slope_falloff: float
    slope_invert: bool
    slope_strength: float
    use_height: bool
    height_min: float
    height_max: float
    height_falloff: float
    height_invert: bool
    height_strength: float
    use_distance: bool
    distance_object: Any
    distance_collection: Any
    ignore_height: bool
    distance_min: float
    distance_max: float
    distance_falloff: float
    distance_invert: bool
    distance_strength: float
    use_border: bool
    border_min: float
    border_max: float
    border_falloff: float
    border_invert: bool
    border_strength: float
    use_aspect: bool
    aspect_direction: float
    aspect_min: float
    aspect_max: float
    aspect_falloff: float
    aspect_invert: bool
    aspect_strength: float
    use_noise: bool
    noise_size: float
    noise_detail: int
    noise_seed: int
    noise_min: float
    noise_max: float
    noise_falloff: float
    noise_invert: bool
    noise_strength: float
    use_outside: bool
    openness: float
    outside_over_time: str
    use_camera_view: bool
    camera_margin: float
    camera_hidden: bool
    hiding_collection: Any
    avoid_collection: Any
    avoid_shape: str
    avoid_margin: float
    shown_term: str

class DAPPLE_PG_tiles(_Open):
    grout: float
    random_inset: float
    thickness: float
    color_by: str
    object: Any

class DAPPLE_PG_weight(_Open):
    object: Any
    collection: Any
    weight: float

class DAPPLE_PG_object_type(_Open):
    use_count: bool
    count: int
    weight: float
    density: str
    radius: float
    radius_from_bounds: bool
    borders: str
    instance: Any
    collection: Any
    use_weights: bool
    scale: float
    scale_x: float
    scale_y: float
    scale_z: float
    random_scale_down: float
    random_scale_up: float
    fit_to_spacing: float
    random_turn: float
    align_to_normal: float
    random_tilt: float
    lean_apart: float
    lean_along: float
    density_scale: float
    offset: float
    weights: _Collection[DAPPLE_PG_weight]

class DAPPLE_PG_part(_Open):
    object: Any
    inside: int
    instances: bool
    rest_scale: float
    rest_shift: Any

class DAPPLE_PG_parts(_Open):
    surface: Any
    entries: _Collection[DAPPLE_PG_part]

class DAPPLE_PG_joined(_Open):
    entries: _Collection[DAPPLE_PG_part]
    collection: Any
    cells: int

class DAPPLE_PG_scatter(_Open):
    surface: Any
    count: int
    amount: str
    points_per_area: float
    scatter_on: str
    edge_creases: bool
    edge_angle: float
    edge_borders: bool
    edge_seams: bool
    edge_sharp: bool
    edge_materials: bool
    edge_spacing: str
    edge_corners: bool
    align_to_edges: bool
    symmetry: str
    merge_doubled: bool
    seed: int
    capacity_weight: float
    repulsion_weight: float
    tolerance: float
    max_evaluations: int
    forward: str
    lean_object: Any
    color_attribute: str
    color_image: Any
    color_uv_map: str
    display_as: str
    viewport_share: float
    detail_in_viewport: bool
    detail_in_renders: bool
    detail_full_until: float
    detail_minimum: float
    detail_widen: float
    detail_outside_view: float
    detail_margin: float
    detail_fade: float
    stickiness: float
    keyframe_step: int
    smoothing: str
    attach_to: str
    population: str
    fade_duration: int
    masks: str
    new_topology: str
    preview_budget: int
    auto_update_mode: str
    keep_points: bool
    instance: Any
    collection: Any
    use_weights: bool
    scale: float
    scale_x: float
    scale_y: float
    scale_z: float
    random_scale_down: float
    random_scale_up: float
    fit_to_spacing: float
    random_turn: float
    align_to_normal: float
    random_tilt: float
    lean_apart: float
    lean_along: float
    density_scale: float
    offset: float
    auto_update: bool
    quality: str
    weights: _Collection[DAPPLE_PG_weight]
    object_types: _Collection[DAPPLE_PG_object_type]
    object_type_index: int
    default_count: bool
    attached_parts: int
    density: DAPPLE_PG_density
    tiles: DAPPLE_PG_tiles
    joined: DAPPLE_PG_joined
    parts: DAPPLE_PG_parts
    report: DAPPLE_PG_report
    solved: DAPPLE_PG_report
    surface_vertices: int
    locked_count: int
    baked_start: int
    bake_fingerprint: str
    baked_frozen: str
    bake_key: str
    attached_to: str
    surface_topology: str
    solved_settings: str
    solved_from: str
    solved_points: str
    baked_settings: str
    baked_from: str
    baked_frames: int
    baked_keys: int
