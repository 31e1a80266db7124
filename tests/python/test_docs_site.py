# SPDX-License-Identifier: GPL-3.0-or-later
"""The sources of the documentation site: all that there is has its place, links lead somewhere.

scripts/docs.sh builds the site; here Sphinx is not needed.
"""

import re
import sys
from pathlib import Path

import dapple3d as dapple
import pytest

sys.path.insert(0, str(Path(__file__).parents[2]))

from docs.site import docstrings, headers, stage, typed_api
from scripts import option_headers, rooms

ROOT = stage.ROOT
SITE = ROOT / "docs/site"
PYTHON = sorted((SITE / "python").glob("*.md"))
MARKDOWN = [*stage.pages(), ROOT / "README.md", ROOT / "native/python/README.md"]
HEADERS = sorted((ROOT / "native/include/dapple").glob("*.hpp"))


def contents(page: Path) -> set[str]:
    """What the tables of contents of a page list."""
    blocks = re.findall(r"^```\{toctree\}\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)
    return {line for block in blocks for line in block.splitlines() if re.match(r"\w", line)}


def test_every_page_is_in_the_contents():
    manual = ROOT / "docs/manual/index.md"
    below = re.findall(
        r"\{toctree\}(.*?)```", stage.with_contents(manual.read_text(), manual), re.S
    )
    listed = contents(SITE / "index.md") | {f"docs/manual/{name}" for name in below[0].split()[1:]}
    pages = {str(page.relative_to(ROOT).with_suffix("")) for page in stage.pages()}
    assert listed == pages | {"python/index", "cpp/index"}
    assert contents(SITE / "python/index.md") | {"index"} == {page.stem for page in PYTHON}


def test_every_page_of_the_repository_is_a_page_of_the_site():
    folders = ("", "blend_examples", *stage.FOLDERS)
    there = {path for folder in folders for path in (ROOT / folder).glob("*.md")}
    assert there == {*stage.pages(), ROOT / "README.md"}


def test_every_public_name_is_on_one_page():
    text = "\n".join(page.read_text() for page in PYTHON)
    listed = re.findall(r"^\.\. auto(?:class|function|exception|data):: (\w+)$", text, re.MULTILINE)
    assert sorted(listed) == sorted(set(dapple.__all__) - {"__version__"})
    modules = set(
        re.findall(r"^\.\. automodule:: dapple3d\.(?:extras\.)?(\w+)$", text, re.MULTILINE)
    )
    of_ours = {"reading", "writing"}  # modules of the package that read and write files
    package = Path(dapple.__file__).parent
    there = {
        path.stem for folder in ("", "extras") for path in (package / folder).glob("[a-z]*.py")
    }
    assert modules == {"density"} | there - of_ours


def test_every_public_header_has_a_room():
    listed = [header for names in rooms.listed_rooms().values() for header in names]
    assert sorted(listed) == [path.stem for path in HEADERS]


def test_every_option_is_reported_at_its_member():
    tables = [row for one in option_headers.read_headers(ROOT) for row in one.tables.values()]
    assert sum(not member.is_group for members in tables for member in members) > 30
    written = "".join(headers.filtered(path.read_text()) for path in HEADERS)
    assert "{." not in re.sub(r"//.*", "", written)
    assert "  /// (\\>= 0; in local spacings).\n  double max_step = 0.5;" in written
    assert "  /// (0..1).\n  double pattern_strength = 0.8;" in written


def test_comments_are_made_fit_for_doxygen():
    text = """
/// Go on.
/// \\throw SurfaceError, Cancelled; ArgumentError if the first is
/// negative
void go();

/// \\pre, \\throw as go()
struct Way {
  double length = 1.0;  ///< > 0
  Options options = {.length = 2.0};
};
"""
    assert (
        headers.filtered(text)
        == """
/// Go on.
/// \\throw SurfaceError naming the first offender
/// \\throw Cancelled through the context
/// \\throw ArgumentError if the first is negative
void go();

/// Conditions and errors as of go()
struct Way {
  double length = 1.0;  ///< \\> 0
  /// As by default, but `.length = 2.0`.
  Options options;
};
"""
    )


@pytest.mark.parametrize("path", HEADERS, ids=lambda path: path.stem)
def test_what_is_thrown_is_an_error(path):
    """Of the site, any other word there is a link to nothing, and a warning is an error."""
    thrown = re.findall(r"\\throw (\w+)", headers.filtered(path.read_text()))
    assert set(thrown) <= {"ArgumentError", "Cancelled", "FileError", "SurfaceError"}


def test_stubs_get_the_documentation_of_the_module():
    stubs = (Path(dapple.__file__).parent / "_native.pyi").read_text()
    namespace = {}
    code = typed_api.documented_stubs(dapple._native, stubs)
    exec(f"from __future__ import annotations\n{code}", namespace)
    surface = namespace["Surface"]
    assert surface.__doc__ == dapple._native.Surface.__doc__
    assert "squared units" in surface.area.__doc__
    assert surface.deformed.__doc__.startswith("The same faces and density")
    assert namespace["sample"].__doc__.startswith("Exactly count samples")


def test_docstrings_become_fields_and_links():
    text = """Samples of *two* kinds, see sample() and print().

    Args:
        surface: a Surface,
            or |none|.
        rows, columns: of
            it.
        **more: those of sample().

    Returns:
        Samples: with a report.

    Raises:
        Cancelled: through the context."""
    lines = docstrings.rewritten(
        re.sub(r"^    ", "", text, flags=re.MULTILINE).splitlines(), dapple
    )
    assert [line for line in lines if line] == [
        r"Samples of \*two\* kinds, see :py:func:`~dapple3d.sample` and print().",
        r":param surface: a :py:class:`~dapple3d.Surface`, or \|none\|.",
        ":param rows: of it.",
        ":param columns: of it.",
        ":param more: those of :py:func:`~dapple3d.sample`.",
        ":returns: :py:class:`~dapple3d.Samples`: with a report.",
        ":raises Cancelled: through the context.",
    ]


def anchors(page: Path) -> set[str]:
    """What links into a page can name, as a git host makes it of the headings."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    plain = [re.sub(r"[^\w\- ]", "", heading.lower()) for heading in headings]
    return {heading.replace(" ", "-") for heading in plain}


@pytest.mark.parametrize("page", MARKDOWN, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`\n]*`", "", text)):
        if re.match(r"https?:", target):
            continue
        name, _, anchor = target.partition("#")
        to = (page.parent / name).resolve() if name else page
        assert to.exists(), target
        assert not anchor or anchor in anchors(to), target


def test_links_to_what_is_no_page_become_text():
    page = ROOT / "docs/cpp.md"
    text = "[tests](../tests/run.sh) [how](method.md#cells) [start](../README.md#in-blender)"
    linked = stage.linked(text, page, set(stage.pages()))
    assert linked == ("tests (`tests/run.sh`) [how](method.md#cells) [start](/index.md#in-blender)")
    assert {"in-blender", "in-python"} <= anchors(SITE / "index.md")
