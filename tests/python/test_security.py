# SPDX-License-Identifier: GPL-3.0-or-later
"""What ships runs no text as a program, starts no process and opens no network."""

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

import dapple3d
import pytest

ROOT = Path(__file__).parents[2]
TREES = {"dapple3d": Path(dapple3d.__file__).parent, "addon": ROOT / "addon"}

# Code execution from data, other processes, network, memory by address.
MODULES = {
    *("pickle", "cPickle", "_pickle", "marshal", "shelve", "dill", "cloudpickle", "joblib"),
    *("code", "codeop", "runpy", "pty", "subprocess", "multiprocessing", "concurrent"),
    *("socket", "socketserver", "ssl", "http", "urllib", "urllib3", "requests", "httpx"),
    *("aiohttp", "ftplib", "smtplib", "poplib", "imaplib", "telnetlib", "xmlrpc"),
    *("webbrowser", "asyncio", "ctypes", "cffi", "yaml", "fsspec", "dask", "distributed"),
}
CALLS = {"eval", "exec", "compile", "__import__", "breakpoint"}
OF_OS = ("system", "popen", "exec", "spawn", "posix_spawn", "fork", "startfile", "kill")

# Intended uses, which SECURITY.md describes.
DASK = "Dask runs work on the machines of a cluster that the caller has made and trusts"
INTENDED = {
    ("addon/blender/surface/images.py", "ctypes"): "keeps a Python object alive; loads no library",
    ("dapple3d/cli/work.py", "concurrent"): "a thread beside the progress bar; starts no process",
    ("dapple3d/extras/distributed/running.py", "dask"): DASK,
    ("dapple3d/extras/distributed/running.py", "distributed"): DASK,
    ("dapple3d/extras/distributed/shots.py", "distributed"): DASK,
    ("dapple3d/extras/distributed/tiling.py", "distributed"): DASK,
    (
        "dapple3d/extras/_gltf_files.py",
        "urllib.parse",
    ): "decodes the path of a file beside a glTF; opens nothing",
    (
        "dapple3d/extras/_gltf_prototypes.py",
        "urllib.parse",
    ): "decodes the path of a picture beside a glTF; opens nothing",
}


def sources() -> Iterator[tuple[str, ast.Module]]:
    for name, folder in TREES.items():
        for path in sorted(folder.rglob("*.py")):
            yield f"{name}/{path.relative_to(folder).as_posix()}", ast.parse(path.read_bytes())


def imported(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Call) and name_of(node.func).endswith("import_module"):
            yield from (one.value for one in node.args if isinstance(one, ast.Constant))


def name_of(node: ast.expr) -> str:
    """Such as os.path.join; empty for what has no name."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        return f"{name_of(node.value)}.{node.attr}"
    return ""


def modules_of(tree: ast.AST) -> set[str]:
    """The forbidden ones, and of urllib which part."""
    found = {name for name in imported(tree) if name.partition(".")[0] in MODULES}
    return {
        ".".join(name.split(".")[:2]) if name.startswith("urllib") else name.partition(".")[0]
        for name in found
    }


def calls_of(tree: ast.AST) -> Iterator[ast.Call]:
    return (node for node in ast.walk(tree) if isinstance(node, ast.Call))


def forbidden(tree: ast.AST) -> set[str]:
    """Modules and calls."""
    names = {name_of(call.func) for call in calls_of(tree)}
    os_calls = tuple(f"os.{name}" for name in OF_OS)
    return modules_of(tree) | {n for n in names if n in CALLS or n.startswith(os_calls)}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("import pickle", {"pickle"}),
        ("from urllib.request import urlopen", {"urllib.request"}),
        ("from concurrent import futures", {"concurrent"}),
        ("def f():\n  import subprocess as s\n  s.run(['ls'])", {"subprocess"}),
        ("eval('1')", {"eval"}),
        ("import os\nos.system('ls'); os.execvp('ls', [])", {"os.system", "os.execvp"}),
        ("import importlib\nimportlib.import_module('socket')", {"socket"}),
        ("# import pickle\ntext = 'eval(1)'\nre.compile('x')\nmodel.eval()", set()),
        ("from . import code\nfrom .http import get", set()),
    ],
)
def test_the_search_finds_what_it_looks_for(text, found):
    assert forbidden(ast.parse(text)) == found


def test_nothing_else_that_ships_can_run_or_reach_anything():
    found = {(file, name) for file, tree in sources() for name in forbidden(tree)}
    assert found == set(INTENDED)


def test_arrays_are_read_without_objects():
    """An object in an array is a pickle, which runs programs."""
    seen = 0
    for file, tree in sources():
        for call in calls_of(tree):
            if name_of(call.func) not in {"np.load", "numpy.load", "np.save", "np.savez"}:
                continue
            allowed = {k.arg: k.value for k in call.keywords}.get("allow_pickle")
            said = isinstance(allowed, ast.Constant) and allowed.value is False
            assert said or name_of(call.func) == "np.savez", f"{file}:{call.lineno}"
            seen += 1
    assert seen > 5


def test_the_extension_asks_for_files_alone():
    manifest = tomllib.loads((ROOT / "addon" / "blender_manifest.toml").read_text())
    assert list(manifest["permissions"]) == ["files"]


def test_the_page_names_what_is_intended():
    page = (ROOT / "SECURITY.md").read_text()
    for file, name in INTENDED:
        module = file.removesuffix(".py").replace("/", ".")
        assert name.partition(".")[0] in page.lower() or module in page, (file, name)
