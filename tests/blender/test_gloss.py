# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much light gloss sends on, against balls of it that Cycles renders under an even sky."""

import bpy
import numpy as np
import pytest
from radiosity_bake.operators.materials import material_surface

from tests.blender.making import link_surface, node_material, node_tree


def rendered_share(material, folder, size=48):
    """Return what a ball of a material shows of an even sky, in the mean over its disk: over light from all sides."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    for name, value in {"device": "CPU", "samples": 64, "use_adaptive_sampling": False, "use_denoising": False}.items():
        setattr(scene.cycles, name, value)
    scene.world = bpy.data.worlds.new("White")
    tree = node_tree(scene.world)
    sky = tree.nodes.new("ShaderNodeBackground")
    sky.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    link_surface(tree, sky)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=128, ring_count=64)
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(material)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -4.0, 0.0), (np.pi / 2.0, 0.0, 0.0)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 2.1
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.film_transparent = True
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format, scene.render.image_settings.color_mode = "OPEN_EXR", "RGBA"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = str(folder / "ball.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.array(image.pixels, dtype=np.float64).reshape(-1, 4)
    return pixels[:, 0].sum() / pixels[:, 3].sum()


@pytest.mark.parametrize(
    ("kind", "inputs"),
    [
        ("Principled", {"Roughness": 0.1}),
        ("Principled", {"Roughness": 0.5}),
        ("Principled", {"Roughness": 0.5, "Specular_IOR_Level": 0.8}),
        ("Principled", {"Roughness": 0.9, "IOR": 1.8}),
        ("Principled", {"Coat_Weight": 0.7, "Specular_IOR_Level": 0.0}),
        ("Principled", {"Sheen_Weight": 0.8, "Specular_IOR_Level": 0.0}),
        ("Sheen", {"Roughness": 0.5, "Color": (0.8, 0.8, 0.8, 1.0)}),
        ("Sheen", {"Roughness": 0.9, "Color": (0.8, 0.8, 0.8, 1.0)}),
    ],
    ids=lambda value: " ".join(map(str, value.values())) if isinstance(value, dict) else value,
)
def test_gloss_sends_on_what_cycles_renders_of_it(tmp_path, kind, inputs):
    black = {"Base_Color": (0.0, 0.0, 0.0, 1.0)} if kind == "Principled" else {}
    material = node_material("Ball", f"ShaderNodeBsdf{kind}", **black, **inputs)
    # Cycles gives light back that facets hide from each other, and has sheen in tables.
    assert material_surface(material).sent_on()[0] == pytest.approx(rendered_share(material, tmp_path), rel=0.08)


def test_gloss_keeps_from_what_is_below_as_much_as_it_mirrors(tmp_path):
    material = node_material("Ball", "ShaderNodeBsdfPrincipled", Base_Color=(0.6, 0.6, 0.6, 1.0), Roughness=0.3)
    assert material_surface(material).sent_on()[0] == pytest.approx(rendered_share(material, tmp_path), rel=0.01)
