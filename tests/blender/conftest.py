# SPDX-License-Identifier: GPL-3.0-or-later
"""Every test starts from a fresh file, with the add-on enabled as an extension.

Processes side by side that are given one folder by DAPPLE_TAKEN share the test files out among
them: pytest-xdist does not fit, its workers have no Blender executable around them.
"""

import atexit
import functools
import itertools
import os
import shutil
import sys
import tempfile
from collections import Counter
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
_HOME = tempfile.mkdtemp(prefix="dapple-blender-")
os.environ.setdefault("BLENDER_USER_RESOURCES", _HOME)  # never the user's own settings
import bpy  # noqa: E402 - after the environment is set, before Blender's own modules

sys.path[:0] = [str(HERE), *(str(one) for one in HERE.iterdir() if one.is_dir())]
import addon_host  # noqa: E402
import child  # noqa: E402
import following  # noqa: E402
import pressing  # noqa: E402
import probe  # noqa: E402
import startup  # noqa: E402

_status = [1]  # replaced by the result of the tests
_TAKEN = os.environ.get("DAPPLE_TAKEN")


def pytest_sessionstart(session):
    """Enable the add-on; test files may look for the native package that it brings."""
    addon_host.add_repository(Path(_HOME) / "repository")
    addon_host.enable()
    if addon_host.TESTED_ZIP:
        addon_host.check_package()


def pytest_configure(config):
    """Name the marks."""
    config.addinivalue_line("markers", "sampled(n): one case in n, unless DAPPLE_THOROUGH is set")
    config.addinivalue_line("markers", "empty_file: begin without node groups, as Blender does")


def pytest_collection_modifyitems(config, items):
    """Of tests with very many cases, run some that are always the same."""
    if os.environ.get("DAPPLE_THOROUGH"):
        return
    cases, left_out = Counter(), []
    for item in items:
        mark = item.get_closest_marker("sampled")
        if mark:
            cases[item.function] += 1
            if cases[item.function] % mark.args[0]:
                left_out.append(item)
    config.hook.pytest_deselected(items=left_out)
    items[:] = [item for item in items if item not in left_out]


@functools.cache
def _takes(name):
    """Whether this process is the first to claim a test file."""
    try:
        Path(_TAKEN, name).touch(exist_ok=False)
    except FileExistsError:
        return False
    return True


def _taken(items):
    """Test items of files that no other process has claimed, file by file."""
    for name, group in itertools.groupby(items, key=lambda item: item.path.name):
        if _takes(name):
            yield from group


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session):
    """If several processes share the tests, run files that no other one has claimed."""
    if not _TAKEN or session.testsfailed or session.config.option.collectonly:
        return None
    # pytest removes what tests share, such as a folder, once the following test does not need it.
    for item, following_item in itertools.pairwise(itertools.chain(_taken(session.items), [None])):
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=following_item)
        if session.shouldfail:
            raise session.Failed(session.shouldfail)
        if session.shouldstop:
            raise session.Interrupted(session.shouldstop)
    return True


@pytest.fixture(scope="session")
def addon():
    """Package of the enabled extension, e.g. for addon.core."""
    yield sys.modules[addon_host.MODULE]
    addon_host.disable()


@pytest.fixture(autouse=True)
def fresh_file(request, addon):
    """An empty scene, no work files of another test's bakes, and no presets of its."""
    shutil.rmtree(Path(bpy.app.tempdir, "dapple"), ignore_errors=True)
    shutil.rmtree(addon_host.part("blender.presets.stored").folder(), ignore_errors=True)
    startup.empty() if request.node.get_closest_marker("empty_file") else startup.begin()
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 6


@pytest.fixture
def live():
    """Scatters that follow changes, driven by hand."""
    with following.driven() as driver:
        yield driver


@pytest.fixture
def artist():
    """Buttons of long work as in a Blender with windows, driven by hand."""
    with pressing.windowed() as pressed:
        yield pressed


@pytest.fixture
def overlay(monkeypatch):
    """The module of the density as colors, which waits for no pause in changes."""
    module = addon_host.part("blender.density.overlay")
    monkeypatch.setattr(module, "PAUSE", 0.0)
    return module


@pytest.fixture
def steps():
    """The module of work in steps."""
    return addon_host.part("core.base.steps")


@pytest.fixture
def engine():
    """The render engine that records the data of a render."""
    with probe.registered():
        yield


@pytest.fixture(scope="session")
def blender(tmp_path_factory):
    """Blender as a program, or a replacement."""
    return child.program(tmp_path_factory.mktemp("program"))


@pytest.fixture
def needs_exporter():
    """Skip where this Blender cannot write files of an ending: some distributions leave USD out."""

    def check(suffix):
        try:
            addon_host.part("blender.export.prototypes").check_installed(suffix)
        except addon_host.part("core.base.errors").ScatterError as error:
            pytest.skip(str(error))

    return check


def pytest_sessionfinish(session, exitstatus):
    _status[0] = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    """Leave at once: Blender hangs at exit when a class is still registered."""
    shutil.rmtree(_HOME, ignore_errors=True)
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(_status[0])
