# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' own bake to vertices, in a process of its own: `python cycles_bake.py SCENE.npz BAKED.npz`.

Reads and writes plain arrays (see `bench.peers.cycles`), and imports nothing of ours.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Mapping

import bpy
import numpy as np
from blender_scene import make_object, set_world

ATTRIBUTE = "Baked"


def set_up(arrays: Mapping[str, np.ndarray]) -> None:
    """Make Cycles a reference of itself: many bounces, no clamping, no denoising, a fixed number of samples."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = int(arrays["samples"])
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = int(arrays["bounces"])
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.bake_type = "DIFFUSE"
    scene.render.bake.use_pass_direct = scene.render.bake.use_pass_indirect = True
    scene.render.bake.use_pass_color = False
    scene.render.bake.target = "VERTEX_COLORS"
    set_world(arrays["world"])


def main(given: str, answered: str) -> None:
    """Bake the scene of one file and write the vertices' values to the other."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with np.load(given) as file:
        arrays = dict(file)
    set_up(arrays)
    count = sum(name.startswith("vertices_") for name in arrays)
    things = {k: make_object(arrays, k) for k in range(count)}
    wanted = [k for k in things if bool(arrays[f"baked_{k}"])]
    for k, thing in things.items():
        mesh = thing.data
        mesh.color_attributes.new(ATTRIBUTE, "FLOAT_COLOR", "POINT")
        mesh.color_attributes.active_color = mesh.color_attributes[ATTRIBUTE]
        thing.select_set(k in wanted)
    bpy.context.view_layer.objects.active = things[wanted[0]]
    start, used = time.perf_counter(), sum(os.times()[:2])
    bpy.ops.object.bake(type="DIFFUSE")
    seconds, processor_seconds = time.perf_counter() - start, sum(os.times()[:2]) - used
    result: dict[str, np.ndarray] = {"seconds": np.array(seconds), "processor_seconds": np.array(processor_seconds)}
    for k in wanted:
        attribute = things[k].data.color_attributes[ATTRIBUTE]
        values = np.empty(4 * len(attribute.data), dtype=np.float32)
        attribute.data.foreach_get("color", values)
        result[f"irradiance_{k}"] = values.reshape(-1, 4)[:, :3].astype(np.float64)
    np.savez(answered, **result)


if __name__ == "__main__":
    main(*sys.argv[-2:])
