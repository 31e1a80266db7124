# SPDX-License-Identifier: GPL-3.0-or-later
"""Workflows: what a host with runners does by itself, and what it must not."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

yaml = pytest.importorskip("yaml", reason="pyyaml is not installed")
ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
# Steps that request permission to publish, or do so.
PUBLISHING = ("twine", "gh-action-pypi-publish", "id-token", "packages: write", "pages: write")


def jobs() -> dict[str, dict]:
    """Jobs of all workflows by file and name."""
    return {
        f"{path.stem}:{name}": job
        for path in WORKFLOWS
        for name, job in yaml.safe_load(path.read_text())["jobs"].items()
    }


JOBS = jobs()


def commands(job: dict) -> list[str]:
    return [step["run"] for step in job.get("steps", []) if "run" in step]


def steps(job: dict, action: str) -> list[dict]:
    """What a job hands to an action each time."""
    return [step.get("with", {}) for step in job["steps"] if action in step.get("uses", "")]


@pytest.mark.parametrize("name", JOBS)
def test_a_job_calls_scripts_that_there_are(root, name):
    """What a host runs, anyone can run: there is no more than a line in a workflow."""
    for command in commands(JOBS[name]):
        assert "\n" not in command.strip()
        words = [word for word in command.split() if word.endswith((".sh", ".py", "ci/run"))]
        assert all((root / word).is_file() for word in words), command


@pytest.mark.parametrize("name", JOBS)
def test_lines_are_sound_shell(name):
    shellcheck = shutil.which("shellcheck")
    if not shellcheck:
        pytest.skip("shellcheck is not installed")
    text = "#!/bin/bash\n" + "\n".join(commands(JOBS[name])) + "\n"
    text = re.sub(r"\$\{\{.*?\}\}", "value", text)
    found = subprocess.run(
        [shellcheck, "-"], input=text, capture_output=True, text=True, check=False
    )
    assert found.returncode == 0, found.stdout + found.stderr


@pytest.mark.parametrize("name", JOBS)
def test_actions_have_a_version_and_contexts_are_there(name):
    job = JOBS[name]
    assert all(re.search(r"@v\d+$", step["uses"]) for step in job["steps"] if "uses" in step)
    whole = {key: value for key, value in job.items() if key != "steps"}
    # only steps know these contexts
    assert not re.search(r"\b(runner|steps|env|job)\.\w", str(whole))


@pytest.mark.parametrize("name", JOBS)
def test_what_a_job_downloads_one_before_it_has_uploaded(name):
    job, workflow = JOBS[name], name.partition(":")[0]
    needed = [job["needs"]] if isinstance(job.get("needs"), str) else job.get("needs", [])
    before = [JOBS[f"{workflow}:{other}"] for other in needed]
    uploaded = {one["name"] for other in before for one in steps(other, "upload-artifact")}
    assert {one["name"] for one in steps(job, "download-artifact")} <= uploaded


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_a_workflow_may_only_read_unless_a_job_says_more(path):
    assert yaml.safe_load(path.read_text())["permissions"] == {"contents": "read"}


def test_nothing_is_published():
    """There is a draft, which a person publishes; and a person has asked for it, by a tag."""
    text = "".join(path.read_text() for path in WORKFLOWS)
    assert [word for word in PUBLISHING if word in text] == []
    more = {name: job["permissions"] for name, job in JOBS.items() if "permissions" in job}
    drafts = [name for name, job in JOBS.items() if "scripts/draft_release.sh" in str(job)]
    assert more == {name: {"contents": "write"} for name in drafts}
    assert all(JOBS[name]["if"] == "github.ref_type == 'tag'" for name in drafts)


def test_the_table_of_a_release_tells_only_systems_that_were_tested():
    """Each line of the draft's table is of a runner that its tests had to pass on."""
    systems = JOBS["release:test"]["strategy"]["matrix"]["system"]
    lines = [line for line in commands(JOBS["release:draft"]) if "platforms.py" in line]
    told = [re.search(r"tests, (?:Server|macOS) (\d+)", line)[1] for line in lines]
    tested = [re.search(r"\d+", system)[0] for system in systems if "ubuntu" not in system]
    assert sorted(told) == sorted(tested)
    assert "test" in JOBS["release:draft"]["needs"]
