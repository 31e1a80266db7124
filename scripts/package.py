# SPDX-License-Identifier: GPL-3.0-or-later
"""Steps of scripts/package.sh: python scripts/package.py STEP ARGUMENT..."""

import shutil
import sys
import sysconfig
import tomllib
from collections.abc import Callable
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

ROOT = Path(__file__).resolve().parents[1]
MANIFEST = "blender_manifest.toml"
ASSETS = "dapple_nodes.blend"  # addon/blender/asset_library.py looks for it
PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"
TAG = f"cp{PYTHON}".replace(".", "")

METADATA = """\
Metadata-Version: 2.4
Name: dapple3d
Version: {version}
Summary: Blue noise on surfaces by variational optimisation
License-Expression: GPL-3.0-or-later
{licences}
Requires-Python: =={python}.*
Requires-Dist: numpy>=1.26
Provides-Extra: cli
Requires-Dist: click; extra == "cli"
Provides-Extra: pictures
Requires-Dist: matplotlib; extra == "pictures"
Requires-Dist: pillow; extra == "pictures"
"""

WHEEL = """\
Wheel-Version: 1.0
Generator: dapple scripts/package.sh
Root-Is-Purelib: false
Tag: {tag}-{tag}-{platform}
"""


def describe(folder: str, version: str, *licences: str) -> None:
    """Write the .dist-info folder that makes the package in folder a wheel's contents.

    A licence /usr/share/doc/NAME/copyright becomes NAME.txt.
    """
    info = Path(folder, f"dapple3d-{version}.dist-info")
    texts = info / "licenses"
    texts.mkdir(parents=True)
    names = []
    for path in map(Path, licences):
        names.append(f"{path.parent.name}.txt" if path.name == "copyright" else path.name)
        (texts / names[-1]).write_bytes(path.read_bytes())
    lines = "\n".join(f"License-File: {name}" for name in names)
    metadata = METADATA.format(version=version, licences=lines, python=PYTHON)
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    (info / "METADATA").write_text(metadata)
    (info / "WHEEL").write_text(WHEEL.format(tag=TAG, platform=platform))


def manifest(text: str, platform: str, version: str, wheels: list[str]) -> str:
    """The add-on's manifest with the two keys of an extension that brings native code."""
    before = tomllib.loads(text)
    if before["version"] != version:
        raise SystemExit(f"{MANIFEST} says version {before['version']}, the package {version}")
    keys = {"platforms": [platform], "wheels": [f"./wheels/{name}" for name in wheels]}
    head, table, tail = text.partition("\n[")  # keys after a table's head would be the table's
    lines = "".join(f"{key} = {value!r}\n" for key, value in keys.items()).replace("'", '"')
    after = f"{head}{lines}{table}{tail}"
    if tomllib.loads(after) != before | keys:
        raise SystemExit(f"{MANIFEST}: {', '.join(keys)} cannot be added")
    return after


def refuse_wheels(version: str, names: list[str]) -> None:
    """Blender takes the wheel for its Python: all are of this version, no two for one Python."""
    pythons = set()
    for name in names:
        distribution, found, python = name.split("-")[:3]
        if (distribution, found) != ("dapple3d", version):
            raise SystemExit(f"{name}: wheels must be of dapple3d {version}")
        if python in pythons:
            raise SystemExit(f"{name}: there is another wheel for {python}")
        pythons.add(python)


def extension(folder: str, platform: str, version: str, assets: str, *wheels: str) -> None:
    """Write the folder that Blender builds into a zip: the add-on, its licence, assets, wheels."""
    names = [Path(wheel).name for wheel in wheels]
    refuse_wheels(version, names)
    target = Path(folder)
    shutil.copytree(ROOT / "addon", target, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "LICENSE", target)
    shutil.copy(assets, target / "assets" / ASSETS)
    (target / "wheels").mkdir()
    for wheel in wheels:
        shutil.copy(wheel, target / "wheels")
    text = manifest((ROOT / "addon" / MANIFEST).read_text(), platform, version, names)
    (target / MANIFEST).write_text(text)


def settle(source: str, target: str) -> None:
    """Copy a zip so that its bytes depend on names and contents alone, not on dates or folders."""
    with ZipFile(source) as old, ZipFile(target, "w") as new:
        for name in sorted(old.namelist()):
            entry = ZipInfo(name)
            entry.external_attr = 0o644 << 16
            kind = ZIP_STORED if name.endswith(".whl") else ZIP_DEFLATED
            new.writestr(entry, old.read(name), kind, 9)


def show(archive: str) -> None:
    """Print a zip's path and size, what is in it, and what is in its wheels."""
    print(f"{archive}: {Path(archive).stat().st_size / 1e6:.1f} MB")
    with ZipFile(archive) as outer:
        for entry in outer.infolist():
            print(f"{entry.file_size:12,}  {entry.filename}")
            if entry.filename.endswith(".whl"):
                with outer.open(entry) as file, ZipFile(file) as wheel:
                    for inner in (inner for inner in wheel.infolist() if not inner.is_dir()):
                        print(f"{inner.file_size:12,}    {inner.filename}")


STEPS: dict[str, Callable[..., None]] = {
    step.__name__: step for step in (describe, extension, settle, show)
}

if __name__ == "__main__":
    STEPS[sys.argv[1]](*sys.argv[2:])
