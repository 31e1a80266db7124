# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks at random over the whole package, on odd surfaces, that judge each step.

`python tests/python/walks.py SEED` repeats one and prints its steps.
"""

import sys
import traceback
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import dapple3d as dapple
import nasty
import numpy as np
from checks import check_samples, is_on_density, same_bytes
from numpy.typing import NDArray
from shapes import Mesh, grid, torus

SAME = 1e-6  # relative tolerance of figures that are equal up to rounding
MOST_FACES = 300
STEPS = 6
MOST_GROWTH = 3.0

# Errors that are acceptable although the input is plain; all others are failures.
REFUSALS = (
    "density is 0 wherever",
    "no area",
    "of which stay: they are locked",
    "locked: the count includes them",
    "are possible",  # the surface grew too much
    "distance squared is not finite",
    "energy is not finite",
)


@dataclass
class Walk:
    """What is there: a surface, samples of it and which of these are locked."""

    seed: int
    steps: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.random = np.random.default_rng([self.seed, 20])
        self.surface = self.new_surface()
        self.samples = dapple.sample(self.surface, self.count(), seed=self.seed)
        self.locked: set[int] = set()

    # ---- random inputs ----

    def note(self, text: str) -> None:
        self.steps.append(text)

    def chance(self, share: float) -> bool:
        return bool(self.random.random() < share)

    def count(self) -> int:
        return int(self.random.choice([1, 2, 5, 12, 30, 60]))

    def new_mesh(self) -> Mesh:
        kind = int(self.random.integers(6))
        if kind == 0:
            mesh = torus(int(self.random.integers(4, 14)), int(self.random.integers(3, 9)))
        elif kind == 1:
            vertices, faces = grid(int(self.random.integers(2, 9)))
            below = vertices - [0, 0, 10.0 ** self.random.integers(-4, 0)]
            plate = np.vstack([faces, faces[:, ::-1] + len(vertices)])
            mesh = np.vstack([vertices, below]), plate
        elif kind == 2:
            mesh = grid(int(self.random.integers(1, 12)))
        else:
            build = nasty.FAMILIES[self.random.integers(len(nasty.FAMILIES))]
            mesh = build(self.random, int(self.random.integers(1, 7)))
            self.note(f"mesh {build.__name__}")
        vertices, faces = mesh
        if self.chance(0.2):
            again = faces[self.random.random(len(faces)) < 0.5]
            faces = np.vstack([faces, again[:, ::-1]])
        return np.asarray(vertices, float), np.asarray(faces[:MOST_FACES], np.int32)

    def values(self, mesh: Mesh) -> tuple[np.ndarray | None, str]:
        """A density; in half of the cases with zeros: scattered, half of all, an island, a hole."""
        where = str(self.random.choice(["none", "vertices", "faces", "corners"]))
        if where == "none":
            return None, "vertices"
        vertices, faces = mesh
        places = vertices if where == "vertices" else vertices[faces].mean(axis=1)
        values = self.random.uniform(0.2, 1, len(places)) ** self.random.choice([0, 1, 4])
        if self.chance(0.5):
            values[self.zeros(places)] = 0.0
        if not values.any():
            values[self.random.integers(len(values))] = 1.0
        if where == "corners":
            values = np.repeat(values[:, None], 3, axis=1)
            values[self.random.random(values.shape) < self.random.choice([0, 0.3])] = 0.0
        return values * 10.0 ** self.random.integers(-3, 4), where

    def zeros(self, places: np.ndarray) -> NDArray[np.bool_]:
        middle = places[self.random.integers(len(places))]
        away = np.linalg.norm(places - middle, axis=1)
        reach = self.random.uniform(0.1, 0.9) * max(float(away.max()), 1e-300)
        kind = int(self.random.integers(4))
        if kind == 0:
            return self.random.random(len(places)) < self.random.choice([0.1, 0.5, 0.9])
        if kind == 1:
            return (places - middle) @ self.random.normal(size=3) > 0
        return away < reach if kind == 2 else away > reach

    def new_surface(self) -> dapple.Surface:
        while True:
            mesh = self.new_mesh()
            values, where = self.values(mesh)
            options = {
                "merge_doubled": self.chance(0.7),
                "weld": None if self.chance(0.2) else 1e-6,
            }
            try:
                surface = dapple.Surface(*mesh, values, density_at=where, **options)
            except dapple.SurfaceError:
                continue
            self.note(f"surface of {len(mesh[1])} faces, density at {where}, {options}")
            return surface

    def other_density(self) -> dapple.Surface:
        mesh = self.surface.vertices, self.surface.faces
        while True:
            values, where = self.values(mesh)
            if values is None:
                values, where = np.ones(len(mesh[0])), "vertices"
            try:
                other = self.surface.with_density(values, density_at=where)
            except dapple.SurfaceError:
                continue
            return self.scaled(other)

    def scaled(self, other: dapple.Surface) -> dapple.Surface:
        """With a density that asks for about as many samples as this one's."""
        values = np.ones(len(other.vertices)) if other.density is None else other.density
        share = self.random.uniform(0.5, 1.5) * self.surface.capacity / other.capacity
        return other.with_density(values * share, density_at=other.density_at)

    def moved(self, most: float = 0.2) -> np.ndarray:
        """A later frame, whose surface does not ask for many times as many samples."""
        vertices = self.drawn_frame(most)
        grown = self.surface.deformed(vertices).capacity > MOST_GROWTH * self.surface.capacity
        return self.surface.vertices if grown else vertices

    def drawn_frame(self, most: float) -> np.ndarray:
        vertices = self.surface.vertices.copy()
        size = np.ptp(vertices, axis=0).max()
        kind = int(self.random.integers(4))
        if kind == 0:
            return vertices * self.random.uniform(1 - most, 1 + most, 3)
        if kind == 1:
            bent = most * np.sin(3 * vertices[:, 0] / size + self.random.uniform(0, 6))
            return vertices + bent[:, None] * size * [0, 0.3, 0.3]
        if kind == 2:
            return vertices + self.random.normal(0, 0.01 * size, vertices.shape)
        return vertices

    def rows(self) -> NDArray[np.int32]:
        return np.flatnonzero(np.isin(self.samples.ids, list(self.locked))).astype(np.int32)

    def places(self) -> dapple.Samples:
        rows = self.rows()
        return dapple.Samples(
            self.surface, self.samples.faces[rows], self.samples.barycentric[rows]
        )

    # ---- steps ----

    def run(self) -> None:
        self.check_all(self.samples, locked=())
        for _ in range(STEPS):
            step = STEPS_TO_TAKE[self.random.integers(len(STEPS_TO_TAKE))]
            try:
                step(self)
            except ValueError as error:
                if not any(words in str(error) for words in REFUSALS):
                    raise
                self.note(f"  refused: {error}")

    def take_new_samples(self) -> None:
        locked = self.places() if self.chance(0.5) else None
        held = 0 if locked is None else len(locked)
        count = held + self.count()
        start = str(self.random.choice(["poisson", "random"]))
        self.note(f"sample {count}, {held} locked, start {start}")
        found = self.on_threads(
            lambda threads: dapple.sample(
                self.surface, count, locked=locked, start=start, seed=self.seed, threads=threads
            )
        )
        assert len(found) == count
        if locked is not None:
            assert np.array_equal(found.positions[:held], locked.positions), "locked moved"
        self.samples, self.locked = found, set(found.ids[:held].tolist())
        self.check_all(found, self.locked)
        self.check_report(found)

    def relax(self) -> None:
        before, surface = self.samples, self.surface
        if self.chance(0.7):
            surface = self.other_density()
            changed = dapple.changed_faces(self.surface, surface)
        else:
            share = self.random.uniform(0, 1)
            changed = np.flatnonzero(self.random.random(len(surface.faces)) < share)
        kind = int(self.random.integers(3))
        count = [None, len(before), self.count()][kind]
        rows = self.rows()
        self.note(f"relax {len(before)} -> {count}, {len(changed)} changed, {len(rows)} locked")
        if len(np.unique(before.classes)) > 1:
            return
        found = self.on_threads(
            lambda threads: dapple.relax(
                surface, before, changed, count=count, locked=rows, threads=threads
            )
        )
        if count is not None:
            assert len(found) == count
        self.check_kept(before, found)
        self.surface, self.samples = surface, found
        self.check_all(found, self.locked)
        if len(changed) == len(surface.faces) and len(found):
            self.check_report(found)

    def resample(self) -> None:
        before = self.samples
        surface = self.other_density() if self.chance(0.5) else self.surface
        if self.chance(0.3):
            surface = surface.deformed(self.moved())
        rows = self.rows()
        count = max(self.count(), len(rows)) if self.chance(0.9) else self.count()
        self.note(f"resample {len(before)} -> {count}, {len(rows)} locked")
        found = self.on_threads(
            lambda threads: dapple.resample(surface, before, count, locked=rows, threads=threads)
        )
        assert len(found) == count
        self.check_kept(before, found, moved=surface.vertices is not self.surface.vertices)
        self.surface, self.samples = surface, found
        self.check_all(found, self.locked)
        if len(found):
            self.check_report(found)

    def lock(self) -> None:
        share = self.random.choice([0.0, 0.1, 0.5, 1.0])
        ids = self.samples.ids[self.random.random(len(self.samples)) < share]
        self.locked = set(ids.tolist())
        self.note(f"lock {len(ids)}")

    def advance(self) -> None:
        frames = [self.moved() for _ in range(2)]
        self.note("advance 2 frames")
        self.locked = set()

        def tracked(threads: int) -> dapple.Samples:
            tracker = dapple.Tracker(self.surface, self.samples, threads=threads)
            for frame in frames[:1]:
                tracker.advance(frame)
            state = tracker.samples, tracker.settled
            tracker.advance(frames[1])
            resumed = dapple.Tracker(self.surface, self.samples, threads=threads)
            resumed.resume(frames[0], state[0], settled=state[1])
            assert same_bytes(resumed.advance(frames[1]), tracker.samples), "resumed to others"
            self.after = tracker.surface
            return tracker.samples

        found = self.on_threads(tracked)
        assert np.array_equal(found.ids, self.samples.ids), "ids changed"
        self.surface, self.samples = self.after, found
        self.check_all(found, ())

    def populate(self) -> None:
        if len(np.unique(self.samples.classes)) > 1 or not len(self.samples):
            return
        frames: list[np.ndarray | dapple.Surface] = [self.moved(0.4)]
        other = self.chance(0.5)
        if other:
            faces = self.surface.faces[: max(1, 2 * len(self.surface.faces) // 3)]
            frames.append(self.scaled(dapple.Surface(self.moved(), faces)))
        self.note(f"population{', of other faces then' if other else ''}")
        self.locked = set()

        def populated(threads: int) -> dapple.Samples:
            begun = dapple.Population(self.surface, self.samples, threads=threads)
            population = dapple.Population(self.surface, self.samples, threads=threads)
            for frame in frames:
                resumed = dapple.Population(begun.surface, self.samples, threads=threads)
                resumed.resume(population.surface, population.samples, population.state)
                assert states_equal(resumed.state, population.state), "another state"
                before = population.samples
                after = population.advance(frame)
                assert same_bytes(resumed.advance(frame), after), "resumed to others"
                known = np.isin(after.ids, before.ids)
                there = ~known | (after.fade == 1)
                assert is_on_density(population.surface, after)[there].all(), "density 0"
            self.after = population.surface
            return population.samples

        found = self.on_threads(populated)
        self.surface = self.after
        check_samples(self.surface, self.bound(found, found.fade >= 0))
        self.samples = self.bound(found, found.fade == 1)
        assert found.report.count >= len(self.samples)

    def bound(self, samples: dapple.Samples, rows: NDArray[np.bool_]) -> dapple.Samples:
        places = samples.faces[rows], samples.barycentric[rows]
        return dapple.Samples(self.surface, *places, ids=samples.ids[rows])

    def window(self) -> None:
        frames = [self.moved() for _ in range(2)]
        self.note("window of 2 frames")
        self.locked = set()
        found = dapple.track_window(self.surface, self.samples, frames, threads=1)
        again = dapple.track_window(self.surface, self.samples, frames, threads=2)
        assert len(found) == 3
        assert all(same_bytes(a, b) for a, b in zip(found, again, strict=True)), "threads"
        for frame, samples in zip(frames, found[1:], strict=True):
            assert np.array_equal(samples.ids, self.samples.ids), "ids changed"
            surface = self.surface.deformed(frame)
            check_samples(surface, samples)
            assert is_on_density(surface, samples).all(), "density 0"

    def classes(self) -> None:
        mesh = self.surface.vertices, self.surface.faces
        classes, surfaces = [], []
        for _ in range(int(self.random.integers(1, 4))):
            values, where = self.values(mesh) if self.chance(0.5) else (None, "vertices")
            try:
                own = (
                    self.surface
                    if values is None
                    else self.surface.with_density(values, density_at=where)
                )
            except dapple.SurfaceError:
                own, values = self.surface, None
            count = int(self.random.choice([0, 1, 5, 20]))
            classes.append(dapple.SampleClass(count, density=values, density_at=where))
            surfaces.append(own)
        self.note(f"classes of {[one.count for one in classes]}")
        found = self.on_threads(
            lambda threads: dapple.sample_classes(self.surface, classes, threads=threads)
        )
        check_samples(self.surface, found)
        for number, (one, own) in enumerate(zip(classes, surfaces, strict=True)):
            rows = found.classes == number
            assert rows.sum() == one.count
            assert is_on_density(own, found)[rows].all(), f"class {number} where it has no density"
        if len(found) and self.chance(0.5) and all(own is self.surface for own in surfaces):
            self.samples, self.locked = found, set()

    def change_topology(self) -> None:
        self.surface = self.new_surface()
        self.samples = dapple.sample(self.surface, self.count(), seed=self.seed)
        self.locked = set()
        self.check_all(self.samples, ())

    def look(self) -> None:
        self.note("mosaic, analyze, energy")
        mosaic = dapple.mosaic(self.surface, self.samples)
        assert np.isfinite(mosaic.vertices).all()
        report = dapple.analyze(self.surface, self.samples)
        energy = dapple.evaluate_energy(self.surface, self.samples.positions, self.samples.faces)
        density = self.surface.density
        # analyze() leaves out faces without density that are far from all samples, and components
        # without any, so its energy is complete only if there are none of either.
        whole = self.surface.topology.components == 1
        if len(self.samples) and whole and (density is None or density.all()):
            assert np.isclose(report.energy, energy.normalized, rtol=SAME, atol=SAME)

    # ---- checks ----

    def on_threads(self, verb: Callable[[int], dapple.Samples]) -> dapple.Samples:
        one, two = verb(1), verb(2)
        assert same_bytes(one, two), "two threads differ"
        return one

    def check_all(self, samples: dapple.Samples, locked: Iterable[int]) -> None:
        check_samples(self.surface, samples)
        assert np.isfinite(samples.positions).all()
        unlocked = ~np.isin(samples.ids, list(locked))
        assert is_on_density(self.surface, samples)[unlocked].all(), "unlocked on density 0"
        if samples.report.converged and len(samples):
            cells = dapple.evaluate_energy(
                self.surface, samples.positions, samples.faces
            ).capacities
            assert (cells[unlocked] > 0).all(), "converged with an empty cell"

    def check_kept(
        self, before: dapple.Samples, after: dapple.Samples, moved: bool = False
    ) -> None:
        """Ids: those that stay come first in their order, new ones follow; locked ones stay."""
        stays = np.isin(after.ids, before.ids)
        assert not (np.diff(stays.astype(int)) > 0).any(), "new ones are not last"
        order = np.searchsorted(np.sort(before.ids), after.ids[stays])
        places = np.argsort(before.ids)[order]
        assert (np.diff(places) > 0).all(), "out of order"
        if len(before) and not stays.all():
            assert after.ids[~stays].min() > before.ids.max(), "an id came back"
        for one in self.locked & set(before.ids.tolist()):
            old, new = np.flatnonzero(before.ids == one), np.flatnonzero(after.ids == one)
            assert len(new) == 1, f"locked {one} has gone"
            same = ("faces", "barycentric") if moved else ("faces", "barycentric", "positions")
            for name in same:
                one_row, other = getattr(before, name)[old[0]], getattr(after, name)[new[0]]
                assert np.array_equal(one_row, other), f"locked {one} has moved: {name}"

    def check_report(self, samples: dapple.Samples) -> None:
        report = dapple.analyze(self.surface, samples)
        for name in ("count", "capacity_variation", "alpha_min", "energy"):
            told, found = getattr(samples.report, name), getattr(report, name)
            assert np.isclose(told, found, rtol=1e-5, atol=SAME), f"{name}: {told}, not {found}"


def states_equal(one: object, other: object) -> bool:
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(states_equal(one[k], other[k]) for k in one)
    if isinstance(one, dapple.Samples) and isinstance(other, dapple.Samples):
        return same_bytes(one, other)
    return bool(np.array_equal(np.asarray(one), np.asarray(other)))


STEPS_TO_TAKE = (
    *(Walk.take_new_samples, Walk.relax, Walk.relax, Walk.relax, Walk.resample, Walk.resample),
    *(Walk.lock, Walk.lock, Walk.advance, Walk.populate, Walk.window, Walk.classes),
    *(Walk.change_topology, Walk.look),
)


def fault_of(seed: int) -> str | None:
    """What went wrong on a walk, and what repeats it."""
    walk = None
    try:
        walk = Walk.__new__(Walk)
        walk.seed, walk.steps = seed, []
        walk.__post_init__()
        walk.run()
    except Exception:
        steps = "\n".join(walk.steps) if walk else ""
        said = traceback.format_exc(limit=-3)
        return f"walk {seed} (python tests/python/walks.py {seed}):\n{steps}\n{said}"
    return None


if __name__ == "__main__":
    for argument in sys.argv[1:]:
        first, _, last = argument.partition("-")
        for number in range(int(first), int(last or first) + 1):
            print(fault_of(number) or f"walk {number} is fine", flush=True)
