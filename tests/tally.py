# SPDX-License-Identifier: GPL-3.0-or-later
"""What JUnit reports say: python tests/tally.py [--sentence] FILE...

Prints how many tests passed, failed and were skipped, then the failed ones, a line each; or, as a
sentence, "12 passed, 1 failed". A report that is missing or cut off counts nothing: whoever wrote
it has failed for itself.
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


def sentence(passed: int, failed: int) -> str:
    """For a table of what was run."""
    if passed + failed == 0:
        return "failed before any test"
    return f"{passed} passed" + (f", {failed} failed" if failed else "")


def main(arguments: list[str]) -> None:
    in_words = arguments[:1] == ["--sentence"]
    suites = read(arguments[in_words:])

    def total(*kinds: str) -> int:
        return sum(int(suite.get(kind, 0)) for suite in suites for kind in kinds)

    failed, skipped = total("failures", "errors"), total("skipped", "disabled")
    passed = total("tests") - failed - skipped
    if in_words:
        print(sentence(passed, failed))
        return
    print(passed, failed, skipped)
    for case in (case for suite in suites for case in suite.iter("testcase")):
        if case.find("failure") is not None or case.find("error") is not None:
            print(case.get("classname"), case.get("name"))


if __name__ == "__main__":
    main(sys.argv[1:])
