# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that vary over a mesh: read as Cycles sees them, which bakes the same colours."""

from contextlib import contextmanager

import bpy
import numpy as np
import pytest
from radiosity_bake.core.textures import mean_colours, with_means
from radiosity_bake.operators import evaluation
from radiosity_bake.operators.extraction import extract
from radiosity_bake.operators.gloss import mean_gloss
from radiosity_bake.operators.scratch import NoCyclesError

from tests.blender.making import (
    add_mesh,
    colours_of,
    diffuse_material,
    link_surface,
    node_material,
    node_tree,
    select_also,
    socket_of,
)
from tests.blender.state import differences, file_state

CELLS = 6


def add_sheet(material, cells=CELLS):
    """Return a bent square sheet of quads with UV maps "First" (to render) and "Second", and a colour attribute."""
    side = np.linspace(-1.0, 1.0, cells + 1)
    row = cells + 1
    quads = [(a, a + 1, a + row + 1, a + row) for j in range(cells) for a in range(j * row, j * row + cells)]
    sheet = add_mesh("Sheet", [(x, y, 0.2 * x * x) for y in side for x in side], quads, materials=[material])
    mesh = sheet.data
    corners = np.array([mesh.vertices[loop.vertex_index].co[:2] for loop in mesh.loops])
    for name, uv in (("First", corners * 0.5 + 0.5), ("Second", corners[:, ::-1] * 0.9 + 0.1)):
        layer = mesh.uv_layers.new(name=name)
        layer.uv.foreach_set("vector", uv.astype(np.float32).reshape(-1))
    mesh.uv_layers["First"].active_render = True
    colours = mesh.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    values = np.column_stack([np.random.default_rng(5).random((len(mesh.vertices), 3)), np.ones(len(mesh.vertices))])
    colours.data.foreach_set("color", values.astype(np.float32).reshape(-1))
    mesh.color_attributes.render_color_index = 0
    return sheet


def smooth_image(name="Picture", size=(32, 24), space="sRGB", is_float=False, **settings):
    """Return an image of colours that change slowly, so that a place and its surroundings are about the same."""
    image = bpy.data.images.new(name, *size, alpha=True, float_buffer=is_float)
    image.colorspace_settings.name = space
    x, y = np.meshgrid(np.arange(size[0]) / size[0] * 2 * np.pi, np.arange(size[1]) / size[1] * 2 * np.pi)
    channels = [0.5 + 0.4 * np.sin(x), 0.5 + 0.4 * np.cos(y), 0.5 + 0.3 * np.sin(x + y), np.ones_like(x)]
    image.pixels.foreach_set(np.stack(channels, axis=-1).astype(np.float32).reshape(-1))
    for key, value in settings.items():
        setattr(image, key, value)
    return image


def painted(build, shader="ShaderNodeBsdfDiffuse", socket="Color", **inputs):
    """Return a material one input of which is what `build`, given the node tree, returns."""
    material = node_material("Painted", shader, **inputs)
    tree = material.node_tree
    node = next(n for n in tree.nodes if n.bl_idname == shader)
    tree.links.new(build(tree), socket_of(node, socket))
    return material


def shader_of(material):
    return next(n for n in material.node_tree.nodes if n.type.startswith(("BSDF", "EMISSION")))


def image_node(tree, image=None, vector=None, **settings):
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image or smooth_image()
    for key, value in settings.items():
        setattr(node, key, value)
    if vector is not None:
        tree.links.new(vector, node.inputs["Vector"])
    return node.outputs["Color"]


def mapping(tree, kind="POINT", source=None):
    node = tree.nodes.new("ShaderNodeMapping")
    node.vector_type = kind
    for name, value in (("Location", (0.1, 0.25, 0.0)), ("Rotation", (0.0, 0.0, 0.5)), ("Scale", (0.7, 1.6, 1.0))):
        socket = socket_of(node, name)
        if socket.enabled:
            socket.default_value = value
    tree.links.new(source or tree.nodes.new("ShaderNodeTexCoord").outputs["UV"], node.inputs["Vector"])
    return node.outputs[0]


def second_map(tree):
    node = tree.nodes.new("ShaderNodeUVMap")
    node.uv_map = "Second"
    return node.outputs[0]


def attribute(tree, kind="ShaderNodeVertexColor"):
    node = tree.nodes.new(kind)
    if kind == "ShaderNodeVertexColor":
        node.layer_name = "Paint"
    else:
        node.attribute_name = "Paint"
    return node.outputs["Color"]


def mixed(tree, first, second, blend="MIX", factor=0.3):
    node = tree.nodes.new("ShaderNodeMix")
    node.data_type, node.blend_type = "RGBA", blend
    for identifier, value in (("Factor_Float", factor), ("A_Color", first), ("B_Color", second)):
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, socket_of(node, identifier))
        else:
            socket_of(node, identifier).default_value = value
    return next(s for s in node.outputs if s.identifier == "Result_Color")


def by_cycles(obj, kind):
    """Return (c, 3) the colours that Cycles bakes at the face corners: DIFFUSE without light, or EMIT."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", 1
    target = obj.data.color_attributes.new("Cycles", "FLOAT_COLOR", "CORNER")
    obj.data.color_attributes.active_color = target
    select_also(obj)
    passes = {"pass_filter": {"COLOR"}} if kind == "DIFFUSE" else {}
    bpy.ops.object.bake(type=kind, target="VERTEX_COLORS", **passes)
    values = colours_of(obj.data, "Cycles")[:, :3]
    obj.data.color_attributes.remove(obj.data.color_attributes["Cycles"])
    return values


def by_us(obj, kind):
    """Return (c, 3) our colours of a small part of the face at each corner, and the warnings.

    They are what it shows of the light, DIFFUSE; what others get of it, SENT; or what it emits.
    """
    bpy.context.view_layer.update()
    extraction = extract(bpy.context, [obj])
    (target,), mesh = extraction.targets, extraction.scene.meshes[extraction.targets[0].meshes[0]]
    name = {"DIFFUSE": "own_reflectance", "SENT": "reflectance"}.get(kind, "emission")
    if mesh.own_reflectance is None and kind == "DIFFUSE":
        name = "reflectance"
    texture, plain = getattr(mesh, f"{name}_texture"), getattr(mesh, name)
    corners = np.full((3, 3, 3), 0.0) + np.eye(3)[:, None, :] * 0.94 + 0.02
    corners += 0.04 * (np.eye(3)[None] - 1 / 3)
    count = len(mesh.triangles)
    triangle, parts = np.repeat(np.arange(count), 3), np.tile(corners, (count, 1, 1))
    found = mean_colours(plain, texture, triangle, parts)
    values = np.full((len(obj.data.loops), 3), np.nan)
    values[target.local.corners.reshape(-1)] = np.maximum(found, 0.0)
    return values, extraction.warnings


STEP = 0.03
"""Colours change by less from a corner to the middle of the cell there: a sixth of the sheet has at least 16 cells, the
steepest picture goes from 0.1 to 0.9 in a third of the sheet, and sRGB makes it at most 2.2 times as steep."""


SCALED = 2.0
"""Times that colours change faster at most where a mapping makes a picture smaller, and on the ramp of the noise."""


def assert_as_in_cycles(material, kind="DIFFUSE", step=STEP):
    sheet = add_sheet(material)
    ours, warnings = by_us(sheet, kind)
    theirs = by_cycles(sheet, kind)
    assert not warnings
    assert np.ptp(theirs, axis=0).max() > 0.2
    assert np.abs(ours - theirs).max() < step * max(1.0, theirs.max())
    # Without a sign on average.
    assert np.abs((ours - theirs).mean(axis=0)).max() < 0.2 * step * max(1.0, theirs.max())


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


# ---------------------------------------------------------------------------------------------- evaluated by Blender


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


@pytest.mark.parametrize("extension", ["REPEAT", "EXTEND"])
def test_a_small_picture_in_srgb_is_magnified_as_in_cycles(extension):
    image = bpy.data.images.new("Halves", 4, 4)
    halves = np.ones((4, 4, 4), dtype=np.float32)
    halves[:2, :, :3], halves[2:, :, :3] = (0.9, 0.1, 0.1), (0.1, 0.1, 0.9)
    image.pixels.foreach_set(halves.reshape(-1))
    # From pixel to pixel in linear light, the middle between them would be 0.4 in place of 0.2.
    assert_as_in_cycles(painted(lambda tree: image_node(tree, image, extension=extension)), step=SCALED * STEP)


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
