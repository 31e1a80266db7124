# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel says of a result: its figures, and whether it still fits."""

import bpy

from ..base.labels import lines_of
from ..base.translation import counted, told
from ..live import watcher
from ..ops.live_operators import DAPPLE_OT_cancel_update
from ..status import freshness

_NOTICED = 0.02  # of an area variation, that is worth a line ...
_SHARE = 0.3  # ... if it is that much of the whole


def result_lines(obj: bpy.types.Object, context: bpy.types.Context) -> list[tuple[str, str]]:
    """What is to be said about the last result: (text, icon)."""
    report = obj.dapple.report
    points = counted(report.count, "{count} point", "{count:,} points")
    spread = 100 * report.capacity_variation
    mean, least = 100 * report.alpha_mean, 100 * report.alpha_min
    if not report.measured and watcher.progress(obj) is None:
        return [
            (told("{points}, not measured: optimize again", points=points), "INFO"),
            *_end(obj, context),
        ]
    lines = [
        (told("{points}, area variation {spread:.2g} %", points=points, spread=spread), "NONE"),
        (told("Spacing {mean:.0f} % of ideal (min {least:.0f} %)", mean=mean, least=least), "NONE"),
        (_effort(obj), "NONE"),
    ]
    if report.whole_count_variation > max(_NOTICED, _SHARE * report.capacity_variation):
        whole = 100 * report.whole_count_variation
        lines.append(
            (
                told("Separate parts have whole numbers of points: {whole:.2g} %", whole=whole),
                "INFO",
            )
        )
    if not report.converged and not obj.dapple.baked_keys:
        lines.append((_shortfall(obj), "INFO"))
    return [*lines, *_end(obj, context)]


def _end(obj: bpy.types.Object, context: bpy.types.Context) -> list[tuple[str, str]]:
    """Whether the result fits; a bar takes that place while it is updated."""
    if watcher.progress(obj) is not None:
        return []
    fit = _fit(freshness.findings(obj, context))
    why = watcher.trouble(obj)
    return [(told("Not updated: {why}", why=why), "ERROR"), fit] if why else [fit]


def draw_result(
    layout: bpy.types.UILayout, context: bpy.types.Context, obj: bpy.types.Object
) -> None:
    """What is to be said, and how far an update is, with a cross to cancel it."""
    for text, icon in result_lines(obj, context):
        lines_of(layout, text, icon)
    share = watcher.progress(obj)
    if share is None:
        return
    row = layout.row(align=True)
    if watcher.is_asked(context.object):
        text = told("Optimizing: {share:.0%}", share=share)
    else:
        text = told("Updating: {share:.0%}", share=share)
    row.progress(factor=share, text=text)
    row.operator(DAPPLE_OT_cancel_update.bl_idname, text="", icon="X")


def _fit(found: freshness.Findings | None) -> tuple[str, str]:
    """Whether a result fits, as far as that is known."""
    if found is None:
        return told("Not compared with the scene yet"), "TIME"
    if found.verdict.reason:
        return told("Out of date: {reason}", reason=found.verdict.reason), "ERROR"
    if found.verdict.note:
        return found.verdict.note, "INFO"
    return told("Up to date"), "CHECKMARK"


def _shortfall(obj: bpy.types.Object) -> str:
    """Why the result is not at the tolerance."""
    if obj.dapple.report.evaluations >= obj.dapple.max_evaluations:
        return told("Tolerance not reached: increase Max Iterations")
    return told("Tolerance not reached: no step improves the result")


def _effort(obj: bpy.types.Object) -> str:
    time = _time(obj.dapple.report.milliseconds)
    if obj.dapple.baked_keys:
        return told("Solved in {time} per frame", time=time)
    return told("Solved in {time}", time=time)


def _time(milliseconds: float) -> str:
    return f"{milliseconds:.0f} ms" if milliseconds < 1000.0 else f"{milliseconds / 1000.0:.1f} s"


def baked_line(obj: bpy.types.Object) -> str:
    """Which frames are baked, and what the frames without a key lose."""
    settings, report = obj.dapple, obj.dapple.report
    last = settings.baked_start + settings.baked_frames - 1
    line = told("Baked: frames {first} to {last}", first=settings.baked_start, last=last)
    if settings.baked_keys == settings.baked_frames:
        return line
    return told(
        "{baked}, {keys} keyframes; between them points are off by {mean:.2g} spacings (at "
        "most {most:.2g})",
        baked=line,
        keys=settings.baked_keys,
        mean=report.key_error_mean,
        most=report.key_error_max,
    )
