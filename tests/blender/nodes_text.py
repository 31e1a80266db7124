# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups as text, to be compared."""

import json

import addon_host
import bpy


def dump(group):
    """Nodes and links of a group as text, with the groups inside."""

    def value(socket):
        found = getattr(socket, "default_value", None)
        return list(found) if isinstance(found, bpy.types.bpy_prop_array) else str(found)

    def node(one):
        inner = getattr(one, "node_tree", None)
        kept = ("operation", "data_type", "mode", "domain", "transform_space", "input_type")
        settings = [str(getattr(one, name, "")) for name in kept]
        shown = [socket for socket in one.inputs if socket.enabled]
        sockets = [[socket.name, socket.is_linked or value(socket)] for socket in shown]
        return [one.name, one.bl_idname, settings, sockets, inner and dump(inner)]

    faces = [
        (item.name, item.in_out, item.socket_type, item.description, value(item))
        for item in group.interface.items_tree
    ]
    ends = [
        (
            link.from_node.name,
            link.from_socket.identifier,
            link.to_node.name,
            link.to_socket.identifier,
        )
        for link in group.links
    ]
    return json.dumps([faces, [node(one) for one in group.nodes], sorted(ends)])


def built():
    """The node groups that are shipped as assets, built in an empty file: name -> text."""
    for group in list(bpy.data.node_groups):
        bpy.data.node_groups.remove(group)
    described = addon_host.part("nodes.assets").ASSETS
    return {asset.name: dump(asset.build()) for asset in described}
