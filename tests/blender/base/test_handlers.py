# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender calls one function of the add-on for each event, and one timer."""

import addon_host
import bpy
import pytest
import scenes


@pytest.fixture
def handlers():
    return addon_host.part("blender.base.handlers")


@pytest.fixture
def timers():
    return addon_host.part("blender.base.timers")


@pytest.fixture
def subscribed(handlers):
    """Subscribes; unsubscribes at the end."""
    made = []

    def subscribe(**functions):
        made.append(handlers.Subscriber(**functions))
        made[-1].register()
        return made[-1]

    yield subscribe
    for one in made:
        one.unregister()


def test_each_of_blenders_lists_has_one_function_of_the_add_on():
    lists = {name: getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)}
    ours = {
        name: sum("dapple" in getattr(one, "__module__", "") for one in functions)
        for name, functions in lists.items()
        if isinstance(functions, list)
    }
    assert max(ours.values()) == 1
    assert ours["depsgraph_update_post"] == ours["load_pre"] == ours["render_init"] == 1


def test_what_fails_does_not_keep_the_others_from_being_called(subscribed, capfd):
    called = []
    subscribed(undone=lambda: 1 / 0)
    subscribed(undone=lambda: called.append("undone"))
    bpy.ops.ed.undo_push(message="Before")
    bpy.ops.ed.undo_push(message="After")
    bpy.ops.ed.undo()
    assert called == ["undone"]
    assert "ZeroDivisionError" in capfd.readouterr().err


def test_updates_are_read_once_and_say_what_was_edited(subscribed):
    surface, seen = scenes.sphere(), []
    bpy.context.view_layer.update()
    subscribed(updated=seen.append)
    subscribed(updated=seen.append)
    surface.location.x = 2.0
    bpy.context.view_layer.update()
    assert seen[0] is seen[1]
    assert seen[0].updates is seen[1].updates
    assert [(obj, one.is_edited) for obj, one in seen[0].objects()] == [(surface, True)]


def test_who_has_unsubscribed_is_called_no_more(subscribed):
    called = []
    one = subscribed(before_load=lambda: called.append(1), disabled=lambda: called.append(2))
    one.unregister()
    assert called == [2]
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    assert called == [2]


def test_one_timer_calls_all_in_time_and_goes_on_after_one_that_fails(timers, monkeypatch, capfd):
    now, called = [0.0], []
    monkeypatch.setattr(timers.time, "monotonic", lambda: now[0])

    def again():
        called.append("again")
        return 0.5

    def failing():
        raise OSError("no more")

    try:
        timers.call_in(0.1, failing)
        timers.call_in(0.1, again)
        timers.call_in(2.0, called.clear)
        timers.call_within(9.0, again)
        timers.run_due()
        assert called == []
        now[0] = 0.2
        assert timers.run_due() <= 0.5
        assert called == ["again"]
        assert "no more" in capfd.readouterr().err
        assert not timers.is_due(failing)
        now[0] = 2.5
        timers.run_due()
        assert not timers.is_due(called.clear)
    finally:
        timers.call_off(again)


def test_a_call_that_is_asked_for_while_it_runs_is_not_lost(timers, monkeypatch):
    now, called = [0.0], []
    monkeypatch.setattr(timers.time, "monotonic", lambda: now[0])

    def once_more():
        called.append(now[0])
        if len(called) == 1:
            timers.call_in(0.0, once_more)

    timers.call_in(0.0, once_more)
    timers.run_due()
    assert timers.is_due(once_more)
    timers.run_due()
    assert called == [0.0, 0.0]
    assert not timers.is_due(once_more)
