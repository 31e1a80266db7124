# SPDX-License-Identifier: GPL-3.0-or-later
"""The hashes of results that are to stay the same bytes, and how to write them anew.

    build/venv/bin/python tests/python/same_bytes.py            what differs from same_bytes.json
    build/venv/bin/python tests/python/same_bytes.py --write    takes this system's results into it

Other versions of CGAL, Embree, the C library or the compiler may give other last bits, so each case
has its hashes under EVERY where all systems that have written the file agree, and else under the
names of the systems. Writing leaves what other systems have written. Sines, logarithms and powers
do not come from the C library (native/src/base/elementary.hpp), so processors and compilers agree.
"""

import json
import platform
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

FILE = Path(__file__).with_suffix(".json")
WRITE = "build/venv/bin/python tests/python/same_bytes.py --write"
EVERY = "every system"
INPUTS = "inputs"

Hashes = Mapping[str, str]  # by array
Entry = dict[str, Hashes]  # by system, or by EVERY


def system_name() -> str:
    """As in scripts/common.sh, such as debian-12."""
    try:
        release = platform.freedesktop_os_release()
    except OSError:
        return "unknown"
    return f"{release.get('ID', 'unknown')}-{release.get('VERSION_ID', '')}"


def read() -> tuple[list[str], dict[str, Entry]]:
    """The systems that have written the file, and its cases."""
    if not FILE.exists():
        return [], {}
    content = json.loads(FILE.read_text("utf-8"))
    return content["systems"], content["cases"]


def expected(entry: Entry, system: str) -> Hashes | None:
    return entry.get(system, entry.get(EVERY))


def difference(name: str, found: Hashes, entry: Entry, systems: Iterable[str], system: str) -> str:
    """What to say of a case; nothing where all is as it was."""
    known = expected(entry, system)
    if known is None:
        return f"{FILE.name} has no hashes of {name} for {system}: {WRITE} adds them"
    changed = [key for key in found | known if found.get(key) != known.get(key)]
    if not changed:
        return ""
    if INPUTS in changed:
        return (
            f"{name} was computed from other inputs on {system}, so its results say nothing: the "
            f"case or tests/python/exact.py has changed ({WRITE}), or NumPy computes otherwise here"
        )
    alike = [key for key in found if key not in changed and key != INPUTS]
    words = f"{name} gives different bytes on {system}: {', '.join(changed)} changed"
    words += f", not {', '.join(alike)}" if alike else ""
    if system not in systems:
        words += f"; the hashes are from {', '.join(systems)}, and systems may differ"
    return f"{words}. If that is meant: {WRITE}"


def merged(entry: Entry, found: Hashes, systems: Iterable[str], system: str) -> Entry:
    """A case with one system's hashes written over.

    Args:
        entry: the case as it was, empty if it is new.
        found: what this system gives.
        systems: those that have written the file, without this one or with it.
        system: this one's name.
    """
    others = [other for other in systems if other != system]
    known = {other: hashes for other in others if (hashes := expected(entry, other)) is not None}
    everyone = {**known, system: found}
    if len(known) == len(others) and all(hashes == found for hashes in known.values()):
        return {EVERY: found}
    return dict(sorted(everyone.items()))


def text(systems: Iterable[str], cases: Mapping[str, Entry]) -> str:
    """The file: a line for each set of hashes, so that a change is a line of a diff."""
    blocks = []
    for name, entry in cases.items():
        lines = [f"   {json.dumps(key)}: {json.dumps(hashes)}" for key, hashes in entry.items()]
        blocks.append(f"  {json.dumps(name)}: {{\n" + ",\n".join(lines) + "\n  }")
    body = ",\n".join(blocks)
    return f'{{\n "systems": {json.dumps(sorted(systems))},\n "cases": {{\n{body}\n }}\n}}\n'


def main(arguments: list[str]) -> int:
    if arguments not in ([], ["--write"]):
        print(__doc__)
        return 2
    from byte_cases import CASES, hashes_of

    system = system_name()
    systems, cases = read()
    written, changed = {}, 0
    for name in CASES:
        found, entry = hashes_of(name), cases.get(name, {})
        words = difference(name, found, entry, systems, system)
        changed += bool(words)
        if words:
            print(words if not arguments else f"new for {system}: {name}", flush=True)
        written[name] = merged(entry, found, systems, system)
    if arguments:
        FILE.write_text(text({*systems, system}, written), "utf-8")
    print(f"{len(CASES)} cases, {changed} differ from what {FILE.name} had for {system}")
    return int(changed > 0 and not arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
