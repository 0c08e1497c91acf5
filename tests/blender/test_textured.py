# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Display materials with the original's textures, rendered by Cycles and compared with what they shall show."""

import dataclasses

import bpy
import numpy as np
import pytest
from mathutils import Euler
from radiosity_bake.operators import display

from tests.blender.making import (
    add_object,
    add_plane,
    bake_selected,
    diffuse_material,
    emission_material,
    link_surface,
    node_material,
    node_tree,
    position_bake,
    report,
    select_also,
    socket_of,
)
from tests.blender.state import differences, file_state

IRRADIANCE = np.array([0.5, 1.0, 4.0])
RADIOSITY = np.array([0.125, 0.25, 0.375])
PIXELS = 4
TOLERANCE = 2e-3
"""Of half-precision floats and of colours that Blender's sockets keep in single precision."""


@pytest.fixture(autouse=True)
def even_bake(run_instead):
    """Bake the same light everywhere, and twice as much of it on backs."""

    def bake(scene, settings, progress):
        result = position_bake(scene, settings, progress, back=True)
        meshes = []
        for mesh in result.meshes:
            radiosity, irradiance = (np.broadcast_to(value, mesh.radiosity.shape) for value in (RADIOSITY, IRRADIANCE))
            meshes.append(
                dataclasses.replace(
                    mesh,
                    radiosity=radiosity,
                    irradiance=irradiance,
                    radiosity_back=2.0 * radiosity,
                    irradiance_back=2.0 * irradiance,
                )
            )
        return dataclasses.replace(result, meshes=tuple(meshes))

    run_instead(bake)


def bake(*materials, material="TEXTURED", output="REFINED"):
    """Bake a plane with one of the materials, or none; returns the baked object."""
    plane = add_plane(materials=materials)
    select_also(plane)
    bpy.context.scene.radiosity.material = material
    bake_selected(output)
    return bpy.context.object


def rendered(folder, from_below=False):
    """Render the plane from straight above, or below, with Cycles; returns (PIXELS, PIXELS, 3) linear colours."""
    scene = bpy.context.scene
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", 2.0
    scene.camera = add_object("Camera", camera)
    scene.camera.location.z = -1.0 if from_below else 1.0
    scene.camera.rotation_euler = Euler((np.pi if from_below else 0.0, 0.0, 0.0))
    world = scene.world = bpy.data.worlds.new("World")
    tree = node_tree(world)
    background = tree.nodes.new("ShaderNodeBackground")
    background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    link_surface(tree, background)
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.pixel_filter_type = 1, False, "BOX"
    scene.cycles.filter_width = 0.01
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = str(folder / "rendered.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    return np.array(image.pixels[:]).reshape(PIXELS, PIXELS, 4)[:, :, :3]


def textured_material():
    """Return a material whose base colour is an image of two halves, as generated coordinates place it."""
    material = node_material("Wood", "ShaderNodeBsdfPrincipled")
    tree = material.node_tree
    image = bpy.data.images.new("Halves", 2, 1, float_buffer=True)
    image.colorspace_settings.name = "Linear Rec.709"
    image.pixels = [0.25, 0.5, 0.75, 1.0, 0.5, 0.25, 0.125, 1.0]
    image.pack()
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = image, "Closest"
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Generated"], texture.inputs["Vector"])
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    return material


def mixed_material():
    material = diffuse_material("Mixed", (0.2, 0.4, 0.6, 1.0))
    tree = material.node_tree
    diffuse = next(node for node in tree.nodes if node.type == "BSDF_DIFFUSE")
    emission, mix = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeMixShader")
    emission.inputs["Color"].default_value = (1.0, 0.5, 0.25, 1.0)
    emission.inputs["Strength"].default_value = 8.0
    mix.inputs[0].default_value = 0.25
    tree.links.new(diffuse.outputs[0], mix.inputs[1])
    tree.links.new(emission.outputs[0], mix.inputs[2])
    link_surface(tree, mix)
    return material


CASES = {
    "no material": (lambda: None, 0.8 * IRRADIANCE),
    "diffuse": (diffuse_material, np.array([0.2, 0.4, 0.6]) * IRRADIANCE),
    "emission": (emission_material, np.array([5.0, 5.0, 5.0])),
    "principled that emits": (
        lambda: node_material(
            "Screen",
            "ShaderNodeBsdfPrincipled",
            Base_Color=(0.5, 0.25, 0.125, 1.0),
            Emission_Color=(1.0, 0.5, 0.0, 1.0),
            Emission_Strength=3.0,
        ),
        np.array([0.5, 0.25, 0.125]) * IRRADIANCE + np.array([3.0, 1.5, 0.0]),
    ),
    "half metal": (
        lambda: node_material("Metal", "ShaderNodeBsdfPrincipled", Base_Color=(0.5, 0.5, 0.25, 1.0), Metallic=0.5),
        np.array([0.25, 0.25, 0.125]) * IRRADIANCE,
    ),
    "a mix": (mixed_material, 0.75 * np.array([0.2, 0.4, 0.6]) * IRRADIANCE + np.array([2.0, 1.0, 0.5])),
    # What is let through is the world, which is white.
    "transparent in half": (
        lambda: node_material("Veil", "ShaderNodeBsdfPrincipled", Base_Color=(0.5, 0.5, 0.5, 1.0), Alpha=0.5),
        0.5 * 0.5 * IRRADIANCE + 0.5 * np.ones(3),
    ),
    "half glass": (
        lambda: node_material(
            "Opal", "ShaderNodeBsdfPrincipled", Base_Color=(0.5, 0.5, 0.5, 1.0), Transmission_Weight=0.5
        ),
        0.5 * 0.5 * IRRADIANCE + 0.5 * np.ones(3),
    ),
}


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
@pytest.mark.parametrize("case", CASES)
def test_what_is_seen_is_reflectance_times_irradiance_plus_emission(tmp_path, case, output):
    make, expected = CASES[case]
    material = make()
    bake(*([material] if material else []), output=output)
    assert rendered(tmp_path) == pytest.approx(np.broadcast_to(expected, (PIXELS, PIXELS, 3)), rel=TOLERANCE)


def test_textures_stay_as_sharp_as_they_are(tmp_path):
    bake(textured_material())
    seen = rendered(tmp_path)
    left, right = np.array([0.25, 0.5, 0.75]) * IRRADIANCE, np.array([0.5, 0.25, 0.125]) * IRRADIANCE
    assert seen[:, : PIXELS // 2] == pytest.approx(np.broadcast_to(left, (PIXELS, PIXELS // 2, 3)), rel=TOLERANCE)
    assert seen[:, PIXELS // 2 :] == pytest.approx(np.broadcast_to(right, (PIXELS, PIXELS // 2, 3)), rel=TOLERANCE)


def test_the_back_shows_the_light_of_the_back(tmp_path):
    bake(diffuse_material())
    expected = 2.0 * np.array([0.2, 0.4, 0.6]) * IRRADIANCE
    assert rendered(tmp_path, True) == pytest.approx(np.broadcast_to(expected, (PIXELS, PIXELS, 3)), rel=TOLERANCE)


def test_plain_shows_the_radiosity_of_either_side(tmp_path):
    bake(diffuse_material(), material="PLAIN")
    assert rendered(tmp_path) == pytest.approx(np.broadcast_to(RADIOSITY, (PIXELS, PIXELS, 3)), rel=TOLERANCE)
    below = rendered(tmp_path, from_below=True)
    assert below == pytest.approx(np.broadcast_to(2.0 * RADIOSITY, (PIXELS, PIXELS, 3)), rel=TOLERANCE)


@pytest.mark.parametrize(
    ("paint", "light", "textures"),
    [(textured_material, "ALL", True), (textured_material, "IRRADIANCE", False), (diffuse_material, "ALL", False)],
)
def test_by_itself_it_shows_textures_where_there_are_some(paint, light, textures):
    bpy.context.scene.radiosity.light = light
    shown = bake(paint(), material="AUTOMATIC").active_material
    assert (shown[display.MARK] == "TEXTURED") == textures


def grouped(material, depth=1):
    """Return the material with its shader, and what that is made of, inside node groups, one within the other."""
    for _ in range(depth):
        tree = material.node_tree
        group = bpy.data.node_groups.new("Paint", "ShaderNodeTree")
        group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
        group.interface.new_socket("Colour", in_out="INPUT", socket_type="NodeSocketColor")
        outside = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL").inputs["Surface"]
        shader = outside.links[0].from_node
        inside = group.nodes.new(shader.bl_idname)
        if shader.type == "GROUP":
            inside.node_tree = shader.node_tree
            entrance, colour = inside.inputs["Colour"], shader.inputs["Colour"]
        else:
            entrance, colour = socket_of(inside, "Color"), socket_of(shader, "Color")
        group.links.new(group.nodes.new("NodeGroupInput").outputs[0], entrance)
        group.links.new(inside.outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
        node = tree.nodes.new("ShaderNodeGroup")
        node.node_tree = group
        node.inputs["Colour"].default_value = colour.default_value
        tree.nodes.remove(shader)
        tree.links.new(node.outputs[0], outside)
    return material


@pytest.mark.parametrize("depth", [1, 2])
def test_shaders_inside_groups_are_followed(tmp_path, depth):
    bake(grouped(diffuse_material(), depth))
    expected = np.array([0.2, 0.4, 0.6]) * IRRADIANCE
    assert rendered(tmp_path) == pytest.approx(np.broadcast_to(expected, (PIXELS, PIXELS, 3)), rel=TOLERANCE)
    assert report()["warnings"] == []


def shader_handed_into_a_group():
    material = diffuse_material("Handed In")
    tree = material.node_tree
    group = bpy.data.node_groups.new("Varnish", "ShaderNodeTree")
    for side in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Shader", in_out=side, socket_type="NodeSocketShader")
    entrance, out = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    group.links.new(entrance.outputs[0], out.inputs[0])
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    tree.links.new(next(each for each in tree.nodes if each.type == "BSDF_DIFFUSE").outputs[0], node.inputs[0])
    link_surface(tree, node)
    return material


def test_what_cannot_be_shown_with_textures_shows_the_radiosity_and_says_so(tmp_path):
    bake(shader_handed_into_a_group())
    assert rendered(tmp_path) == pytest.approx(np.broadcast_to(RADIOSITY, (PIXELS, PIXELS, 3)), rel=TOLERANCE)
    (sentence,) = report()["warnings"]
    assert '"Handed In"' in sentence and "one colour for each vertex" in sentence


@pytest.mark.parametrize("make", [lambda: grouped(diffuse_material(), 2), shader_handed_into_a_group])
def test_copies_of_groups_go_with_the_materials(make):
    material = make()
    before = sorted(group.name for group in bpy.data.node_groups)
    bake(material)
    bake_selected()
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert sorted(group.name for group in bpy.data.node_groups) == before
    assert [each.name for each in bpy.data.materials] == [material.name]


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_restoring_brings_the_materials_back_and_leaves_nothing_behind(output):
    plane = add_plane(materials=[textured_material(), emission_material()])
    select_also(plane)
    before = file_state()
    bpy.context.scene.radiosity.material = "TEXTURED"
    bake_selected(output)
    assert len(bpy.data.materials) == 4
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert differences(before, file_state()) == []


def test_baking_again_shows_the_colours_that_the_material_has_now_under_the_same_name(tmp_path):
    material = diffuse_material()
    bake(material)
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_DIFFUSE")
    socket_of(shader, "Color").default_value = (0.8, 0.1, 0.3, 1.0)
    assert bpy.ops.radiosity.bake() == {"FINISHED"}
    assert [slot.material.name for slot in bpy.context.object.material_slots] == ["Paint Radiosity"]
    assert sorted(item.name for item in bpy.data.materials) == ["Paint", "Paint Radiosity"]
    expected = np.array([0.8, 0.1, 0.3]) * IRRADIANCE
    assert rendered(tmp_path) == pytest.approx(np.broadcast_to(expected, (PIXELS, PIXELS, 3)), rel=TOLERANCE)


def test_objects_with_the_same_material_share_its_copy():
    material = diffuse_material()
    first, second = add_plane("A", materials=[material]), add_plane("B", materials=[material])
    select_also(first, second)
    bpy.context.scene.radiosity.material = "TEXTURED"
    bake_selected("REFINED")
    shown = {slot.material.name for obj in bpy.context.selected_objects for slot in obj.material_slots}
    assert shown == {"Paint Radiosity"}
