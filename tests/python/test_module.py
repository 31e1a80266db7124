# SPDX-License-Identifier: GPL-3.0-or-later
"""The package as a whole: names, documentation, types, the README's code."""

import ast
import inspect
import re
import subprocess
import sys
from pathlib import Path

import dapple3d as dapple
import pytest

PUBLIC = sorted(set(dapple.__all__) - {"__version__"})


def test_has_its_version(root):
    assert dapple.__version__ == "1.0.0"
    assert f"VERSION {dapple.__version__}" in (root / "CMakeLists.txt").read_text()


def test_exports_all_that_is_native():
    native = {name for name in vars(dapple._native) if not name.startswith("_")}
    assert native <= set(PUBLIC)
    assert all(hasattr(dapple, name) for name in PUBLIC)


THINGS = [name for name in PUBLIC if callable(getattr(dapple, name))]


@pytest.mark.parametrize("name", THINGS)
def test_documents(name):
    thing = getattr(dapple, name)
    assert inspect.getdoc(thing)
    if not inspect.isclass(thing):
        return
    for member, value in vars(thing).items():
        if not member.startswith("_"):
            assert inspect.getdoc(value), f"{name}.{member}"


ARRAYS = {
    "Surface": ["vertices", "faces", "density"],
    "Samples": ["positions", "normals", "faces", "barycentric", "ids", "classes"],
    "Energy": ["capacities", "masses", "areas", "gradient"],
    "Projection": ["positions", "faces", "barycentric", "distances"],
}


@pytest.mark.parametrize(("name", "member"), [(c, m) for c, ms in ARRAYS.items() for m in ms])
def test_documents_shapes(name, member):
    text = inspect.getdoc(vars(getattr(dapple, name))[member])
    assert re.search(r"\((n|v|m),( 3)?\) (float64|int32)", text), text


@pytest.mark.parametrize(
    "name", ["Surface", "Samples", "Tracker.advance", "evaluate_energy", "project", "write_mesh"]
)
def test_documents_arguments_and_errors(name):
    thing = dapple
    for part in name.split("."):
        thing = getattr(thing, part)
    text = inspect.getdoc(thing)
    assert re.search(r"\((n|v|m),( 3)?\)", text)
    assert "Args:" in text
    assert "Raises:" in text


def test_is_typed():
    package = Path(dapple.__file__).parent
    assert (package / "py.typed").is_file()
    assert (package / "_native.pyi").is_file()


# Reports of stubtest about classes made by pybind11 that are expected: their metaclass, an __init__
# that only raises, a library beside the module, an alias of a Literal, functions that cache their
# results, and a function that passes options to another one and shows them by name.
ALLOWED = r"""
dapple3d\._native\.\w+
dapple3d\._native\.\w+\.__init__
dapple3d\.libdapple_embree
dapple3d\.cli\.meshes\.Place
dapple3d\._meshes\.MeshArrays
dapple3d\.extras\.distributed\.grids\._open_\w+
dapple3d\.extras\.distributed\.layout\.Kind
dapple3d\.extras\.distributed\.meshes\._mapped
dapple3d\.extras\.distributed\.patches\.Place
dapple3d\.instances\.Up
dapple3d\.stippling\.stipple
dapple3d\.extras\.usd\._pxr
"""

UNTYPED = "[mypy]\n[mypy-pxr.*,rasterio.*]\nignore_missing_imports = True\n"


def test_stubs_match_the_module(tmp_path):
    pytest.importorskip("mypy.stubtest", reason="mypy is not installed")
    settings = tmp_path / "mypy.ini"
    settings.write_text(UNTYPED)
    allowed = tmp_path / "allowed"
    allowed.write_text(ALLOWED)
    command = [
        sys.executable,
        "-m",
        "mypy.stubtest",
        "dapple3d",
        "--concise",
        "--allowlist",
        allowed,
        "--mypy-config-file",
        settings,
    ]
    found = subprocess.run(
        [*command, "--ignore-unused-allowlist"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert found.returncode == 0, found.stdout + found.stderr


def stub_signatures() -> dict[str, list[str]]:
    """Names of the arguments of every function and method in the stubs, without self."""
    tree = ast.parse((Path(dapple.__file__).parent / "_native.pyi").read_text())
    signatures = {}

    def visit(body: list[ast.stmt], prefix: str) -> None:
        for node in body:
            if isinstance(node, ast.ClassDef):
                visit(node.body, f"{node.name}.")
            elif isinstance(node, ast.FunctionDef) and not node.decorator_list:
                arguments = [*node.args.args, *node.args.kwonlyargs]
                names = [argument.arg for argument in arguments if argument.arg != "self"]
                signatures[prefix + node.name] = names

    visit(tree.body, "")
    return signatures


@pytest.mark.parametrize(("name", "arguments"), stub_signatures().items())
def test_stubs_name_the_arguments(name, arguments):
    """stubtest cannot see arguments of native functions; their documentation begins with them."""
    thing = dapple._native
    for part in name.split("."):
        thing = getattr(thing, part)
    first = thing.__doc__.strip().splitlines()[0]
    listed = re.findall(r"(\w+): ", first)
    assert [argument for argument in listed if argument != "self"] == arguments, first


def python_blocks(text: str) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("page", ["README.md", "native/python/README.md"])
def test_runs_the_readme(root, tmp_path, page):
    blocks = python_blocks((root / page).read_text())
    assert blocks, f"{page} shows no Python"
    script = tmp_path / "readme.py"
    script.write_text("\n".join(blocks))
    found = subprocess.run(
        [sys.executable, script],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=120,
        check=False,
    )
    assert found.returncode == 0, found.stderr


def test_the_cpp_page_shows_the_program_that_is_tested(root):
    """tests/consumer compiles it against the installed library and runs it."""
    page = (root / "docs/cpp.md").read_text()
    (shown,) = re.findall(r"^```cpp\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    license_line, _, program = (root / "tests/consumer/main.cpp").read_text().partition("\n")
    assert "SPDX" in license_line
    assert shown == program
    assert len(program.splitlines()) <= 30
