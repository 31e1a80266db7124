# SPDX-License-Identifier: GPL-3.0-or-later
import os
from collections.abc import Iterable, Sequence
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
_verbs: tuple[str, ...]

class SurfaceError(ValueError): ...
class Cancelled(RuntimeError): ...
class FileError(OSError): ...

class Context:
    def __init__(self) -> None: ...
    def part(self, start: float, end: float) -> Context: ...
    def advance(self, progress: float) -> None: ...
    def check(self) -> None: ...
    def cancel(self) -> None: ...
    @property
    def cancelled(self) -> bool: ...
    @property
    def progress(self) -> float: ...

class Option:
    @property
    def name(self) -> str: ...
    @property
    def type(self) -> Literal["float", "int", "bool", "str"]: ...
    @property
    def default(self) -> Any: ...
    @property
    def min(self) -> Any: ...
    @property
    def max(self) -> Any: ...
    @property
    def open(self) -> bool: ...
    @property
    def choices(self) -> list[str]: ...
    @property
    def range(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def documentation(self) -> str: ...
    @property
    def changes_solution(self) -> bool: ...
    @property
    def level(self) -> Literal["basic", "expert"]: ...

def option_table(verb: str) -> list[Option]: ...

class Topology:
    @property
    def components(self) -> int: ...
    @property
    def border_edges(self) -> int: ...
    @property
    def border_loops(self) -> int: ...
    @property
    def nonmanifold_edges(self) -> int: ...
    @property
    def manifold(self) -> bool: ...
    @property
    def closed(self) -> bool: ...
    @property
    def genus(self) -> int: ...

class Surface:
    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        density: ArrayLike | None = None,
        *,
        density_at: Literal["vertices", "faces", "corners"] = "vertices",
        weld: float | None = 1e-06,
        normals: ArrayLike | None = None,
        sharp_angle: float = 30.0,
        merge_doubled: bool = True,
        context: Context | None = None,
    ) -> None: ...
    @property
    def weld(self) -> float | None: ...
    @property
    def sharp_angle(self) -> float: ...
    @property
    def doubled_faces(self) -> int: ...
    @property
    def merge_doubled(self) -> bool: ...
    @property
    def corner_normals(self) -> NDArray[np.float64]: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.int32]: ...
    @property
    def density(self) -> NDArray[np.float64] | None: ...
    @property
    def density_at(self) -> Literal["vertices", "faces", "corners"]: ...
    @property
    def area(self) -> float: ...
    @property
    def capacity(self) -> float: ...
    @property
    def topology(self) -> Topology: ...
    @property
    def islands(self) -> NDArray[np.int32]: ...
    def spacing(self, count: int) -> float: ...
    def count(self, spacing: float) -> int: ...
    def deformed(
        self,
        vertices: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        context: Context | None = None,
    ) -> Surface: ...
    def with_density(
        self,
        density: ArrayLike | None,
        *,
        density_at: Literal["vertices", "faces", "corners"] = "vertices",
        context: Context | None = None,
    ) -> Surface: ...

class Quality:
    @property
    def count(self) -> int: ...
    @property
    def spacing(self) -> float: ...
    @property
    def alpha_min(self) -> float: ...
    @property
    def alpha_mean(self) -> float: ...
    @property
    def capacity_variation(self) -> float: ...
    @property
    def bond_order(self) -> float: ...
    @property
    def energy(self) -> float: ...
    @property
    def whole_count_variation(self) -> float: ...
    @property
    def thin_share(self) -> float: ...

class Report(Quality):
    @property
    def classes(self) -> list[Quality]: ...
    @property
    def worst_overlap(self) -> float: ...
    @property
    def overlapping(self) -> tuple[int, int]: ...
    @property
    def evaluations(self) -> int: ...
    @property
    def iterations(self) -> int: ...
    @property
    def parts(self) -> int: ...
    @property
    def converged(self) -> bool: ...
    @property
    def seconds(self) -> float: ...
    @property
    def profile(self) -> dict[str, float]: ...
    @property
    def energies(self) -> list[float]: ...
    @property
    def slide_mean(self) -> float: ...
    @property
    def slide_median(self) -> float: ...
    @property
    def slide_max(self) -> float: ...
    @property
    def births(self) -> int: ...
    @property
    def deaths(self) -> int: ...
    def to_dict(self) -> dict[str, Any]: ...

class Samples:
    def __init__(
        self,
        surface: Surface,
        faces: ArrayLike,
        barycentric: ArrayLike,
        *,
        ids: ArrayLike | None = None,
        classes: ArrayLike | None = None,
    ) -> None: ...
    def __len__(self) -> int: ...
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def normals(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.int32]: ...
    @property
    def barycentric(self) -> NDArray[np.float64]: ...
    @property
    def ids(self) -> NDArray[np.int32]: ...
    @property
    def classes(self) -> NDArray[np.int32]: ...
    @property
    def fade(self) -> NDArray[np.float64]: ...
    @property
    def report(self) -> Report: ...

class Mosaic:
    def __len__(self) -> int: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def corners(self) -> NDArray[np.int32]: ...
    @property
    def starts(self) -> NDArray[np.int32]: ...
    @property
    def sites(self) -> NDArray[np.int32]: ...
    @property
    def classes(self) -> NDArray[np.int32]: ...
    @property
    def faces(self) -> NDArray[np.int32]: ...
    @property
    def sides(self) -> NDArray[np.int32]: ...
    @property
    def cell_areas(self) -> NDArray[np.float64]: ...
    @property
    def areas(self) -> NDArray[np.float64]: ...
    @property
    def parts(self) -> NDArray[np.int32]: ...
    @property
    def empty(self) -> int: ...
    @property
    def loops(self) -> NDArray[np.int32]: ...

class LineSamples:
    def __len__(self) -> int: ...
    @property
    def samples(self) -> Samples: ...
    @property
    def tangents(self) -> NDArray[np.float64]: ...
    @property
    def lines(self) -> NDArray[np.int32]: ...
    @property
    def lengths(self) -> NDArray[np.float64]: ...

class SymmetricSamples:
    def __len__(self) -> int: ...
    @property
    def samples(self) -> Samples: ...
    @property
    def mirror(self) -> NDArray[np.int32]: ...
    @property
    def mirror_error(self) -> float: ...

class RemeshReport:
    @property
    def asked(self) -> int: ...
    @property
    def vertices(self) -> int: ...
    @property
    def faces(self) -> int: ...
    @property
    def on_lines(self) -> int: ...
    @property
    def corners(self) -> int: ...
    @property
    def dropped_lines(self) -> int: ...
    @property
    def smallest_angle(self) -> float: ...
    @property
    def mean_smallest_angle(self) -> float: ...
    @property
    def below_30(self) -> float: ...
    @property
    def valence_6(self) -> float: ...
    @property
    def flipped(self) -> int: ...
    @property
    def self_intersecting(self) -> int: ...
    @property
    def nonmanifold_edges(self) -> int: ...
    @property
    def euler(self) -> int: ...
    @property
    def border_loops(self) -> int: ...
    @property
    def flaws(self) -> int: ...
    @property
    def distance(self) -> float: ...
    @property
    def evaluations(self) -> int: ...
    @property
    def converged(self) -> bool: ...
    @property
    def seconds(self) -> float: ...
    @property
    def profile(self) -> dict[str, float]: ...
    def to_dict(self) -> dict[str, Any]: ...

class NextRemesh:
    @property
    def mesh(self) -> RemeshResult: ...
    @property
    def previous(self) -> NDArray[np.int32]: ...
    @property
    def kept(self) -> int: ...

class RemeshResult:
    def __len__(self) -> int: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.int32]: ...
    @property
    def source_faces(self) -> NDArray[np.int32]: ...
    @property
    def barycentric(self) -> NDArray[np.float64]: ...
    @property
    def features(self) -> NDArray[np.int32]: ...
    @property
    def lines(self) -> NDArray[np.int32]: ...
    @property
    def density(self) -> NDArray[np.float64] | None: ...
    @property
    def report(self) -> RemeshReport: ...

class Texels:
    @property
    def faces(self) -> NDArray[np.int32]: ...
    @property
    def barycentric(self) -> NDArray[np.float64]: ...

class SampleClass:
    def __init__(
        self,
        count: int,
        *,
        density: ArrayLike | None = None,
        density_at: Literal["vertices", "faces", "corners"] = "vertices",
        radius: float = 0.0,
        locked: Samples | None = None,
    ) -> None: ...
    @property
    def count(self) -> int: ...
    @property
    def density(self) -> ArrayLike | None: ...
    @property
    def density_at(self) -> str: ...
    @property
    def radius(self) -> float: ...
    @property
    def locked(self) -> Samples | None: ...

class Refined:
    @property
    def original(self) -> Surface: ...
    @property
    def surface(self) -> Surface: ...
    @property
    def parents(self) -> NDArray[np.int32]: ...
    @property
    def barycentric(self) -> NDArray[np.float64]: ...
    @property
    def resolved(self) -> bool: ...
    def to_original(self, samples: Samples) -> Samples: ...
    def from_original(self, samples: Samples) -> Samples: ...
    def vertices(self, vertices: ArrayLike) -> NDArray[np.float64]: ...
    def deformed(self, vertices: ArrayLike) -> Refined: ...
    def then(self, finer: Refined) -> Refined: ...

class FlatDomain:
    @property
    def area(self) -> float: ...
    @property
    def capacity(self) -> float: ...
    def spacing(self, count: int) -> float: ...

class Plane(FlatDomain):
    def __init__(self, width: float, height: float, density: ArrayLike | None = None) -> None: ...
    @staticmethod
    def polygon(outline: ArrayLike, holes: Sequence[ArrayLike] = ()) -> Plane: ...
    @property
    def surface(self) -> Surface: ...

class Torus(FlatDomain):
    def __init__(self, density: ArrayLike | None = None) -> None: ...

class PlanarSamples:
    def __len__(self) -> int: ...
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def classes(self) -> NDArray[np.int32]: ...
    @property
    def report(self) -> Report: ...

class Energy:
    @property
    def total(self) -> float: ...
    @property
    def cvt(self) -> float: ...
    @property
    def capacity_term(self) -> float: ...
    @property
    def normalized(self) -> float: ...
    @property
    def capacities(self) -> NDArray[np.float64]: ...
    @property
    def masses(self) -> NDArray[np.float64]: ...
    @property
    def areas(self) -> NDArray[np.float64]: ...
    @property
    def gradient(self) -> NDArray[np.float64]: ...

class RadialStatistics:
    @property
    def radius(self) -> NDArray[np.float64]: ...
    @property
    def mean(self) -> NDArray[np.float64]: ...
    @property
    def anisotropy(self) -> NDArray[np.float64]: ...

class Spectrum:
    @property
    def runs(self) -> int: ...
    @property
    def half_width(self) -> int: ...
    @property
    def periodogram(self) -> NDArray[np.float64]: ...
    @property
    def radial(self) -> RadialStatistics: ...
    @property
    def frequency_unit(self) -> float: ...

class SurfaceSpectrum:
    @property
    def runs(self) -> int: ...
    @property
    def centers(self) -> int: ...
    @property
    def radius(self) -> float: ...
    @property
    def bins(self) -> int: ...
    @property
    def differentials(self) -> NDArray[np.float64]: ...
    @property
    def radial_differentials(self) -> RadialStatistics: ...
    @property
    def half_width(self) -> int: ...
    @property
    def power(self) -> NDArray[np.float64]: ...
    @property
    def radial_power(self) -> RadialStatistics: ...
    @property
    def frequency_step(self) -> float: ...

class Projection:
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.int32]: ...
    @property
    def barycentric(self) -> NDArray[np.float64]: ...
    @property
    def distances(self) -> NDArray[np.float64]: ...

class Tracker:
    def __init__(
        self,
        surface: Surface,
        samples: Samples,
        *,
        union_weight: float = 1.0,
        capacity_weight: float = 30.0,
        repulsion_weight: float = 3.0,
        tolerance: float = 5e-05,
        max_evaluations: int = 6,
        max_slide: float = 0.45,
        stickiness: float = 0.0,
        slide_smoothing: float = 0.0,
        method: Literal["trust_region", "line_search"] = "trust_region",
        pattern_strength: float = 0.8,
        longest_motion: float = 0.02,
        cells: Literal["connected", "euclidean"] = "connected",
        threads: int = 0,
        classes: Sequence[SampleClass | int] | None = None,
        context: Context | None = None,
    ) -> None: ...
    def advance(self, vertices: ArrayLike, *, context: Context | None = None) -> Samples: ...
    def resume(self, vertices: ArrayLike, samples: Samples, *, settled: bool = False) -> None: ...
    def resume_on(
        self,
        surface: Surface,
        vertices: ArrayLike,
        samples: Samples,
        first: Samples,
        *,
        classes: Sequence[SampleClass | int] | None = None,
        anywhere: bool = False,
        context: Context | None = None,
    ) -> None: ...
    @property
    def settled(self) -> bool: ...
    @property
    def surface(self) -> Surface: ...
    @property
    def samples(self) -> Samples: ...

class WindowTracker:
    def __init__(
        self,
        surface: Surface,
        samples: Samples,
        *,
        closed: bool = False,
        sweeps: int = 2,
        union_weight: float = 1.0,
        capacity_weight: float = 30.0,
        repulsion_weight: float = 3.0,
        tolerance: float = 5e-05,
        max_evaluations: int = 6,
        max_slide: float = 0.45,
        stickiness: float = 1.0,
        slide_smoothing: float = 0.0,
        method: Literal["trust_region", "line_search"] = "trust_region",
        pattern_strength: float = 0.8,
        longest_motion: float = 0.02,
        cells: Literal["connected", "euclidean"] = "connected",
        threads: int = 0,
        classes: Sequence[SampleClass | int] | None = None,
        context: Context | None = None,
    ) -> None: ...
    def advance(
        self, frames: Iterable[ArrayLike], done: int, *, context: Context | None = None
    ) -> list[Samples]: ...
    def resume(self, vertices: ArrayLike, samples: Samples, ahead: Sequence[Samples]) -> None: ...
    @property
    def surface(self) -> Surface: ...
    @property
    def samples(self) -> Samples: ...
    @property
    def ahead(self) -> list[Samples]: ...

class Population:
    def __init__(
        self,
        surface: Surface,
        samples: Samples,
        *,
        fade: int = 12,
        reach: float = 1.0,
        union_weight: float = 1.0,
        capacity_weight: float = 30.0,
        repulsion_weight: float = 3.0,
        tolerance: float = 5e-05,
        max_evaluations: int = 6,
        max_slide: float = 0.45,
        stickiness: float = 0.0,
        slide_smoothing: float = 0.0,
        method: Literal["trust_region", "line_search"] = "trust_region",
        pattern_strength: float = 0.8,
        longest_motion: float = 0.02,
        cells: Literal["connected", "euclidean"] = "connected",
        threads: int = 0,
        classes: Sequence[SampleClass | int] | None = None,
        context: Context | None = None,
    ) -> None: ...
    def advance(
        self,
        vertices: ArrayLike | Surface,
        faces: ArrayLike | None = None,
        *,
        context: Context | None = None,
    ) -> Samples: ...
    def resume(self, surface: Surface, samples: Samples, state: dict[str, Any]) -> None: ...
    @property
    def state(self) -> dict[str, Any]: ...
    @property
    def surface(self) -> Surface: ...
    @property
    def samples(self) -> Samples: ...

def track_window(
    surface: Surface,
    samples: Samples,
    frames: Iterable[ArrayLike],
    *,
    closed: bool = False,
    sweeps: int = 2,
    union_weight: float = 1.0,
    capacity_weight: float = 30.0,
    repulsion_weight: float = 3.0,
    tolerance: float = 5e-05,
    max_evaluations: int = 6,
    max_slide: float = 0.45,
    stickiness: float = 1.0,
    slide_smoothing: float = 0.0,
    method: Literal["trust_region", "line_search"] = "trust_region",
    pattern_strength: float = 0.8,
    longest_motion: float = 0.02,
    cells: Literal["connected", "euclidean"] = "connected",
    threads: int = 0,
    classes: Sequence[SampleClass | int] | None = None,
    context: Context | None = None,
) -> list[Samples]: ...
@overload
def sample(
    surface: Surface,
    count: int,
    *,
    seed: int = 0,
    capacity_weight: float = 30.0,
    repulsion_weight: float = 3.0,
    tolerance: float = 5e-05,
    max_evaluations: int = 200,
    method: Literal["trust_region", "line_search"] = "trust_region",
    start: Literal["poisson", "random"] = "poisson",
    cells: Literal["connected", "euclidean"] = "connected",
    threads: int = 0,
    locked: Samples | None = None,
    context: Context | None = None,
) -> Samples: ...
@overload
def sample(
    domain: FlatDomain,
    count: int,
    *,
    seed: int = 0,
    capacity_weight: float = 30.0,
    repulsion_weight: float = 3.0,
    tolerance: float = 5e-05,
    max_evaluations: int = 200,
    method: Literal["trust_region", "line_search"] = "trust_region",
    start: Literal["poisson", "random"] = "poisson",
    cells: Literal["connected", "euclidean"] = "connected",
    threads: int = 0,
    context: Context | None = None,
) -> PlanarSamples: ...
def resample(
    surface: Surface,
    samples: Samples,
    count: int,
    *,
    seed: int = 0,
    capacity_weight: float = 30.0,
    repulsion_weight: float = 3.0,
    tolerance: float = 5e-05,
    max_evaluations: int = 200,
    method: Literal["trust_region", "line_search"] = "trust_region",
    cells: Literal["connected", "euclidean"] = "connected",
    threads: int = 0,
    locked: ArrayLike | None = None,
    context: Context | None = None,
) -> Samples: ...
def relax(
    surface: Surface,
    samples: Samples,
    changed: ArrayLike,
    *,
    seed: int = 0,
    union_weight: float = 1.0,
    free_counts: bool = False,
    capacity_weight: float = 30.0,
    repulsion_weight: float = 3.0,
    tolerance: float = 5e-05,
    max_evaluations: int = 200,
    method: Literal["trust_region", "line_search"] = "trust_region",
    threads: int = 0,
    classes: Sequence[SampleClass | int] | None = None,
    count: int | None = None,
    locked: ArrayLike | None = None,
    context: Context | None = None,
) -> Samples: ...
def changed_faces(before: Surface, after: Surface) -> NDArray[np.int32]: ...
@overload
def evaluate_energy(
    surface: Surface,
    positions: ArrayLike,
    faces: ArrayLike,
    *,
    capacity_weight: float = 30.0,
    cells: Literal["connected", "euclidean"] = "connected",
    context: Context | None = None,
) -> Energy: ...
@overload
def evaluate_energy(
    domain: FlatDomain,
    positions: ArrayLike,
    *,
    capacity_weight: float = 30.0,
    cells: Literal["connected", "euclidean"] = "connected",
) -> Energy: ...
def texels(
    surface: Surface,
    uv: ArrayLike,
    rows: int,
    columns: int,
    *,
    margin: int = 4,
    context: Context | None = None,
) -> Texels: ...
def decal_cover(
    surface: Surface,
    samples: Samples,
    radii: ArrayLike,
    tangents: ArrayLike,
    texels: Texels,
    *,
    context: Context | None = None,
) -> tuple[NDArray[np.int32], NDArray[np.float64]]: ...
def mosaic(
    surface: Surface,
    samples: Samples,
    *,
    grout: float = 0.0,
    thickness: float = 0.0,
    shortest_edge: float = 0.001,
    merge: bool = True,
    cells: Literal["connected", "euclidean"] = "connected",
    threads: int = 0,
    insets: ArrayLike | None = None,
    context: Context | None = None,
) -> Mosaic: ...
def sample_symmetric(
    surface: Surface,
    count: int,
    *,
    seed: int = 0,
    capacity_weight: float = 30.0,
    repulsion_weight: float = 3.0,
    tolerance: float = 5e-05,
    max_evaluations: int = 200,
    method: Literal["trust_region", "line_search"] = "trust_region",
    start: Literal["poisson", "random"] = "poisson",
    cells: Literal["connected", "euclidean"] = "connected",
    threads: int = 0,
    max_mirror_error: float = 0.01,
    normal: ArrayLike = (1, 0, 0),
    point: ArrayLike = (0, 0, 0),
    context: Context | None = None,
) -> SymmetricSamples: ...
def sample_lines(
    surface: Surface,
    count: int,
    *,
    seed: int = 0,
    feature_angle: float = 30.0,
    line_spacing: Literal["even", "natural"] = "even",
    borders: bool = True,
    corners: bool = False,
    edges: ArrayLike | None = None,
    context: Context | None = None,
) -> LineSamples: ...
def remesh(
    surface: Surface,
    count: int,
    *,
    seed: int = 0,
    feature_angle: float = 30.0,
    max_distance: float = 0.0,
    adaptive: bool = False,
    non_manifold: Literal["kept", "cut"] = "kept",
    capacity_weight: float = 0.3,
    repulsion_weight: float = 0.0,
    tolerance: float = 0.0005,
    max_evaluations: int = 80,
    method: Literal["trust_region", "line_search"] = "trust_region",
    cells: Literal["connected", "euclidean"] = "connected",
    threads: int = 0,
    edges: ArrayLike | None = None,
    context: Context | None = None,
) -> RemeshResult: ...
def remesh_next(
    before: Surface,
    mesh: RemeshResult,
    surface: Surface,
    capacity: float,
    *,
    seed: int = 0,
    feature_angle: float = 30.0,
    max_distance: float = 0.0,
    capacity_weight: float = 0.3,
    repulsion_weight: float = 0.0,
    tolerance: float = 0.0005,
    max_evaluations: int = 80,
    method: Literal["trust_region", "line_search"] = "trust_region",
    cells: Literal["connected", "euclidean"] = "connected",
    threads: int = 0,
    edges: ArrayLike | None = None,
    context: Context | None = None,
) -> NextRemesh: ...
def analyze(
    surface: Surface,
    samples: Samples | ArrayLike,
    *,
    capacity_weight: float = 30.0,
    cells: Literal["connected", "euclidean"] = "connected",
    context: Context | None = None,
) -> Report: ...
def spectrum(
    runs: ArrayLike | Sequence[ArrayLike],
    *,
    half_width: int = 0,
    threads: int = 0,
    context: Context | None = None,
) -> Spectrum: ...
def surface_spectrum(
    surface: Surface,
    runs: Samples | ArrayLike | Sequence[Samples | ArrayLike],
    *,
    radius: float = 5.0,
    bins: int = 128,
    threads: int = 0,
    context: Context | None = None,
) -> SurfaceSpectrum: ...
def refine_edges(
    surface: Surface,
    longest: float | ArrayLike,
    *,
    max_faces: int = 1_000_000,
    context: Context | None = None,
) -> Refined: ...
def away_from_neighbors(points: ArrayLike) -> NDArray[np.float64]: ...
def nearest_distances(points: ArrayLike) -> NDArray[np.float64]: ...
def progressive_ranks(
    points: ArrayLike, classes: ArrayLike | None = None, *, context: Context | None = None
) -> NDArray[np.int32]: ...
def refine_image(
    surface: Surface,
    uv: ArrayLike,
    image: ArrayLike,
    *,
    repeat: bool = False,
    max_error: float = 0.02,
    texels: float = 1.0,
    shortest: float = 0.0,
    max_faces: int = 1000000,
    context: Context | None = None,
) -> Refined: ...
def refine_obstacles(
    surface: Surface,
    points: ArrayLike,
    radii: ArrayLike,
    *,
    areas: ArrayLike | None = None,
    edge: float = 0.125,
    max_faces: int = 1_000_000,
    context: Context | None = None,
) -> Refined: ...
def exposure(
    surface: Surface,
    faces: ArrayLike | None = None,
    barycentric: ArrayLike | None = None,
    *,
    context: Context | None = None,
) -> NDArray[np.float64]: ...
def seen_from(
    surface: Surface, eye: ArrayLike, points: ArrayLike, *, context: Context | None = None
) -> NDArray[np.bool_]: ...
def reached_by_solids(
    vertices: ArrayLike,
    faces: ArrayLike,
    points: ArrayLike,
    counts: ArrayLike,
    *,
    margin: float = 0.0,
    context: Context | None = None,
) -> NDArray[np.uint8]: ...
def touching_solids(
    points: ArrayLike, counts: ArrayLike, *, margin: float = 0.0, context: Context | None = None
) -> NDArray[np.int32]: ...
def refine_outside(
    surface: Surface,
    edge: float,
    *,
    openness: float = 0.05,
    max_faces: int = 1_000_000,
    poses: Sequence[ArrayLike] = (),
    context: Context | None = None,
) -> Refined: ...
def curvedness(
    surface: Surface, *, smoothing: int = 2, context: Context | None = None
) -> NDArray[np.float64]: ...
def curvature_density(
    surface: Surface,
    *,
    exponent: float = 1.0,
    floor: float = 0.1,
    percentile: float = 95.0,
    smoothing: int = 2,
    context: Context | None = None,
) -> NDArray[np.float64]: ...
def project(surface: Surface, points: ArrayLike) -> Projection: ...
def _paper_options() -> dict[str, Any]: ...
def _read_mesh(path: str | os.PathLike[str], may_be_empty: bool) -> dict[str, Any]: ...
def _longest_edges(vertices: ArrayLike, faces: ArrayLike) -> NDArray[np.float64]: ...
def _face_areas(vertices: ArrayLike, faces: ArrayLike) -> NDArray[np.float64]: ...
def _read_vertex_columns(path: str | os.PathLike[str]) -> dict[str, NDArray[np.float64]]: ...
def write_mesh(path: str | os.PathLike[str], vertices: ArrayLike, faces: ArrayLike) -> None: ...
@overload
def sample_classes(
    surface: Surface,
    classes: Sequence[SampleClass | int],
    *,
    union_weight: float = 1.0,
    two_stages: bool = False,
    seed: int = 0,
    capacity_weight: float = 30.0,
    repulsion_weight: float = 5.0,
    tolerance: float = 1e-05,
    max_evaluations: int = 200,
    method: Literal["trust_region", "line_search"] = "trust_region",
    start: Literal["poisson", "random"] = "poisson",
    cells: Literal["connected", "euclidean"] = "connected",
    threads: int = 0,
    context: Context | None = None,
) -> Samples: ...
@overload
def sample_classes(
    domain: FlatDomain,
    classes: Sequence[SampleClass | int],
    *,
    union_weight: float = 1.0,
    two_stages: bool = False,
    seed: int = 0,
    capacity_weight: float = 30.0,
    repulsion_weight: float = 5.0,
    tolerance: float = 1e-05,
    max_evaluations: int = 200,
    method: Literal["trust_region", "line_search"] = "trust_region",
    start: Literal["poisson", "random"] = "poisson",
    cells: Literal["connected", "euclidean"] = "connected",
    threads: int = 0,
    context: Context | None = None,
) -> PlanarSamples: ...

class Stipples:
    def __len__(self) -> int: ...
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def classes(self) -> NDArray[np.int32]: ...
    @property
    def radius(self) -> float: ...
    @property
    def report(self) -> Report: ...

def separate_inks(channels: ArrayLike) -> NDArray[np.float64]: ...
def mix_inks(inks: ArrayLike) -> NDArray[np.float64]: ...
def stipple_inks(
    inks: ArrayLike,
    count: int,
    *,
    radius: float = 0.0,
    seed: int = 0,
    union_weight: float = 1.0,
    capacity_weight: float = 30.0,
    repulsion_weight: float = 3.0,
    tolerance: float = 0.0002,
    max_evaluations: int = 200,
    threads: int = 0,
    counts: Sequence[int] = [],
    context: Context | None = None,
) -> Stipples: ...
