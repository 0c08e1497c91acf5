# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Played in Blender's window by mouse and keyboard: Bake and Esc, then Bake to the end, then Restore."""

from __future__ import annotations

import json
import time

import bpy

from tools.blend_rooms import build_room

ATTRIBUTES = {"Radiosity", "Irradiance"}


def meshes():
    return {thing.name for thing in bpy.data.objects if thing.type == "MESH"}


def baked():
    """Return the meshes that carry the baked attributes."""
    return {
        thing.name
        for thing in bpy.data.objects
        if thing.type == "MESH" and set(thing.data.color_attributes.keys()) >= ATTRIBUTES
    }


def play(window):
    for thing in build_room("cornell_box"):
        thing.select_set(True)
        bpy.context.view_layer.objects.active = thing
    with window.context():
        bpy.ops.view3d.view_camera()
    space = window.area().spaces.active
    space.shading.type, space.overlay.show_overlays = "SOLID", False
    settings = bpy.context.scene.radiosity
    yield from window.open_sidebar("Radiosity")
    yield from window.screenshot("1_before")
    yield from cancel(window, settings)
    yield from bake(window, settings)
    yield from restore(window)


def cancel(window, settings):
    """Esc ends a bake that takes minutes at once, and nothing was changed."""
    before = meshes()
    settings.quality, settings.method, settings.minimum_size = "HIGH", "UNIFORM", 0.002
    yield from window.click_operator("radiosity.bake")
    yield from window.until(lambda: window.is_running("radiosity.bake"))
    yield from window.settle(10)
    assert window.is_running("radiosity.bake"), "the bake was to be cancelled, but is over already"
    yield from window.screenshot("2_running")
    pressed = time.monotonic()
    window.key("Escape")
    yield from window.until(lambda: not window.is_running("radiosity.bake"))
    # Half a second is promised; the rest is for the mouse and keyboard of a virtual screen on a busy machine.
    assert time.monotonic() - pressed < 2.0
    assert meshes() == before
    assert not baked()
    assert not settings.report
    yield from window.screenshot("3_cancelled")


def bake(window, settings):
    """A click on Bake lights every object, and the panel tells what came of it."""
    settings.quality, settings.method, settings.minimum_size = "DRAFT", "ADAPTIVE", 0.05
    yield from window.settle()
    yield from window.click_operator("radiosity.bake")
    yield from window.until(lambda: baked() and not window.is_running("radiosity.bake"), 120)
    assert len(baked()) == 8
    assert json.loads(settings.report)["rays"] > 0
    yield from window.screenshot("4_baked")


def restore(window):
    """A click on Restore brings the originals back."""
    yield from window.click_operator("radiosity.restore")
    yield from window.until(lambda: not baked())
    assert all(thing.visible_get() for thing in bpy.data.objects if thing.type == "MESH")
    yield from window.screenshot("5_restored")
