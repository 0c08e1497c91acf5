# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A low-polygon game level."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .. import stage
from . import parts

CELLS = 24
SIDE = 24.0


def build() -> None:
    """Flat-shaded terrain with colours on its vertices, crates of one palette picture, torches, and a low sun."""
    palette = parts.textured("Palette", parts.image("Palette", 8, _palette))
    _terrain()
    generator = np.random.default_rng(7)
    for k in range(14):
        x, y = generator.uniform(-8.0, 8.0, 2)
        size = float(generator.uniform(0.5, 1.1))
        _crate(f"Crate {k + 1}", palette, int(generator.integers(8)), (x, y, _height(x, y) - 0.1), size, k * 0.7)
    for k in range(12):
        x, y = generator.uniform(-10.0, 10.0, 2)
        _pine(f"Pine {k + 1}", (x, y, _height(x, y) - 0.05), float(generator.uniform(0.8, 1.4)))
    _fort(palette)
    for k, (x, y) in enumerate(((-2.2, 1.6), (2.2, 1.6))):
        torch = stage.lamp("POINT", place=(x, y, 2.6), shadow_soft_size=0.12, energy=150.0, color=(1.0, 0.45, 0.12))
        torch.name = f"Torch {k + 1}"
    stage.lamp("SUN", turn=(math.radians(60), 0.0, math.radians(-40)), angle=0.01, energy=2.0, color=(1.0, 0.8, 0.6))
    stage.world((0.35, 0.45, 0.75), 0.4)
    stage.camera((5.5, -11.0, 5.0), (0.0, 1.5, 1.0), 28.0)


def _height(x: float, y: float) -> float:
    """Return the ground's height, flat in the middle."""
    away = min(max((math.hypot(x, y) - 5.0) / 5.0, 0.0), 1.0)
    return away * (0.9 * math.sin(0.7 * x + 1.0) + 0.8 * math.cos(0.6 * y) + 0.8)


def _terrain() -> None:
    ground = stage.grid("Terrain", SIDE, SIDE, CELLS)
    for vertex in ground.data.vertices:
        vertex.co.z = _height(vertex.co.x, vertex.co.y)
    colours = ground.data.color_attributes.new("Paint", "BYTE_COLOR", "POINT")
    values = [
        (0.10 + 0.16 * (v.co.z > 0.7), 0.26 - 0.05 * (v.co.z > 0.7), 0.07 + 0.08 * (v.co.z > 0.7), 1.0)
        for v in ground.data.vertices
    ]
    colours.data.foreach_set("color", np.array(values, dtype=np.float32).ravel())
    made = stage.material("Painted Ground", "ShaderNodeBsdfDiffuse")
    attribute = made.node_tree.nodes.new("ShaderNodeVertexColor")
    attribute.layer_name = "Paint"
    diffuse = next(node for node in made.node_tree.nodes if node.type == "BSDF_DIFFUSE")
    made.node_tree.links.new(attribute.outputs["Color"], diffuse.inputs["Color"])
    ground.data.materials.append(made)


def _palette(u: Any, v: Any) -> Any:
    """Eight colours side by side."""
    colours = ((0.7, 0.5, 0.3), (0.55, 0.35, 0.2), (0.6, 0.2, 0.15), (0.2, 0.35, 0.55))
    row = np.array((*colours, (0.5, 0.5, 0.5), (0.35, 0.35, 0.38), (0.75, 0.7, 0.4), (0.3, 0.5, 0.3)))
    return row[np.clip((u * 8).astype(int), 0, 7)]


def _of_palette(thing: Any, colour: int) -> Any:
    """Unwrap all faces to one colour of the palette, as low-polygon artists do."""
    layer = thing.data.uv_layers.new(name="UVMap")
    for corner in range(len(thing.data.loops)):
        layer.uv[corner].vector = ((colour + 0.5) / 8.0, 0.5)
    return thing


def _crate(name: str, palette: Any, colour: int, place: Any, size: float, turn: float) -> None:
    half = size / 2.0
    crate = _of_palette(stage.box(name, (-half, -half, 0.0), (half, half, size), palette), colour)
    crate.location, crate.rotation_euler.z = place, turn


def _pine(name: str, place: Any, size: float) -> None:
    bark, needles = parts.principled("Bark", (0.2, 0.12, 0.07)), parts.principled("Needles", (0.07, 0.22, 0.12))
    trunk = parts.cylinder(f"{name} Trunk", 0.12 * size, 0.7 * size, bark, place, 6)
    trunk.data.polygons.foreach_set("use_smooth", [False] * len(trunk.data.polygons))
    for k in range(3):
        height = place[2] + (0.6 + 0.55 * k) * size
        radius = (0.75 - 0.2 * k) * size
        cone = parts.cylinder(f"{name} Needles {k + 1}", radius, 0.9 * size, needles, (*place[:2], height), 7, 0.02)
        cone.data.polygons.foreach_set("use_smooth", [False] * len(cone.data.polygons))


def _fort(palette: Any) -> None:
    """Two towers, a gate and a ramp."""
    for k, x in enumerate((-3.2, 3.2)):
        _of_palette(stage.box(f"Tower {k + 1}", (x - 0.9, 2.0, -0.2), (x + 0.9, 3.8, 4.0), palette), 4)
        for j, (a, b) in enumerate(((-0.9, 2.0), (0.5, 2.0), (-0.9, 3.4), (0.5, 3.4))):
            low, high = (x + a, b, 4.0), (x + a + 0.4, b + 0.4, 4.5)
            _of_palette(stage.box(f"Tower {k + 1} Merlon {j + 1}", low, high, palette), 5)
    _of_palette(stage.box("Gate Beam", (-2.3, 2.4, 2.6), (2.3, 3.4, 3.4), palette), 5)
    corners = [(-1.0, -1.5, -0.1), (1.0, -1.5, -0.1), (1.0, 2.4, 0.9), (-1.0, 2.4, 0.9)]
    low = [(x, y, -0.3) for x, y, _ in corners]
    faces = [(0, 1, 2, 3), (7, 6, 5, 4), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
    _of_palette(stage.mesh("Ramp", [*corners, *low], faces, palette), 0)
