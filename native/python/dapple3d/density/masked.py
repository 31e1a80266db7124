# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface with a density that varies within its faces, cut finer there.

A field or a picture knows nothing of the faces of a surface. So the faces are cut before samples
are made, and samples are returned on the original faces. During a deformation the fine vertices
follow the original ones.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from .._native import (
    Context,
    Refined,
    Samples,
    Surface,
    SymmetricSamples,
    refine_edges,
    refine_image,
    refine_obstacles,
    refine_outside,
)
from .arrays import (
    Flags,
    Floats,
    Ints,
    at_corners,
    check_values,
    density_of,
    face_areas,
    longest_edges,
    placed,
    product,
    shaped,
)
from .fields import Clearance, Field, needs_cut
from .mirrored import with_exact_images
from .nearest import border_edges
from .pictures import Tile, crossing, filled_share, laid_out, reduced, repeats, texture_area

_FINE = 0.3  # longest edge where a density changes within faces, in spacings
_AT_BORDER = (
    0.05  # longest edge at the border of a UDIM tile, where a density may jump, in spacings
)
_AT_HIDDEN = 0.1  # longest edge at the border of what is hidden, in spacings
_ROUNDS = 24  # of halving edges
_MOST_FACES = 1_000_000
_COUNTS = (100, 1_000_000)  # limits of the number of points that faces are cut for
_PIXELS = 8.0  # of a picture per spacing; finer pixels are averaged
_REPEATED = 1.5  # the same for a picture that repeats often, which is fine everywhere
_SHORTEST = 0.7  # shortest edge that is cut for a picture, in spacings where it is densest
_X, _ORIGIN = np.eye(3)[0], np.zeros(3)

Poses = Sequence[Floats]


@dataclass(frozen=True)
class _Skin:
    """The part of a surface that is seen from outside."""

    surface: Surface  # in the first pose, with the same density everywhere
    openness: float
    edge: float
    poses: tuple[Floats, ...]  # the others
    refined: Refined  # of the surface; its density is 0 where that is hidden

    def fits(self, surface: Surface, openness: float, edge: float | None, poses: Poses) -> bool:
        """Whether it is what another surface would have; edges of any length fit None."""
        return (
            self.openness == openness
            and edge in (None, self.edge)
            and len(self.poses) == len(poses)
            and np.array_equal(self.surface.vertices, surface.vertices)
            and np.array_equal(self.surface.faces, surface.faces)
            and all(map(np.array_equal, self.poses, poses))
        )


class _Mesh:
    """The arrays of a surface, each made once.

    product: its density with all fields, (m, 3); None: not asked for yet.
    """

    def __init__(self, surface: Surface) -> None:
        self.surface = surface
        self.product: Floats | None = None

    @cached_property
    def vertices(self) -> Floats:
        return self.surface.vertices

    @cached_property
    def faces(self) -> Ints:
        return self.surface.faces

    @cached_property
    def areas(self) -> Floats:
        return face_areas(self.vertices, self.faces)

    @cached_property
    def longest(self) -> Floats:
        return longest_edges(self.vertices, self.faces)


@dataclass(frozen=True)
class _Cleared:
    """Values of a class that are 0 near their border."""

    values: str  # name of the values that they are without it; '' for none
    clearance: Clearance | None  # None: there is no border


class MaskedSurface:
    """A surface whose density is multiplied by fields and pictures.

    `surface` has the faces that were cut, for `dapple.sample` and others; `to_original` gives what
    they make on the faces of the surface that was masked.

    >>> masked = MaskedSurface(surface, [Height(Range(high=0.4))], count=2000)
    >>> samples = masked.to_original(dapple.sample(masked.surface, 2000))

    Args:
        surface: of v vertices and m faces; it keeps its own density as a factor.
        fields: factors of the density at each place.
        count: number of points that will be sampled: edges are cut relative to their spacing.
        outside: least exposure, 0 to 1, of places that get points, where the surface is at rest:
            see `dapple.refine_outside`; None: hidden places get points too.
        poses: of (v, 3) each, the vertices in poses of a moving surface: places get points that are
            seen in all of them; none: where it is at rest.
        balls: centers (k, 3) and radii (k,) of balls that are taken out.
        uv: (m, 3, 2), texture coordinates at the corners of the faces.
        image: (rows, columns), factors >= 0 by texture coordinates, row 0 at v = 0.
        tiles: UDIM tiles in place of the image: the number and the factors of each.
        values: more values by name, each (v,), (m, 1) or (m, 3): densities of classes.
        like: a masked surface of the same faces: if it has the same shape at rest, what is hidden
            is taken from it.
        rest: (v, 3), vertices of the surface where fields that ride on it are looked up; None:
            where they are.
        context: cancels the cutting.

    Raises:
        ValueError: an array has another shape, fields or pictures leave no density, or texture
            coordinates are in no tile.
        Cancelled
    """

    def __init__(
        self,
        surface: Surface,
        fields: Sequence[Field] = (),
        *,
        count: int,
        outside: float | None = None,
        poses: Poses = (),
        balls: tuple[Floats, Floats] | None = None,
        uv: Floats | None = None,
        image: Floats | None = None,
        tiles: Sequence[Tile] = (),
        values: Mapping[str, Floats] | None = None,
        like: "MaskedSurface | None" = None,
        rest: Floats | None = None,
        context: Context | None = None,
    ) -> None:
        if uv is not None:
            uv = shaped("uv", uv, len(surface.faces), 3, 2)
        if rest is not None:
            rest = shaped("rest", rest, len(surface.vertices), 3)
        poses = [
            shaped(f"poses[{k}]", pose, len(surface.vertices), 3) for k, pose in enumerate(poses)
        ]
        for name, own in (values or {}).items():
            check_values(f"values '{name}'", own, surface)
        self.surface, self._original, self._context = surface, surface, context
        self._values, self._rest = values or {}, rest
        self._refined: Refined | None = None
        self._mesh = _Mesh(surface)
        self._skin: _Skin | None = None
        self._cleared: dict[str, _Cleared] = {}
        self._fields = fields
        self._boundless = [field for field in fields if not field.bounds]
        self._count = count = min(max(count, _COUNTS[0]), _COUNTS[1])
        if outside is not None:
            self._leave_out_hidden(outside, poses, None if like is None else like._skin)
        if fields or balls is not None:
            self._cut_for_fields(balls)
        if image is not None and uv is not None:
            self._lay_image(image, uv, count)
        if tiles and uv is not None:
            self._lay_tiles(tiles, uv, count)
        self._mesh = _Mesh(self.surface)  # without what only cutting needs

    @property
    def original(self) -> Surface:
        """The surface with the faces that were given."""
        return self._original

    @property
    def is_cut(self) -> bool:
        """Whether `surface` has other faces than `original`."""
        return self._refined is not None

    @property
    def face_count(self) -> int:
        """Number of faces of `surface`."""
        return len(self._faces)

    @property
    def pieces(self) -> tuple[Ints, Floats]:
        """For each face of `surface` the original face (m,) that has it, and its corners (m, 3, 3)
        there in barycentric coordinates.
        """
        if self._refined is not None:
            return self._refined.parents, self._refined.barycentric
        count = len(self._faces)
        corners = np.broadcast_to(np.eye(3), (count, 3, 3))
        return np.arange(count, dtype=np.int32), corners

    def to_original(self, samples: Samples, vertices: Floats | None = None) -> Samples:
        """Samples of `surface`, on the faces of `original`: the same ids, classes and report.

        Args:
            samples: of `surface`, or of it with the vertices that a deformation moved.
            vertices: (v, 3), those of `original` in that deformation; None: where they are.
        """
        if self._refined is None:
            return samples
        moved = self._refined if vertices is None else self._refined.deformed(vertices)
        return moved.to_original(samples)

    def pairs_to_original(
        self, pairs: SymmetricSamples, normal: Floats = _X, point: Floats = _ORIGIN
    ) -> Samples:
        """Samples of `dapple.sample_symmetric`, on the faces of `original`: pairs stay exact.

        `to_original` moves samples at the border of the density inward, each along its own face, so
        that images differ where faces do. Here an image follows the first of its pair. The samples
        keep their ids and have no report.

        Args:
            pairs: of `surface`.
            normal: (3,), of the plane of symmetry.
            point: (3,), on it.
        """
        alone = self.to_original(pairs.samples)
        return with_exact_images(pairs, alone, self.original, np.asarray(normal), np.asarray(point))

    def from_original(self, samples: Samples) -> Samples:
        """Samples of `original`, on the faces of `surface`."""
        return samples if self._refined is None else self._refined.from_original(samples)

    def vertices(self, original: Floats) -> Floats:
        """Vertices of `surface` once those of `original` are at (v, 3)."""
        return original if self._refined is None else self._refined.vertices(original)

    @property
    def own_density(self) -> Floats:
        """Density (m, 3) of `original` at the corners of its faces, without fields and pictures."""
        return at_corners(density_of(self._original), self._original.faces)

    def corner_density(self, name: str = "") -> Floats:
        """Density (m, 3) at the corners of the faces of `surface`, times the values of that name;
        1 where it is the same everywhere.
        """
        own, common = self._values_of(name), density_of(self.surface)
        if common is not None:
            own.append(common)
        faces = self._faces
        return at_corners(product(own, faces) if own else None, faces)

    def class_density(self, name: str) -> dict[str, Any]:
        """Options of a `dapple.SampleClass` for the density times the values of that name; those of
        a class without a density for ''.
        """
        own, common = self._values_of(name), density_of(self.surface)
        if not own:
            return {}
        terms = own if common is None else [*own, common]
        values, place = placed(product(terms, self._faces))
        return {"density": values, "density_at": place}

    def clear_borders(self, wanted: Mapping[str, tuple[str, float]]) -> None:
        """Add values for classes whose discs stay inside the border.

        They are values by name, or 1, that are 0 nearer to their border than a distance: no point
        of a class with this density and a radius of that distance sticks out. The border is that of
        the surface, and of the places where fields, pictures and values leave no density; the frame
        of a camera is none. Distances are straight, and those of the surface at rest. Faces are cut
        where the values change.

        >>> masked = MaskedSurface(surface, count=2000)
        >>> masked.clear_borders({"trees": ("", 0.3)})
        >>> trees = dapple.SampleClass(50, radius=0.3, **masked.class_density("trees"))

        Args:
            wanted: for each new name the name of values, '' for none, and a distance > 0.

        Raises:
            ValueError: a name has values already, there are no values of a name, or a distance is
                not > 0.
            Cancelled
        """
        for name, (values, distance) in wanted.items():
            self._check_clearance(name, values, distance)
            border = self._border(values)
            clearance = Clearance(border, distance) if len(border) else None
            self._cleared[name] = _Cleared(values, clearance)
            if clearance is not None:
                self._cut_at(clearance)

    def cleared_share(self, name: str) -> float:
        """Share, 0 to 1, of the capacity that values of `clear_borders` leave of theirs."""
        a, b, c = (self.surface.vertices[self._faces[:, k]] for k in range(3))
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        before, after = (
            float((areas * self.corner_density(one).mean(axis=1)).sum())
            for one in (self._cleared[name].values, name)
        )
        return after / before if before > 0.0 else 0.0

    def density_at(self, samples: Samples) -> Floats:
        """Density (n,) at samples of `surface`; 1 where it is the same everywhere."""
        density, at = density_of(self.surface), samples.faces
        if density is None:
            return np.ones(len(samples))
        values = density[at] if density.ndim == 2 else density[self._faces[at]]
        found: Floats = np.einsum(
            "nk,nk->n", samples.barycentric, np.broadcast_to(values, (len(at), 3))
        )
        return found

    @property
    def _known(self) -> "_Mesh":
        """What `surface` makes anew whenever it is asked."""
        if self._mesh.surface is not self.surface:
            self._mesh = _Mesh(self.surface)
        return self._mesh

    @property
    def _faces(self) -> Ints:
        return self._known.faces

    def _values_of(self, name: str) -> list[Floats]:
        """The factors of the density that a name stands for; none for ''."""
        found, cleared = [], self._cleared.get(name)
        if cleared is not None:
            name = cleared.values
            if cleared.clearance is not None:
                places = self._places([cleared.clearance])[0]
                found.append(cleared.clearance.at_corners(places, self._faces))
        return [*found, self._carried(self._values[name])] if name else found

    def _check_clearance(self, name: str, values: str, distance: float) -> None:
        if name in self._values or name in self._cleared or not name:
            raise ValueError(f"clear_borders '{name}': another name is needed")
        if values and values not in self._values:
            raise ValueError(f"clear_borders '{name}': there are no values '{values}'")
        if not 0.0 < distance < np.inf:
            raise ValueError(
                f"clear_borders '{name}': the distance is {distance}: it must be finite and "
                "greater than 0"
            )

    def _border(self, name: str) -> Floats:
        """Edges (k, 2, 3), at rest, around the faces on which values leave a density."""
        surface = self.surface
        left = self.corner_density(name).max(axis=1) > 0.0
        for field, points in zip(self._boundless, self._places(self._boundless), strict=True):
            left |= field.at_corners(points, self._faces).max(axis=1) == 0.0
        vertices = surface.vertices if self._rest is None else self.vertices(self._rest)
        return border_edges(vertices, self._faces[left])

    def _cut_at(self, clearance: Clearance) -> None:
        """Halve the edges of the faces on which a clearance ends, until they are short."""
        target = _FINE * self._spacing(self.corner_density(), self._count)

        def long(lengths: Floats) -> Flags:
            places = self._places([clearance])
            return needs_cut([clearance], places, self._faces, lengths, target)

        self._halve(long)

    def _carried(self, values: Floats) -> Floats:
        """Values of the original surface, as they are on the faces of the fine one."""
        if self._refined is None:
            return values
        if values.ndim == 2:
            parents, corners = self.pieces
            own = values[parents]
            return own if own.shape[1] == 1 else np.einsum("mkc,mc->mk", corners, own)
        return self._refined.vertices(np.repeat(values[:, None], 3, axis=1))[:, 0]

    def _extend(self, cut: Refined) -> None:
        self._refined = cut if self._refined is None else self._refined.then(cut)
        self.surface = self._refined.surface

    def _leave_out_hidden(self, openness: float, poses: Poses, known: _Skin | None) -> None:
        """Remove the density of places that are hidden in the poses, or at rest."""
        edge = _AT_HIDDEN * self._spacing(self.corner_density(), self._count)
        first = poses[0] if poses else self._rest
        if poses and np.array_equal(poses[0], self.surface.vertices):
            first = None
        begin = self.surface if first is None else self.surface.deformed(first)
        # In a deformation the spacing differs on each frame, and finding the skin anew takes long.
        if known is None or not known.fits(
            begin, openness, edge if first is None else None, poses[1:]
        ):
            known = self._skin_of(begin.with_density(None), openness, edge, poses[1:])
        self._skin, moved = known, first is not None
        self._extend(known.refined.deformed(self.surface.vertices) if moved else known.refined)
        if density_of(self._original) is not None:
            own = self._carried(self.own_density)
            shaped = self.surface.with_density(own * self.corner_density(), density_at="corners")
            self._extend(refine_edges(shaped, np.inf))

    def _skin_of(self, surface: Surface, openness: float, edge: float, poses: Poses) -> _Skin:
        refined = refine_outside(
            surface,
            edge,
            openness=openness,
            max_faces=_MOST_FACES,
            poses=poses,
            context=self._context,
        )
        return _Skin(surface, openness, edge, tuple(poses), refined)

    def _cut_for_fields(self, balls: tuple[Floats, Floats] | None) -> None:
        """Halve the edges of the faces on which fields change, until they are short."""

        def long(lengths: Floats) -> Flags:
            target = _FINE * self._spacing(self._product(), self._count)
            places = self._places(self._fields)
            return needs_cut(self._fields, places, self._faces, lengths, target)

        self._halve(long)
        self._take_away(balls or (np.empty((0, 3)), np.empty(0)))

    def _halve(self, long: Callable[[Floats], Flags]) -> None:
        """Halve the edges of faces, until by their longest edges (m,) none is too long."""
        for _ in range(_ROUNDS):
            lengths = self._known.longest
            chosen = long(lengths)
            if not chosen.any():
                break
            limits = np.where(chosen, 0.51 * lengths, np.inf)
            cut = refine_edges(self.surface, limits, max_faces=_MOST_FACES, context=self._context)
            self._extend(cut)
            if not cut.resolved:
                break

    def _take_away(self, balls: tuple[Floats, Floats]) -> None:
        areas = self._blocked()
        surface = self.surface.with_density(self._product(), density_at="corners")
        self._extend(
            refine_obstacles(
                surface,
                *balls,
                areas=areas,
                max_faces=4 * _MOST_FACES,
                context=self._context,
            )
        )

    def _blocked(self) -> Flags:
        """Faces (m,) that reach where fields are 0 that block."""
        found = np.zeros(len(self._faces), dtype=bool)
        for field in self._fields:
            if field.blocks:
                found |= field.reach(self._known.vertices, self._faces)
        return found

    def _product(self) -> Floats:
        """The density (m, 3) at the corners of the faces as they are cut so far, with fields."""
        known = self._known
        if known.product is None:
            factors = np.ones((len(known.faces), 3))
            for field, points in zip(self._fields, self._places(self._fields), strict=True):
                factors = factors * field.at_corners(points, known.faces)
            known.product = factors * self.corner_density()
        return known.product

    def _spacing(self, density: Floats, count: int) -> float:
        """Of so many points, packed as well as can be on what a density (m, 3) leaves."""
        has_some = density[:, 0] + density[:, 1] + density[:, 2] > 0.0
        left = float((self._known.areas * has_some).sum())
        return float(np.sqrt(2.0 * left / (np.sqrt(3.0) * count)))

    def _places(self, fields: Sequence[Field]) -> list[Floats]:
        """Vertices (v, 3) as they are cut so far, where each of the fields is looked up."""
        now = self._known.vertices
        if self._rest is None or not any(field.rides for field in fields):
            return [now] * len(fields)
        rest = self.vertices(self._rest)
        return [rest if field.rides else now for field in fields]

    def _cut_uv(self, uv: Floats) -> Floats:
        """Texture coordinates of the faces as they are cut so far, of those of the original."""
        if self._refined is None:
            return uv
        found: Floats = np.einsum(
            "fkc,fcd->fkd", self._refined.barycentric, uv[self._refined.parents]
        )
        return found

    def _lay_tiles(self, tiles: Sequence[Tile], uv: Floats, count: int) -> None:
        self._cut_at_borders(tiles, uv, count)
        most = int(_PIXELS * np.sqrt(count))
        small = [(number, reduced(picture, most)) for number, picture in tiles]
        picture, places = laid_out(self._cut_uv(uv), small)
        share = min(filled_share(one) for _, one in tiles)
        self._lay(places, picture, count, share)

    def _cut_at_borders(self, tiles: Sequence[Tile], uv: Floats, count: int) -> None:
        """Halve the edges of the faces that reach over a tile's border, until they are short."""
        target = _AT_BORDER * self._spacing(self.corner_density(), count)
        self._halve(lambda lengths: crossing(self._cut_uv(uv), tiles) & (lengths > target))

    def _lay_image(self, image: Floats, uv: Floats, count: int) -> None:
        uv = self._cut_uv(uv)
        times, share = max(texture_area(uv), 1.0), filled_share(image)
        least = min(_REPEATED / float(np.sqrt(times * share)), _PIXELS)
        most = max(_PIXELS / times, least) * np.sqrt(count)
        self._lay(uv, reduced(image, max(int(most), 1)), count, share, repeat=repeats(uv))

    def _lay(
        self, uv: Floats, picture: Floats, count: int, share: float, *, repeat: bool = False
    ) -> None:
        """Multiply by a picture; edges shorter than its details' share of a spacing stay whole."""
        spacing = self._spacing(self.corner_density(), count)
        self._extend(
            refine_image(
                self.surface,
                uv,
                picture,
                repeat=repeat,
                shortest=_SHORTEST * float(np.sqrt(share)) * spacing,
                max_faces=2 * _MOST_FACES,
                context=self._context,
            )
        )
