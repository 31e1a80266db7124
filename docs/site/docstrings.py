# SPDX-License-Identifier: GPL-3.0-or-later
"""Docstrings as what Sphinx reads.

Those of the package are plain text with the sections Args, Attributes, Returns and Raises. A star
or a bar in them is a star or a bar; public names become links.
"""

import re
from collections.abc import Callable, Iterator
from itertools import pairwise
from types import ModuleType

SECTION = re.compile(r"(Args|Attributes|Returns|Raises):")
ITEM = re.compile(r"(?P<names>\*{0,2}\w+(?:, \w+)*): (?P<text>.*)")
SPECIAL = re.compile(r"[*`|\\]|_(?=\W|$)")
CALL = re.compile(r"(?<![\w.])([a-z]\w+)\(\)")
CLASS = re.compile(r"(?<![\w.])[A-Z]\w+\b(?!\(|\.\w)")
PROMPT = ">>> "


def escaped(text: str) -> str:
    """Plain text that stays so."""
    return SPECIAL.sub(r"\\\g<0>", text)


def linked(text: str, package: ModuleType) -> str:
    """Plain text as reStructuredText, with links to the functions and classes that it names."""

    def call(found: re.Match[str]) -> str:
        known = callable(getattr(package, found[1], None))
        return f":py:func:`~{package.__name__}.{found[1]}`" if known else found[0]

    def word(found: re.Match[str]) -> str:
        known = isinstance(getattr(package, found[0], None), type)
        return f":py:class:`~{package.__name__}.{found[0]}`" if known else found[0]

    return CALL.sub(call, CLASS.sub(word, escaped(text)))


def paragraphs(lines: list[str], text: Callable[[str], str]) -> Iterator[str]:
    """What stands before the sections; examples with prompts stay as they are.

    The first word may be a class that only begins a sentence.
    """
    for at, line in enumerate(lines):
        first, space, rest = line.strip().partition(" ") if at == 0 else ("", "", line.strip())
        yield line if line.startswith(PROMPT) else escaped(first) + space + text(rest)


def items(lines: list[str]) -> Iterator[tuple[str, str]]:
    """Name and text of each entry of a section; several names may share a text."""
    margin = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    found: list[tuple[str, list[str]]] = []
    for line in lines:
        item = ITEM.fullmatch(line.strip()) if line[margin : margin + 1].strip() else None
        if item:
            found.append((item["names"], [item["text"]]))
        elif found:
            found[-1][1].append(line.strip())
    for names, words in found:
        for name in names.split(", "):
            yield name.lstrip("*"), " ".join(words).strip()


def section(kind: str, lines: list[str], text: Callable[[str], str]) -> Iterator[str]:
    """A section as a list of fields."""
    if kind == "Returns":
        yield f":returns: {text(' '.join(line.strip() for line in lines).strip())}"
        return
    form = (
        ":raises {}:" if kind == "Raises" else ":param {}:"
    )  # a data class is made of its attributes
    for name, words in items(lines):
        yield f"{form.format(name)} {text(words)}"


def rewritten(lines: list[str], package: ModuleType) -> list[str]:
    """A docstring as reStructuredText."""

    def text(line: str) -> str:
        return linked(line, package)

    starts = [at for at, line in enumerate(lines) if SECTION.fullmatch(line)]
    written = list(paragraphs(lines[: starts[0] if starts else None], text))
    for start, end in pairwise([*starts, len(lines)]):
        written += ["", *section(lines[start].rstrip(":"), lines[start + 1 : end], text)]
    return [*written, ""]
