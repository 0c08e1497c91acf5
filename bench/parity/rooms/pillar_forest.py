# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""An instanced forest of pillars."""

from __future__ import annotations

import math
from typing import Any

import bpy

from .. import stage
from . import parts

ALONG = 10
APART = 1.6


def build() -> None:
    """A hundred pillars of geometry nodes and three arches as collection instances, on a ground that is baked."""
    side = ALONG * APART + 2.0
    stage.grid("Ground", side, side, 16, parts.principled("Sand", (0.55, 0.45, 0.30)))
    wall = parts.principled("Wall", (0.45, 0.30, 0.22))
    stage.box("Wall", (-side / 2.0, side / 2.0 - 0.4, 0.0), (side / 2.0, side / 2.0, 2.5), wall)
    pillar = parts.cylinder(
        "Pillar", 0.2, 3.0, parts.principled("Marble", (0.75, 0.73, 0.70)), (0.0, 0.0, 0.0), 16, 0.15
    )
    pillar.location.z = -50.0
    pillar.hide_render = True
    _forest(pillar)
    _arches()
    stage.lamp("SUN", turn=(math.radians(50), 0.0, math.radians(25)), angle=0.02, energy=3.0, color=(1.0, 0.92, 0.8))
    stage.world((0.45, 0.6, 0.9), 0.6)
    stage.camera((1.0, -side / 2.0 - 3.0, 3.2), (0.0, 0.0, 0.8), 28.0)


def _forest(pillar: Any) -> None:
    tree = bpy.data.node_groups.new("Forest", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    grid = tree.nodes.new("GeometryNodeMeshGrid")
    for name, value in (("Size X", APART * (ALONG - 1)), ("Size Y", APART * (ALONG - 1))):
        grid.inputs[name].default_value = value
    for name in ("Vertices X", "Vertices Y"):
        grid.inputs[name].default_value = ALONG
    given = tree.nodes.new("GeometryNodeObjectInfo")
    given.inputs["Object"].default_value = pillar
    instance = tree.nodes.new("GeometryNodeInstanceOnPoints")
    output = tree.nodes.new("NodeGroupOutput")
    tree.links.new(grid.outputs["Mesh"], instance.inputs["Points"])
    tree.links.new(given.outputs["Geometry"], instance.inputs["Instance"])
    tree.links.new(instance.outputs["Instances"], output.inputs[0])
    forest = stage.mesh("Forest", [], [])
    forest.modifiers.new("Forest", "NODES").node_group = tree


def _arches() -> None:
    stone = parts.principled("Sandstone", (0.6, 0.42, 0.25))
    arch = bpy.data.collections.new("Arch")
    for name, low, high in (
        ("Left", (-0.9, -0.2, 0.0), (-0.5, 0.2, 2.0)),
        ("Right", (0.5, -0.2, 0.0), (0.9, 0.2, 2.0)),
        ("Beam", (-1.0, -0.25, 2.0), (1.0, 0.25, 2.4)),
    ):
        thing = stage.box(f"Arch {name}", low, high, stone)
        bpy.context.scene.collection.objects.unlink(thing)
        arch.objects.link(thing)
    for k, (x, y, turn) in enumerate(((-4.0, -8.1, 0.1), (0.0, -8.2, 0.0), (4.0, -8.1, -0.1))):
        instance = stage.add(f"Arch {k + 1}", None, (x, y, 0.0), (0.0, 0.0, turn))
        instance.instance_type, instance.instance_collection = "COLLECTION", arch
