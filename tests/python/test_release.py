# SPDX-License-Identifier: GPL-3.0-or-later
"""What a release promises, its notes and draft, and the page that tells how to make one."""

import importlib.util
import os
import platform
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
_SPEC = importlib.util.spec_from_file_location("notes", ROOT / "scripts" / "release_notes.py")
notes = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(notes)

CHANGELOG = """# Changelog

## [1.2.0] - 2027-01-02

### Added

- One thing, told in two
  lines ([docs/one.md](docs/one.md), [elsewhere](https://example.org)).
- Another.

## [1.1.0] - 2026-12-01

- Older.
"""


def test_notes_are_the_first_section_for_a_page_without_a_checkout():
    text = notes.standing_alone(notes.section(CHANGELOG, "1.2.0"))
    assert text.splitlines() == [
        "### Added",
        "",
        "- One thing, told in two lines (docs/one.md, [elsewhere](https://example.org)).",
        "- Another.",
    ]


def test_another_version_or_no_date_is_refused():
    with pytest.raises(SystemExit, match=r'begins with "## \[1.2.0\] - 2027-01-02", not with'):
        notes.section(CHANGELOG, "1.3.0")
    unreleased = CHANGELOG.replace("[1.2.0] - 2027-01-02", "[Unreleased]")
    with pytest.raises(SystemExit, match="Unreleased"):
        notes.section(unreleased, "1.2.0")
    assert "Another" in notes.section(unreleased, "1.2.0", draft=True)


def test_the_changelog_of_today_makes_notes(root):
    command = [sys.executable, root / "scripts" / "release_notes.py", "--draft"]
    found = subprocess.run(command, capture_output=True, text=True, check=True)
    assert found.stdout.startswith("### ")
    assert "](docs/" not in found.stdout


def test_a_tag_of_another_version_is_refused(root):
    now = notes.version((root / "CMakeLists.txt").read_text())
    command = [sys.executable, root / "scripts" / "release_notes.py", "--draft", "--tag"]
    found = subprocess.run([*command, "v99.0"], capture_output=True, text=True, check=False)
    assert found.returncode == 1
    assert f"the tag is v99.0, but CMakeLists.txt names version {now}" in found.stderr
    subprocess.run([*command, f"v{now}"], capture_output=True, check=True)


@pytest.fixture
def checkout(root, tmp_path) -> Path:
    """A repository that has a release's scripts, its changelog, and its files in `files`."""
    (tmp_path / "scripts").mkdir()
    for name in ("draft_release.sh", "release_notes.py"):
        target = tmp_path / "scripts" / name
        target.write_bytes((root / "scripts" / name).read_bytes())
        target.chmod(0o755)
    (tmp_path / "CHANGELOG.md").write_text(CHANGELOG)
    (tmp_path / "CMakeLists.txt").write_text("project(dapple VERSION 1.2.0 LANGUAGES CXX)\n")
    (tmp_path / "files" / "wheels").mkdir(parents=True)
    for command in (["init", "-q"], ["add", "."], ["commit", "-qm", "all"]):
        git(tmp_path, *command)
    return tmp_path


def git(folder: Path, *command: str) -> None:
    """Run git in a repository of a test."""
    settings = ["user.name=n", "user.email=e", "init.defaultBranch=main"]
    options = [word for setting in settings for word in ("-c", setting)]
    subprocess.run(["git", *options, *command], cwd=folder, check=True, capture_output=True)


def drafted(checkout: Path) -> subprocess.CompletedProcess:
    """What scripts/draft_release.sh hands to a `gh` that only prints it."""
    tools = checkout / "tools"
    tools.mkdir(exist_ok=True)
    (tools / "gh").write_text(
        '#!/bin/sh\nprintf "%s\\n" "$@"\nwhile [ "$1" != --notes-file ]; do shift; done; cat "$2"\n'
    )
    (tools / "gh").chmod(0o755)
    return subprocess.run(
        [checkout / "scripts" / "draft_release.sh", "files"],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PATH": f"{tools}{os.pathsep}{os.environ['PATH']}"},
    )


def test_a_release_is_a_draft_with_its_files_and_notes(checkout):
    made = {"dapple3d-1.2.0.tar.gz", "dapple-1.2.0-linux-x64.zip", "wheels/dapple3d-1.2.0-any.whl"}
    for name in {*made, "tested.md"}:
        (checkout / "files" / name).write_text(f"of {name}\n")
    found = drafted(checkout)
    assert found.returncode == 0, found.stderr
    said = found.stdout.splitlines()
    assert said[:4] == ["release", "create", "v1.2.0", "--draft"]
    assert {f"files/{name}" for name in made} <= set(said)
    assert "files/tested.md" not in said
    assert said[-3:] == ["- Another.", "", "of tested.md"]


def test_without_files_there_is_no_draft(checkout):
    found = drafted(checkout)
    assert found.returncode == 1
    assert "files has no wheels" in found.stderr


def test_a_tag_elsewhere_is_no_place_for_these_files(checkout):
    """The host would make the release of the tag's commit, whatever the files were made of."""
    (checkout / "files" / "dapple3d-1.2.0.tar.gz").write_text("sources\n")
    git(checkout, "tag", "-a", "v1.2.0", "-m", "a release")
    assert drafted(checkout).returncode == 0
    git(checkout, "commit", "--allow-empty", "-qm", "more")
    found = drafted(checkout)
    assert found.returncode == 1
    assert "the tag v1.2.0 is another commit than this one" in found.stderr


# Promises that several pages repeat


def found_in(root: Path, name: str, pattern: str) -> set[str]:
    """All that a pattern's group matches in a file."""
    return set(re.findall(pattern, (root / name).read_text(), re.MULTILINE))


def test_everything_is_for_the_same_pythons(root):
    told = {
        "release": found_in(root, "scripts/release.sh", r"^pythons=\((.*?)\)"),
        "dependencies": found_in(root, "scripts/dependencies.sh", r"^pythons=\((.*?)\)"),
        "workflow": found_in(root, ".github/workflows/release.yml", r"^ +python: \[(.*)\]"),
        "native": found_in(root, "pyproject.toml", r"^build = \[(.*)\]"),
    }
    numbers = {name: re.findall(r"3\.?(\d\d)", str(found)) for name, found in told.items()}
    assert numbers == {name: ["11", "13"] for name in told}
    for number in ("3.11", "3.13"):
        assert f"Python :: {number}" in (root / "pyproject.toml").read_text()


def test_everything_is_for_the_same_oldest_linux(root):
    dots, underscores = r"(\d+\.\d+)", r"(\d+_\d+)"
    told = {
        *found_in(root, "scripts/dependencies.sh", rf"-linux-gnu\.{dots}"),
        *found_in(root, "scripts/release.sh", rf"manylinux_{underscores}"),
        *found_in(root, "scripts/audit.py", r"^GLIBC = \((\d+, \d+)\)"),
        *found_in(root, "pyproject.toml", rf"manylinux_{underscores}"),
    }
    assert {re.sub(r"\D+", ".", one) for one in told} == {"2.28"}


def test_everything_is_for_the_same_oldest_macos(root):
    told = {
        *found_in(root, "scripts/dependencies.sh", r"-macos\.(\d+\.\d+)"),
        *found_in(root, "scripts/release.sh", r"macosx_(\d+_\d+)"),
        *found_in(root, "scripts/audit.py", r"^MACOS_LEAST = \((\d+, \d+)\)"),
    }
    assert {re.sub(r"\D+", ".", one) for one in told} == {"11.0"}


def test_wheels_of_every_platform_are_tested_on_it(root):
    (platforms,) = found_in(root, "scripts/release.sh", r"platforms=\((linux.*)\)")
    (systems,) = found_in(root, ".github/workflows/release.yml", r"^ +system: \[(.*)\]")
    runners = {"ubuntu": "linux-x64", "windows": "windows-x64", "macos": "macos-arm64"}
    tested = [
        "macos-x64" if system.endswith("-intel") else runners[system.partition("-")[0]]
        for system in systems.split(", ")
    ]
    assert sorted(tested) == sorted(platforms.split())


# The page about releases


def shell_lines(page: Path) -> list[str]:
    blocks = re.findall(r"^ *```sh\n(.*?)^ *```", page.read_text(), re.MULTILINE | re.DOTALL)
    return [line.strip() for block in blocks for line in block.splitlines()]


def test_the_page_names_scripts_and_files_that_there_are(root):
    page = root / "docs" / "releasing.md"
    for line in shell_lines(page):
        command = line.split()[0]
        if command not in ("git", "rsync", "twine"):
            assert os.access(root / command, os.X_OK), line
    named = re.findall(r"`([\w./-]+/[\w.-]+\.\w+)`", page.read_text())
    assert len(named) > 5
    assert [name for name in named if not (root / name).is_file()] == []


def test_the_page_does_what_the_workflow_does(root):
    """A person without such a host makes the same release."""
    workflow = (root / ".github" / "workflows" / "release.yml").read_text()
    steps = re.findall(r"- run: ((?:scripts|tests)/.*)", workflow)
    lines = shell_lines(root / "docs" / "releasing.md")
    assert [line for line in lines if line in steps] == steps


@pytest.mark.skipif(
    (platform.system(), platform.machine()) != ("Linux", "x86_64"), reason="packages are made there"
)
def test_a_new_checkout_is_set_up_before_it_is_packaged(root, tmp_path):
    (tmp_path / "scripts").mkdir()
    for name in ("package.sh", "common.sh", "extension.sh"):
        shutil.copy(root / "scripts" / name, tmp_path / "scripts")
    script = tmp_path / "scripts" / "setup.sh"
    script.write_text("#!/bin/sh\necho set up\nexit 7\n")
    script.chmod(0o755)
    found = subprocess.run(
        [tmp_path / "scripts" / "package.sh"], capture_output=True, text=True, check=False
    )
    assert (found.returncode, found.stdout) == (7, "set up\n"), found.stderr
