# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of the main panel about a result and about background work."""

import bpy

from ...core.solve.stale import was_on_edges
from ..base import operator_jobs
from ..base.sidebars import BUTTON, lines_of
from ..base.translation import translated, translated_count
from ..freshness import findings
from . import auto_update
from .operators import DAPPLE_OT_cancel_update, DAPPLE_OT_hide_message

# A part of the area variation is shown if it exceeds both: an absolute value, and a share of all.
_NOTABLE, _SHARE = 0.02, 0.3
_ICONS = {"ERROR": "ERROR", "WARNING": "ERROR", "INFO": "INFO"}


def result_lines(obj: bpy.types.Object, context: bpy.types.Context) -> list[tuple[str, str]]:
    """The last result in a line, and problems with it: (text, icon)."""
    if auto_update.progress(obj) is not None:  # a bar shows the rest
        return [(_result(obj), "NONE")]
    why = auto_update.trouble(obj)
    trouble = [(translated("Not updated: {why}", why=why), "ERROR")] if why else []
    fit = _fit(_result(obj), findings.findings(obj, context))
    return [*fit, *_doubled(obj.dapple.report), *trouble]


def figure_lines(obj: bpy.types.Object) -> list[tuple[str, str]]:
    """More figures of the last result: (text, icon)."""
    report = obj.dapple.report
    if not report.measured or was_on_edges(obj.dapple.solved_settings):
        return [(_effort(obj), "NONE")]
    variation, least = 100 * report.capacity_variation, 100 * report.alpha_min
    lines = [(translated("Area variation {spread:.2g} %", spread=variation), "NONE")]
    if _has_spacing(report):
        lines.append((translated("Smallest spacing {least:.0f} % of ideal", least=least), "NONE"))
    lines.append((_effort(obj), "NONE"))
    if report.thin_share > 0.0:
        thin = 100 * report.thin_share
        text = translated(
            "{thin:.3g} % of the points are on parts thinner than the spacing", thin=thin
        )
        lines.append((text, "INFO"))
    if report.whole_count_variation > max(_NOTABLE, _SHARE * report.capacity_variation):
        whole = 100 * report.whole_count_variation
        text = translated("Due to whole counts per part: {whole:.2g} %", whole=whole)
        lines.append((text, "INFO"))
    if report.small_parts:
        text = translated_count(
            report.small_parts,
            "{count} part is too small for a whole point",
            "{count:,} parts are too small for a whole point",
        )
        lines.append((text, "INFO"))
    if not report.converged and not obj.dapple.baked_keys:
        lines.append((_shortfall(obj), "INFO"))
    return lines


def _has_spacing(report: bpy.types.PropertyGroup) -> bool:
    """Whether the ideal spacing is meaningful; along a thin wire points are farther apart."""
    return bool(0.0 < report.alpha_mean <= 1.0) or report.count < 2


def _doubled(report: bpy.types.PropertyGroup) -> list[tuple[str, str]]:
    """The number of faces that lie on other faces: (text, icon)."""
    count = report.doubled_faces
    if not count:
        return []
    text = translated_count(
        count, "{count} doubled face counts once", "{count:,} doubled faces count once"
    )
    return [(text, "INFO")]


def _length(value: float) -> str:
    """A length with the unit of the scene."""
    units = bpy.context.scene.unit_settings
    if units.system == "NONE":
        return f"{value:.3g}"
    return bpy.utils.units.to_string(
        units.system, "LENGTH", value * units.scale_length, precision=3
    )


def _result(obj: bpy.types.Object) -> str:
    """The number of instances, and how evenly they are spread."""
    report = obj.dapple.report
    instances = translated_count(report.count, "{count} instance", "{count:,} instances")
    if not report.measured and auto_update.progress(obj) is None:
        return translated("{instances}, not measured: optimize again", instances=instances)
    if was_on_edges(obj.dapple.solved_settings):
        apart = _length(report.spacing)
        return translated("{instances}, {apart} apart", instances=instances, apart=apart)
    if not _has_spacing(report):
        spread = 100 * report.capacity_variation
        return translated(
            "{instances}, area variation {spread:.2g} %", instances=instances, spread=spread
        )
    mean = 100 * report.alpha_mean
    return translated("{instances}, spacing {mean:.0f} % of ideal", instances=instances, mean=mean)


def draw_result(
    layout: bpy.types.UILayout, context: bpy.types.Context, obj: bpy.types.Object
) -> None:
    """Draw the lines about a result, and the progress of an update with a button to cancel it."""
    for text, icon in result_lines(obj, context):
        lines_of(layout, text, icon)
    share = auto_update.progress(obj)
    if share is None:
        return
    row = layout.row(align=True)
    if auto_update.is_requested(obj):
        text = translated("Optimizing: {share:.0%}", share=share)
    else:
        text = translated("Updating: {share:.0%}", share=share)
    row.progress(factor=share, text=text)
    row.operator(DAPPLE_OT_cancel_update.bl_idname, text="", icon="X")


def _fit(result: str, found: findings.Findings | None) -> list[tuple[str, str]]:
    """A result, and whether it is up to date, if that is known."""
    if found is None:
        return [(translated("{result}, not compared with the scene yet", result=result), "TIME")]
    verdict = found.verdict
    if verdict.reason:
        out = translated("Out of date: {reason}", reason=verdict.reason)
        return [(result, "NONE"), (out, "ERROR")]
    if verdict.note:
        return [(result, "NONE"), (verdict.note, "INFO")]
    return [(translated("{result}, up to date", result=result), "CHECKMARK")]


def _shortfall(obj: bpy.types.Object) -> str:
    """Why the tolerance was not reached."""
    if obj.dapple.report.evaluations >= obj.dapple.max_evaluations:
        return translated("Tolerance not reached: increase Max Iterations")
    return translated("Tolerance not reached: no step improves the result")


def _effort(obj: bpy.types.Object) -> str:
    time = _time(obj.dapple.report.milliseconds)
    if obj.dapple.baked_keys:
        return translated("Solved in {time} per frame", time=time)
    return translated("Solved in {time}", time=time)


def _time(milliseconds: float) -> str:
    return f"{milliseconds:.0f} ms" if milliseconds < 1000.0 else f"{milliseconds / 1000.0:.1f} s"


def draw_work(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the progress of running work, and messages about the last work on the active object."""
    work, obj = operator_jobs.current(), context.object
    if work is None:
        _end_bar(layout)
    else:
        row = layout.row(align=True)
        row.progress(factor=work.job.progress, text=work.line())
        row.operator(DAPPLE_OT_cancel_update.bl_idname, text="", icon="X")
    messages = operator_jobs.notes(obj) if obj is not None else []
    if not messages:
        return
    row = layout.row()
    column = row.column(align=True)
    for kind, text in messages:
        lines_of(column, text, _ICONS[kind], BUTTON)
    row.operator(DAPPLE_OT_hide_message.bl_idname, text="", icon="X")


def _end_bar(layout: bpy.types.UILayout) -> None:
    """Draw an item without a size first.

    Versions before Blender 5 confuse a progress bar under the mouse with the first label that is
    drawn after it, and draw that label as a bar.
    """
    layout.column(align=True).separator(factor=0.0)
