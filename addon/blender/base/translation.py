# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts of the interface in the language that Blender is set to.

addon/translations/LOCALE.json holds {context: {English message: text}}. Blender translates labels,
names, tooltips and the texts of a layout. Texts that are composed at run time go through
`translated`, `translated_count` or `translated_report`, which look up a template and then fill it
in. Numbers are written alike in all languages, as Blender writes them.

Some texts are always in English: errors, which core raises without knowing Blender and which
people search for and pass on, and all that a file stores (names of data-blocks, warnings of the
node group), since the next reader may use another language.
"""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
from bpy.app.translations import pgettext_iface, pgettext_rpt

from .. import base

FOLDER = base.FOLDER / "translations"
OWN = "Dapple"  # context of names that Blender translates as something else
Messages = dict[tuple[str, str], str]  # (context, English message): text
Translate = Callable[..., str]  # translated or english


def translated(template: str, **values: Any) -> str:
    """A message of the interface, its {placeholders} filled in."""
    return _filled(pgettext_iface(template), template, values)


def translated_count(count: int, one: str, many: str) -> str:
    """The singular or the plural message, with its {count} filled in.

    A language with more plural forms needs a wording that fits all of them: "Points: {count}".
    """
    return translated(one if count == 1 else many, count=count)


def translated_report(template: str, **values: Any) -> str:
    """A message that an operator reports, its {placeholders} filled in."""
    return _filled(pgettext_rpt(template), template, values)


def english(template: str, **values: Any) -> str:
    """A message in English: for errors, and for what is written to a file."""
    return template.format(**values)


def label_of(prop: bpy.types.Property, translate: Translate = translated) -> str:
    """The label of a property in the language of `translate`."""
    if translate is english:
        return prop.name
    return pgettext_iface(prop.name, prop.translation_context)


def item_label(prop: bpy.types.Property, identifier: str) -> str:
    """The name of an item of a menu, as the panel shows it."""
    return pgettext_iface(prop.enum_items[identifier].name, prop.translation_context)


def operator_label(label: str) -> str:
    """The label of an operator, as its button shows it."""
    return pgettext_iface(label, "Operator")


def _filled(text: str, template: str, values: dict[str, Any]) -> str:
    """Fill in a text; if its placeholders are not those of the template, use the template."""
    try:
        return text.format(**values)
    except (LookupError, ValueError, AttributeError, TypeError):
        return template.format(**values)


def catalogs(folder: Path) -> dict[str, Messages]:
    """Catalogs of a folder by locale; invalid files are reported on the console and skipped."""
    found = {}
    for path in sorted(folder.glob("*.json")):
        try:
            found[path.stem] = _read(path)
        except (OSError, ValueError) as error:
            print(f"Dapple: '{path}' is not a translation: {error}")
    return found


def _read(path: Path) -> Messages:
    stored = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(stored, dict):
        raise ValueError("it must hold contexts")
    messages: Messages = {}
    for context, own in stored.items():
        if not isinstance(own, dict) or not all(isinstance(text, str) for text in own.values()):
            raise ValueError(f"context '{context}' must hold messages and their texts")
        messages |= {(context, message): text for message, text in own.items()}
    return messages


def register() -> None:
    """Register the catalogs in Blender."""
    bpy.app.translations.register(base.PACKAGE, catalogs(FOLDER))


def unregister() -> None:
    """Remove the catalogs."""
    bpy.app.translations.unregister(base.PACKAGE)
