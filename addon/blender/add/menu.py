# SPDX-License-Identifier: GPL-3.0-or-later
"""Entries of the Add menu, one of them a menu of the collections that can be scattered over."""

import bpy

from ..base.translation import told
from .operators import DAPPLE_OT_add, DAPPLE_OT_add_over_collection


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


def draw_add_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Entry of Add > Mesh."""
    add = DAPPLE_OT_add.bl_idname
    menu.layout.operator(add, text="Dapple Scatter", icon="OUTLINER_DATA_POINTCLOUD")
    if context.scene.collection.children:
        text = told("Dapple Scatter over Collection")
        menu.layout.menu(DAPPLE_MT_over_collection.__name__, text=text)
