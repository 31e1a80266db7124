# SPDX-License-Identifier: GPL-3.0-or-later
"""Ordinary Blender objects, scattered over by the add-on's defaults, judged against goals."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import bpy

import addon
from benchmarks.compare.tables import say, table
from benchmarks.zoo.objects import CASES, Case
from benchmarks.zoo.standing import at_faces_of_zero, degrees_off

_HEAD = (
    "object",
    "points",
    "variation",
    "alpha min",
    "mean",
    "evaluations",
    "s",
    "degrees off",
    "goals",
)
_UPRIGHT = 0.5  # degrees between an instance and the normal as the surface is shaded there


def main() -> None:
    options = _options()
    addon.register()
    try:
        found = [measured(case) for case in CASES if options.only in (None, case.name)]
    finally:
        addon.unregister()
    print(table(_HEAD, [_row(one) for one in found]))
    if options.json:
        options.json.write_text(json.dumps(found, indent=1) + "\n")
    missed = sum(bool(one["missed"]) for one in found)
    print(f"\n{len(found) - missed} of {len(found)} met their goals")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benchmarks/zoo/run.sh", description=__doc__)
    parser.add_argument("--only", choices=[case.name for case in CASES], help="one object")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    return parser.parse_args()


def measured(case: Case) -> dict[str, Any]:
    """The report of a scatter over the object, and which goals it missed."""
    say(case.name)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    case.make()
    figures: dict[str, Any] = {"name": case.name, "points": case.points}
    try:
        surface = bpy.context.object
        bpy.ops.dapple.add_scatter(count=case.points)
        if case.attribute:
            bpy.context.object.dapple.density.attribute = case.attribute
            bpy.ops.dapple.optimize()
    except RuntimeError as error:
        return {**figures, "error": str(error).strip(), "missed": ["an error"]}
    scatter = bpy.context.object
    report = scatter.dapple.report
    figures |= {
        "variation": report.capacity_variation,
        "alpha_min": report.alpha_min,
        "alpha_mean": report.alpha_mean,
        "evaluations": report.evaluations,
        "seconds": report.milliseconds / 1000,
        "converged": report.converged,
        "degrees_off": float(degrees_off(scatter, surface).max()),
        "misplaced": at_faces_of_zero(scatter, surface, case.attribute),
    }
    return {**figures, "missed": _missed(case, figures)}


def _missed(case: Case, figures: dict[str, Any]) -> list[str]:
    missed = []
    if figures["variation"] > case.variation:
        missed.append(f"variation {case.variation}")
    if figures["alpha_min"] < case.alpha_min:
        missed.append(f"alpha min {case.alpha_min}")
    if case.evaluations and figures["evaluations"] > case.evaluations:
        missed.append(f"evaluations {case.evaluations}")
    if figures["degrees_off"] > _UPRIGHT:
        missed.append(f"{_UPRIGHT} degrees")
    if figures["misplaced"]:
        missed.append(f"{figures['misplaced']} where the density is 0")
    return missed


def _row(one: dict[str, Any]) -> list[str]:
    judged = "missed: " + ", ".join(one["missed"]) if one["missed"] else "met"
    if "error" in one:
        return [one["name"], str(one["points"]), *("",) * 6, one["error"]]
    return [
        one["name"],
        str(one["points"]),
        *(f"{one[name]:.3f}" for name in ("variation", "alpha_min", "alpha_mean")),
        str(one["evaluations"]),
        f"{one['seconds']:.2f}",
        f"{one['degrees_off']:.2f}",
        judged,
    ]


if __name__ == "__main__":
    try:
        main()
    finally:
        sys.stdout.flush()
