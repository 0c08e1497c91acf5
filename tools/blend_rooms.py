# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The example rooms as an artist would have them in Blender: named objects, Principled materials, a camera, Cycles."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from mathutils import Vector

from .rooms import CAMERAS, ROOMS, Camera, Surface

SHORTER_SIDE = 512  # pixels; the rooms are as wide as high, or wider
SAMPLES = 32  # few, and denoised: without that, twelve times as many still show grain in dark corners
SAMPLES_IF_NOT_DENOISED = 400


def build_room(name: str) -> list[bpy.types.Object]:
    """Replace everything in the open file by one of the example rooms and return its meshes."""
    for blocks in (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.cameras, bpy.data.lights):
        bpy.data.batch_remove(list(blocks))
    objects = add_surfaces(ROOMS[name]())
    add_camera(CAMERAS[name])
    make_world_dark()
    set_render(width=round(SHORTER_SIDE / CAMERAS[name].aspect), height=SHORTER_SIDE)
    return objects


def add_surfaces(surfaces: Sequence[Surface]) -> list[bpy.types.Object]:
    """Add an object for each surface; surfaces of one material share it."""
    materials: dict[tuple[object, ...], bpy.types.Material] = {}
    objects = []
    for surface in surfaces:
        look = (surface.material, surface.reflectance, surface.emission)
        if look not in materials:
            materials[look] = make_material(surface)
        objects.append(add_object(surface, materials[look]))
    return objects


def add_object(surface: Surface, material: bpy.types.Material) -> bpy.types.Object:
    """Add one mesh object, with its origin where its geometry stands: in the middle, at the bottom."""
    points = [Vector(point) for point in surface.vertices]
    low = Vector(map(min, zip(*points, strict=True)))
    high = Vector(map(max, zip(*points, strict=True)))
    origin = Vector(((low.x + high.x) / 2.0, (low.y + high.y) / 2.0, low.z))
    mesh = bpy.data.meshes.new(surface.name)
    mesh.from_pydata([point - origin for point in points], [], surface.faces)
    mesh.materials.append(material)
    mesh.polygons.foreach_set("use_smooth", [surface.smooth] * len(mesh.polygons))
    mesh.update()
    thing = bpy.data.objects.new(surface.name, mesh)
    thing.location = origin
    bpy.context.scene.collection.objects.link(thing)
    return thing


def make_material(surface: Surface) -> bpy.types.Material:
    """Make a Principled material without gloss; the strongest channel of an emission becomes its strength."""
    material = bpy.data.materials.new(surface.material)
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    principled = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    principled.inputs["Base Color"].default_value = (*surface.reflectance, 1.0)
    principled.inputs["Roughness"].default_value = 1.0
    principled.inputs["Specular IOR Level"].default_value = 0.0
    strength = max(surface.emission)
    if strength > 0.0:
        principled.inputs["Emission Color"].default_value = (*(value / strength for value in surface.emission), 1.0)
        principled.inputs["Emission Strength"].default_value = strength
    material.diffuse_color = (*surface.reflectance, 1.0)
    return material


def add_camera(view: Camera) -> None:
    """Add the camera that the pictures are taken with."""
    data = bpy.data.cameras.new("Camera")
    data.lens, data.sensor_width = view.lens, view.sensor_width
    data.sensor_fit = "HORIZONTAL"
    data.clip_start = 0.01
    camera = bpy.data.objects.new("Camera", data)
    camera.location = view.location
    direction = Vector(view.target) - Vector(view.location)
    camera.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def make_world_dark() -> None:
    """Let no light come from outside."""
    world = bpy.context.scene.world or bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    world.color = (0.0, 0.0, 0.0)
    if bpy.app.version < (5, 0):
        world.use_nodes = True
    for node in world.node_tree.nodes:
        if node.type == "BACKGROUND":
            node.inputs["Strength"].default_value = 0.0


def set_render(width: int, height: int) -> None:
    """Set Cycles up as a reference: deep paths, nothing clamped, denoised, colours shown as they are."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.samples = SAMPLES if denoise() else SAMPLES_IF_NOT_DENOISED
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.max_bounces = cycles.diffuse_bounces = 64
    cycles.caustics_reflective = cycles.caustics_refractive = True


def denoise() -> bool:
    """Have renders denoised by OpenImageDenoise, guided by colours and normals; false if this Blender lacks it."""
    cycles = bpy.context.scene.cycles
    try:
        cycles.denoiser = "OPENIMAGEDENOISE"
    except TypeError:  # no such choice: a distribution may build Blender without it
        cycles.use_denoising = False
        return False
    cycles.use_denoising = True
    cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"
    cycles.denoising_prefilter = "ACCURATE"
    return True
