# SPDX-License-Identifier: GPL-3.0-or-later
"""Workflows: what a host with runners does by itself, and what it must not."""

from pathlib import Path

import pytest

yaml = pytest.importorskip("yaml", reason="pyyaml is not installed")
WORKFLOWS = sorted((Path(__file__).parents[2] / ".github" / "workflows").glob("*.yml"))


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


@pytest.mark.parametrize("name", JOBS)
def test_a_job_calls_scripts_that_there_are(root, name):
    """What a host runs, anyone can run: there is no more than a line in a workflow."""
    for command in commands(JOBS[name]):
        assert "\n" not in command.strip()
        words = [word for word in command.split() if word.endswith((".sh", ".py", "ci/run"))]
        assert all((root / word).is_file() for word in words), command


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_a_workflow_may_only_read_unless_a_job_says_more(path):
    assert yaml.safe_load(path.read_text())["permissions"] == {"contents": "read"}


def test_publishing_is_asked_for_and_approved_by_a_person():
    uploads = [name for name, job in JOBS.items() if "twine" in str(job)]
    more = [name for name, job in JOBS.items() if "permissions" in job]
    assert sorted({*uploads, *more}) == sorted({"release:draft", "release:publish"} & JOBS.keys())
    for name in uploads:
        assert JOBS[name]["environment"] == "release"
        assert JOBS[name]["if"] == "inputs.publish"
    for path in WORKFLOWS:
        if path.stem == "release":  # `on` is the truth value in YAML
            assert list(yaml.safe_load(path.read_text())[True]) == ["workflow_dispatch"]
