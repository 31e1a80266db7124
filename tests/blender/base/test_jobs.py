# SPDX-License-Identifier: GPL-3.0-or-later
"""Background work: every way in which it can end."""

from types import SimpleNamespace

import addon_host
import pytest


@pytest.fixture
def jobs():
    return addon_host.part("blender.base.jobs")


@pytest.fixture
def made(jobs, monkeypatch):
    """A job of steps whose end is recorded."""
    found = SimpleNamespace(done=[], failed=[], stopped=[], undo=[])
    monkeypatch.setattr(jobs, "push_undo", found.undo.append)

    def make(generator, **options):
        def done(result):
            found.done.append(result)
            return "Step"

        found.job = jobs.Job(
            "Bake", generator, done, found.failed.append, found.stopped.append, **options
        )
        return found

    yield make
    found.job.abandon()


def two_tasks(steps):
    first = yield steps.Task(lambda _: 20)
    second = yield steps.Task(lambda _: 1, 0.5)
    return first + second


def test_its_result_is_followed_by_one_undo_step(made, steps):
    found = made(two_tasks(steps), whole=False)
    while not found.job.go_on(0.01):
        assert found.job.is_running
    assert found.done == [21]
    assert found.undo == ["Step"]
    assert not found.job.is_running


def test_without_windows_all_of_it_is_done_at_once(made, steps):
    found = made(two_tasks(steps))
    found.job.begin()
    assert found.done == [21]


def test_what_fails_at_once_is_raised_and_what_fails_later_is_reported(made, steps, jobs):
    def failing():
        raise addon_host.part("core.base.errors").ScatterError("There is no surface")
        yield

    found = made(failing(), whole=False)
    with pytest.raises(addon_host.part("core.base.errors").ScatterError, match="no surface"):
        found.job.begin()
    assert not found.failed
    found = made(failing(), whole=False)
    assert found.job.go_on()
    assert found.failed == ["There is no surface"]
    assert not found.done
    assert not found.undo


def test_an_unexpected_error_is_reported_with_the_name_of_the_work(made, capfd):
    def failing():
        yield from ()
        raise ZeroDivisionError("by nothing")

    found = made(failing(), whole=False)
    assert found.job.go_on()
    assert found.failed == ["'Bake' failed, nothing was changed: by nothing"]
    assert "ZeroDivisionError" in capfd.readouterr().err


@pytest.mark.parametrize("kept", [False, True])
def test_a_render_stops_a_job_unless_it_works_during_renders(made, steps, kept):
    found = made(two_tasks(steps), whole=False, works_during_renders=kept)
    found.job.begin()
    for event in ("render_began", "render_ended"):
        addon_host.part("blender.base.handlers").publish(event)
    assert found.job.is_running == kept
    while not found.job.go_on(0.01):
        pass
    assert bool(found.stopped) != kept
    assert bool(found.done) == kept


def test_what_is_abandoned_is_followed_by_nothing(made, steps):
    closed = []

    def watched():
        try:
            yield from two_tasks(steps)
        finally:
            closed.append(True)

    found = made(watched(), whole=False)
    found.job.begin()
    found.job.abandon()
    assert closed == [True]
    assert found.done == found.failed == found.stopped == []
    assert not found.job.is_running
