# SPDX-License-Identifier: GPL-3.0-or-later
"""Dapple and other packages remesh the same meshes: a Markdown table."""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import dapple3d as dapple
import numpy as np

from benchmarks.remesh.measure import Figures, euler_of, figures
from benchmarks.remesh.sequences import table
from benchmarks.remesh.worker import CONTENDERS, OF_PEERS, may_run

MESHES = Path(__file__).resolve().parents[3] / "shared/data/meshes"
COUNTS = {
    "bunny": 10_000,
    "fandisk": 3_000,
    "crank": 6_000,
    "camelhead": 4_000,
    "lilium": 3_000,
    "truck": 4_000,
}
LIMIT = 300  # seconds for one
HEAD = (
    "| mesh | package | seconds | vertices | non-manifold edges | Euler characteristic | "
    "smallest angle | mean | below 30 degrees | valence 6 | distance |\n" + "|---" * 11 + "|"
)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benchmarks/remesh/run.sh", description=__doc__)
    parser.add_argument("--only", nargs="+", choices=[*CONTENDERS], help="these packages")
    parser.add_argument("--mesh", nargs=2, metavar=("FILE", "COUNT"), help="this mesh alone")
    parser.add_argument(
        "--sequences", action="store_true", help="bodies whose faces change, frame after frame"
    )
    parser.add_argument("--peers-python", default=sys.executable, help=argparse.SUPPRESS)
    return parser.parse_args()


def row(mesh: str, package: str, seconds: float, found: Figures, euler: int) -> str:
    """A line of the table."""
    cells = [
        *(mesh, package, f"{seconds:.1f}", f"{found.vertices:,}", f"{found.nonmanifold}"),
        f"{found.euler} ({euler})",
        *(f"{found.smallest:.1f}", f"{found.mean:.1f}", f"{100 * found.below_30:.1f} %"),
        *(f"{100 * found.valence_6:.0f} %", f"{found.distance:.5f}"),
    ]
    return f"| {' | '.join(cells)} |"


def remeshed(python: str, package: str, path: Path, count: int) -> str:
    """A line of the table, or why there is none."""
    mesh = dapple.read_mesh(path)
    with tempfile.TemporaryDirectory() as folder:
        given, out = Path(folder, "in.npz"), Path(folder, "out.npz")
        np.savez(given, vertices=mesh.vertices, faces=mesh.faces, count=count)
        worker = Path(__file__).with_name("worker.py")
        command = [python, str(worker), package, str(given), str(out)]
        try:
            subprocess.run(command, check=True, capture_output=True, timeout=LIMIT)
        except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
            said = (error.stderr or b"").decode(errors="replace").strip().splitlines()
            return f"| {path.stem} | {package} | {said[-1] if said else error} |" + " |" * 8
        with np.load(out) as made:
            found = figures(made["vertices"], made["faces"], (mesh.vertices, mesh.faces))
            seconds = float(made["seconds"])
    return row(path.stem, package, seconds, found, euler_of(mesh.faces))


def main() -> int:
    chosen = arguments()
    if chosen.sequences:
        table()
        return 0
    if chosen.mesh:
        meshes = {Path(chosen.mesh[0]): int(chosen.mesh[1])}
    else:
        meshes = {MESHES / f"{name}.ply": count for name, count in COUNTS.items()}
    print(HEAD)
    for path, count in meshes.items():
        if not path.is_file():
            print(f"{path} is missing", file=sys.stderr)
            return 1
        for package in chosen.only or CONTENDERS:
            if may_run(package):
                python = chosen.peers_python if package in OF_PEERS else sys.executable
                print(remeshed(python, package, path, count), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
