# SPDX-License-Identifier: GPL-3.0-or-later
"""Auto Update: scatters are solved again once what they are solved from has rested for a moment,
and at once when a stroke, a move or another operator has ended. Optimize is one of these updates,
from the seed, that is asked for.

Handlers and property updates only note what changed. An app timer reads what is there part by
part, a worker solves, and the timer writes; until then the old points stay. A change meanwhile
gives that up and begins the pause anew. No undo step is made: an undo of the artist's change brings
back settings or points that do not fit, which is a change as any other. What was asked for is an
undo step, made once the points are there.

In background mode nothing follows by itself, unless a test says so and drives the timer by hand.
"""

from dataclasses import dataclass, field

import bpy

from ...core.base.errors import ScatterError
from ...core.base.schedule import Schedule
from ...core.base.steps import Stepper
from ..base import artist, renders, step_operators
from ..base.all_or_nothing import sentence
from ..base.artist import is_operated
from ..base.handlers import Evaluation, Subscriber
from ..base.object_handles import Held
from ..base.quiet import is_quiet
from ..base.sidebars import redraw
from ..base.step_operators import is_under_way
from ..base.timers import call_in
from ..base.undo import push_undo
from ..display import preview
from .changes import NOBODY, Cause, Changes, follows, scatters
from .optimize import optimize_steps

_POLL = 0.005  # seconds between two looks at a worker
_PART = 0.01  # seconds of a look in which the artist waits
_HELD = 0.1  # seconds between two looks whether what holds it up is over
_TOOL = 0.02  # the same while the artist uses a tool, and waits for what follows

enabled = not bpy.app.background


@dataclass(frozen=True)
class _Wish:
    """What the artist has asked for."""

    step: str  # name of the undo step, as that of its button
    drops_keys: bool


@dataclass
class _Job:
    """The scatter that is being solved."""

    scatter: Held
    stepper: Stepper
    cause: Cause  # itself and the scatters because of which it is
    wish: _Wish | None  # None: it follows a change
    shown: int = -1  # hundredths that the panel shows

    def writes(self) -> dict[int, Cause]:
        """The cause of changes of what it writes, by session_uid."""
        try:
            obj = self.scatter.get()
        except ScatterError:  # it was removed
            return {}
        return dict.fromkeys((obj.session_uid, obj.data.session_uid), self.cause)


@dataclass
class _State:
    """What the timer and the handlers share; file data is always looked up anew."""

    schedule: Schedule = field(default_factory=Schedule)
    changes: Changes = field(default_factory=Changes)
    job: _Job | None = None
    caused: dict[int, Cause] = field(default_factory=dict)  # by which updates
    troubles: dict[int, str] = field(default_factory=dict)  # why a scatter could not be solved
    asked: dict[int, _Wish] = field(default_factory=dict)  # for a solution from the seed


_state = _State()


def progress(obj: bpy.types.Object) -> float | None:
    """How much of a scatter's update is done, in [0, 1]; None: it waits for none."""
    job = _state.job
    if job is not None and job.scatter.uid == obj.session_uid:
        return job.stepper.progress
    return 0.0 if obj.session_uid in _state.schedule else None


def trouble(obj: bpy.types.Object) -> str:
    """Why the last update of a scatter failed; empty when it did not."""
    return _state.troubles.get(obj.session_uid, "")


def touch(obj: bpy.types.Object) -> None:
    """A setting of a scatter was changed: of what it depends, too."""
    if enabled and not is_quiet():
        _state.changes.relink()
        _change(obj.session_uid)
        _wake()


def ask(obj: bpy.types.Object, step: str = "Optimize") -> None:
    """Solve a scatter from its seed, as Optimize does, in place of what is done for it now.

    It is an undo step of that name. Its keys may go only if it has some by now.
    """
    forget(obj)
    _change(obj.session_uid)
    _state.asked[obj.session_uid] = _Wish(step, obj.dapple.baked_keys > 0)
    _state.schedule.hurry(obj.session_uid)
    _state.changes.relink()
    _wake()
    redraw()


def is_asked(obj: bpy.types.Object) -> bool:
    """Whether a scatter is solved from its seed, or waits for that."""
    return obj.session_uid in _state.asked


def forget(obj: bpy.types.Object) -> None:
    """Discard the work on a scatter: it was solved otherwise."""
    _state.asked.pop(obj.session_uid, None)
    _state.schedule.forget(obj.session_uid)
    if _state.job is not None and _state.job.scatter.uid == obj.session_uid:
        _give_up()


def cancel() -> None:
    """Give up all updates, until something is changed again."""
    _state.asked.clear()
    _state.schedule.clear()
    _give_up()
    redraw()


def is_active() -> bool:
    """Whether some scatter is updated, or waits for that."""
    return _state.job is not None or bool(_state.schedule)


def tick() -> float | None:
    """Go on with what is to be done; seconds until the next time, None to end."""
    wait = _look()
    return 0.0 if _state.changes.any_noted() else wait


def _look() -> float | None:
    _state.changes.look_for_end()
    if is_held():
        _spread()
        _step_aside()
        waits = is_active() or _state.changes.wait() is not None
        return (_TOOL if _state.changes.used_tool else _HELD) if waits else None
    if enabled and _state.job is None:
        _state.changes.glance()
    _spread()
    if _state.changes.take_end():
        _state.schedule.settle()
    if _state.job is None:
        _begin()
    if _state.job is not None:
        _go_on(_state.job)
    if _state.job is not None:
        return _POLL if _state.job.stepper.waits else 0.0
    return _rest()


def _rest() -> float | None:
    """Seconds until there may be something to do."""
    tool = _TOOL if _state.changes.used_tool and _state.schedule else None
    waits = [_state.schedule.wait(), _state.changes.wait(), tool]
    return min((one for one in waits if one is not None), default=None)


def _spread() -> None:
    """Note which scatters depend on what was changed."""
    writes = _state.job.writes() if _state.job is not None else {}
    for uid, cause in _state.changes.changed_scatters(writes):
        _change(uid, cause)
    for uid in (
        _state.asked.keys() - _state.changes.known_scatters()
    ):  # an undo may have removed them
        del _state.asked[uid]


def _change(uid: int, cause: Cause = NOBODY) -> None:
    _state.changes.turn_to(uid)
    _state.troubles.pop(uid, None)
    _state.caused[uid] = cause
    _state.schedule.change(uid)
    if _state.job is not None and _state.job.scatter.uid == uid:
        _give_up()


def _begin() -> None:
    uid = _state.schedule.take()
    obj = next((one for one in scatters() if one.session_uid == uid), None)
    if obj is None:
        return
    held = Held(obj)
    wish = _state.asked.get(held.uid)
    if wish is not None or follows(obj):
        cause = _state.caused.pop(held.uid, NOBODY) | {held.uid}
        drops_keys = wish is not None and wish.drops_keys
        steps = optimize_steps(held, asked=wish is not None, drops_keys=drops_keys)
        _state.job = _Job(held, Stepper(steps), cause, wish)
    else:
        _state.changes.pass_over(held.uid)


def _go_on(job: _Job) -> None:
    try:
        if not (job.wish and is_operated()) and job.stepper.run_for(_PART):
            _done(job)
    except Exception as error:
        _fail(job)
        _state.troubles[job.scatter.uid] = sentence("Optimize", error)
    except BaseException:
        _fail(job)
        raise
    _show(job)


def _done(job: _Job) -> None:
    _state.job = None
    _state.asked.pop(job.scatter.uid, None)
    if job.stepper.result:
        _state.changes.wrote(job.writes())
        follow_up(job.scatter.get(), job.wish.step if job.wish else "")
    else:
        _state.changes.wait_for_frame(job.scatter.get())


def _fail(job: _Job) -> None:
    _state.asked.pop(job.scatter.uid, None)
    _give_up()


def _give_up() -> None:
    """Forget what a worker still finds."""
    job, _state.job = _state.job, None
    if job is not None:
        job.stepper.abandon()


def _show(job: _Job) -> None:
    hundredths = -1 if _state.job is None else int(100 * job.stepper.progress)
    if hundredths != job.shown or _state.job is None:
        job.shown = hundredths
        redraw()


def _wake() -> None:
    """Have the timer look now, which may sleep until the next glance at pictures."""
    call_in(0.0, tick)


def _updated(evaluation: Evaluation) -> None:
    """Note what was changed, and look at it soon."""
    if not enabled or is_quiet():
        return
    if _state.changes.note(evaluation):
        _wake()


def _frame_changed(evaluation: Evaluation) -> None:
    """What was edited at another time may make a difference now."""
    if enabled and not is_quiet() and _state.changes.note_frame(evaluation.scene):
        _wake()


def _undone() -> None:
    """An undo may have brought back anything."""
    if enabled:
        _state.changes.doubt_all()
        _give_up()
        _wake()


def reset() -> None:
    """Forget all changes, updates and requests."""
    _give_up()
    vars(_state).update(vars(_State()))


def _render_began() -> None:
    """The worker stops; the scatter has its turn again afterward."""
    if _state.job is not None:
        _state.schedule.change(_state.job.scatter.uid)
        _give_up()


def _step_aside() -> None:
    """The same for operators; while the animation plays the worker may go on."""
    if is_under_way():
        _render_began()


SUBSCRIBER = Subscriber(
    updated=_updated,
    frame_changed=_frame_changed,
    undone=_undone,
    render_began=_render_began,
    before_load=reset,
    disabled=reset,
    ticks=(tick,),
)


def follow_up(obj: bpy.types.Object, step: str) -> None:
    """Have the live preview start from there; what was asked for is an undo step of that name."""
    preview.solved_anew(obj)
    if step:
        push_undo(step)


def is_held() -> bool:
    """Whether Blender renders, plays, paints a stroke, or an operator of the add-on works."""
    return (
        renders.busy()
        or step_operators.is_under_way()
        or artist.is_playing()
        or artist.is_painting()
    )
