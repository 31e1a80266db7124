# SPDX-License-Identifier: GPL-3.0-or-later
"""What a release's wheels are refused for, what they are made of, how the zips are called."""

import json
import random
import subprocess
import sys
import tomllib
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import dapple3d
import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import audit  # noqa: E402
import bill_of_materials  # noqa: E402
import package  # noqa: E402

LINUX = "dapple3d-1.0.0-cp311-cp311-manylinux_2_28_x86_64.whl"
WINDOWS = "dapple3d-1.0.0-cp313-cp313-win_amd64.whl"
MACOS = "dapple3d-1.0.0-cp311-cp311-macosx_11_0_arm64.whl"
INFO = "dapple3d-1.0.0.dist-info"


def wheel(folder: Path, name: str, module: bytes | None = b"", licenses: int = 9) -> Path:
    """A wheel with this module, or without one."""
    files = [f"{INFO}/licenses/{number}.txt" for number in range(licenses)]
    files += [f"{INFO}/licenses/LICENSE", f"{INFO}/sboms/dapple3d.cdx.json", "dapple3d/__init__.py"]
    with ZipFile(folder / name, "w", ZIP_DEFLATED) as archive:
        for file in files:
            archive.writestr(file, "")
        if module is not None:
            archive.writestr(audit.module_name(audit.Wheel.named(Path(name))), module)
    return folder / name


def native_module() -> bytes:
    """The module of this build: it needs the system's libraries, which a release must not."""
    return Path(dapple3d._native.__file__).read_bytes()


@pytest.mark.parametrize("name", [LINUX, WINDOWS, MACOS])
def test_a_wheel_without_its_module_is_refused(tmp_path, name):
    with pytest.raises(audit.RefusedError, match=r"lacks dapple3d/_native\.c"):
        audit.audit(wheel(tmp_path, name, None))


def test_a_module_of_another_python_is_none(tmp_path):
    other = wheel(tmp_path, LINUX, native_module())
    with pytest.raises(audit.RefusedError, match=r"lacks dapple3d/_native\.cpython-313-"):
        audit.audit(other.rename(tmp_path / LINUX.replace("cp311", "cp313")))


def test_a_wheel_without_its_licenses_is_refused(tmp_path):
    with pytest.raises(audit.RefusedError, match=r"fewer than 8 files in .*/licenses/"):
        audit.audit(wheel(tmp_path, LINUX, licenses=5))


def test_a_module_that_is_none_is_refused(tmp_path):
    with pytest.raises(audit.RefusedError, match="is no module of any system"):
        audit.audit(wheel(tmp_path, LINUX, b"not a module"))


def test_a_module_that_needs_more_than_the_system_is_refused(tmp_path):
    with pytest.raises(audit.RefusedError, match=r"needs lib\w+\.so"):
        audit.audit(wheel(tmp_path, LINUX, native_module()))


def test_a_module_with_a_function_that_is_nowhere_is_refused(root, tmp_path):
    source, module = tmp_path / "module.c", tmp_path / "module.so"
    source.write_text("int missing(void); int PyInit__native(void) { return missing(); }")
    map_file = f"-Wl,--version-script={root}/native/python/module.map"
    command = ["gcc", "-shared", "-fPIC", "-nostdlib", map_file, source, "-o", module]
    subprocess.run(command, check=True)
    with pytest.raises(audit.RefusedError, match="asks for missing"):
        audit.audit(wheel(tmp_path, LINUX, module.read_bytes()))


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (["-z", "execstack"], "a stack that can be executed"),
        (["-z", "norelro"], "tables of addresses that stay writable"),
        (["-z", "lazy"], "tables of addresses that stay writable"),
        ([], "without a guard of the stack"),
    ],
)
def test_a_module_that_is_not_hardened_is_refused(root, tmp_path, flags, said):
    source, module = tmp_path / "module.c", tmp_path / "module.so"
    source.write_text("int PyInit__native(void) { return 0; }")
    map_file = f"-Wl,--version-script={root}/native/python/module.map"
    hard = ["-z", "relro", "-z", "now", "-z", "noexecstack", *flags]
    command = ["gcc", "-shared", "-fPIC", "-nostdlib", map_file, source, "-o", module, *hard]
    subprocess.run(command, check=True)
    with pytest.raises(audit.RefusedError, match=said):
        audit.audit(wheel(tmp_path, LINUX, module.read_bytes()))


@pytest.mark.parametrize(
    "name", ["execve", "_fork", "system", "_wsystem", "popen", "CreateProcessW", "socket", "_send"]
)
def test_a_module_that_starts_programs_or_connects_is_refused(name):
    audit.refuse_outside(["executable", "bindtextdomain", "_execute_onexit_table", "sendfile64"])
    with pytest.raises(audit.RefusedError, match=f"calls {name}, which starts"):
        audit.refuse_outside(["memcpy", name])


def test_a_module_of_windows_is_loaded_anywhere():
    kinds = audit.lief.PE.OptionalHeader.DLL_CHARACTERISTICS
    hard = [kinds.NX_COMPAT, kinds.DYNAMIC_BASE, kinds.HIGH_ENTROPY_VA]
    audit.refuse_soft_pe(hard)
    for missing in hard:
        with pytest.raises(audit.RefusedError, match=missing.name):
            audit.refuse_soft_pe([kind for kind in hard if kind != missing])


def test_a_wheel_that_is_too_large_is_refused(tmp_path):
    with pytest.raises(audit.RefusedError, match="more than 6,000,000"):
        audit.audit(wheel(tmp_path, LINUX, random.Random(0).randbytes(6_000_000)))


def test_a_module_shows_its_entry_alone():
    audit.refuse_exports(["PyInit__native"])
    with pytest.raises(audit.RefusedError, match="shows PyInit__native, rtcNewDevice, not"):
        audit.refuse_exports(["PyInit__native", "rtcNewDevice"])
    with pytest.raises(audit.RefusedError, match="shows nothing"):
        audit.refuse_exports([])


def test_a_macos_module_shows_its_entry_and_what_all_of_them_do():
    all_do = [
        "__Znwm",
        "__ZdaPvSt11align_val_t",
        "__ZTIN5boost9exceptionE",
        "__mh_dylib_header",
        "___dso_handle",
    ]
    assert audit.own_exports(["_PyInit__native", *all_do]) == ["PyInit__native"]
    assert audit.own_exports(["__ZN3tbb4stopEv", *all_do]) == ["_ZN3tbb4stopEv"]


@pytest.mark.parametrize(
    ("platform", "name"),
    [("linux-x64", "Dapple"), ("windows-x64", "Dapple (experimental on Windows)")],
)
def test_a_system_that_nobody_has_loaded_it_on_is_called_experimental(platform, name):
    text = (ROOT / "addon" / package.MANIFEST).read_text("utf-8")
    version = tomllib.loads(text)["version"]
    written = tomllib.loads(package.manifest(text, platform, version, ["one.whl"]))
    assert (written["name"], written["platforms"]) == (name, [platform])


def test_the_bill_names_what_is_inside():
    bill = json.loads(bill_of_materials.bill("1.2.3"))
    assert bill["bomFormat"] == "CycloneDX"
    assert bill["metadata"]["component"]["version"] == "1.2.3"
    names = {part["name"] for part in bill["components"]}
    assert {"embree", "onetbb", "openmesh", "libcgal-dev", "libcxx"} <= names
    assert not any(name.startswith(("googletest", "python", "libpython")) for name in names)
    assert all(part["licenses"] and part["purl"] for part in bill["components"])


def test_the_bill_has_the_same_bytes_again():
    assert bill_of_materials.bill("1.2.3") == bill_of_materials.bill("1.2.3")
    assert bill_of_materials.bill("1.2.3") != bill_of_materials.bill("1.2.4")


def test_every_source_has_its_hash():
    for one in bill_of_materials.dependencies():
        assert one.kind in ("source", "headers")
        assert (len(one.sha256) == 64) == (one.kind == "source"), one.name
