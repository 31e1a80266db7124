# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups as Python sources: what plays a scatter back without the add-on."""

from .builder import VERSION, VERSION_KEY, version_of
from .detail import DETAIL_INPUTS
from .inputs import get_input, has_input, input_names, inputs_of, restore_inputs, set_input
from .scatter import GROUP_NAME, INPUTS, INSTANCE_INPUTS, ensure_group, input_name, is_current

__all__ = [
    "DETAIL_INPUTS",
    "GROUP_NAME",
    "INPUTS",
    "INSTANCE_INPUTS",
    "VERSION",
    "VERSION_KEY",
    "ensure_group",
    "get_input",
    "has_input",
    "input_name",
    "input_names",
    "inputs_of",
    "is_current",
    "restore_inputs",
    "set_input",
    "version_of",
]
