# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether an operator can run on the active object, and the message if it cannot."""

import bpy

from ...core.base.native import missing
from ..base import operator_jobs
from ..base.translation import operator_label, translated
from ..scatter.linked_data import read_only
from ..scatter.object import is_scatter
from .joined_surface import chosen


def free(cls: type[bpy.types.Operator]) -> bool:
    """Whether long work can begin: the package is installed and no other work is running."""
    work = operator_jobs.current()
    if missing():
        cls.poll_message_set(missing())
    elif work is not None:
        name = operator_label(work.label)
        cls.poll_message_set(translated("'{work}' is still running: cancel it or wait", work=name))
    else:
        return True
    return False


def ready(cls: type[bpy.types.Operator], context: bpy.types.Context, scatter: bool) -> bool:
    """Whether the active object fits: a writable scatter, or a surface."""
    obj = context.object
    if not free(cls):
        return False
    if context.mode != "OBJECT" or obj is None:
        cls.poll_message_set(translated("Needs an active object in Object Mode"))
    elif scatter:
        return writable(cls, context)
    elif is_scatter(obj):
        cls.poll_message_set(translated("The active object is a scatter, not a surface"))
    elif not chosen(context):
        cls.poll_message_set(translated("Needs an active mesh, curve, text or metaball object"))
    else:
        return True
    return False


def writable(cls: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Whether the active object is a scatter that can be written."""
    if not is_scatter(context.object):
        cls.poll_message_set(translated("The active object is not a Dapple scatter"))
    elif read_only(context.object):
        cls.poll_message_set(read_only(context.object))
    else:
        return True
    return False


def editable(cls: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Whether the active object is a scatter whose points can be edited by hand."""
    if not ready(cls, context, scatter=True):
        return False
    if context.object.dapple.baked_keys:
        cls.poll_message_set(translated("The scatter is baked: clear the bake to edit points"))
        return False
    return True


def may_be_listed(cls: type[bpy.types.Operator], context: bpy.types.Context, why: str) -> bool:
    """Whether the lists of the active scatter can be edited; if not, sets the poll message."""
    if not writable(cls, context):
        return False
    if context.object.override_library:
        cls.poll_message_set(why)
    return not context.object.override_library
