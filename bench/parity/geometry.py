# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways in which Blender makes surfaces."""

from __future__ import annotations

from typing import Any

import bpy

from . import stage
from .cases import case


def lit_room() -> Any:
    """Return the floor of a room with a lamp and a little light from all around."""
    floor = stage.room()
    stage.lamp("AREA", shape="DISK", size=0.4)
    stage.world((0.5, 0.6, 0.8), 0.3)
    return floor


@case("Negative scale")
def negative_scale() -> list[Any]:
    """The floor and a box are mirrored."""
    floor = lit_room()
    floor.scale = (-1.0, 1.0, 1.0)
    stage.box("Box", (0, 0, 0), (0.4, 0.4, 0.5), stage.paint("Blue", (0.2, 0.3, 0.7)), location=(-0.3, -0.5, 0.13))
    bpy.data.objects["Box"].scale = (-1.0, 1.0, 1.5)
    return [floor]


@case("Non-uniform scale and turns")
def sheared() -> list[Any]:
    """A box below a scaled and turned parent is sheared."""
    floor = lit_room()
    parent = stage.add("Parent", None, (0.2, 0.3, 0.3), (0.3, 0.2, 0.4), (2.0, 0.7, 1.0))
    child = stage.box("Box", (-0.1, -0.2, -0.1), (0.1, 0.2, 0.1), stage.paint("Blue", (0.2, 0.3, 0.7)))
    child.rotation_euler = (0.5, 0.4, 0.3)
    child.parent = parent
    return [floor]


@case("Modifiers")
def modifiers() -> list[Any]:
    """An array, a bevel and a subdivision throw the shadow."""
    floor = lit_room()
    thing = stage.box("Post", (-0.08, -0.08, 0), (0.08, 0.08, 0.5), stage.paint("Blue", (0.2, 0.3, 0.7)))
    thing.location = (-0.5, -0.5, 0.13)
    array = thing.modifiers.new("Array", "ARRAY")
    array.count, array.use_relative_offset, array.use_constant_offset = 3, False, True
    array.constant_offset_displace = (0.4, 0.1, 0.0)
    thing.modifiers.new("Bevel", "BEVEL").width = 0.02
    thing.modifiers.new("Subdivision", "SUBSURF").render_levels = 2
    return [floor]


@case("Collection instances")
def collection_instances() -> list[Any]:
    """Two turned instances of a collection with a box and a mesh that shines."""
    floor = stage.room()
    parts = bpy.data.collections.new("Parts")
    box = stage.box("Box", (-0.1, -0.1, 0.1), (0.1, 0.1, 0.6), stage.paint("Blue", (0.2, 0.3, 0.7)))
    panel = stage.grid("Panel", 0.3, 0.3, 1, stage.glow(), location=(0.0, 0.0, 1.4))
    for thing in (box, panel):
        bpy.context.scene.collection.objects.unlink(thing)
        parts.objects.link(thing)
    for place, turn in (((-0.5, -0.4, 0.0), 0.4), ((0.55, 0.5, 0.1), 1.2)):
        instance = stage.add("Instance", None, place, (0.0, 0.1, turn), (1.0, 1.3, 1.0))
        instance.instance_type, instance.instance_collection = "COLLECTION", parts
    return [floor]


@case("Shared mesh data")
def shared_mesh() -> list[Any]:
    """Three floors of one mesh in different light, each compared."""
    floor = lit_room()
    others = [stage.add(f"Floor {k}", floor.data, (0.0, 2.2 * k, 0.1 * k), (0.2 * k, 0.0, 0.5)) for k in (1, 2)]
    return [floor, *others]
