# SPDX-License-Identifier: GPL-3.0-or-later
"""Gathers what the site is built of: python -m docs.site.stage FOLDER

The pages lie in FOLDER/source as they lie in the repository, so that the links between them hold,
and those of docs/site at its root. Links to what is no page become plain text. The public headers
lie in FOLDER/include/dapple, as Doxygen is to read them.
"""

import re
import shutil
import sys
from pathlib import Path

from docs.site import headers

ROOT = Path(__file__).resolve().parents[2]

FOLDERS = ("docs", "docs/manual", "docs/development")
# Beside the pages in these folders. The start page shows what README.md says.
PAGES = (
    "CHANGELOG.md",
    "CODE_OF_CONDUCT.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "blend_examples/README.md",
)
PICTURES = (".webp", ".png", ".svg")
LINK = re.compile(r"(?<!!)\[(?P<text>[^][]+)\]\((?P<target>[^)#:]+)(?P<anchor>#[^)]*)?\)")


def pages() -> list[Path]:
    """Every page that is also read in the repository."""
    found = [path for folder in FOLDERS for path in (ROOT / folder).glob("*.md")]
    return sorted(found) + [ROOT / name for name in PAGES]


def pictures() -> list[Path]:
    """Every picture of those pages."""
    folders = (ROOT / "docs/images", ROOT / "docs/manual/images")
    return [path for folder in folders for path in folder.iterdir() if path.suffix in PICTURES]


def linked(text: str, page: Path, known: set[Path]) -> str:
    """A page whose links lead to pages only: README.md is the start page, others are named."""

    def replace(found: re.Match[str]) -> str:
        target = (page.parent / found["target"]).resolve()
        if target in known:
            return found[0]
        if target == ROOT / "README.md":
            return f"[{found['text']}](/index.md{found['anchor'] or ''})"
        name = str(target.relative_to(ROOT))
        plain = found["text"].strip("`")
        return f"`{name}`" if plain == name else f"{found['text']} (`{name}`)"

    return LINK.sub(replace, text)


def with_contents(text: str, page: Path) -> str:
    """A page that lists others has them below it in the site's contents."""
    if page.name != "index.md":
        return text
    names = re.findall(r"^\d+\. \[[^]]+\]\(([\w-]+)\.md\)", text, re.MULTILINE)
    return "\n".join([text, "```{toctree}", ":hidden:", "", *names, "```", ""])


def write_pages(to: Path) -> None:
    """Pages and pictures, at the same places as in the repository."""
    known = set(pages())
    for path in [*known, *pictures()]:
        target = to / path.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        if path in known:
            text = linked(path.read_text(encoding="utf-8"), path, known)
            target.write_text(with_contents(text, path), encoding="utf-8")
        else:
            shutil.copy(path, target)


def main(folder: Path) -> None:
    """All of it, anew."""
    source = folder / "source"
    shutil.rmtree(source, ignore_errors=True)
    shutil.rmtree(folder / "include", ignore_errors=True)
    shutil.copytree(ROOT / "docs/site", source, ignore=shutil.ignore_patterns("__pycache__"))
    write_pages(source)
    shutil.copy(ROOT / "README.md", source)  # the start page shows its code
    headers.write_headers(ROOT / "native/include/dapple", folder / "include/dapple")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
