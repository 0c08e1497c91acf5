# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Furniture and materials that several rooms have."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import bpy
import numpy as np

from .. import stage

Point = Sequence[float]


def principled(name: str, colour: Point, **inputs: Any) -> Any:
    """Return a matt Principled material, as artists use for everything."""
    return stage.material(
        name, "ShaderNodeBsdfPrincipled", Base_Color=tuple(colour), Roughness=1.0, Specular_IOR_Level=0.0, **inputs
    )


def image(name: str, side: int, colour_at: Callable[[Any, Any], Any]) -> Any:
    """Return a packed picture of `side` pixels: `colour_at` gives (side, side, 3) sRGB for u and v in 0..1."""
    v, u = np.meshgrid(*[(np.arange(side) + 0.5) / side] * 2, indexing="ij")
    pixels = np.ones((side, side, 4), dtype=np.float32)
    pixels[..., :3] = np.clip(colour_at(u, v), 0.0, 1.0)
    made = bpy.data.images.new(name, side, side)
    made.pixels.foreach_set(pixels.ravel())
    made.update()
    made.pack()
    return made


def textured(name: str, picture: Any, repeat: float = 1.0) -> Any:
    """Return a matt Principled material that shows a picture by the mesh's UV map, repeated by a Mapping node."""
    made = bpy.data.materials.new(name)
    tree = stage.node_tree(made)
    place = tree.nodes.new("ShaderNodeTexCoord")
    mapping = stage.shader(tree, "ShaderNodeMapping", Vector=place.outputs["UV"], Scale=(repeat, repeat, repeat))
    texture = stage.shader(tree, "ShaderNodeTexImage", Vector=mapping.outputs[0])
    texture.image = picture
    colour = texture.outputs["Color"]
    stage.show(
        tree,
        stage.shader(tree, "ShaderNodeBsdfPrincipled", Base_Color=colour, Roughness=1.0, Specular_IOR_Level=0.0),
    )
    return made


def sky(elevation: float, turn: float, strength: float = 0.1) -> None:
    """Give the scene Blender's Sky Texture without its sun, which a Sun lamp stands for."""
    made = bpy.data.worlds.new("Sky")
    tree = stage.node_tree(made)
    texture = tree.nodes.new("ShaderNodeTexSky")
    texture.sun_disc = False
    texture.sun_elevation, texture.sun_rotation = elevation, turn
    stage.show(tree, stage.shader(tree, "ShaderNodeBackground", Color=texture.outputs[0], Strength=strength))
    bpy.context.scene.world = made


def cylinder(
    name: str, radius: float, height: float, material: Any, place: Point, sides: int = 24, top: float = -1.0
) -> Any:
    """Return a closed cylinder that stands on `place`, or a cone with another radius at its top, smooth around."""
    top = radius if top < 0.0 else top
    angles = 2.0 * math.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    vertices = [(*(radius * p), 0.0) for p in ring] + [(*(top * p), height) for p in ring]
    around = [(k, (k + 1) % sides, (k + 1) % sides + sides, k + sides) for k in range(sides)]
    thing = stage.mesh(
        name,
        vertices,
        [*around, tuple(range(sides - 1, -1, -1)), tuple(range(sides, 2 * sides))],
        material,
        location=place,
    )
    thing.data.polygons.foreach_set("use_smooth", [True] * sides + [False, False])
    keep_sharp(thing)
    return thing


def keep_sharp(thing: Any) -> None:
    """Mark the edges between smooth and flat faces sharp."""
    flat = {edge for face in thing.data.polygons if not face.use_smooth for edge in face.edge_keys}
    for edge in thing.data.edges:
        edge.use_edge_sharp = edge.key in flat


def ball(name: str, radius: float, material: Any, place: Point, subdivisions: int = 3, smooth: bool = True) -> Any:
    """Return an icosphere."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions, radius=radius, location=place)
    thing = bpy.context.object
    thing.name = name
    thing.data.materials.append(material)
    thing.data.polygons.foreach_set("use_smooth", [smooth] * len(thing.data.polygons))
    return thing


def rounded(thing: Any, width: float, segments: int = 2) -> Any:
    """Give an object a bevel, and return it."""
    modifier = thing.modifiers.new("Bevel", "BEVEL")
    modifier.width, modifier.segments = width, segments
    return thing


def wall_with_opening(name: str, low: Point, high: Point, hole: tuple[Point, Point], material: Any) -> Any:
    """Return a box that a Boolean modifier with a hidden box cuts a window into."""
    wall = stage.box(name, low, high, material)
    cutter = stage.box(f"{name} Cutter", *hole)
    cutter.hide_render, cutter.display_type = True, "WIRE"
    boolean = wall.modifiers.new("Window", "BOOLEAN")
    boolean.object, boolean.operation = cutter, "DIFFERENCE"
    return wall
