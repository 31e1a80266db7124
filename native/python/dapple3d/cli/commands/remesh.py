# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple remesh: the best triangle mesh of so many vertices."""

from functools import partial
from pathlib import Path
from typing import Any

import click
import numpy as np

import dapple3d as dapple
from dapple3d.cli import meshes, options
from dapple3d.cli.files import check_outputs, listed
from dapple3d.cli.report import Reporter
from dapple3d.cli.work import Work
from dapple3d.writing import replacing, write_npz

MESHES = (".off", ".obj", ".ply", ".stl")  # write_mesh() knows them
ARRAYS = ("vertices", "faces", "source_faces", "barycentric", "features", "lines")


@click.command("remesh", short_help="An even triangle mesh of a mesh.")
@click.argument("mesh", type=options.INPUT)
@click.argument("out", type=options.OUTPUT)
@options.count_options("Number of vertices.")
@options.density_options
@options.library_options("remesh")
@options.surface_options
@options.profile_option
@options.report_options
def command(
    mesh: Path,
    out: Path,
    count: int | None,
    spacing: float | None,
    density: str | None,
    density_at: meshes.Place | None,
    surface_options: meshes.SurfaceOptions,
    profile: bool,
    json_out: str | None,
    quiet: bool,
    **chosen: Any,
) -> None:
    """Make a new triangle mesh of COUNT evenly spaced vertices on MESH, into OUT.

    Creases, corners and borders stay, and so does the topology: where it needs more vertices, the
    command says how many. MESH is read as by 'sample'. OUT is .ply, .obj, .off, .stl or .npz, which
    also holds where each vertex lies on MESH.

    \b
    Examples:
      dapple remesh bunny.ply even.ply -n 10000
      dapple remesh part.stl even.obj --spacing 0.5 --feature-angle 40
    """
    reporter = Reporter(json_out, quiet)
    check_extension(out)
    options.check_amount(count, spacing)
    check_outputs([mesh, options.density_file(density)], [out, reporter.file])
    loaded = meshes.load(meshes.read_mesh(mesh), density, density_at, surface_options)
    count = options.counted(loaded.surface, count, spacing)
    given = options.given(chosen)
    with Work("remeshing", quiet=quiet) as work:
        made = work.run(partial(dapple.remesh, loaded.surface, count, **given))
    write(out, made)
    reporter.store(
        "remesh",
        input=loaded.describe(),
        output=str(out),
        settings={
            "count": count,
            **options.given({"spacing": spacing}),
            **options.library_defaults("remesh"),
            **given,
        },
        mesh=made.report.to_dict(),
    )
    reporter.say(f"{out}: {figures(made.report)}{loaded.doubled()}")
    if profile:
        reporter.show_profile([made.report])


def check_extension(path: Path) -> None:
    """Raise ClickException unless a mesh can be written to the file."""
    suffix = path.suffix.lower()
    if suffix not in (*MESHES, ".npz"):
        known = listed((*MESHES, ".npz"))
        raise click.ClickException(
            f"{path}: unknown format '{suffix}'; meshes are written as {known}"
        )


def write(path: Path, mesh: dapple.RemeshResult) -> None:
    """Write in the format of the extension; the file is complete or not written."""
    if path.suffix.lower() != ".npz":
        dapple.write_mesh(path, mesh.vertices, mesh.faces)
        return
    with replacing(path) as file:
        write_npz(file, {name: np.asarray(getattr(mesh, name)) for name in ARRAYS})


def figures(report: dapple.RemeshReport) -> str:
    """The figures of the mesh, and what is not as asked."""
    words = (
        f"{report.vertices} vertices, {report.faces} triangles, angles from "
        f"{report.smallest_angle:.1f} degrees, {100 * report.valence_6:.0f} % of the vertices "
        "have six neighbors"
    )
    if report.vertices > report.asked:
        words += f"; the topology needs {report.vertices - report.asked} more than asked for"
    if report.dropped_lines:
        words += f"; {report.dropped_lines} creases were given up"
    if report.flaws:
        words += f"; in {report.flaws} places the topology is not that of the surface"
    return words
