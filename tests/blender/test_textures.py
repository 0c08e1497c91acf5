# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Images, mappings and attributes that vary over a mesh: read as Cycles sees them, which bakes the same colours."""

import bpy
import numpy as np
import pytest
from radiosity_bake.core.textures import with_means
from radiosity_bake.operators.extraction import extract

from tests.blender.making import (
    link_surface,
    node_material,
    node_tree,
    socket_of,
)
from tests.blender.sheets import (
    SCALED,
    STEP,
    add_sheet,
    assert_as_in_cycles,
    attribute,
    by_cycles,
    by_us,
    image_node,
    mapping,
    mixed,
    painted,
    second_map,
    shader_of,
    smooth_image,
)


@pytest.mark.parametrize("space", ["sRGB", "Non-Color"])
@pytest.mark.parametrize("is_float", [False, True])
def test_an_image_has_the_colours_of_its_space(space, is_float):
    assert_as_in_cycles(painted(lambda tree: image_node(tree, smooth_image(space=space, is_float=is_float))))


@pytest.mark.parametrize(("kind", "extension"), [("POINT", "REPEAT"), ("TEXTURE", "MIRROR"), ("VECTOR", "EXTEND")])
def test_a_mapping_moves_and_turns_the_image_and_its_extension_fills_the_rest(kind, extension):
    material = painted(lambda tree: image_node(tree, vector=mapping(tree, kind), extension=extension))
    assert_as_in_cycles(material, step=SCALED * STEP)


def test_a_named_uv_map_is_taken():
    material = painted(lambda tree: image_node(tree, vector=mapping(tree, "POINT", second_map(tree))))
    assert_as_in_cycles(material, step=SCALED * STEP)


@pytest.mark.parametrize("kind", ["ShaderNodeVertexColor", "ShaderNodeAttribute"])
def test_colour_attributes_are_taken(kind):
    # From corner to corner they go through a third of all colours, and the place asked for lies a part of it inside.
    assert_as_in_cycles(painted(lambda tree: attribute(tree, kind)), step=0.08)


@pytest.mark.parametrize("blend", ["MULTIPLY", "ADD", "SUBTRACT", "DARKEN", "LIGHTEN", "SCREEN"])
def test_colours_are_mixed(blend):
    material = painted(lambda tree: mixed(tree, image_node(tree), (0.2, 0.5, 0.3, 1.0), blend))
    assert_as_in_cycles(material)


def test_an_image_times_an_image_is_their_product_place_by_place():
    def product(tree):
        return mixed(tree, image_node(tree), image_node(tree, vector=second_map(tree)), "MULTIPLY", 1.0)

    # It changes as fast as both together.
    assert_as_in_cycles(painted(product), step=2.0 * STEP)


def test_an_image_may_be_the_factor_of_a_mix():
    assert_as_in_cycles(
        painted(lambda tree: mixed(tree, (0.9, 0.1, 0.2, 1.0), (0.1, 0.2, 0.8, 1.0), "MIX", image_node(tree)))
    )


def test_shaders_are_mixed_by_an_image():
    material = bpy.data.materials.new("Mixed")
    tree = node_tree(material)
    mix = tree.nodes.new("ShaderNodeMixShader")
    red, glow = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeEmission")
    red.inputs["Color"].default_value = (0.8, 0.1, 0.1, 1.0)
    tree.links.new(image_node(tree), mix.inputs[0])
    tree.links.new(red.outputs[0], mix.inputs[1])
    tree.links.new(glow.outputs[0], mix.inputs[2])
    link_surface(tree, mix)
    assert_as_in_cycles(material)
    bpy.data.objects.remove(bpy.data.objects["Sheet"])
    assert_as_in_cycles(material, "EMIT")


def test_emission_is_textured():
    assert_as_in_cycles(painted(image_node, "ShaderNodeEmission", Strength=7.0), "EMIT")


def test_a_transparent_image_darkens_its_colours_unless_its_alpha_is_linked():
    image = smooth_image()
    pixels = np.array(image.pixels).reshape(-1, 4)
    pixels[:, 3] = np.linspace(0.3, 1.0, len(pixels))
    image.pixels.foreach_set(pixels.astype(np.float32).reshape(-1))
    material = painted(lambda tree: image_node(tree, image, extension="EXTEND"), "ShaderNodeEmission", Strength=1.0)
    assert_as_in_cycles(material, "EMIT")
    node = next(node for node in material.node_tree.nodes if node.type == "TEX_IMAGE")
    material.node_tree.links.new(node.outputs["Alpha"], socket_of(shader_of(material), "Strength"))
    bpy.data.objects.remove(bpy.data.objects["Sheet"])
    assert_as_in_cycles(material, "EMIT")


@pytest.mark.parametrize("mode", ["STRAIGHT", "PREMUL"])
def test_a_file_with_alpha_has_the_colours_that_cycles_reads_from_it(tmp_path, mode):
    image = smooth_image()
    pixels = np.array(image.pixels).reshape(-1, 4)
    pixels[:, 3] = np.linspace(0.5, 1.0, len(pixels))
    image.pixels.foreach_set(pixels.astype(np.float32).reshape(-1))
    image.filepath_raw, image.file_format = str(tmp_path / "picture.png"), "PNG"
    image.save()
    loaded = bpy.data.images.load(image.filepath_raw)
    loaded.alpha_mode = mode
    shining = painted(lambda tree: image_node(tree, loaded, extension="EXTEND"), "ShaderNodeEmission", Strength=1.0)
    assert_as_in_cycles(shining, "EMIT")


def test_a_leaf_is_cut_out_by_the_alpha_of_its_image():
    image = bpy.data.images.new("Leaf", 8, 8, alpha=True)
    pixels = np.ones((8, 8, 4), dtype=np.float32)
    pixels[:, 4:, 3] = 0.0
    image.pixels.foreach_set(pixels.reshape(-1))
    material = node_material("Leaf", "ShaderNodeBsdfPrincipled")
    tree = material.node_tree
    node = image_node(tree, image, interpolation="Closest")
    tree.links.new(node.node.outputs["Alpha"], shader_of(material).inputs["Alpha"])
    sheet = add_sheet(material, cells=1)
    bpy.context.view_layer.update()
    extraction = extract(bpy.context, [sheet])
    (mesh,), texture = extraction.scene.meshes, extraction.scene.meshes[0].transmittance_texture
    assert mesh.clear is None and not extraction.warnings
    # Of a UV map that runs once over the sheet, half of it is a hole; cells at its border are in part.
    assert texture.colours.mean() == pytest.approx(0.5, abs=0.02)
    assert ((texture.colours < 0.01) | (texture.colours > 0.99)).mean() > 0.9


def test_what_goes_through_is_evaluated_by_blender_where_its_nodes_are_not_read():
    material = node_material("Lace", "ShaderNodeBsdfPrincipled", Base_Color=(0.64, 0.64, 0.64, 1.0))
    tree = material.node_tree
    shader, steps = shader_of(material), tree.nodes.new("ShaderNodeMath")
    steps.operation = "GREATER_THAN"
    steps.inputs[1].default_value = 0.5
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["UV"], split.inputs[0])
    tree.links.new(split.outputs["X"], steps.inputs[0])
    tree.links.new(steps.outputs[0], shader.inputs["Alpha"])
    socket_of(shader, "Transmission Weight").default_value = 0.5
    sheet = add_sheet(material)
    bpy.context.view_layer.update()
    (mesh,) = extract(bpy.context, [sheet]).scene.meshes
    shares = mesh.transmittance_texture.colours
    # All of the side that is not there, and of the other what half of it, as glass, lets through.
    assert np.isclose(shares, 1.0, atol=0.01).mean() == pytest.approx(0.5, abs=0.05)
    assert np.isclose(shares, 0.4, atol=0.01).mean() == pytest.approx(0.5, abs=0.05)


def test_mirrored_objects_keep_their_texture_where_it_is():
    sheet = add_sheet(painted(image_node))
    before, _ = by_us(sheet, "DIFFUSE")
    sheet.scale.x = -1.0
    after, _ = by_us(sheet, "DIFFUSE")
    # The cells of a triangle wound the other way are the same.
    assert after == pytest.approx(before, abs=1e-5)


def test_an_image_sequence_shows_the_current_frame(tmp_path):
    for frame, colour in ((1, (0.8, 0.1, 0.1)), (2, (0.1, 0.7, 0.2))):
        still = bpy.data.images.new(f"Still {frame}", 4, 4, float_buffer=True, is_data=True)
        still.pixels.foreach_set(np.tile(np.array([*colour, 1.0], dtype=np.float32), 16))
        still.filepath_raw, still.file_format = str(tmp_path / f"still_{frame:04d}.exr"), "OPEN_EXR"
        still.save()
    film = bpy.data.images.load(str(tmp_path / "still_0001.exr"))
    film.source, film.colorspace_settings.name = "SEQUENCE", "Non-Color"
    material = painted(lambda tree: image_node(tree, film))
    user = next(node for node in material.node_tree.nodes if node.type == "TEX_IMAGE").image_user
    user.frame_duration, user.frame_start, user.use_auto_refresh = 2, 1, True
    sheet = add_sheet(material)
    for frame, colour in ((2, (0.1, 0.7, 0.2)), (1, (0.8, 0.1, 0.1))):
        bpy.context.scene.frame_set(frame)
        shown, _ = by_us(sheet, "DIFFUSE")
        # Half floats are kept of an EXR.
        assert shown == pytest.approx(np.broadcast_to(colour, shown.shape), abs=1e-3)


def test_a_sharp_picture_in_srgb_has_the_mean_that_cycles_sees():
    image = bpy.data.images.new("Chequered", 8, 8)
    bright = (np.add.outer(np.arange(8), np.arange(8)) % 2)[..., None] * np.array([0.9, 0.8, 0.7, 0.0]) + [0, 0, 0, 1]
    image.pixels.foreach_set(bright.astype(np.float32).reshape(-1))
    sheet = add_sheet(painted(lambda tree: image_node(tree, image)), cells=64)
    theirs = by_cycles(sheet, "DIFFUSE")
    bpy.context.view_layer.update()
    mesh = extract(bpy.context, [sheet]).scene.meshes[0]
    ours = with_means(mesh.reflectance, mesh.reflectance_texture)
    # Cycles' values are those of a grid eight times as fine as the picture; half of light and dark would be 20% more.
    assert ours.mean(axis=0) == pytest.approx(theirs.mean(axis=0), rel=0.03)


@pytest.mark.parametrize("extension", ["REPEAT", "EXTEND"])
def test_a_small_picture_in_srgb_is_magnified_as_in_cycles(extension):
    image = bpy.data.images.new("Halves", 4, 4)
    halves = np.ones((4, 4, 4), dtype=np.float32)
    halves[:2, :, :3], halves[2:, :, :3] = (0.9, 0.1, 0.1), (0.1, 0.1, 0.9)
    image.pixels.foreach_set(halves.reshape(-1))
    # From pixel to pixel in linear light, the middle between them would be 0.4 in place of 0.2.
    assert_as_in_cycles(painted(lambda tree: image_node(tree, image, extension=extension)), step=SCALED * STEP)
