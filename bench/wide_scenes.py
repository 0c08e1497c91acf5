# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Small things on wide grounds: scenes most of whose area is not what anybody looks at."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from radiosity_bake.core.scene import Floats, Scene, SurfaceMesh

from tests.scenes import exact

from .scenes import COOL, DARKNESS, GREY, LAMP, WARM, WHITE, ball, block, panel, table

WOOD = (0.45, 0.28, 0.15)


@dataclass(frozen=True)
class WideScene:
    """A scene on a ground of any size.

    Attributes
    ----------
    on_ground : callable
        Gives the scene for the ground's side in metres (0: none), and whether it is baked.
    low, high : tuple of float, m
        Box in which the error is judged.
    """

    on_ground: Callable[[float, bool], Scene]
    low: tuple[float, float, float]
    high: tuple[float, float, float]

    @property
    def width(self) -> float:
        """Side of a ground that holds the box."""
        return 2.0 * max(self.high[:2])


def ground(side: float, height: float, baked: bool) -> list[SurfaceMesh]:
    """Return two triangles of a side, about the origin, or nothing."""
    if not side:
        return []
    corner = (-side / 2.0, -side / 2.0, height)
    mesh = exact.rectangle("Ground", corner, (side, 0, 0), (0, side, 0), reflectance=GREY)
    return [replace(mesh, baked=baked)]


def house(world: Floats = DARKNESS) -> WideScene:
    """Return a house of one room of 6 x 5 x 2.8 m with an open door and a window, a table, a crate and a lamp."""
    meshes = [
        block("Floor", (-3.2, -2.7, -0.1), (6.4, 5.4, 0.1), reflectance=WOOD),
        block("Roof", (-3.2, -2.7, 2.8), (6.4, 5.4, 0.2), reflectance=WHITE),
        block("West", (-3.2, -2.7, 0.0), (0.2, 5.4, 2.8), reflectance=WARM),
        block("North", (-3.0, 2.5, 0.0), (6.0, 0.2, 2.8), reflectance=WHITE),
        block("South West", (-3.0, -2.7, 0.0), (2.5, 0.2, 2.8), reflectance=WHITE),
        block("South East", (0.5, -2.7, 0.0), (2.5, 0.2, 2.8), reflectance=WHITE),
        block("Above Door", (-0.5, -2.7, 2.1), (1.0, 0.2, 0.7), reflectance=WHITE),
        block("East South", (3.0, -2.7, 0.0), (0.2, 2.0, 2.8), reflectance=COOL),
        block("East North", (3.0, 0.7, 0.0), (0.2, 2.0, 2.8), reflectance=COOL),
        block("Below Window", (3.0, -0.7, 0.0), (0.2, 1.4, 0.9), reflectance=COOL),
        block("Above Window", (3.0, -0.7, 2.1), (0.2, 1.4, 0.7), reflectance=COOL),
        block("Crate", (-2.2, -1.6, 0.0), (0.9, 0.9, 0.8), degrees=20.0, reflectance=WARM),
        *table("Table", (0.6, 0.3), (1.4, 0.9), 0.75, 0.06),
        panel("Lamp", (-0.5, -0.5, 2.75), (1.0, 1.0)),
    ]
    return WideScene(
        lambda side, baked: Scene((*meshes, *ground(side, -0.1, baked)), world),
        (-3.01, -2.51, -0.01),
        (3.01, 2.51, 2.81),
    )


def hut() -> WideScene:
    """Return a room that stands on the ground without a floor of its own, and is open to one side."""
    meshes = [
        block("Roof", (-3.2, -2.7, 2.8), (6.4, 5.4, 0.2), reflectance=WHITE),
        block("West", (-3.2, -2.7, 0.0), (0.2, 5.4, 2.8), reflectance=WARM),
        block("East", (3.0, -2.7, 0.0), (0.2, 5.4, 2.8), reflectance=COOL),
        block("North", (-3.0, 2.5, 0.0), (6.0, 0.2, 2.8), reflectance=WHITE),
        block("Crate", (-2.2, -1.6, 0.0), (0.9, 0.9, 0.8), degrees=20.0, reflectance=WARM),
        panel("Lamp", (-0.5, -0.5, 2.75), (1.0, 1.0)),
    ]
    return WideScene(
        lambda side, baked: Scene((*meshes, *ground(side, 0.0, baked)), DARKNESS),
        (-3.01, -2.51, -0.01),
        (3.01, 2.51, 2.81),
    )


def street() -> WideScene:
    """Return two rows of six houses along a street of 60 m under a sky, with crates and balls before them."""
    rng = np.random.default_rng(4)
    meshes = []
    for k in range(12):
        x, y = -30.0 + 10.0 * (k % 6), (5.0, -15.0)[k // 6]
        size = (9.0, 10.0, 5.0 + 5.0 * rng.random())
        meshes.append(block(f"House {k + 1}", (x, y, 0.0), size, reflectance=(WHITE, WARM, COOL)[k % 3]))
        meshes.append(block(f"Crate {k + 1}", (x + 2.0, -3.0 + 5.0 * (k // 6), 0.0), (1.0, 1.0, 1.0), reflectance=WOOD))
        meshes.append(ball(f"Ball {k + 1}", (x + 5.0, 1.0 - 3.0 * (k // 6), 0.5), 0.5, levels=3, reflectance=WARM))
    return WideScene(
        lambda side, baked: Scene((*meshes, *ground(side, 0.0, baked)), np.array([1.0, 1.2, 1.6])),
        (-31.0, -16.0, -0.01),
        (31.0, 16.0, 11.0),
    )


def stall() -> WideScene:
    """Return a few things under a small bright lamp on a ground that a dim sky lights."""
    meshes = [
        block("Counter", (-1.0, -0.4, 0.0), (2.0, 0.8, 0.9), reflectance=WOOD),
        ball("Ball", (0.3, 0.0, 1.1), 0.2, levels=3, reflectance=WARM),
        block("Box", (-0.7, -0.2, 0.9), (0.4, 0.3, 0.3), degrees=30.0, reflectance=COOL),
        panel("Lamp", (-0.2, -0.2, 2.2), (0.4, 0.4), 2.0 * np.array(LAMP)),
    ]
    return WideScene(
        lambda side, baked: Scene((*meshes, *ground(side, 0.0, baked)), np.full(3, 0.01)),
        (-4.0, -4.0, -0.01),
        (4.0, 4.0, 2.5),
    )


WIDE_SCENES: dict[str, Callable[[], WideScene]] = {
    "house": house,
    "house_at_dusk": lambda: house(np.array([0.1, 0.12, 0.16])),
    "hut": hut,
    "street": street,
    "stall": stall,
}
