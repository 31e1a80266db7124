# SPDX-License-Identifier: GPL-3.0-or-later
"""Say what a release's modules are made of: python scripts/bill_of_materials.py FOLDER VERSION

Writes a CycloneDX document of what scripts/dependencies.txt names into the .dist-info folder in
FOLDER, where PEP 770 wants it.
"""

import re
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple
from uuid import NAMESPACE_URL, uuid5

from cyclonedx.contrib.license.factories import LicenseFactory
from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.output.json import JsonV1Dot6
from packageurl import PackageURL

TABLE = Path(__file__).with_name("dependencies.txt")
COMPILER = Path(__file__).with_name("requirements-release.txt")
LIBCXX = "Apache-2.0 WITH LLVM-exception"
EPOCH = datetime(1980, 1, 1, tzinfo=UTC)
NOT_INSIDE = ("googletest", "python", "libpython")  # tests, and what the user has


class Dependency(NamedTuple):
    """A line of the table."""

    kind: str
    name: str
    suite: str
    version: str
    license: str
    sha256: str


def dependencies() -> Iterator[Dependency]:
    """The lines of the table that name something."""
    for line in TABLE.read_text().splitlines():
        if line and not line.startswith("#"):
            yield Dependency(*line.split())


def component(name: str, version: str, expression: str, source: PackageURL | None) -> Component:
    """One part, or the product."""
    return Component(
        name=name,
        version=version,
        type=ComponentType.LIBRARY,
        bom_ref=f"{name}@{version}",
        licenses=[LicenseFactory().make_from_string(expression)],
        purl=source,
    )


def compiler() -> str:
    """The version of the compiler, whose C++ library is linked too."""
    found = re.search(r"^ziglang==([\d.]+)", COMPILER.read_text(), re.MULTILINE)
    if not found:
        raise SystemExit(f"{COMPILER} names no ziglang")
    return found[1]


def parts() -> Iterator[Component]:
    """All whose code is in a module, besides the system's own."""
    for one in dependencies():
        if not one.name.startswith(NOT_INSIDE):
            distro = {"distro": one.suite}
            source = PackageURL("deb", "debian", one.name, one.version, distro)
            yield component(one.name, one.version, one.license, source)
    source = PackageURL("pypi", None, "ziglang", compiler())
    yield component("libcxx", f"ziglang-{source.version}", LIBCXX, source)


def bill(version: str) -> str:
    """The document for dapple3d of a version; the same bytes for the same table."""
    inside = list(parts())
    document = Bom(components=inside)
    document.metadata.component = component("dapple3d", version, "GPL-3.0-or-later", None)
    document.metadata.timestamp = EPOCH  # contents alone decide the bytes
    document.register_dependency(document.metadata.component, inside)
    names = [version, *(part.bom_ref.value for part in inside)]
    document.serial_number = uuid5(NAMESPACE_URL, repr(names))
    return JsonV1Dot6(document).output_as_string(indent=2) + "\n"


def main(folder: str, version: str) -> None:
    """Write the document."""
    sboms = Path(folder, f"dapple3d-{version}.dist-info", "sboms")
    sboms.mkdir()
    (sboms / "dapple3d.cdx.json").write_text(bill(version))


if __name__ == "__main__":
    main(*sys.argv[1:])
