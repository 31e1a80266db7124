# SPDX-License-Identifier: GPL-3.0-or-later
"""Arguments of the command line; docs/farm.md describes them for users."""

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

_FRAMES = re.compile(r"(-?\d+)(?:-(-?\d+))?")
_CODES = "Exit codes: 0 done; 1 failed, or not up to date; 2 wrong usage; 130, 143 stopped."

if TYPE_CHECKING:
    _Verbs = argparse._SubParsersAction[argparse.ArgumentParser]


class Arguments(argparse.Namespace):
    """A parsed command line; each verb has some of these arguments."""

    verb: str
    scatters: list[str]  # none: all
    json: Path | None
    progress: str
    quiet: bool
    frames: tuple[int, int] | None = None  # those of the scene
    frame: int | None = None  # the one that the file shows
    output: Path | None = None  # the file itself
    file: Path  # that is exported to
    if_needed: bool = False
    delete_keyframes: bool = False
    baked: bool = False


def parsed(arguments: list[str]) -> Arguments:
    """Parse a command line; SystemExit with the exit code if there is nothing to do."""
    options = parser().parse_args(arguments, Arguments())
    options.scatters = list(filter(None, options.scatters))
    return options


def path(text: str) -> Path | None:
    """Path of a file; None if the text is empty, so that a job template may contain all options."""
    return Path(text) if text else None


def frames(text: str) -> tuple[int, int] | None:
    """First and last frame of "1-250" or "7"; None if the text is empty."""
    if not text:
        return None
    found = _FRAMES.fullmatch(text)
    if not found:
        raise argparse.ArgumentTypeError(f"'{text}' is not a range of frames such as 1-250")
    first, last = int(found[1]), int(found[2] or found[1])
    if last < first:
        raise argparse.ArgumentTypeError(f"the range of frames is empty: {first} to {last}")
    return first, last


def parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="blender -b FILE.blend --command dapple",
        description="Solves the scatters of a file without a window.",
        epilog=_CODES,
    )
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="VERB")
    _add_bake(verbs)
    _add_optimize(verbs)
    _add_check(verbs)
    _add_export(verbs)
    return parser


def _add_bake(verbs: "_Verbs") -> None:
    verb = _verb(verbs, "bake", "bake keyframes, and save the file")
    _add_frames(verb, "to bake; default: those of the scene")
    verb.add_argument(
        "--if-needed", action="store_true", help="leave out scatters whose bake is up to date"
    )
    _add_output(verb)


def _add_optimize(verbs: "_Verbs") -> None:
    verb = _verb(verbs, "optimize", "distribute the points in one frame, and save the file")
    verb.add_argument("--frame", type=int, help="the frame; default: the one that the file shows")
    verb.add_argument(
        "--delete-keyframes", action="store_true", help="delete the keyframes of a bake"
    )
    _add_output(verb)


def _add_check(verbs: "_Verbs") -> None:
    verb = _verb(verbs, "check", "say whether scatters are up to date; 1 if one is not")
    _add_frames(verb, "to compare; default: those of the scene")
    verb.add_argument(
        "--baked", action="store_true", help="take scatters that are not baked for out of date"
    )


def _add_export(verbs: "_Verbs") -> None:
    verb = _verb(verbs, "export", "write the instances to a file for other programs")
    verb.add_argument("file", type=Path, metavar="FILE", help="its ending says the format")
    one = verb.add_mutually_exclusive_group()
    _add_frames(one, "to write")
    one.add_argument("--frame", type=int, help="the frame; default: the one that the file shows")


def _verb(verbs: "_Verbs", name: str, text: str) -> argparse.ArgumentParser:
    verb = verbs.add_parser(name, help=text, description=text.capitalize() + ".", epilog=_CODES)
    verb.add_argument(
        "--scatter",
        action="append",
        default=[],
        dest="scatters",
        metavar="NAME",
        help="a scatter object, several times for several; default: all of the scene",
    )
    verb.add_argument("--json", type=path, metavar="FILE", help="write a report")
    verb.add_argument(
        "--progress",
        choices=["text", "openjd"],
        default="text",
        help="form of the lines on stderr; openjd: as Open Job Description reads them",
    )
    verb.add_argument("--quiet", action="store_true", help="no progress, only errors")
    return verb


def _add_frames(to: argparse._ActionsContainer, what: str) -> None:
    to.add_argument("--frames", type=frames, metavar="A-B", help=f"frames {what}")


def _add_output(verb: argparse.ArgumentParser) -> None:
    verb.add_argument(
        "--output",
        type=path,
        metavar="FILE.blend",
        help="save there and leave the file as it is; default: the file itself",
    )
