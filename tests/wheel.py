# SPDX-License-Identifier: GPL-3.0-or-later
"""Test the package as a wheel installs it, on any system: python tests/wheel.py [FOLDER | --needs]

With a folder, its wheel for this Python is installed into build/wheel-tests/venv first. Without, it
is the package of the running Python, which needs pytest too. Left out are tests of this checkout.
With --needs, what the tests need is installed into the running Python, and nothing is tested.
"""

import shutil
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# They need git, Debian's tools or a build folder; hashes are recorded for builds of Debian.
OF_THE_CHECKOUT = (
    "addon_imports",
    "audit",
    "distribution",
    "docs_examples",
    "docs_site",
    "one_definition",
    "paper_report",
    "peers",
    "pins",
    "release",
    "rooms",
    "run",
    "same_bytes",
    "spelling",
    "wheel_builds",
    "workflows",
)
NEEDED = (
    "numpy",
    "click",
    "DracoPy",
    "distributed",
    "matplotlib",
    "pillow",
    "pytest",
    "rasterio",
    "scikit-image",
    "usd-core",
    "zarr",
)


def call(*command: object) -> None:
    """Run a command, end with it where it fails."""
    print("+", *command, flush=True)
    code = subprocess.run(list(map(str, command)), cwd=ROOT, check=False).returncode
    if code:
        sys.exit(code)


def environment(wheels: Path) -> Path:
    """The Python of a new environment with the wheel that suits this one."""
    folder = ROOT / "build" / "wheel-tests"
    shutil.rmtree(folder, ignore_errors=True)
    venv.create(folder / "venv", with_pip=True)
    python = folder / "venv" / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    pip = (python, "-m", "pip", "install", "--quiet")
    call(*pip, "--no-index", "--no-deps", "--find-links", wheels, "--only-binary=:all:", "dapple3d")
    install_needed(python)
    return python


def install_needed(python: Path) -> None:
    """What the tests need, in the versions that are pinned for this Python."""
    pins = ROOT / "scripts" / "constraints.txt"
    call(python, "-m", "pip", "install", "--quiet", "-c", pins, *NEEDED)


def main(arguments: list[str]) -> None:
    """Run the tests, or install what they need."""
    if arguments == ["--needs"]:
        return install_needed(Path(sys.executable))
    python = environment(Path(arguments[0]).resolve()) if arguments else Path(sys.executable)
    left_out = [f"--ignore=tests/python/test_{name}.py" for name in OF_THE_CHECKOUT]
    call(python, "-m", "pip", "check")
    call(python, "-m", "pytest", "-q", "tests/python", *left_out)


if __name__ == "__main__":
    main(sys.argv[1:])
