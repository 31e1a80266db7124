# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows what is placed, edited or not: radii from bounds, weights of the objects of a
collection.
"""

import bpy

from ..base import jobs, renders
from ..base.handlers import Evaluation, Subscriber
from ..base.quiet import is_quiet
from ..scatter.library import read_only
from ..scatter.modifier import write_instance_inputs
from ..scatter.object import is_scatter
from ..scatter.placed_objects import follow_bounds, follow_members


def _updated(evaluation: Evaluation) -> None:
    """What is placed has its scatter evaluated too."""
    if is_quiet() or jobs.current() is not None or renders.busy():
        return
    for obj, _ in evaluation.objects():
        if is_scatter(obj) and not read_only(obj):
            _follow(obj, evaluation.depsgraph)


def _follow(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> None:
    if any([follow_members(kind) for kind in (obj.dapple, *obj.dapple.classes)]):
        write_instance_inputs(obj)
    for kind in obj.dapple.classes:
        follow_bounds(kind, depsgraph)


SUBSCRIBER = Subscriber(updated=_updated)
