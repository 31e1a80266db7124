# SPDX-License-Identifier: GPL-3.0-or-later
"""What changes again and again is worked on once it has rested."""

import pytest

from addon.core.base.schedule import PAUSE, Schedule


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def schedule(clock: Clock) -> Schedule:
    return Schedule(clock)


def test_nothing_is_taken_before_it_has_rested(schedule, clock) -> None:
    schedule.change(1)
    assert schedule.take() is None
    assert schedule.wait() == pytest.approx(PAUSE)
    clock.now += 0.9 * PAUSE
    assert schedule.take() is None
    clock.now += 0.2 * PAUSE
    assert schedule.wait() == 0.0
    assert schedule.take() == 1
    assert schedule.take() is None
    assert schedule.wait() is None
    assert not schedule


def test_each_change_begins_the_pause_anew(schedule, clock) -> None:
    for _ in range(20):
        schedule.change(1)
        clock.now += 0.9 * PAUSE
        assert schedule.take() is None
    clock.now += 0.2 * PAUSE
    assert schedule.take() == 1


def test_what_rests_longest_comes_first(schedule, clock) -> None:
    schedule.change(1)
    clock.now += 0.1 * PAUSE
    schedule.change(2)
    clock.now += 0.1 * PAUSE
    schedule.change(1)
    clock.now += 0.95 * PAUSE
    assert schedule.take() == 2
    assert schedule.take() is None
    clock.now += 0.1 * PAUSE
    assert schedule.take() == 1


def test_what_changes_no_more_does_not_wait(schedule, clock) -> None:
    for key in (1, 2):
        schedule.change(key)
    schedule.settle()
    schedule.change(3)
    schedule.change(1)
    assert schedule.wait() == 0.0
    assert schedule.take() == 2
    assert schedule.take() is None
    clock.now += PAUSE + 0.01
    assert schedule.take() == 3


def test_what_is_forgotten_is_not_taken(schedule, clock) -> None:
    schedule.change(1)
    schedule.change(2)
    schedule.forget(1)
    schedule.forget(3)
    clock.now += PAUSE + 0.01
    assert 1 not in schedule
    assert schedule.take() == 2
    schedule.change(2)
    schedule.clear()
    clock.now += PAUSE + 0.01
    assert schedule.take() is None


def test_what_has_no_time_is_the_next_one(schedule, clock) -> None:
    schedule.change(1)
    schedule.change(2)
    schedule.hurry(2)
    assert schedule.wait() == 0.0
    assert schedule.take() == 2
    assert schedule.take() is None
    schedule.hurry(1)
    schedule.change(1)  # the next update waits for it
    assert schedule.take() is None
