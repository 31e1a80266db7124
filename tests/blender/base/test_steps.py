# SPDX-License-Identifier: GPL-3.0-or-later
"""The modal's step function: worker thread, progress, cancel."""

import gc
import threading
import time
import weakref

import addon_host
import bpy
import pytest
import scenes


@pytest.fixture
def errors():
    return addon_host.part("core.base.errors")


def finish(stepper, limit=60.0):
    """Poll as the modal does; the result."""
    end = time.monotonic() + limit
    while not stepper.poll():
        assert time.monotonic() < end
        time.sleep(0.005)
    return stepper.result


def test_tasks_run_in_a_worker_and_answer_the_generator(steps):
    threads = []

    def work(_context):
        threads.append(threading.current_thread())
        return 7

    def generator():
        return (yield steps.Task(work)) + (yield steps.Task(work))

    assert finish(steps.Stepper(generator())) == 14
    assert threading.main_thread() not in threads
    assert steps.run_now(generator()) == 14


def test_a_thread_takes_up_one_task_after_another(steps):
    threads = []

    def generator():
        for _ in range(3):
            yield steps.Task(lambda _: threads.append(threading.current_thread()))

    for _ in range(4):
        finish(steps.Stepper(generator()))
    assert len(threads) == 12
    assert len(set(threads)) == 1


def test_what_is_abandoned_does_not_keep_others_waiting(steps):
    goes_on = threading.Event()

    def first():
        yield steps.Task(lambda _: goes_on.wait(60.0))

    def second():
        return (yield steps.Task(lambda _: "done"))

    left = steps.Stepper(first())
    left.poll()
    assert left.waits
    left.abandon()
    assert finish(steps.Stepper(second())) == "done"
    assert left.waits
    goes_on.set()


def test_an_idle_thread_keeps_nothing_of_its_task(steps):
    class Large:
        pass

    def generator():
        return (yield steps.Task(lambda _: Large()))

    stepper = steps.Stepper(generator())
    seen = weakref.ref(finish(stepper))
    del stepper
    gc.collect()
    assert seen() is None


def test_disabling_ends_idle_threads(steps):
    worker = addon_host.part("core.base.steps")

    def generator():
        yield steps.Task(lambda _: None)

    finish(steps.Stepper(generator()))
    assert worker.free_threads()
    worker.end_free_threads()
    end = time.monotonic() + 60.0
    while [thread for thread in threading.enumerate() if thread.name == "dapple"]:
        assert time.monotonic() < end
        time.sleep(0.005)
    assert not worker.free_threads()
    finish(steps.Stepper(generator()))  # and new ones appear


def test_an_error_of_the_worker_is_raised_where_it_was_asked_for(steps):
    def fail(_context):
        raise ValueError("no")

    def generator():
        try:
            yield steps.Task(fail)
        except ValueError as error:
            return str(error)

    assert finish(steps.Stepper(generator())) == "no"
    assert steps.run_now(generator()) == "no"


@pytest.mark.parametrize("smoothing", ["FORWARD", "BOTH_WAYS"])
def test_a_bake_in_steps_gives_what_a_bake_at_once_gives(steps, smoothing, monkeypatch):
    baking = addon_host.part("blender.bake.steps")
    monkeypatch.setattr(addon_host.part("core.bake.window_bake"), "PIECE", 3)
    monkeypatch.setattr(addon_host.part("core.bake.window_bake"), "OVERLAP", 1)
    obj = scenes.scattered(scenes.tail())
    obj.dapple.smoothing = smoothing
    bpy.context.scene.frame_set(3)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    expected = scenes.positions(obj)
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    stepper = steps.Stepper(baking.bake_steps(bpy.context, 1, 6))
    progress = [stepper.progress]
    while not stepper.poll():
        progress.append(stepper.progress)
    assert progress == sorted(progress)
    assert 0.0 <= progress[0] <= progress[-1] <= 1.0
    assert bpy.context.scene.frame_current == 3
    assert (scenes.positions(obj) == expected).all()


@pytest.mark.parametrize("polls", [0, 1, 3])
def test_a_canceled_bake_leaves_the_scene_as_it_was(steps, errors, polls):
    baking = addon_host.part("blender.bake.steps")
    scenes.scattered(scenes.tail(), count=300)
    bpy.context.scene.frame_set(3)
    before = scenes.snapshot()
    stepper = steps.Stepper(baking.bake_steps(bpy.context, 1, 6))
    for _ in range(polls):
        stepper.poll()
    stepper.cancel()
    with pytest.raises(errors.StoppedError):
        finish(stepper)
    stepper.close()
    assert scenes.snapshot() == before


def held(obj):
    return addon_host.part("blender.base.object_handles").ObjectHandle(obj)


def test_a_canceled_optimization_leaves_the_scene_as_it_was(steps, errors):
    work = addon_host.part("blender.solve.optimize")
    obj = scenes.scattered(scenes.tail())
    obj.dapple.count, obj.dapple.tolerance, obj.dapple.max_evaluations = 3000, 1e-9, 100_000
    before = scenes.snapshot()
    stepper = steps.Stepper(work.optimize_steps(held(obj)))
    while not stepper.progress:  # until it is being solved
        stepper.poll(wait=0.01)
    stepper.cancel()
    with pytest.raises(errors.StoppedError):
        finish(stepper)
    stepper.close()
    assert scenes.snapshot() == before


def test_closing_stops_the_worker_and_restores_the_frame(steps):
    baking = addon_host.part("blender.bake.steps")
    scenes.scattered(scenes.tail())
    bpy.context.scene.frame_set(2)
    before = scenes.snapshot()
    stepper = steps.Stepper(baking.bake_steps(bpy.context, 1, 6))
    stepper.poll()
    stepper.close()
    assert scenes.snapshot() == before
    assert not stepper.waits
    at_work = [thread for thread in threading.enumerate() if thread.name == "dapple"]
    assert len(at_work) == addon_host.part("core.base.steps").free_threads()


def test_a_scatter_removed_meanwhile_is_named(steps, errors):
    work = addon_host.part("blender.solve.optimize")
    obj = scenes.scattered(scenes.tail())
    name = obj.name
    stepper = steps.Stepper(work.optimize_steps(held(obj)))
    stepper.poll()
    bpy.data.objects.remove(obj)
    with pytest.raises(errors.ScatterError, match=f"'{name}' was removed"):
        finish(stepper)
    stepper.close()
