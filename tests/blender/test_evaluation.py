# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is not read is evaluated by Blender itself: as Cycles sees it, with nothing left behind, and named."""

from contextlib import contextmanager

import bpy
import numpy as np
import pytest
from radiosity_bake.core.textures import with_means
from radiosity_bake.operators import evaluation
from radiosity_bake.operators.extraction import extract
from radiosity_bake.operators.gloss import mean_gloss
from radiosity_bake.operators.scratch import NoCyclesError

from tests.blender.making import (
    diffuse_material,
    select_also,
    socket_of,
)
from tests.blender.sheets import (
    SCALED,
    STEP,
    add_sheet,
    assert_as_in_cycles,
    by_cycles,
    by_us,
    image_node,
    mixed,
    painted,
)
from tests.blender.state import differences, file_state


def noise(tree, coordinates="Generated"):
    """Return a colour of a procedural texture as wide as the sheet, made colourful by a ramp."""
    where, texture, ramp = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "TexNoise", "ValToRGB"))
    socket_of(texture, "Scale").default_value = 1.5
    socket_of(texture, "Detail").default_value = 0.0
    ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = 0.3, 0.7
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.9, 0.2, 0.1, 1), (0.1, 0.3, 0.8, 1)
    tree.links.new(where.outputs[coordinates], texture.inputs["Vector"])
    tree.links.new(next(s for s in texture.outputs if s.identifier == "Fac"), ramp.inputs[0])
    return ramp.outputs["Color"]


@pytest.mark.parametrize("coordinates", ["Generated", "Object", "UV"])
def test_procedural_textures_are_evaluated_by_blender(coordinates):
    assert_as_in_cycles(painted(lambda tree: noise(tree, coordinates)), step=SCALED * STEP)


def test_coordinates_of_the_camera_are_those_of_the_scenes_camera():
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.4, -0.7, 3.0), (0.1, 0.2, 0.3)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    assert_as_in_cycles(painted(lambda tree: noise(tree, "Camera")), step=SCALED * STEP)


def test_an_evaluated_material_looks_as_diffuse_rays_see_it():
    def seen(tree):
        mix = tree.nodes.new("ShaderNodeMix")
        mix.data_type = "RGBA"
        path = tree.nodes.new("ShaderNodeLightPath")
        tree.links.new(path.outputs["Is Camera Ray"], socket_of(mix, "Factor_Float"))
        tree.links.new(noise(tree), socket_of(mix, "A_Color"))
        socket_of(mix, "B_Color").default_value = (0.0, 0.0, 0.0, 1.0)
        return next(socket for socket in mix.outputs if socket.identifier == "Result_Color")

    sheet = add_sheet(painted(seen))
    shown, _ = by_us(sheet, "DIFFUSE")
    sheet.data.materials[0] = painted(noise)
    plain, _ = by_us(sheet, "DIFFUSE")
    assert shown == pytest.approx(plain, abs=1e-5) and shown.max() > 0.1


@pytest.mark.parametrize("kelvin", [1500.0, 2700.0, 4000.0, 6500.0, 11000.0])
def test_a_glowing_body_has_the_colour_that_cycles_gives_it(kelvin):
    def glowing(tree):
        node = tree.nodes.new("ShaderNodeBlackbody")
        node.inputs["Temperature"].default_value = kelvin
        return node.outputs[0]

    sheet = add_sheet(painted(glowing, "ShaderNodeEmission", Strength=1.0), cells=1)
    ours, warnings = by_us(sheet, "EMIT")
    # Ours has a fit of the eye's response, and Cycles one of the colours: 3.5% apart at the reddest.
    theirs = by_cycles(sheet, "EMIT")
    assert not warnings and ours == pytest.approx(theirs, abs=0.04 * float(theirs.max()))


def random_glow():
    """Return a material that shines as the number tells that an object or an instance has."""
    return painted(
        lambda tree: tree.nodes.new("ShaderNodeObjectInfo").outputs["Random"], "ShaderNodeEmission", Strength=1.0
    )


def test_objects_of_one_mesh_have_the_random_numbers_that_cycles_gives_them():
    first = add_sheet(random_glow(), cells=1)
    others = [bpy.data.objects.new(name, first.data) for name in ("Second", "Größe")]
    for sheet in others:
        bpy.context.scene.collection.objects.link(sheet)
    for sheet in (first, *others):
        ours, _ = by_us(sheet, "EMIT")
        # To the nearest of 32 levels.
        assert ours == pytest.approx(by_cycles(sheet, "EMIT"), abs=0.5 / 32 + 1e-5)


def test_instances_of_one_object_have_random_numbers_of_their_own():
    floor, sheet = add_sheet(None), add_sheet(random_glow(), cells=1)
    box = bpy.data.collections.new("Box")
    box.objects.link(sheet)
    bpy.context.scene.collection.objects.unlink(sheet)
    for number in range(4):
        empty = bpy.data.objects.new(f"Instance {number}", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", box
        bpy.context.scene.collection.objects.link(empty)
    bpy.context.view_layer.update()
    meshes = extract(bpy.context, [floor]).scene.meshes
    shades = {round(float(mesh.emission_texture.colours[0, 0]), 3) for mesh in meshes if mesh.emission_texture}
    assert len(meshes) == 5 and len(shades) == 4


@pytest.mark.parametrize(("name", "colour"), [("tint", [0.2, 0.5, 0.1]), ("nothing", [0.0, 0.0, 0.0])])
def test_attributes_of_the_instancer_are_those_of_the_object_and_black_where_it_has_none(name, colour):
    def asked(tree):
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_type, node.attribute_name = "INSTANCER", name
        return node.outputs["Color"]

    sheet = add_sheet(painted(asked), cells=1)
    sheet["tint"] = [0.2, 0.5, 0.1]
    ours, _ = by_us(sheet, "DIFFUSE")
    assert ours == pytest.approx(np.broadcast_to(colour, ours.shape), abs=1e-5)


@pytest.mark.parametrize("kind", ["INSTANCER", "AMBIENT_OCCLUSION", "REFLECTION"])
def test_what_a_copy_that_stands_alone_cannot_tell_is_named(kind):
    def asked(tree):
        if kind == "AMBIENT_OCCLUSION":
            return tree.nodes.new("ShaderNodeAmbientOcclusion").outputs["Color"]
        if kind == "REFLECTION":
            return noise(tree, "Reflection")
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_type, node.attribute_name = "INSTANCER", "tint"
        return node.outputs["Color"]

    said = {"INSTANCER": "instancer", "AMBIENT_OCCLUSION": "object alone", "REFLECTION": "head on"}
    (warning,) = by_us(add_sheet(painted(asked), cells=1), "DIFFUSE")[1]
    assert said[kind] in warning


def test_what_blender_evaluates_emits_too():
    assert_as_in_cycles(painted(noise, "ShaderNodeEmission", Strength=7.0), "EMIT", SCALED * STEP)


def test_gloss_does_not_dim_what_blender_evaluates():
    sheet = add_sheet(painted(noise, "ShaderNodeBsdfPrincipled", "Base Color", Metallic=0.25))
    glossy, _ = by_us(sheet, "DIFFUSE")
    sheet.data.materials[0] = painted(noise)
    matt, _ = by_us(sheet, "DIFFUSE")
    assert glossy == pytest.approx(0.75 * matt, abs=1e-4)


def test_others_get_the_gloss_of_what_blender_evaluates():
    sheet = add_sheet(painted(noise, "ShaderNodeBsdfPrincipled", "Base Color", Roughness=0.5))
    sent, _ = by_us(sheet, "SENT")
    sheet.data.materials[0] = painted(noise)
    matt, _ = by_us(sheet, "DIFFUSE")
    share = mean_gloss(0.5, 1.5)
    assert sent == pytest.approx(matt * (1.0 - share) + share, abs=1e-4)


def test_others_get_the_colours_of_metal_that_blender_evaluates():
    sheet = add_sheet(painted(noise, "ShaderNodeBsdfPrincipled", "Base Color", Metallic=1.0))
    sent, _ = by_us(sheet, "SENT")
    shown, _ = by_us(sheet, "DIFFUSE")
    sheet.data.materials[0] = painted(noise)
    matt, _ = by_us(sheet, "DIFFUSE")
    # Seen head on, metal has its base colour, less what Cycles lets facets of a roughness of 0.5 hide from each other.
    assert not shown.any() and sent == pytest.approx(matt, rel=0.1)


def test_what_is_alpha_of_a_base_colour_stays_the_same_when_blender_evaluates_it():
    sheet = add_sheet(painted(noise, "ShaderNodeBsdfPrincipled", "Base Color", Alpha=0.5))
    half, _ = by_us(sheet, "DIFFUSE")
    sheet.data.materials[0] = painted(noise)
    full, _ = by_us(sheet, "DIFFUSE")
    assert half == pytest.approx(0.5 * full, abs=1e-4)


def test_only_the_triangles_of_a_material_are_evaluated():
    sheet = add_sheet(painted(noise))
    sheet.data.materials.append(diffuse_material(colour=(0.25, 0.5, 0.75, 1.0)))
    sheet.data.materials.append(painted(image_node))
    for polygon in sheet.data.polygons:
        polygon.material_index = polygon.index % 3
    ours, warnings = by_us(sheet, "DIFFUSE")
    theirs = by_cycles(sheet, "DIFFUSE")
    assert not warnings
    assert np.abs(ours - theirs).max() < SCALED * STEP


def test_what_blender_evaluates_of_mirrored_objects_stays_where_it_is():
    sheet = add_sheet(painted(noise))
    before, _ = by_us(sheet, "DIFFUSE")
    sheet.scale.x = -1.0
    after, _ = by_us(sheet, "DIFFUSE")
    assert after == pytest.approx(before, abs=1e-5)


def test_evaluating_leaves_nothing_behind_and_is_named():
    material = painted(lambda tree: mixed(tree, noise(tree), image_node(tree)))
    sheet = add_sheet(material)
    select_also(sheet)
    before = file_state()
    extraction = extract(bpy.context, [sheet])
    assert differences(before, file_state()) == []
    assert extraction.evaluated == ('Material "Painted" of "Sheet": Color Ramp',)
    assert extraction.warnings == ()


def test_without_cycles_the_sockets_value_is_taken_and_named(monkeypatch):
    @contextmanager
    def no_scene(samples=1):
        raise NoCyclesError("Cycles is off.")
        yield

    monkeypatch.setattr(evaluation, "scratch_scene", no_scene)
    sheet = add_sheet(painted(noise, Color=(0.6, 0.5, 0.4, 1.0)))
    bpy.context.view_layer.update()
    extraction = extract(bpy.context, [sheet])
    assert extraction.scene.meshes[0].reflectance[0] == pytest.approx([0.6, 0.5, 0.4])
    (warning,) = extraction.warnings
    assert "Color Ramp could not be evaluated (Cycles is off)" in warning
    assert extraction.evaluated == ()


@pytest.mark.parametrize("evaluated", [False, True])
def test_places_that_are_brighter_than_white_are_named(evaluated):
    def bright(tree):
        image = bpy.data.images.new("Bright", 4, 4, float_buffer=True, is_data=True)
        image.pixels.foreach_set(np.full(64, 1.5, dtype=np.float32))
        colour = image_node(tree, image)
        if evaluated:
            gamma = tree.nodes.new("ShaderNodeGamma")
            tree.links.new(colour, gamma.inputs["Color"])
            return gamma.outputs[0]
        return colour

    sheet = add_sheet(painted(bright))
    bpy.context.view_layer.update()
    extraction = extract(bpy.context, [sheet])
    assert bool(extraction.evaluated) == evaluated
    note = 'Material "Painted" of "Sheet": its colour is brighter than white in places; white was used there'
    assert extraction.warnings == (note,)


def test_properties_of_the_scene_and_its_view_layer_reach_what_blender_evaluates():
    def asked(tree, name):
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_type, node.attribute_name = "VIEW_LAYER", name
        return node.outputs["Color"]

    bpy.context.scene["of the scene"], bpy.context.view_layer["of the layer"] = [0.8, 0.2, 0.1], [0.1, 0.3, 0.6]
    for name, colour in (("of the scene", (0.8, 0.2, 0.1)), ("of the layer", (0.1, 0.3, 0.6))):
        sheet = add_sheet(painted(lambda tree, name=name: asked(tree, name)))
        bpy.context.view_layer.update()
        mesh = extract(bpy.context, [sheet]).scene.meshes[-1]
        assert with_means(mesh.reflectance, mesh.reflectance_texture) == pytest.approx(
            np.broadcast_to(colour, mesh.reflectance.shape), abs=1e-4
        )


def test_a_property_of_a_text_reaches_what_blender_evaluates():
    def asked(tree):
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_type, node.attribute_name = "OBJECT", "tint"
        return node.outputs["Color"]

    curve = bpy.data.curves.new("Text", "FONT")
    curve.body = "O"
    curve.materials.append(painted(asked))
    text = bpy.data.objects.new("Text", curve)
    text["tint"] = [0.7, 0.2, 0.1]
    bpy.context.scene.collection.objects.link(text)
    bpy.context.view_layer.update()
    (mesh,) = extract(bpy.context, [text]).scene.meshes
    assert with_means(mesh.reflectance, mesh.reflectance_texture) == pytest.approx(
        np.broadcast_to((0.7, 0.2, 0.1), mesh.reflectance.shape), abs=1e-4
    )
