# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that scenes of cases are built of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np
from mathutils import Vector

Point = Sequence[float]

# Metres along a side of the floor, and its cells; a vertex in the middle of each side of a cell would tell no more.
HALF_SIDE = 1.0
CELLS = 10

PAINT = (0.5, 0.5, 0.5)


def add(
    name: str, data: Any, location: Point = (0, 0, 0), rotation: Point = (0, 0, 0), scale: Point = (1, 1, 1)
) -> Any:
    """Return a new object in the scene."""
    thing = bpy.data.objects.new(name, data)
    thing.location, thing.rotation_euler, thing.scale = location, rotation, scale
    bpy.context.scene.collection.objects.link(thing)
    return thing


def mesh(
    name: str, vertices: Sequence[Point], faces: Sequence[Sequence[int]], material: Any = None, **place: Any
) -> Any:
    """Return a new mesh object; `place` is what `add` takes."""
    data = bpy.data.meshes.new(name)
    data.from_pydata([tuple(map(float, vertex)) for vertex in vertices], [], faces)
    if material is not None:
        data.materials.append(material)
    return add(name, data, **place)


def grid(name: str, width: float, depth: float, cells: int = CELLS, material: Any = None, **place: Any) -> Any:
    """Return a rectangle about its origin, cut into square-like cells, that faces up; it has a UV map."""
    x, y = np.linspace(-width / 2, width / 2, cells + 1), np.linspace(-depth / 2, depth / 2, cells + 1)
    row = cells + 1
    quads = [(a, a + 1, a + row + 1, a + row) for j in range(cells) for a in range(j * row, j * row + cells)]
    thing = mesh(name, [(a, b, 0.0) for b in y for a in x], quads, material, **place)
    layer = thing.data.uv_layers.new(name="UVMap")
    for corner, loop in enumerate(thing.data.loops):
        a, b, _ = thing.data.vertices[loop.vertex_index].co
        layer.uv[corner].vector = (a / width + 0.5, b / depth + 0.5)
    return thing


def box(name: str, low: Point, high: Point, material: Any = None, **place: Any) -> Any:
    """Return a closed box that faces outwards."""
    vertices = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return mesh(name, vertices, faces, material, **place)


def node_tree(owner: Any) -> Any:
    """Return the emptied node tree of a material, world or lamp, with an output node in it."""
    if bpy.app.version < (5, 0, 0):
        owner.use_nodes = True
    tree = owner.node_tree
    tree.nodes.clear()
    kinds = {bpy.types.World: "World", bpy.types.Light: "Light", bpy.types.Material: "Material"}
    tree.nodes.new(next(f"ShaderNodeOutput{name}" for kind, name in kinds.items() if isinstance(owner, kind)))
    return tree


def shader(tree: Any, kind: str, **inputs: Any) -> Any:
    """Return a new node with some of its inputs set, by name with `_` for a space; one that is a socket is linked."""
    node = tree.nodes.new(kind)
    for name, value in inputs.items():
        socket = node.inputs[name.replace("_", " ")]
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, socket)
        elif isinstance(value, tuple) and len(value) == 3 and socket.type == "RGBA":
            socket.default_value = (*value, 1.0)
        else:
            socket.default_value = value
    return node


def show(tree: Any, node: Any) -> None:
    """Make a shader node what the output shows."""
    output = next(found for found in tree.nodes if found.type.startswith("OUTPUT_"))
    tree.links.new(node.outputs[0], output.inputs["Surface"])


def material(name: str, kind: str, **inputs: Any) -> Any:
    """Return a material of one shader node."""
    made = bpy.data.materials.new(name)
    tree = node_tree(made)
    show(tree, shader(tree, kind, **inputs))
    return made


def paint(name: str = "Paint", colour: Point = PAINT) -> Any:
    """Return a diffuse material."""
    return material(name, "ShaderNodeBsdfDiffuse", Color=tuple(colour))


def glow(name: str = "Glow", colour: Point = (1.0, 1.0, 1.0), strength: float = 5.0) -> Any:
    """Return a material that emits from both sides."""
    return material(name, "ShaderNodeEmission", Color=tuple(colour), Strength=strength)


def world(colour: Point = (1.0, 1.0, 1.0), strength: float = 1.0) -> Any:
    """Give the scene a constant world and return it."""
    made = bpy.data.worlds.new("World")
    tree = node_tree(made)
    show(tree, shader(tree, "ShaderNodeBackground", Color=tuple(colour), Strength=strength))
    bpy.context.scene.world = made
    return made


def lamp(
    kind: str, place: Point = (0.3, -0.2, 1.6), turn: Point = (0, 0, 0), scale: Point = (1, 1, 1), **values: Any
) -> Any:
    """Return a lamp of 10 W (a sun of strength 3) above the floor, unless `values` of its data say otherwise."""
    light = bpy.data.lights.new("Lamp", kind)
    light.energy = 3.0 if kind == "SUN" else 10.0
    for key, value in values.items():
        setattr(light, key, value)
    return add("Lamp", light, place, turn, scale)


def camera(place: Point, target: Point, lens: float = 35.0) -> Any:
    """Add the camera that the pictures are taken with."""
    data = bpy.data.cameras.new("Camera")
    data.lens, data.clip_start = lens, 0.01
    turn = (Vector(target) - Vector(place)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.camera = add("Camera", data, place, turn)
    return bpy.context.scene.camera


def room(material: Any = None) -> Any:
    """Return a floor of many vertices, with a coloured wall beside it and a board that floats above it, and a camera.

    The floor's vertices lie on nothing else, so that their light is defined to the last bit.
    """
    grey, red = material or paint(), paint("Red Paint", (0.6, 0.25, 0.15))
    floor = grid("Floor", 2 * HALF_SIDE, 2 * HALF_SIDE, material=grey)
    mesh("Wall", [(-1.2, -2, 0), (-1.2, 2, 0), (-1.2, 2, 2), (-1.2, -2, 2)], [(0, 1, 2, 3)], red)
    board((0.05, 0.01, 0.6))
    camera((2.6, -2.6, 2.2), (-0.1, 0.0, 0.3), 40.0)
    return floor


def board(place: Point, material: Any = None) -> Any:
    """Return a turned square that throws a shadow."""
    corners = [(-0.18, -0.38, 0.0), (0.38, -0.18, 0.0), (0.18, 0.40, 0.0), (-0.38, 0.20, 0.0)]
    return mesh("Board", corners, [(0, 1, 2, 3)], material or paint("Board Paint"), location=place)


def closed_room(inside: Point = (0.7, 0.7, 0.7)) -> Any:
    """Return the floor of a closed room of 3 x 3 x 2.4 m with a red and a green wall, and a camera in it."""
    white, red, green = paint("White", inside), paint("Red", (0.6, 0.1, 0.05)), paint("Green", (0.1, 0.5, 0.12))
    floor = grid("Floor", 3.0, 3.0, material=white)
    a, h = 1.5, 2.4
    quad = [(0, 1, 2, 3)]
    mesh("Ceiling", [(-a, -a, h), (-a, a, h), (a, a, h), (a, -a, h)], quad, white)
    mesh("Left", [(-a, -a, 0), (-a, a, 0), (-a, a, h), (-a, -a, h)], quad, red)
    mesh("Right", [(a, -a, 0), (a, -a, h), (a, a, h), (a, a, 0)], quad, green)
    mesh("Back", [(-a, a, 0), (a, a, 0), (a, a, h), (-a, a, h)], quad, white)
    mesh("Front", [(-a, -a, 0), (-a, -a, h), (a, -a, h), (a, -a, 0)], quad, white)
    camera((0.0, -1.45, 1.5), (0.0, 1.0, 0.9), 18.0)
    return floor


def turned_over(thing: Any) -> None:
    """Turn the faces of an object over."""
    thing.data.flip_normals()
