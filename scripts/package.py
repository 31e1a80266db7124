# SPDX-License-Identifier: GPL-3.0-or-later
"""Steps of scripts/package.sh: python scripts/package.py STEP ARGUMENT..."""

import shutil
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

from scikit_build_core.build import prepare_metadata_for_build_wheel

ROOT = Path(__file__).resolve().parents[1]
MANIFEST = "blender_manifest.toml"
ASSETS = "dapple_nodes.blend"  # addon/blender/assets/library.py looks for it
# Nobody has loaded it in a Blender of that system yet: its name in Blender's list says so.
EXPERIMENTAL = {"windows-x64": "Windows", "macos-arm64": "macOS", "macos-x64": "macOS"}


def describe(folder: str, version: str, *licenses: str) -> None:
    """Write the .dist-info folder that makes the package in folder a wheel's contents.

    pyproject.toml says what is in it. A license /usr/share/doc/NAME/copyright becomes NAME.txt.
    """
    info = Path(folder, prepare_metadata_for_build_wheel(folder))
    if info.name != f"dapple3d-{version}.dist-info":
        raise SystemExit(f"the build is of version {version}, pyproject.toml describes {info.stem}")
    added = ""
    for path in map(Path, licenses):
        name = f"{path.parent.name}.txt" if path.name == "copyright" else path.name
        (info / "licenses" / name).write_bytes(path.read_bytes())
        added += f"License-File: {name}\n"
    before, line, after = (info / "METADATA").read_text().partition("License-File: LICENSE\n")
    (info / "METADATA").write_text(before + line + added + after)


def retag(folder: str, tag: str) -> None:
    """Say which Python and system the wheel is for, where it was not built by and for this one."""
    (path,) = Path(folder).glob("*.dist-info/WHEEL")
    lines = [line for line in path.read_text().splitlines() if line and not line.startswith("Tag:")]
    path.write_text("\n".join([*lines, f"Tag: {tag}"]) + "\n")


def manifest(text: str, platform: str, version: str, wheels: list[str]) -> str:
    """The add-on's manifest with the two keys of an extension that brings native code."""
    if system := EXPERIMENTAL.get(platform):
        text = text.replace(
            '\nname = "Dapple"\n', f'\nname = "Dapple (experimental on {system})"\n'
        )
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
    """Write the folder that Blender builds into a zip: the add-on, its license, assets, wheels."""
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
    step.__name__: step for step in (describe, extension, retag, settle, show)
}

if __name__ == "__main__":
    STEPS[sys.argv[1]](*sys.argv[2:])
