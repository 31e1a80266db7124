# SPDX-License-Identifier: GPL-3.0-or-later
"""What the test command and the style checks rely on."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SOURCES = {
    "a.hpp": "",
    "a.cpp": '#include "a.hpp"\n',
    "b.hpp": '#include "a.hpp"\n',
    "b.cpp": '#include "b.hpp"\n',
    "deep.hpp": "",
    "only.hpp": '#include "deep.hpp"\n',
    "only.cpp": '#include "only.hpp"\n',
}
EVERY = ["a.cpp", "b.cpp", "only.cpp"]


def git(folder, *arguments):
    identity = ["-c", "user.name=Test", "-c", "user.email=test@localhost"]
    return subprocess.run(
        ["git", *identity, *arguments], cwd=folder, check=True, capture_output=True, text=True
    ).stdout.strip()


def commit(folder):
    git(folder, "add", "-A")
    git(folder, "commit", "-qm", "A change")


def edit(folder, name):
    with Path(folder, name).open("a") as file:
        file.write("// changed\n")


@pytest.fixture
def checkout(tmp_path, root):
    """A repository with the style checks, some sources, and a clang-tidy that notes its files."""
    if not shutil.which("git") or not shutil.which("bash"):
        pytest.skip("needs git and bash")
    for folder in ("scripts", "native", "build/venv/bin"):
        (tmp_path / folder).mkdir(parents=True)
    for name in ("check.sh", "common.sh", "requirements-tools.txt"):
        shutil.copy(root / "scripts" / name, tmp_path / "scripts")
    for name, text in SOURCES.items():
        (tmp_path / "native" / name).write_text(text)
    (tmp_path / ".clang-tidy").write_text("Checks: '*'\n")
    (tmp_path / ".gitignore").write_text("build\n")
    configures = tmp_path / "build/venv/bin/cmake"
    configures.write_text(
        "#!/bin/sh\nmkdir -p build/tidy/commands\n"
        "echo '[]' >build/tidy/commands/compile_commands.json\n"
    )
    configures.chmod(0o755)
    tool = tmp_path / "build/venv/bin/clang-tidy"
    tool.write_text('#!/bin/sh\nfor last; do :; done\necho "${last##*/}" >>build/looked-at\n')
    tool.chmod(0o755)
    git(tmp_path, "init", "-qb", "main")
    commit(tmp_path)
    return tmp_path


def looked_at(checkout, *options):
    """The sources that clang-tidy looks at, in a folder where it has not been run before."""
    shutil.rmtree(checkout / "build" / "tidy", ignore_errors=True)
    return looked_at_again(checkout, *options)


def looked_at_again(checkout, *options):
    noted = checkout / "build" / "looked-at"
    noted.write_text("")
    command = ["scripts/check.sh", "--only", "clang-tidy", *options]
    done = subprocess.run(command, cwd=checkout, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return sorted(noted.read_text().split())


def test_clang_tidy_looks_at_every_source_of_a_first_commit(checkout):
    assert looked_at(checkout) == EVERY


def test_clang_tidy_looks_at_the_sources_of_a_changed_header(checkout):
    edit(checkout, "native/b.hpp")
    commit(checkout)
    assert looked_at(checkout) == ["b.cpp"]
    edit(checkout, "native/a.hpp")
    commit(checkout)
    assert looked_at(checkout) == ["a.cpp"]
    assert looked_at(checkout, "--since", "HEAD~2") == ["a.cpp", "b.cpp"]
    assert looked_at(checkout, "--all") == EVERY


def test_clang_tidy_finds_sources_behind_a_header_that_only_headers_include(checkout):
    edit(checkout, "native/deep.hpp")
    commit(checkout)
    assert looked_at(checkout) == ["only.cpp"]


def test_clang_tidy_looks_at_what_is_not_committed(checkout):
    edit(checkout, "native/a.cpp")
    commit(checkout)
    edit(checkout, "native/only.cpp")
    (checkout / "native" / "new.cpp").write_text("")
    assert looked_at(checkout) == ["a.cpp", "new.cpp", "only.cpp"]


def test_clang_tidy_looks_at_all_commits_of_a_branch(checkout):
    git(checkout, "update-ref", "refs/remotes/origin/main", "HEAD")
    for name in ("a.cpp", "only.cpp"):
        edit(checkout, f"native/{name}")
        commit(checkout)
    assert looked_at(checkout) == ["a.cpp", "only.cpp"]


def test_clang_tidy_goes_on_from_the_commit_that_it_found_clean(checkout):
    assert looked_at(checkout) == EVERY
    for name in ("a.cpp", "b.cpp"):
        edit(checkout, f"native/{name}")
        commit(checkout)
    assert looked_at_again(checkout) == ["a.cpp", "b.cpp"]
    assert looked_at_again(checkout) == []


def test_clang_tidy_looks_at_every_source_when_its_rules_change(checkout):
    edit(checkout, "native/a.cpp")
    commit(checkout)
    (checkout / ".clang-tidy").write_text("Checks: '-*'\n")
    commit(checkout)
    assert looked_at(checkout) == EVERY


def tally(root, *reports):
    command = [sys.executable, root / "tests" / "tally.py", *reports]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()


def test_reports_are_added_up_and_name_what_failed(root, tmp_path):
    (tmp_path / "test_mixed.py").write_text(
        "import pytest\n"
        "def test_good(): pass\n"
        "def test_bad(): assert False\n"
        "@pytest.mark.skip\ndef test_left(): pass\n"
        "@pytest.fixture\ndef broken(): raise ValueError\n"
        "def test_error(broken): pass\n"
    )
    report = tmp_path / "pytest.xml"
    command = [sys.executable, "-m", "pytest", "-q", "--rootdir", tmp_path, tmp_path]
    subprocess.run([*command, f"--junitxml={report}"], stdout=subprocess.DEVNULL, cwd=tmp_path)
    ctest = tmp_path / "ctest.xml"
    ctest.write_text(
        '<testsuite tests="3" failures="1" disabled="0" skipped="0">'
        '<testcase name="Plane.IsFlat" classname="Plane.IsFlat"><failure message=""/></testcase>'
        '<testcase name="a" classname="a"/><testcase name="b" classname="b"/></testsuite>'
    )
    counts, *failed = tally(root, report, ctest)
    assert counts.split() == ["3", "3", "1"]
    assert failed == ["test_mixed test_bad", "test_mixed test_error", "Plane.IsFlat Plane.IsFlat"]
    assert tally(root, "--sentence", report, ctest) == ["3 passed, 3 failed"]


def test_a_report_that_is_missing_or_cut_off_counts_nothing(root, tmp_path):
    cut = tmp_path / "cut.xml"
    cut.write_text('<testsuites><testsuite tests="3" failures="0">')
    assert tally(root, cut, tmp_path / "none.xml") == ["0 0 0"]
    assert tally(root, "--sentence", cut) == ["failed before any test"]


def table(root, path, *cells):
    command = [sys.executable, root / "tests" / "platforms.py", path, *cells]
    subprocess.run(command, check=True)
    return path.read_text().splitlines()


def test_a_platform_that_ran_again_changes_its_own_line_of_the_table_alone(root, tmp_path):
    path = tmp_path / "platforms.md"
    head = ["| platform | built | tests run | loaded in Blender |", "|---|---|---|---|"]
    assert table(root, path, "Here", "yes", "3 passed", "") == [
        *head,
        "| Here | yes | 3 passed | no |",
    ]
    path.write_text("What ran:\n\n" + path.read_text() + "\nMore.\n")
    table(root, path, "There", "yes", "", "")
    assert table(root, path, "Here", "yes", "4 passed", "4.5: 2 passed") == [
        "What ran:",
        "",
        *head,
        "| Here | yes | 4 passed | 4.5: 2 passed |",
        "| There | yes | no | no |",
        "",
        "More.",
    ]


ALONE = "--zip goes with --only package"
MISSING = "none.zip: No such file or directory"


@pytest.mark.parametrize(
    ("options", "said"),
    [(["--zip", "README.md"], ALONE), (["--only", "package", "--zip", "none.zip"], MISSING)],
)
def test_a_zip_to_be_tested_exists_and_is_asked_for_alone(root, options, said):
    if not shutil.which("bash"):
        pytest.skip("needs bash")
    command = ["bash", "tests/run.sh", *options]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True)
    assert done.returncode == 1
    assert said in done.stderr


@pytest.mark.parametrize(
    ("build", "summary"), [("false", "0 passed, 1 failed"), ("true", "2 passed")]
)
def test_native_tests_wait_for_their_build_and_its_errors_count(root, tmp_path, build, summary):
    if not shutil.which("bash"):
        pytest.skip("needs bash")
    for folder in ("scripts", "tests", "build/venv/bin"):
        (tmp_path / folder).mkdir(parents=True)
    for name in ("scripts/common.sh", "tests/run.sh", "tests/tally.py"):
        shutil.copy(root / name, tmp_path / name)
    python = tmp_path / "build/venv/bin/python"
    ctest = tmp_path / "build/venv/bin/ctest"
    setup = tmp_path / "scripts/setup.sh"
    python.write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n')
    ctest.write_text("#!/bin/sh\n[ -f built ] && echo tested\n")
    setup.write_text(
        '#!/bin/sh\n[ "$1" = --tests ] || exit 0\nsleep 0.5\n'
        f"echo 'not compiled' >&2\ntouch built\n{build}\n"
    )
    for tool in (python, ctest, setup):
        tool.chmod(0o755)
    command = ["bash", "tests/run.sh", "--only", "native"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert summary in done.stdout
    assert (done.returncode, "not compiled" in done.stderr) == (
        (1, True) if build == "false" else (0, False)
    )
    assert ("tested" in done.stdout) == (build == "true")


def test_help_of_the_examples_sets_nothing_up(root, tmp_path):
    if not shutil.which("bash"):
        pytest.skip("needs bash")
    for name in ("scripts/common.sh", "blend_examples/run.sh"):
        (tmp_path / name).parent.mkdir()
        shutil.copy(root / name, tmp_path / name)
    for options in (["--help"], ["meadow", "-h"]):
        command = ["bash", "blend_examples/run.sh", *options]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        assert done.stdout.startswith("blend_examples/run.sh [SCENE]")
        assert "--count N" in done.stdout
