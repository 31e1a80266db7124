# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of test_same_bytes.py: what collects the bytes that each gives and is given."""

import hashlib
import json
from collections.abc import Callable
from typing import Any

import dapple3d as dapple
import exact
import numpy as np
from checks import ARRAYS
from shapes import Mesh

TIMES = ("seconds", "profile")
COUNTS = ("births", "deaths")  # the ids, which are recorded, determine them


class Run:
    """Collects the bytes of a case; the same name again goes on where it was."""

    def __init__(self, threads: int = 1) -> None:
        self.threads = threads
        self._hashes: dict[str, Any] = {}

    def hashes(self) -> dict[str, str]:
        return {name: found.hexdigest()[:16] for name, found in self._hashes.items()}

    def _add(self, name: str, content: bytes) -> None:
        self._hashes.setdefault(name, hashlib.sha256()).update(content)

    def keep(self, **arrays: Any) -> None:
        for name, value in arrays.items():
            array = np.ascontiguousarray(value)
            self._add(name, f"{array.dtype.str}{array.shape}".encode() + array.tobytes())

    def given(self, array: Any) -> Any:
        self.keep(inputs=array)
        return array

    def surface(self, mesh: Mesh, density: np.ndarray | None = None, **options: Any):
        for array in (*mesh, density):
            if array is not None:
                self.given(array)
        return dapple.Surface(*mesh, density, **options)

    def sample(self, surface: dapple.Surface, count: int = 300, **options: Any):
        """Samples that a case begins with."""
        samples = dapple.sample(surface, count, threads=self.threads, **options)
        self.keep(start=samples.faces)
        self.keep(start=samples.barycentric)
        return samples

    def samples(self, samples: dapple.Samples) -> None:
        self.keep(**{name: getattr(samples, name) for name in (*ARRAYS, "fade")})
        self.report(samples.report)

    def report(self, report: dapple.Report) -> None:
        figures = _told(report.to_dict())
        figures["classes"] = [_told(figure) for figure in figures["classes"]]
        self._add("report", json.dumps(figures, sort_keys=True).encode())


def _told(figures: dict[str, Any]) -> dict[str, Any]:
    """Without what other arrays tell; a thin share only where something is thin."""
    left_out = (*TIMES, *COUNTS, *(() if figures["thin_share"] else ("thin_share",)))
    return {name: value for name, value in figures.items() if name not in left_out}


Case = Callable[[Run], None]
CASES: dict[str, Case] = {}


def case(function: Case) -> Case:
    CASES[function.__name__] = function
    return function


def steps(mesh: Mesh) -> np.ndarray:
    """A density at the faces that jumps."""
    return np.where(mesh[0][mesh[1][:, 0], 0] > 0, 4.0, 1.0)


TORUS, WAVY, SPHERE, BOX = exact.torus(), exact.wavy(), exact.sphere(), exact.box()
RADII = [dapple.SampleClass(count, radius=radius) for count, radius in ((15, 0.12), (200, 0.03))]


def hashes_of(name: str, threads: int = 1) -> dict[str, str]:
    run = Run(threads)
    CASES[name](run)
    return run.hashes()
