# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Links of node trees, followed in and out of groups."""

from collections.abc import Iterator

import bpy
import numpy as np
from numpy.typing import NDArray

_DEEPEST_NESTING = 64
"""Node trees have no cycles that render; this only ends a walk through a broken one."""


def source_of(socket, groups):
    """Return the output socket that feeds `socket`, through reroutes, muted nodes and groups, and where it is.

    Without a source the second value is the socket, maybe on a group node outside, whose own value counts.
    """
    for _ in range(_DEEPEST_NESTING):
        link = next((link for link in socket.links if link.is_valid and not link.is_muted), None)
        if link is None:
            return None, socket
        output, node = link.from_socket, link.from_node
        if node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.mute:
            inner = next((inner for inner in node.internal_links if inner.to_socket == output), None)
            if inner is None:
                return None, socket
            socket = inner.from_socket
        elif node.type == "GROUP" and node.node_tree is not None:
            group_output = next(
                (n for n in node.node_tree.nodes if n.type == "GROUP_OUTPUT" and n.is_active_output), None
            )
            if group_output is None:
                return None, socket
            socket, groups = input_of(group_output, output.identifier), (*groups, node)
        elif node.type == "GROUP_INPUT" and groups:
            socket, groups = input_of(groups[-1], output.identifier), groups[:-1]
        else:
            return output, groups
    return None, socket


def input_of(node, identifier: str):
    """Return the input socket of that identifier, which unlike its name does not change between versions."""
    return next(socket for socket in node.inputs if socket.identifier == identifier)


def title_of(node) -> str:
    """Return what kind of node it is, in the words of Blender's Add menu; a group's own name."""
    return node.node_tree.name if node.type == "GROUP" and node.node_tree else node.bl_label


def value_of(socket) -> float | NDArray[np.float64]:
    value = socket.default_value
    return float(value) if isinstance(value, float | int) else np.array(value[:3], dtype=np.float64)


def all_trees(tree: bpy.types.NodeTree) -> Iterator[bpy.types.NodeTree]:
    """Yield a node tree and those of its groups."""
    yield tree
    for node in tree.nodes:
        if node.type == "GROUP" and node.node_tree is not None:
            yield from all_trees(node.node_tree)


def own_trees(tree: bpy.types.NodeTree) -> Iterator[bpy.types.NodeTree]:
    """Yield a node tree and those of its groups, which become copies of their own."""
    yield tree
    for node in tree.nodes:
        if node.type == "GROUP" and node.node_tree is not None:
            node.node_tree = node.node_tree.copy()
            yield from own_trees(node.node_tree)
