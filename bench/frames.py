# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays of a frame in which something moved a little, of which most are those of the frame before.

`python -m bench.frames` bakes two frames of each scene, the second with what the rays of the first met and without, and
prints a table: rays that are traced and rays that are not, for both outputs at GOOD.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from radiosity_bake.core.bake import bake
from radiosity_bake.core.scene import Floats, PointLamp, Scene
from radiosity_bake.core.settings import BakeSettings

from . import scenes, varied_buildings

HINGE = np.array([1.0, 1.85, 0.0])


def with_vertices(scene: Scene, name: str, place: Callable[[Floats], Floats]) -> Scene:
    """Return the scene with the vertices of one of its meshes elsewhere."""
    return replace(
        scene,
        meshes=tuple(
            replace(mesh, vertices=place(mesh.vertices)) if mesh.name == name else mesh for mesh in scene.meshes
        ),
    )


def shifted(scene: Scene, name: str, *way: float) -> tuple[Scene, Scene]:
    """Return the scene before and after one of its meshes moved."""
    return scene, with_vertices(scene, name, lambda vertices: vertices + way)


def swinging_door() -> tuple[Scene, Scene]:
    """Return four rooms at a corridor, whose first door is open by 40 degrees and then by 50."""
    scene = varied_buildings.doors()
    leaf = scenes.block("Door", HINGE - [0.0, 0.02, -0.01], (0.88, 0.04, 2.03), reflectance=scenes.WARM)
    scene = replace(scene, meshes=(*scene.meshes, leaf))

    def opened(degrees: float) -> Scene:
        turned = scenes.rotation(degrees).T
        return with_vertices(scene, "Door", lambda vertices: (vertices - HINGE) @ turned + HINGE)

    return opened(40.0), opened(50.0)


def swinging_lamp() -> tuple[Scene, Scene]:
    """Return the furnished room in the light of a bulb that hangs from its ceiling, before and after it swings."""
    room = scenes.furnished_room()
    dark = tuple(replace(mesh, emission=np.zeros_like(mesh.emission)) for mesh in room.meshes)
    bulb = PointLamp("Bulb", np.array([2.5, 2.0, 2.2]), 0.05, np.full(3, 20.0))
    return tuple(
        replace(room, meshes=dark, lamps=(replace(bulb, centre=bulb.centre + [x, 0.0, 0.0]),)) for x in (0.0, 0.2)
    )


FRAMES = {
    "a block slides 4 cm in the Cornell box": lambda: shifted(scenes.cornell_box(), "Short Block", 0.03, 0.02, 0.0),
    "a ball moves 11 cm in the furnished room": lambda: shifted(scenes.furnished_room(), "Ball 3", -0.1, 0.05, 0.0),
    "a door opens by 10 degrees": swinging_door,
    "a lamp swings by 20 cm in the furnished room": swinging_lamp,
}


def main() -> None:
    """Print the table."""
    print("| what moves | output | rays of the frame alone | traced | share | kept, MB |\n|---|---|---|---|---|---|")
    for name, frames in FRAMES.items():
        for output in ("ORIGINAL", "REFINED"):
            settings = BakeSettings(output=output)
            first, second = frames()
            rays = bake(first, settings, keep_rays=True).kept_rays
            assert rays is not None
            report = bake(second, settings, before=rays, keep_rays=True).report
            traced, all_rays = report["rays"], report["rays"] + report["rays_known"]
            size = rays.bytes() / 1e6
            print(
                f"| {name} | {output} | {all_rays:,} | {traced:,} | {traced / all_rays:.0%} | {size:.0f} |", flush=True
            )


if __name__ == "__main__":
    main()
