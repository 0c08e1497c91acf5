# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What relighting costs of a bake, and how near it comes to a fresh one: `python -m bench.relight`.

Every scene is baked, then lit with other colours: all base colours darker, its emitting meshes brighter and dimmer in
turn. The same is baked anew, and both are compared at area-uniform points; their meshes differ, as light decides where
vertices go, so the difference is due to both.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
from radiosity_bake.core.bake import bake
from radiosity_bake.core.relight import KeptTransport, relight, size_of
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import QUALITIES, BakeSettings

from .accuracy import LUMINANCE, irradiance_at_probes
from .probes import area_uniform_probes
from .scenes import SCENES
from .stopwatch import timed

DARKER = 0.7
STRENGTHS = (2.0, 0.5)

HEADER = (
    f"{'scene':20}{'quality':>8}{'bake s':>9}{'relight s':>11}{'share':>8}{'MiB':>7}{'difference':>12}{'stated':>9}"
)


def recoloured(scene: Scene) -> Scene:
    """Return the scene with darker surfaces, and emitting meshes that are brighter and dimmer in turn."""
    meshes, emitting = [], 0
    for mesh in scene.meshes:
        strength = STRENGTHS[emitting % len(STRENGTHS)]
        emitting += bool(mesh.emission.any())
        meshes.append(replace(mesh, reflectance=DARKER * mesh.reflectance, emission=strength * mesh.emission))
    return Scene(tuple(meshes), scene.world)


def line_of(name: str, quality: str, probes: int) -> str:
    """Return a row of the table."""
    scene, settings = SCENES[name](), BakeSettings(quality=quality)
    other, points = recoloured(scene), area_uniform_probes(scene, probes)
    result, cost = timed(lambda: bake(scene, settings))
    if not isinstance(result.kept, KeptTransport):
        return f"{name:20}{quality:>8}  not kept: {result.kept.why if result.kept else ''}"
    kept = result.kept
    relit, relight_cost = timed(lambda: relight(kept, other))
    fresh = bake(other, settings)
    values = [irradiance_at_probes(lit, points) @ LUMINANCE for lit in (relit, fresh)]
    dark = np.concatenate([[not mesh.emission[t].any() for t in range(len(mesh.triangles))] for mesh in scene.meshes])
    first = np.cumsum([0, *(len(mesh.triangles) for mesh in scene.meshes)])
    counted = dark[first[points.mesh] + points.triangle] & np.isfinite(values).all(axis=0)
    difference = (values[0] - values[1])[counted]
    rms = np.sqrt((difference**2).mean()) / values[1][counted].mean()
    stated = np.hypot(relit.report["estimated_error"], fresh.report["estimated_error"])
    share = relight_cost.processor_seconds / cost.processor_seconds
    return (
        f"{name:20}{quality:>8}{cost.processor_seconds:9.2f}{relight_cost.processor_seconds:11.2f}{share:8.1%}"
        f"{size_of(kept) / 2**20:7.0f}{rms:12.2%}{stated:9.2%}"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--scene", nargs="+", choices=sorted(SCENES), default=list(SCENES), metavar="NAME")
    parser.add_argument("--quality", nargs="+", choices=QUALITIES, default=["GOOD"])
    parser.add_argument("--probes", type=int, default=4000)
    asked = parser.parse_args()
    print("Processor seconds; difference and stated errors are RMS over the surface, relative to its mean")
    print(HEADER)
    for name in asked.scene:
        for quality in asked.quality:
            print(line_of(name, quality, asked.probes), flush=True)


if __name__ == "__main__":
    main()
