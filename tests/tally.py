# SPDX-License-Identifier: GPL-3.0-or-later
"""What JUnit reports say: python tests/tally.py FILE...

Prints how many tests passed, failed and were skipped, then the failed ones, a line each. A report
that is missing or cut off counts nothing: whoever wrote it has failed for itself.
"""

import sys
from contextlib import suppress
from xml.etree import ElementTree


def read(paths: list[str]) -> list[ElementTree.Element]:
    """Test suites of those reports that are whole."""
    suites: list[ElementTree.Element] = []
    for path in paths:
        with suppress(OSError, ElementTree.ParseError):
            suites += ElementTree.parse(path).iter("testsuite")
    return suites


def main(paths: list[str]) -> None:
    suites = read(paths)

    def total(*kinds: str) -> int:
        return sum(int(suite.get(kind, 0)) for suite in suites for kind in kinds)

    failed, skipped = total("failures", "errors"), total("skipped", "disabled")
    print(total("tests") - failed - skipped, failed, skipped)
    for case in (case for suite in suites for case in suite.iter("testcase")):
        if case.find("failure") is not None or case.find("error") is not None:
            print(case.get("classname"), case.get("name"))


if __name__ == "__main__":
    main(sys.argv[1:])
