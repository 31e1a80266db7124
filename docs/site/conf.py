# SPDX-License-Identifier: GPL-3.0-or-later
"""Sphinx's settings; scripts/docs.sh calls it on what stage.py has gathered."""

import sys
from pathlib import Path
from typing import Any

import dapple3d
from dapple3d import density, instances, plot, stippling, tables, texturing, writing
from dapple3d.extras import gltf, godot, usd
from sphinx.pycode import ModuleAnalyzer

from docs.site import docstrings, typed_api

project = "Dapple"
author = "Dapple developers"
version = release = dapple3d.__version__
copyright = author
language = "en"

extensions = [
    "breathe",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx_copybutton",
    "sphinx_design",
]
exclude_patterns = ["README.md"]  # the start page shows its code
nitpicky = True
suppress_warnings = ["config.cache"]

# Pages
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]
copybutton_prompt_text = r"\$ |>>> "
copybutton_prompt_is_regexp = True
copybutton_only_copy_prompt_lines = True
pygments_style = "tango"
pygments_dark_style = "github-dark"

# Python
parts = [
    sys.modules[f"{density.__name__}.{name}"]  # a function is named as its module
    for name in (
        "arrays", "ranges", "orientation", "nearest", "noise", "normals", "fields", "masked",
    )
]  # fmt: skip
for module in (
    *parts, density, gltf, godot, instances, plot, stippling, tables, texturing, usd, writing,
):  # fmt: skip
    typed_api.defer(module)
vars(dapple3d).update(Dots=stippling.Dots, stipple=stippling.stipple)
package = Path(dapple3d.__file__).parent
code = typed_api.overlay(dapple3d, (package / "_native.pyi").read_text(encoding="utf-8"))
ModuleAnalyzer.cache["module", "dapple3d"] = ModuleAnalyzer.for_string(
    (package / "__init__.py").read_text(encoding="utf-8") + "\n" + code, "dapple3d"
)
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "class-doc-from": "class"}
python_maximum_signature_line_length = 70
python_use_unqualified_type_names = True
add_module_names = False

# C++
breathe_projects = {"dapple": "../xml"}
breathe_default_project = "dapple"
breathe_show_include = False
breathe_default_members = ("members",)
cpp_maximum_signature_line_length = 70
cpp_index_common_prefix = ["dapple::"]

# Of Python, numpy, matplotlib, the C++ library and Eigen, whose pages are elsewhere.
nitpick_ignore_regex = [
    ("py:.*", r"(np|numpy|matplotlib|os|collections|typing|pathlib)\..*"),
    ("py:.*", r"ArrayLike|NDArray|Any|Literal|Sequence|Iterable|Final|Figure|Up"),
    ("py:.*", r"int|float|str|bool"),
    ("cpp:identifier", r"(std|Eigen)(::.*)?|dapple|Vec3::Zero"),
    ("cpp:identifier", r"OrderedSurface|Stopwatch|Connectivity|SidedSurface"),  # not for callers
]

# The theme
html_theme = "furo"
html_title = f"Dapple {version}"
html_static_path = ["static"]
html_css_files = ["dapple.css"]
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {"navigation_with_keys": True}


def rewrite(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Docstrings of the package are plain text."""
    if name.startswith("dapple3d."):
        lines[:] = docstrings.rewritten(lines, dapple3d)


def setup(app: Any) -> None:
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", rewrite)
