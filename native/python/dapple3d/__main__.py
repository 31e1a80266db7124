# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: python -m dapple3d, or the script dapple."""

import sys
from importlib.util import find_spec


def start() -> None:
    """Run the command line, or name the package that is missing."""
    if not find_spec("click"):
        sys.exit("Error: the command line needs click, which is missing: pip install click")
    from dapple3d import _starting
    from dapple3d.cli.app import main

    try:
        main(prog_name="dapple")
    finally:
        _starting.ended()


if __name__ == "__main__":
    start()
