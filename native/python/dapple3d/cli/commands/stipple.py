# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple stipple: a picture as dots."""

from functools import partial
from pathlib import Path
from typing import Any

import click

import dapple3d as dapple
from dapple3d import stippling
from dapple3d.cli import options
from dapple3d.cli.files import about, check_outputs
from dapple3d.cli.ranges import Number
from dapple3d.cli.report import Reporter, figures
from dapple3d.cli.work import Work
from dapple3d.writing import replacing


@click.command("stipple", short_help="A picture as dots.")
@click.argument("picture", type=options.INPUT)
@click.argument("out", type=options.OUTPUT)
@click.option("-n", "--count", type=options.COUNT, required=True, help="Number of dots.")
@click.option(
    "--scale",
    type=Number(0.0, finite=True, open_below=True),
    default=4.0,
    show_default=True,
    help="Pixels of a .png for each of PICTURE.",
)
@options.library_options("stipple_inks")
@options.profile_option
@options.report_options
def command(
    picture: Path,
    out: Path,
    count: int,
    scale: float,
    profile: bool,
    json_out: str | None,
    quiet: bool,
    **solver: Any,
) -> None:
    """Render PICTURE with COUNT dots, into OUT.

    PICTURE is .png, .jpg or what else Pillow reads, turned as its EXIF orientation says. A gray one
    becomes black dots; one in color becomes red, green, blue, cyan, magenta, yellow and black ones.
    What is transparent is paper. OUT is .png, .svg or .pdf.

    \b
    Examples:
      dapple stipple portrait.png portrait.svg -n 10000
      dapple stipple flower.jpg flower.png -n 50000 --scale 6
    """
    reporter = Reporter(json_out, quiet)
    if out.suffix.lower() not in stippling.SUFFIXES:
        raise click.ClickException(f"{out}: must end in {', '.join(stippling.SUFFIXES)}")
    check_outputs([picture], [out, reporter.file])
    image = stippling.read_picture(picture)
    chosen = options.given(solver)
    with about(picture), Work("stippling", quiet=quiet) as work:
        dots = work.run(partial(dapple.stipple, image, count, **chosen))
    content = stippling.encode(dots, out.suffix, scale=scale)
    with replacing(out) as file:
        file.write(content)
    defaults = options.library_defaults("stipple_inks")
    inks = {name: int((dots.classes == k).sum()) for k, name in enumerate(dots.inks)}
    reporter.store(
        "stipple",
        input={"picture": str(picture), "width": dots.size[0], "height": dots.size[1]},
        output=str(out),
        settings={"count": count, "scale": scale, **defaults} | chosen,
        inks=inks,
        radius=dots.radius,
        report=dots.report.to_dict(),
    )
    reporter.say(f"{out}: {count} dots of radius {dots.radius:.3g}, {figures(dots.report)}")
    if profile:
        reporter.show_profile([dots.report])
