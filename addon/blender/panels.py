# SPDX-License-Identifier: GPL-3.0-or-later
"""Sub-panels of the sidebar. They only draw; what they show is found elsewhere."""

from .add.menu import DAPPLE_MT_over_collection
from .bake.panel import DAPPLE_PT_animation
from .density.panel import DAPPLE_MT_materials, DAPPLE_PT_density
from .display.panel import DAPPLE_PT_display
from .hand_points.placement_panel import DAPPLE_PT_placement
from .object_types.panel import DAPPLE_PT_instances, DAPPLE_UL_classes
from .solve.advanced_panel import DAPPLE_PT_advanced
from .solve.amount_panel import DAPPLE_PT_amount
from .solve.figures_panel import DAPPLE_PT_details
from .tiles.panel import DAPPLE_PT_tiles

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
