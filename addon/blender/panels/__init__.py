# SPDX-License-Identifier: GPL-3.0-or-later
"""Sub-panels of the sidebar. They only draw; what they show is found elsewhere."""

from .advanced import DAPPLE_PT_advanced
from .amount import DAPPLE_PT_amount
from .animation import DAPPLE_PT_animation
from .collections import DAPPLE_MT_over_collection
from .density import DAPPLE_MT_materials, DAPPLE_PT_density
from .details import DAPPLE_PT_details
from .display import DAPPLE_PT_display
from .instances import DAPPLE_PT_instances, DAPPLE_UL_classes
from .placement import DAPPLE_PT_placement
from .tiles import DAPPLE_PT_tiles

CLASSES = (  # in the order in which the sidebar shows them
    DAPPLE_UL_classes,
    DAPPLE_MT_over_collection,
    DAPPLE_MT_materials,
    DAPPLE_PT_details,
    DAPPLE_PT_instances,
    DAPPLE_PT_amount,
    DAPPLE_PT_density,
    DAPPLE_PT_placement,
    DAPPLE_PT_display,
    DAPPLE_PT_animation,
    DAPPLE_PT_tiles,
    DAPPLE_PT_advanced,
)
