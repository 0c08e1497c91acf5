# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a wide ground costs accuracy where it matters: `python -m bench.wide`.

Each scene of `bench/wide_scenes.py` is baked on grounds of many sizes, baked or not, and compared with the reference
within its box alone. The reference is computed once, on a ground of `REFERENCE_SIDE`: what lies beyond it brings
little, and single precision is too coarse for a path tracer on the widest of them.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
from radiosity_bake.core.bake import bake
from radiosity_bake.core.scene import Ints, Scene
from radiosity_bake.core.settings import QUALITIES, BakeSettings

from .accuracy import compare, irradiance_at_probes
from .probes import Probes, area_uniform_probes
from .reference import Reference, combined, irradiance
from .stopwatch import timed_once
from .wide_scenes import WIDE_SCENES, WideScene

SIDES = (60.0, 600.0, 6000.0)
REFERENCE_SIDE = 200.0
PROBES = 3000

SAMPLES, PARTS = 2048, 4


def probes_within(scene: WideScene, baked: bool) -> Probes:
    """Return probes in the scene's box, on a ground no wider than that, or few of them would be."""
    narrow = scene.on_ground(scene.width, baked)
    probes = area_uniform_probes(narrow, PROBES)
    inside = np.all((probes.position > scene.low) & (probes.position < scene.high), axis=1)
    return taken(probes, np.flatnonzero(inside))


def taken(probes: Probes, which: Ints) -> Probes:
    """Return some of the probes."""
    arrays = (probes.mesh, probes.triangle, probes.barycentric, probes.position, probes.normal, probes.shading_normal)
    return Probes(*(array[which] for array in arrays), probes.area * len(which) / len(probes))


def on_wider_ground(probes: Probes, scene: Scene) -> Probes:
    """Return the same places, in the triangles of a scene with a wider ground."""
    ground = len(scene.meshes) - 1
    rows = np.flatnonzero((probes.mesh == ground) & (scene.meshes[ground].name == "Ground"))
    corners = scene.meshes[ground].vertices[scene.meshes[ground].triangles]
    triangle, barycentric = probes.triangle.copy(), probes.barycentric.copy()
    for number, (a, b, c) in enumerate(corners):
        if len(rows):
            matrix = np.stack([b - a, c - a], axis=1)
            weights = np.linalg.lstsq(matrix, (probes.position[rows] - a).T, rcond=None)[0].T
            weights = np.column_stack([1.0 - weights.sum(axis=1), weights])
            inside = weights.min(axis=1) >= 0.0
            triangle[rows[inside]], barycentric[rows[inside]] = number, weights[inside]
    return replace(probes, triangle=triangle, barycentric=barycentric)


def reference_of(scene: WideScene, probes: Probes, side: float) -> Reference:
    """Return the light at probes, computed on a ground of a side."""
    where = probes.position, probes.normal, probes.shading_normal
    return combined([irradiance(scene.on_ground(side, True), *where, samples=SAMPLES, seed=k) for k in range(PARTS)])


def main() -> None:
    """Bake, compare and print."""
    parser = argparse.ArgumentParser(prog="python -m bench.wide", description=__doc__.splitlines()[0])
    parser.add_argument("scene", nargs="*", help=f"default: all of {', '.join(WIDE_SCENES)}")
    parser.add_argument("--quality", choices=QUALITIES, default="GOOD")
    parser.add_argument("--side", type=float, action="append", help="of the ground, m; 0 leaves it away")
    asked = parser.parse_args()
    print(
        f"{'scene':<15}{'ground':>8}{'baked':>7}{'error':>8}{'noise':>7}{'bias':>8}{'estimate':>10}{'vertices':>10}"
        f"{'patches':>9}{'rays':>8}{'cpu':>7}{'size':>9}"
    )
    for name in asked.scene or WIDE_SCENES:
        wide = WIDE_SCENES[name]()
        for baked in (False, True):
            probes = probes_within(wide, baked)
            truths = {wanted: reference_of(wide, probes, wanted) for wanted in (REFERENCE_SIDE,)}
            for side in asked.side or SIDES:
                scene = wide.on_ground(side, baked)
                result, cost = timed_once(
                    lambda scene=scene: bake(scene, BakeSettings(quality=asked.quality, keep_transport=False))
                )
                values = irradiance_at_probes(result, on_wider_ground(probes, scene))
                accuracy = compare(wide.on_ground(wide.width, baked), probes, values, truths[REFERENCE_SIDE])
                report = result.report
                print(
                    f"{name:<15}{side:>8,.0f}{baked!s:>7}{accuracy.rms:>8.2%}{accuracy.reference_noise:>7.2%}"
                    f"{accuracy.bias:>8.2%}{report['estimated_error']:>10.2%}{report['vertices']:>10,}"
                    f"{report['patches']:>9,}{report['rays'] / 1e6:>7.1f}M{cost.processor_seconds:>7.1f}"
                    f"{report['minimum_size']:>9.3g}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
