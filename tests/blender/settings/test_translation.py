# SPDX-License-Identifier: GPL-3.0-or-later
"""Translations are complete, without unused texts, and shown by the panel and Blender."""

import importlib.util
import json
import re
import string
from zipfile import ZipFile

import addon_host
import bpy
import messages
import pytest
import scenes
import test_panels
from test_addon import extension_tool

LOCALES = sorted(path.stem for path in (addon_host.sources() / "translations").glob("*.json"))
INTERNATIONAL = bpy.app.build_options.international


def blenders_languages():
    """Of Blender's own translation tools; their module got another name in 5.2."""
    for name in ("bl_i18n_utils", "_bl_i18n_utils"):
        if importlib.util.find_spec(name):
            return importlib.import_module(f"{name}.settings").LANGUAGES
    raise ModuleNotFoundError("Blender's translation tools are not found")


def part():
    return addon_host.part("blender.base.translation")


def catalog(locale):
    return part().catalogs(part().FOLDER)[locale]


@pytest.fixture
def german(monkeypatch):
    """Blender's interface in German; what it makes of a message in a context."""
    if INTERNATIONAL:
        view = bpy.context.preferences.view
        view.language, view.use_translate_interface = "de_DE", True
        view.use_translate_reports = True
        yield lambda message, context="*": bpy.app.translations.pgettext_iface(message, context)
        view.language = "DEFAULT"
        return
    texts = catalog("de_DE")

    def lookup(message, context="*"):
        return texts.get((context, message), message)

    for name in ("pgettext_iface", "pgettext_rpt"):
        monkeypatch.setattr(part(), name, lookup)
    yield lookup


def translating(lookup):
    """A layout that looks up its texts as Blender's does."""

    class Layout(test_panels.Layout):
        def label(self, text="", icon="NONE", translate=True):
            super().label(lookup(text), icon)

        def popover(self, panel, text="", icon="NONE"):
            super().popover(panel, lookup(text), icon)

        def prop(self, data, name, text=None, translate=True, **options):
            super().prop(data, name, **options)
            prop = data.bl_rna.properties[name]
            self.shown.append(lookup(text or prop.name, prop.translation_context))

        def operator(self, name, text="", translate=True, text_ctxt="Operator", **options):
            given = super().operator(name, text, **options)
            group, verb = name.split(".")
            label = text or getattr(getattr(bpy.ops, group), verb).get_rna_type().name
            self.shown.append(lookup(label, text_ctxt) if translate else label)
            return given

    return Layout


def placeholders(text):
    return {(name, spec) for _, name, spec, _ in string.Formatter().parse(text) if name is not None}


@pytest.mark.parametrize("locale", LOCALES)
def test_a_catalog_has_all_that_is_shown_and_nothing_else(locale):
    shown, known = messages.shown(), set(catalog(locale))
    assert not shown - known, "not translated"
    assert not known - shown, "shown nowhere"


@pytest.mark.parametrize("locale", LOCALES)
def test_a_catalog_is_of_a_language_of_blenders_and_fills_in_the_same(locale):
    assert locale in [code for _, _, code, *_ in blenders_languages()]
    for (_, message), text in catalog(locale).items():
        assert text.strip()
        assert placeholders(text) == placeholders(message), message
        assert message.endswith(".") == text.endswith("."), message


def test_what_is_shown_is_found():
    shown = messages.shown()
    expected = {
        ("Operator", "Replace Tiles"),  # an enum item in the sources
        ("Operator", "Add Object Type"),  # the text of a button
        # another one, which Blender's own German translation gets wrong
        ("Dapple", "Lock Selected"),
        ("Operator", "Scatter Points"),  # the name of a tool
        ("*", "Area Uniformity"),
        ("*", "Separation"),
        ("*", "{count} instance"),
        ("*", "Exact Count"),  # a heading
        ("Dapple", "Rest Position"),  # Blender's German translation would be that of Resolution
        ("*", "Even, without a visible pattern, like grass or pebbles"),
    }
    assert expected <= shown
    assert len(shown) > 250
    assert not [message for _, message in shown if "\n" in message]


@pytest.mark.parametrize("baked", [False, True])
def test_no_line_of_a_panel_is_composed_in_english(baked, monkeypatch):
    obj = scenes.scattered(scenes.tail(frames=3), count=30)
    if baked:
        obj.dapple.keyframe_step = 2
        bpy.ops.dapple.bake()
        obj.dapple.locked_count, obj.dapple.report.converged = 2, False
    obj.dapple.seed, obj.dapple.report.worst_overlap = 7, 0.2
    bpy.context.scene.frame_set(1)
    monkeypatch.setattr(part(), "pgettext_iface", lambda message, context="*": f"«{message}»")
    monkeypatch.setattr(
        addon_host.part("blender.base.sidebars"), "line_width", lambda _icon: 100_000
    )
    known, lines = {message for _, message in messages.shown()}, []

    class Layout(test_panels.Layout):
        def label(self, text="", icon="NONE", translate=True):
            lines.append(text)

    test_panels.drawn(Layout)
    assert any("«Seed»" in line for line in lines)
    plain = [line for line in lines if "«" not in line and line not in known]
    assert not [line for line in plain if not re.fullmatch(r"[\d.,e+-]*", line)]


# Texts shown with another text or in a field, or verified to fit.
ELSEWHERE = {
    "auto_update_mode",
    "avoid_collection",
    "preview_budget",
    "random_scale_up",
    "random_scale_down",
}


@pytest.mark.parametrize("locale", ["", *LOCALES])
def test_names_of_settings_fit_beside_their_values(locale):
    """In a sidebar as wide as Blender opens it: 84 pixels are shown, of more the end is cut."""
    texts = catalog(locale) if locale else {}
    width_of = addon_host.part("blender.base.sidebars").width_of
    tables = addon_host.part("core.settings.tables")
    wide = {}
    for setting in (one for group in tables.GROUPS.values() for one in group):
        if setting.kind.name == "SWITCH" or setting.name in ELSEWHERE:
            continue
        context = part().OWN if setting.own_words else "*"
        shown = texts.get((context, setting.label), setting.label)
        if width_of(shown) > 84.0:
            wide[shown] = width_of(shown)
    assert not wide


@pytest.mark.skipif(not INTERNATIONAL, reason="this Blender is built without translations")
def test_names_that_blender_translates_otherwise_fit_too(german):
    """Blender's words go before those of a catalog, unless a setting has its own."""
    width_of = addon_host.part("blender.base.sidebars").width_of
    tables = addon_host.part("core.settings.tables")
    settings = [one for group in tables.GROUPS.values() for one in group]
    said = {}
    for setting in settings:
        if setting.kind.name != "SWITCH" and setting.name not in ELSEWHERE:
            said[setting.name] = german(setting.label, part().OWN if setting.own_words else "*")
    assert {name: text for name, text in said.items() if width_of(text) > 84.0} == {}


def test_a_word_that_some_versions_of_blender_write_too_long_is_our_own(german):
    """Color Attribute is Farbeigenschaft in the German of Blender 4.3, whose end was cut."""
    scatter = bpy.types.Object.bl_rna.properties["dapple"].fixed_type
    color = scatter.properties["color_attribute"]
    assert german(color.name, color.translation_context) == "Farbattribut"
    assert color.translation_context == part().OWN


def test_a_long_text_has_lines_that_fit():
    labels, text = addon_host.part("blender.base.sidebars"), "Added points come down on the surface"
    lines = labels.wrapped(text, 120.0)
    assert " ".join(lines) == text
    assert len(lines) > 1
    assert max(map(labels.width_of, lines)) <= 120.0
    assert labels.wrapped("Unbreakable words", 1.0) == ["Unbreakable", "words"]
    assert labels.wrapped("Because 32 %, of all", 1.0) == ["Because", "32 %,", "of", "all"]


def test_the_panel_is_german(german):
    obj = scenes.scattered(scenes.sphere(), count=120)
    shown = test_panels.drawn(translating(german))
    for text in (
        "Optimieren",
        "Neu anheften",
        "Objekttyp hinzufügen",
        "Anheften an",
        "Klebrigkeit",
    ):
        assert text in shown
    assert any(text.startswith("120 Instanzen, Abstand ") for text in shown)
    assert "des idealen, aktuell" in " ".join(shown)
    obj.dapple.seed, obj.dapple.repulsion_weight = 3, 1.0
    shown = "|".join(test_panels.drawn(translating(german)))
    reason = "Einstellungen wurden geändert (Startwert, Abstoßung): neu optimieren"
    assert f"Veraltet: {reason}" in shown.replace("|", " ")


def test_items_of_menus_are_reported_from_blenders_own_words(german):
    """Blender's Aspect is that of pictures, its Border that of a render."""
    obj = scenes.scattered(scenes.sphere())
    prop = obj.dapple.density.bl_rna.properties["shown_term"]
    found = {item.name: german(item.name, prop.translation_context) for item in prop.enum_items}
    assert (found["Aspect"], found["Border"], found["Attribute"]) == (
        "Hangrichtung",
        "Rand",
        "Attribut",
    )
    assert [name for name, text in found.items() if name == text] == ["Material"]


def test_one_is_no_plural(german):
    counted = part().translated_count
    assert counted(1, "{count} instance", "{count:,} instances") == "1 Instanz"
    assert counted(0, "{count} instance", "{count:,} instances") == "0 Instanzen"
    assert counted(2000, "{count} instance", "{count:,} instances") == "2,000 Instanzen"


def test_a_file_keeps_english(german):
    obj = scenes.scattered(scenes.sphere())
    obj.dapple.seed = 9
    get_input = addon_host.part("nodes").get_input
    assert get_input(obj.modifiers[0], "Warning") == "Settings were changed (Seed): optimize again"
    assert "Einstellungen" in addon_host.part("blender.freshness.staleness").stale_reason(
        obj, bpy.context
    )
    obj.dapple.surface = None
    with pytest.raises(RuntimeError, match="has no surface: choose a mesh object"):
        bpy.ops.dapple.optimize()


def test_names_with_braces_are_shown_as_they_are(german):
    surface = scenes.sphere()
    obj = scenes.scattered(surface)
    surface.name = "{0} {count} }{"
    bpy.data.collections.new("Away").objects.link(surface)
    for collection in list(surface.users_collection):
        collection.objects.unlink(surface)
    reason = addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)
    assert reason.startswith("Oberfläche '{0} {count} }{'")


BROKEN = {
    "de_DE": b"{ not json",
    "es": b"[1, 2]",
    "fr_FR": b'{"*": ["Count"]}',
    "it_IT": b'{"*": {"Count": 3}}',
    "ja_JP": '{"*": {"Count": "é"}}'.encode("latin-1"),
}


def test_broken_catalogs_are_named_and_left_out(tmp_path, monkeypatch, capsys):
    for locale, content in BROKEN.items():
        (tmp_path / f"{locale}.json").write_bytes(content)
    (tmp_path / "nl_NL.json").write_text(json.dumps({"*": {"Count": "Aantal"}}))
    assert part().catalogs(tmp_path) == {"nl_NL": {("*", "Count"): "Aantal"}}
    said = capsys.readouterr().out
    assert all(f"{locale}.json' is not a translation: " in said for locale in BROKEN)
    monkeypatch.setattr(part(), "FOLDER", tmp_path)
    addon_host.part("blender").unregister()
    addon_host.part("blender").register()
    assert len(scenes.positions(scenes.scattered(scenes.sphere()))) == 60


@pytest.mark.parametrize("text", ["{other} Punkte", "{count", "{count.far}", "{0}", "{count:q}"])
def test_a_text_that_cannot_be_filled_in_is_left_english(text, monkeypatch):
    monkeypatch.setattr(part(), "pgettext_iface", lambda _message: text)
    assert part().translated("{count:,} points", count=5) == "5 points"


def test_the_zip_has_the_catalogs(tmp_path):
    archive = tmp_path / "dapple.zip"
    extension_tool("build", f"--source-dir={addon_host.sources()}", f"--output-filepath={archive}")
    with ZipFile(archive) as file:
        names = set(file.namelist())
    assert {f"translations/{locale}.json" for locale in LOCALES} <= names
    assert "de_DE" in LOCALES


@pytest.mark.skipif(not INTERNATIONAL, reason="this Blender is built without translations")
def test_blender_looks_up_the_catalog_and_forgets_it(german):
    part().unregister()
    own = {key: german(key[1], key[0]) for key in messages.shown()}
    assert own["Operator", "Optimize"] == "Optimize"
    part().register()
    for (context, message), text in catalog("de_DE").items():
        before = own[context, message]
        assert german(message, context) == (text if before == message else before)
