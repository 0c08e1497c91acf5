# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A lamp under a shade, in a dark corner."""

from __future__ import annotations

import math

import numpy as np

from .. import stage
from . import parts


def build() -> None:
    """All light comes from a bulb that glows inside a shade without thickness."""
    wall = parts.principled("Wallpaper", (0.42, 0.34, 0.28))
    stage.grid("Floor", 4.0, 4.0, 4, parts.principled("Parquet", (0.30, 0.17, 0.09)))
    stage.grid("Back Wall", 4.0, 2.6, 4, wall, location=(0.0, 2.0, 1.3), rotation=(math.pi / 2.0, 0.0, 0.0))
    stage.grid("Side Wall", 4.0, 2.6, 4, wall, location=(-2.0, 0.0, 1.3), rotation=(math.pi / 2.0, 0.0, math.pi / 2.0))
    wood = parts.principled("Mahogany", (0.20, 0.07, 0.04))
    parts.cylinder("Table Top", 0.55, 0.03, wood, (-0.9, 0.9, 0.70), 48)
    parts.cylinder("Table Leg", 0.05, 0.70, wood, (-0.9, 0.9, 0.0), 16)
    brass = parts.principled("Brass", (0.5, 0.36, 0.12))
    parts.cylinder("Lamp Foot", 0.11, 0.02, brass, (-0.9, 0.9, 0.73), 32)
    parts.cylinder("Lamp Stem", 0.012, 0.30, brass, (-0.9, 0.9, 0.75), 12)
    _shade((-0.9, 0.9, 1.02))
    parts.ball("Bulb", 0.035, stage.glow("Bulb", (1.0, 0.72, 0.42), 900.0), (-0.9, 0.9, 1.13), 3)
    for k, (turn, colour) in enumerate(((0.2, (0.4, 0.05, 0.04)), (-0.1, (0.05, 0.15, 0.3)), (0.5, (0.2, 0.3, 0.1)))):
        low, high = (-0.11, -0.08, 0.0), (0.11, 0.08, 0.03)
        book = stage.box(f"Book {k + 1}", low, high, parts.principled(f"Cover {k + 1}", colour))
        book.location, book.rotation_euler.z = (-0.62, 0.62, 0.7305 + 0.0305 * k), turn
    _armchair()
    stage.camera((1.6, -1.9, 1.45), (-0.8, 0.8, 0.85), 30.0)


def _shade(place) -> None:
    """A cone open at both ends."""
    sides = 48
    angles = 2.0 * math.pi * np.arange(sides) / sides
    vertices = [
        (radius * math.cos(a), radius * math.sin(a), z) for radius, z in ((0.20, 0.0), (0.12, 0.24)) for a in angles
    ]
    faces = [(k, (k + 1) % sides, (k + 1) % sides + sides, k + sides) for k in range(sides)]
    thing = stage.mesh("Lamp Shade", vertices, faces, parts.principled("Parchment", (0.72, 0.60, 0.42)), location=place)
    thing.data.polygons.foreach_set("use_smooth", [True] * sides)


def _armchair() -> None:
    leather = parts.principled("Leather", (0.25, 0.10, 0.05))
    for name, low, high in (
        ("Seat", (0.1, 0.7, 0.12), (0.85, 1.45, 0.42)),
        ("Chair Back", (0.1, 1.40, 0.12), (0.85, 1.65, 1.0)),
        ("Left Arm", (-0.08, 0.7, 0.12), (0.1, 1.65, 0.62)),
        ("Right Arm", (0.85, 0.7, 0.12), (1.03, 1.65, 0.62)),
    ):
        parts.rounded(stage.box(name, low, high, leather), 0.05, 3)
