# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles as a reference of itself: its bake to face corners, and its pictures, with nothing cut short."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

BOUNCES = 64
ATTRIBUTE = "Cycles"
PICTURE_SAMPLES = 256
OWN_PICTURE_SAMPLES = 16  # for smooth outlines: baked colours have no noise

Floats = NDArray[np.float64]


def set_up(samples: int, seed: int = 0) -> None:
    """Make Cycles a reference: many bounces, no clamping, no denoising, a fixed number of samples."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    for name, value in {
        "device": "CPU",
        "samples": samples,
        "seed": seed,
        "use_adaptive_sampling": False,
        "use_denoising": False,
        "sample_clamp_direct": 0.0,
        "sample_clamp_indirect": 0.0,
        "light_sampling_threshold": 0.0,
        "blur_glossy": 0.0,
        "caustics_reflective": True,
        "caustics_refractive": True,
        "max_bounces": BOUNCES,
        "diffuse_bounces": BOUNCES,
        "glossy_bounces": BOUNCES,
        "transmission_bounces": BOUNCES,
        "transparent_max_bounces": BOUNCES,
    }.items():
        setattr(scene.cycles, name, value)


PASSES = {"DIRECT": {"DIRECT"}, "INDIRECT": {"INDIRECT"}}
"""Of Cycles' bakes for the parts of the light that our setting `light` names; all others have both."""


def light(things: Sequence[Any], quantity: str, samples: int, seed: int, part: str = "ALL") -> list[Floats]:
    """Return what Cycles bakes for a quantity (see `Case.quantity`): (c, 3) at the face corners of each object."""
    passes = PASSES.get(part, {"DIRECT", "INDIRECT"})
    set_up(samples, seed)
    with own_meshes(things, quantity.endswith("Back")):
        if quantity.startswith("Irradiance"):
            return baked(things, "DIFFUSE", passes)
        reflected = baked(things, "DIFFUSE", {*passes, "COLOR"})
        if part == "INDIRECT":
            return reflected
        return [a + b for a, b in zip(reflected, baked(things, "EMIT", set()), strict=True)]


@contextmanager
def own_meshes(things: Sequence[Any], turned_over: bool) -> Iterator[None]:
    """Give each object a mesh of its own to bake to, maybe turned over, for a while."""
    before = [thing.data for thing in things]
    for thing in things:
        thing.data = thing.data.copy()
        if turned_over:
            thing.data.flip_normals()
        attribute = thing.data.color_attributes.new(ATTRIBUTE, "FLOAT_COLOR", "CORNER")
        thing.data.color_attributes.active_color = attribute
    try:
        yield
    finally:
        for thing, mesh in zip(things, before, strict=True):
            own, thing.data = thing.data, mesh
            bpy.data.meshes.remove(own)


def baked(things: Sequence[Any], kind: str, passes: set[str]) -> list[Floats]:
    """Return one of Cycles' bakes at the face corners."""
    select(things)
    bpy.ops.object.bake(type=kind, pass_filter=passes, target="VERTEX_COLORS")
    return [corner_colours(thing.data, ATTRIBUTE) for thing in things]


def select(things: Sequence[Any]) -> None:
    """Select just these objects."""
    for other in bpy.context.view_layer.objects:
        other.select_set(False)
    for thing in things:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = things[0]


def corner_colours(mesh: Any, name: str) -> Floats:
    """Return (c, 3) a colour attribute at the face corners, wherever it is kept."""
    attribute = mesh.color_attributes[name]
    values = np.empty(4 * len(attribute.data), dtype=np.float32)
    attribute.data.foreach_get("color", values)
    colours: Floats = values.reshape(-1, 4)[:, :3].astype(np.float64)
    return colours if attribute.domain == "CORNER" else colours[vertex_of_corner(mesh)]


def vertex_of_corner(mesh: Any) -> NDArray[np.int32]:
    """Return (c,) the vertex of each face corner."""
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return corners


def picture(width: int, height: int, path_traced: bool, samples: int = PICTURE_SAMPLES, seed: int = 0) -> Floats:
    """Return (h, w, 3) the scene's radiance as its camera sees it, rows from above.

    Parameters
    ----------
    path_traced : bool
        With `samples` for each pixel, and denoised; else with just as many as smooth outlines need.
    seed : int
        Of the noise.
    """
    set_up(samples if path_traced else OWN_PICTURE_SAMPLES)
    scene = bpy.context.scene
    scene.cycles.seed = seed
    if path_traced:
        scene.cycles.use_denoising = True
        scene.cycles.denoiser = "OPENIMAGEDENOISE"
        scene.cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "picture.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        pixels = np.empty(width * height * image.channels, dtype=np.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
    seen: Floats = pixels.reshape(height, width, -1)[::-1, :, :3].astype(np.float64)
    return seen
