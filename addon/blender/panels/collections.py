# SPDX-License-Identifier: GPL-3.0-or-later
"""Menu of the collections that can be scattered over, each as one surface."""

import bpy

from ..ops.add_operators import DAPPLE_OT_add_over_collection


class DAPPLE_MT_over_collection(bpy.types.Menu):
    """Scatter over all objects of a collection, as one surface"""

    bl_label = "Over Collection"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        for collection in context.scene.collection.children_recursive:
            row = layout.operator(
                DAPPLE_OT_add_over_collection.bl_idname,
                text=collection.name,
                translate=False,
                icon="OUTLINER_COLLECTION",
            )
            row.collection = collection.name_full
