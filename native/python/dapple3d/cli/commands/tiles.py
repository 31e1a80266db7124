# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple tiles: more points than memory, tile by tile."""

import time
from functools import partial
from pathlib import Path
from typing import Any

import click

from dapple3d._starting import INTERRUPTED
from dapple3d.cli import options
from dapple3d.cli.ranges import Whole
from dapple3d.cli.report import Reporter
from dapple3d.cli.work import Work
from dapple3d.extras.distributed import open_surface, sample_tiles
from dapple3d.extras.distributed.results import Folder

SURFACE = click.Path(exists=True, path_type=Path)  # of Zarr it is a folder
FOLDER = click.Path(file_okay=False, path_type=Path)
COUNT = Whole(1)
STEP = click.Tuple([click.FLOAT, click.FLOAT])


@click.command("tiles", short_help="More points than memory, tile by tile.")
@click.argument("surface", type=SURFACE)
@click.argument("folder", type=FOLDER)
@click.option("-n", "--count", type=COUNT, required=True, help="Number of points in all.")
@click.option(
    "--tile",
    type=Whole(2_000),
    default=100_000,
    show_default=True,
    help="About how many points a tile has; memory follows it.",
)
@click.option("--density", type=SURFACE, help="Of a terrain: a file with as many numbers >= 0.")
@click.option(
    "--step",
    type=STEP,
    metavar="X Y",
    help="Of a terrain that does not say it: between two columns and between two rows.  "
    "[default: 1 1]",
)
@click.option(
    "--workers",
    type=Whole(0),
    help="So many processes on this machine, by Dask; 0 is one for each processor.",
)
@click.option("--scheduler", metavar="ADDRESS", help="Of a cluster of Dask that does the work.")
@options.library_options("sample")
@options.report_options
def command(
    surface: Path,
    folder: Path,
    count: int,
    tile: int,
    density: Path | None,
    step: tuple[float, float] | None,
    workers: int | None,
    scheduler: str | None,
    json_out: str | None,
    quiet: bool,
    **solver: Any,
) -> None:
    """Put COUNT points on SURFACE, tile by tile, into FOLDER.

    SURFACE is a terrain: GeoTIFF (.tif, .vrt), heights as .npy or .zarr; or a mesh: .npz, .ply,
    .obj, .stl, .off or glTF. It is never in memory as a whole, nor are the points. Each tile is a
    file, FOLDER/tiles/tile-ROW-COLUMN.npz. The same command goes on where it was stopped, with the
    same SURFACE and options only; files that are damaged are made again.

    \b
    Examples:
      dapple tiles island.tif pines -n 10000000
      dapple tiles island.npy pines -n 10000000 --step 0.5 0.5 --workers 4 --json report.json
    """
    if workers is not None and scheduler:
        raise click.UsageError("give either --workers or --scheduler")
    reporter = Reporter(json_out, quiet)
    begun = time.monotonic()
    ground = open_surface(surface, Folder(folder).surface, density=density, step=step)
    call = partial(sample_tiles, ground, folder, count, tile=tile, workers=workers,
                   scheduler=scheduler, **options.given(solver))  # fmt: skip
    with Work("tiles", quiet=quiet) as work:
        try:
            tiles = work.run(call)
        except KeyboardInterrupt:
            click.echo("Cancelled: the same command goes on from here.", err=True)
            click.get_current_context().exit(INTERRUPTED)
    settings = {"count": count, "tile": tile, **options.library_defaults("sample")}
    rows, columns = tiles.shape
    reporter.store(
        "tiles",
        input={"surface": str(surface), **tiles.plan().surface},
        output=str(folder),
        settings=settings | options.given(solver),
        rows=rows,
        columns=columns,
        made_again=[str(file) for file in tiles.made_again],
        seconds=time.monotonic() - begun,
    )
    for file in tiles.made_again:
        reporter.say(f"{file}: was damaged, and was made again")
    reporter.say(f"{folder}: {len(tiles)} points in {rows} x {columns} tiles")
