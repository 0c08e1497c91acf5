# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Played in Blender's window: Blender is ended amid a bake that takes minutes, of `frames` if that is the argument."""

from __future__ import annotations

import time

import bpy

from tools.blend_rooms import build_room


def play(window):
    for thing in build_room("cornell_box"):
        thing.select_set(True)
        bpy.context.view_layer.objects.active = thing
    settings = bpy.context.scene.radiosity
    settings.quality, settings.method, settings.minimum_size = "HIGH", "UNIFORM", 0.002
    operator = bpy.ops.radiosity.bake_frames if "frames" in window.arguments else bpy.ops.radiosity.bake
    with window.context():
        assert operator("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    # Long enough that rays are traced, however busy the machine is.
    began = time.monotonic()
    yield from window.until(lambda: time.monotonic() - began > 4.0)
    assert window.is_running("radiosity.bake_frames" if "frames" in window.arguments else "radiosity.bake")
    print("quitting", flush=True)
    with window.context():
        bpy.ops.wm.quit_blender()
    yield from window.until(lambda: False)
