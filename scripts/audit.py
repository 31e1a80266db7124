# SPDX-License-Identifier: GPL-3.0-or-later
"""Look into the wheels of a release: python scripts/audit.py WHEEL...

A wheel holds its module, licenses and a bill of materials, and is at most 5 MB. The module is for
the wheel's system, imports only what that system and Python have, starts no program and opens no
connection, shows nothing but its entry, and is hardened: a stack that is guarded and never
executed, addresses that are fixed once it is loaded.
Prints a line for each wheel; ends with status 1 at the first that is otherwise.
"""

import re
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple
from zipfile import ZipFile

import lief

MOST_BYTES = 6_000_000
ENTRY = "PyInit__native"
LINUX = re.compile(r"(libc|libm|libpthread|libdl|librt)\.so\.\d+|ld-linux-[\w-]+\.so\.\d+")
WINDOWS = re.compile(r"(kernel32|ntdll|advapi32|bcrypt|ucrtbase|api-ms-win-[\w-]+)\.dll", re.I)
MACOS = re.compile(r"/usr/lib/libSystem\.B\.dylib")
# Weak ones, of which the loader takes one for all (operators, exceptions' types); the file's head.
MACOS_SHOWS_TOO = re.compile(r"_Zn[aw]m\w*|_Zd[al]Pv\w*|_ZT[IS]\w+|_mh_dylib_header|__dso_handle")
PYTHON = re.compile(r"_?Py\w+")
# What starts a program or opens a connection: nothing that ships does.
OUTSIDE = re.compile(
    r"_*(v?fork|f?exec[lv]\w*|posix_spawn\w*|w?system|w?popen|w?spawn[lv]\w*|CreateProcess\w*"
    r"|ShellExecute\w*|WinExec|socket|connect|bind|listen|accept4?|getaddrinfo|gethostby\w+"
    r"|send(to|msg)?|recv(from|msg)?|WSA\w+|InternetOpen\w*|URLDownload\w*)"
)
GLIBC = (2, 28)
MACOS_LEAST = (11, 0)


class RefusedError(Exception):
    """What is wrong with a wheel."""


class Wheel(NamedTuple):
    """What a wheel's name says."""

    name: str
    version: str
    python: str  # as in cp311
    platform: str

    @classmethod
    def named(cls, path: Path) -> "Wheel":
        """Take a file's name apart."""
        distribution, version, python, _, platform = path.stem.split("-")
        if distribution != "dapple3d":
            raise RefusedError(f"is a wheel of {distribution}")
        return cls(path.name, version, python, platform)


def refuse_others(what: str, found: Iterable[str], allowed: re.Pattern[str]) -> None:
    """All that is found must be allowed."""
    for name in sorted(found):
        if not allowed.fullmatch(name):
            raise RefusedError(f"{what} {name}")


def refuse_exports(names: Iterable[str]) -> None:
    """The module shows its entry and nothing else."""
    if (shown := set(names)) != {ENTRY}:
        raise RefusedError(f"shows {', '.join(sorted(shown)[:5]) or 'nothing'}, not {ENTRY} alone")


def numbers(text: str) -> tuple[int, ...]:
    """The numbers of a version such as GLIBC_2.17."""
    return tuple(int(part) for part in text.rpartition("_")[2].split("."))


def asked_for(module: Any) -> list[str]:
    """Functions that are in none of an ELF file's libraries, as far as their versions say."""
    return [
        symbol.name
        for symbol in module.dynamic_symbols
        if symbol.name
        and symbol.shndx == 0
        and symbol.binding == lief.ELF.Symbol.BINDING.GLOBAL
        and not (symbol.symbol_version and symbol.symbol_version.has_auxiliary_version)
    ]


def refuse_outside(imported: Iterable[str]) -> None:
    """No process is started, no connection is opened."""
    for name in sorted(imported):
        if OUTSIDE.fullmatch(name):
            raise RefusedError(f"calls {name}, which starts a program or opens a connection")


def refuse_unguarded(imported: Iterable[str]) -> None:
    """A compiler that guards the stack has functions call what ends the program."""
    if not {"__stack_chk_fail", "___stack_chk_fail"} & set(imported):  # macOS adds one to each name
        raise RefusedError("is built without a guard of the stack (-fstack-protector-strong)")


def refuse_soft_elf(module: Any) -> None:
    """An ELF file's stack and tables of addresses."""
    if not module.has_nx:
        raise RefusedError("has a stack that can be executed (-z noexecstack)")
    kinds = {segment.type for segment in module.segments}
    flags = module.get(lief.ELF.DynamicEntry.TAG.FLAGS)
    is_bound = flags is not None and flags.has(lief.ELF.DynamicEntryFlags.FLAG.BIND_NOW)
    if lief.ELF.Segment.TYPE.GNU_RELRO not in kinds or not is_bound:
        raise RefusedError("has tables of addresses that stay writable (-z relro -z now)")
    refuse_unguarded(symbol.name for symbol in module.imported_symbols)


def refuse_soft_pe(flags: Iterable[Any]) -> None:
    """What a PE file says of where it may be loaded, and of its stack."""
    kinds = lief.PE.OptionalHeader.DLL_CHARACTERISTICS
    for wanted in (kinds.NX_COMPAT, kinds.DYNAMIC_BASE, kinds.HIGH_ENTROPY_VA):
        if wanted not in flags:
            raise RefusedError(f"lacks {wanted.name} among its characteristics")


def audit_linux(module: Any, wheel: Wheel) -> str:
    """An ELF file: its libraries, the glibc that it needs, its symbols."""
    if module.header.machine_type != lief.ELF.ARCH.X86_64:
        raise RefusedError(f"is for {module.header.machine_type}")
    refuse_others("needs", module.libraries, LINUX)
    versions = {
        auxiliary.name
        for requirement in module.symbols_version_requirement
        for auxiliary in requirement.get_auxiliary_symbols()
    }
    least = max((numbers(name) for name in versions if name.startswith("GLIBC_")), default=(0,))
    refuse_others("needs", versions, re.compile(r"GLIBC_[\d.]+"))
    if least > GLIBC:
        raise RefusedError(f"needs glibc {least}, {wheel.platform} promises {GLIBC}")
    refuse_others("asks for", asked_for(module), PYTHON)
    refuse_exports(s.name for s in module.exported_symbols)
    refuse_outside(symbol.name for symbol in module.imported_symbols)
    refuse_soft_elf(module)
    return f"glibc {'.'.join(map(str, least))}"


def audit_windows(module: Any, wheel: Wheel) -> str:
    """A PE file: its libraries, among them its own Python, and its exports."""
    if module.header.machine != lief.PE.Header.MACHINE_TYPES.AMD64:
        raise RefusedError(f"is for {module.header.machine}")
    libraries = {imported.name for imported in module.imports}
    python = f"python{wheel.python.removeprefix('cp')}.dll"
    if python not in libraries:
        raise RefusedError(f"does not import {python}")
    refuse_others("imports", libraries - {python}, WINDOWS)
    refuse_exports(entry.name for entry in module.get_export().entries)
    refuse_outside(entry.name for library in module.imports for entry in library.entries)
    optional = module.optional_header
    refuse_soft_pe(optional.dll_characteristics_lists)
    return f"Windows {optional.major_subsystem_version}.{optional.minor_subsystem_version}"


def own_exports(names: Iterable[str]) -> list[str]:
    """What a Mach-O file shows besides what every one shows that brings its C++ library."""
    plain = (name.removeprefix("_") for name in names)
    return [name for name in plain if not MACOS_SHOWS_TOO.fullmatch(name)]


def audit_macos(module: Any, wheel: Wheel) -> str:
    """A Mach-O file: its libraries, the macOS that it needs, its symbols."""
    processor = {"arm64": "ARM64", "x86_64": "X86_64"}[wheel.platform.split("_", 3)[3]]
    if module.header.cpu_type.name != processor:
        raise RefusedError(f"is for {module.header.cpu_type.name}")
    refuse_others(
        "needs",
        (library.name for library in module.libraries if library.command.name != "ID_DYLIB"),
        MACOS,
    )
    least = tuple((module.build_version or module.version_min).minos[:2])
    if least > MACOS_LEAST:
        raise RefusedError(f"needs macOS {least}, {wheel.platform} promises {MACOS_LEAST}")
    lookups = (s.name.removeprefix("_") for s in module.imported_symbols if not s.library_ordinal)
    refuse_others("asks for", lookups, PYTHON)
    refuse_exports(own_exports(symbol.name for symbol in module.exported_symbols))
    imported = [symbol.name for symbol in module.imported_symbols]
    refuse_outside(imported)
    refuse_unguarded(imported)
    return f"macOS {'.'.join(map(str, least))}"


AUDITS = {
    lief.ELF.Binary: audit_linux,
    lief.PE.Binary: audit_windows,
    lief.MachO.Binary: audit_macos,
}


def module_name(wheel: Wheel) -> str:
    """Where Python looks for the module."""
    digits = wheel.python.removeprefix("cp")
    if wheel.platform == "win_amd64":
        return f"dapple3d/_native.cp{digits}-win_amd64.pyd"
    if wheel.platform.startswith("macosx"):
        return f"dapple3d/_native.cpython-{digits}-darwin.so"
    return f"dapple3d/_native.cpython-{digits}-x86_64-linux-gnu.so"


def module_of(archive: ZipFile, wheel: Wheel) -> Any:
    """The module, taken apart; the wheel holds it and the texts that travel along."""
    names = archive.namelist()
    info = f"dapple3d-{wheel.version}.dist-info"
    for name in (module_name(wheel), "dapple3d/__init__.py", f"{info}/licenses/LICENSE"):
        if name not in names:
            raise RefusedError(f"lacks {name}")
    for folder, least in ((f"{info}/licenses/", 8), (f"{info}/sboms/", 1)):
        if sum(name.startswith(folder) for name in names) < least:
            raise RefusedError(f"has fewer than {least} files in {folder}")
    with tempfile.TemporaryDirectory() as folder:
        module = lief.parse(archive.extract(module_name(wheel), folder))
    if module is None:
        raise RefusedError(f"{module_name(wheel)} is no module of any system")
    return module.at(0) if isinstance(module, lief.MachO.FatBinary) else module


def audit(path: Path) -> str:
    """What a good wheel needs, as a line; raises RefusedError at the first fault."""
    wheel = Wheel.named(path)
    if path.stat().st_size > MOST_BYTES:
        raise RefusedError(f"has {path.stat().st_size:,} bytes, more than {MOST_BYTES:,}")
    with ZipFile(path) as archive:
        module = module_of(archive, wheel)
    least = AUDITS[type(module)](module, wheel)
    return f"{wheel.name}: {path.stat().st_size / 1e6:.1f} MB, from {least}"


def main(paths: list[str]) -> None:
    """Audit all."""
    lief.logging.disable()  # it remarks on tables that a linker has left empty
    for path in map(Path, paths):
        try:
            print(audit(path))
        except RefusedError as error:
            sys.exit(f"{path.name}: {error}")


if __name__ == "__main__":
    main(sys.argv[1:])
