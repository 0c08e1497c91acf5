# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds: what is read of them, and that they light a floor as in Cycles."""

import bpy
import numpy as np
import pytest
from radiosity_bake.operators.scratch import bake_in, scratch_scene
from radiosity_bake.operators.world import world_light

from tests.blender.making import add_plane, bake_selected, colours_of, link_surface, node_tree, report, select_also
from tests.blender.state import differences, file_state

UP = np.array([0.0, 0.0, 1.0])


def add_world(name="Sky", **inputs):
    """Return a world of one background node, that node and the tree."""
    world = bpy.data.worlds.new(name)
    tree = node_tree(world)
    background = tree.nodes.new("ShaderNodeBackground")
    for key, value in inputs.items():
        background.inputs[key].default_value = value
    link_surface(tree, background)
    return world, background, tree


def sky_world(strength=0.1, **values):
    world, background, tree = add_world(Strength=strength)
    sky = tree.nodes.new("ShaderNodeTexSky")
    kinds = [item.identifier for item in sky.bl_rna.properties["sky_type"].enum_items]
    sky.sky_type = "NISHITA" if "NISHITA" in kinds else "MULTIPLE_SCATTERING"
    sky.sun_elevation, sky.sun_rotation = np.radians(40.0), np.radians(20.0)
    for key, value in values.items():
        setattr(sky, key, value)
    tree.links.new(sky.outputs[0], background.inputs["Color"])
    return world


def image_world(pixels, projection="EQUIRECTANGULAR", turn=(0.0, 0.0, 0.0)):
    """Return a world of an environment texture (h, w, 3), rows from below, turned by a Mapping node."""
    height, width, _ = pixels.shape
    image = bpy.data.images.new("Photo", width, height, float_buffer=True, is_data=True)
    image.pixels.foreach_set(np.concatenate([pixels, np.ones((height, width, 1))], axis=2).astype(np.float32).ravel())
    image.update()
    image.pack()
    world, background, tree = add_world("Photo")
    texture, mapping = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMapping")
    texture.image, texture.projection = image, projection
    mapping.inputs["Rotation"].default_value = turn
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
    tree.links.new(texture.outputs[0], background.inputs["Color"])
    return world


def sun_picture():
    """An even grey with a sun of 2 x 2 texels, each 1.4 degrees across, that has most of the light."""
    pixels = np.full((128, 256, 3), 0.3)
    pixels[100:102, 60:62] = (900.0, 700.0, 500.0)
    return pixels


def by_cycles(world, samples=4096):
    """Return what Cycles' bake gives a black floor with nothing around, (3,)."""
    with scratch_scene(samples) as scene:
        scene.world = world
        mesh = bpy.data.meshes.new("Floor")
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
        mesh.color_attributes.active_color = mesh.color_attributes.new("Light", "FLOAT_COLOR", "POINT")
        floor = bpy.data.objects.new("Floor", mesh)
        scene.collection.objects.link(floor)
        bake_in(scene, floor, type="DIFFUSE", pass_filter={"DIRECT"}, target="VERTEX_COLORS")
        return colours_of(mesh, "Light")[:, :3].mean(axis=0)


def by_us(world):
    """Return the irradiance over pi of an open floor, (3,)."""
    bpy.context.scene.world = world
    floor = bpy.data.objects.get("Floor") or add_plane("Floor")
    select_also(floor)
    bake_selected("ORIGINAL")
    assert report()["warnings"] == []
    return colours_of(floor.data, "Irradiance")[:, :3].mean(axis=0)


def plain(world):
    """Assert that a world is one colour without suns, and return colour and notes."""
    light = world_light(world)
    assert light.suns == () and light.radiance.shape == (3,)
    return light.radiance, light.notes


def test_no_world_is_dark():
    radiance, notes = plain(None)
    assert radiance.tolist() == [0.0, 0.0, 0.0] and notes == ()


def test_a_constant_background_is_colour_times_strength():
    world, _, _ = add_world(Color=(0.5, 0.25, 1.0, 1.0), Strength=2.0)
    radiance, notes = plain(world)
    assert radiance == pytest.approx([1.0, 0.5, 2.0]) and notes == ()


def test_a_world_without_nodes_has_its_colour():
    if bpy.app.version >= (5, 0, 0):
        pytest.skip("from Blender 5.0 on every world has nodes")
    world = bpy.data.worlds.new("Plain")
    world.color = (0.1, 0.2, 0.3)
    assert plain(world)[0] == pytest.approx([0.1, 0.2, 0.3])


def test_nodes_that_make_one_colour_are_one_colour():
    world, background, tree = add_world()
    gamma = tree.nodes.new("ShaderNodeGamma")
    gamma.inputs["Color"].default_value, gamma.inputs["Gamma"].default_value = (0.5, 0.25, 1.0, 1.0), 2.0
    tree.links.new(gamma.outputs[0], background.inputs["Color"])
    radiance, notes = plain(world)
    assert radiance == pytest.approx([0.25, 0.0625, 1.0], rel=1e-4) and notes == ()


def test_what_only_the_camera_sees_lights_nothing():
    world, background, tree = add_world(Color=(1.0, 0.0, 0.0, 1.0))
    other, mix = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeMixShader")
    other.inputs["Color"].default_value = (0.0, 0.5, 0.0, 1.0)
    tree.links.new(tree.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"], mix.inputs[0])
    tree.links.new(other.outputs[0], mix.inputs[1])
    tree.links.new(background.outputs[0], mix.inputs[2])
    link_surface(tree, mix)
    assert plain(world)[0] == pytest.approx([0.0, 0.5, 0.0], abs=1e-6)


def test_a_world_that_diffuse_rays_do_not_see_lights_nothing():
    world, _, _ = add_world(Color=(1.0, 1.0, 1.0, 1.0))
    world.cycles_visibility.diffuse = False
    assert plain(world)[0].tolist() == [0.0, 0.0, 0.0]


def test_a_negative_world_is_dark_and_named():
    world, _, _ = add_world(Strength=-1.0)
    radiance, (note,) = plain(world)
    assert radiance.tolist() == [0.0, 0.0, 0.0] and "negative" in note


def test_fog_is_left_out_and_named():
    world, _, tree = add_world(Color=(0.2, 0.4, 0.6, 1.0), Strength=1.0)
    output = next(node for node in tree.nodes if node.type == "OUTPUT_WORLD")
    tree.links.new(tree.nodes.new("ShaderNodeVolumeScatter").outputs[0], output.inputs["Volume"])
    light = world_light(world)
    assert light.radiance == pytest.approx([0.2, 0.4, 0.6]) and "volume" in light.notes[0]


def test_without_cycles_a_textured_world_is_dark_and_named():
    world = sky_world()
    bpy.ops.preferences.addon_disable(module="cycles")
    try:
        radiance, (note,) = plain(world)
    finally:
        bpy.ops.preferences.addon_enable(module="cycles")
    assert radiance.tolist() == [0.0, 0.0, 0.0] and "Cycles" in note and "dark" in note


def test_reading_a_world_leaves_the_file_as_it_was():
    world = bpy.context.scene.world = sky_world()
    add_plane(select=True)
    before, worlds = file_state(), [(w.name, w.users) for w in bpy.data.worlds]
    nodes = [(node.name, node.location[:]) for node in world.node_tree.nodes]
    world_light(world)
    assert differences(before, file_state()) == []
    assert [(w.name, w.users) for w in bpy.data.worlds] == worlds
    assert [(node.name, node.location[:]) for node in world.node_tree.nodes] == nodes


def test_the_disc_of_a_sky_becomes_a_sun_where_the_sky_has_it():
    sun = world_light(sky_world(sun_size=np.radians(2.0))).suns[0]
    assert np.degrees(sun.angle) == pytest.approx(2.0, abs=0.15)
    assert np.degrees(np.arcsin(-sun.direction[2])) == pytest.approx(40.0, abs=0.05)
    assert not world_light(sky_world(sun_disc=False)).suns


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.2, -0.1, 2.0)])
def test_the_sun_of_a_picture_is_where_the_mapping_turns_it(turn):
    light = world_light(image_world(sun_picture(), turn=turn))
    latitude, longitude = (101.0 / 128.0 - 0.5) * np.pi, (61.0 / 256.0 - 0.5) * 2.0 * np.pi
    # Cycles' own mapping: longitude counts against the angle from +x, and from the middle of the picture.
    seen = np.cos(latitude) * np.cos(longitude), -np.cos(latitude) * np.sin(longitude), np.sin(latitude)
    # The node turns the direction that is looked up, so the picture turns the other way.
    a, b, c = ([1, 0, 0], [0, np.cos(turn[0]), -np.sin(turn[0])], [0, np.sin(turn[0]), np.cos(turn[0])])
    about_x = np.array([a, b, c])
    about_y = np.array([[np.cos(turn[1]), 0, np.sin(turn[1])], [0, 1, 0], [-np.sin(turn[1]), 0, np.cos(turn[1])]])
    about_z = np.array([[np.cos(turn[2]), -np.sin(turn[2]), 0], [np.sin(turn[2]), np.cos(turn[2]), 0], [0, 0, 1]])
    toward = (about_z @ about_y @ about_x).T @ seen
    # Seen so far up the picture is narrowed, and may be two suns, one above the other.
    vector = -sum(sun.strength[0] * sun.direction for sun in light.suns)
    assert vector @ toward > np.cos(np.radians(0.3)) * np.linalg.norm(vector)


@pytest.mark.parametrize(
    "world",
    [
        sky_world,
        lambda: sky_world(sun_disc=False),
        lambda: image_world(sun_picture(), turn=(0.2, -0.1, 2.0)),
        lambda: image_world(sun_picture(), "MIRROR_BALL", (0.5, 0.0, 0.0)),
    ],
    ids=["sky", "sky without sun", "picture", "mirror ball"],
)
def test_an_open_floor_is_lit_as_in_cycles(world):
    world = world()
    theirs = by_cycles(world)
    # 4,096 samples of light that is up to 90% in one small place, sampled by importance: 0.5% is 3 sigma or more.
    np.testing.assert_allclose(by_us(world), theirs, rtol=0.01)


def test_older_models_of_the_sky_are_read_too():
    sky = bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"]
    for kind in [item.identifier for item in sky.enum_items]:
        world = sky_world(sky_type=kind)
        light = world_light(world)
        assert light.notes == () and light.radiance.max() > 0.0, kind


def test_relighting_follows_the_strength_of_a_sky_but_not_its_sun():
    world = sky_world()
    bpy.context.scene.radiosity.quality = "DRAFT"
    before = by_us(world)
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Strength"].default_value *= 1.37
    assert bpy.ops.radiosity.relight() == {"FINISHED"}
    after = colours_of(bpy.data.objects["Floor"].data, "Irradiance")[:, :3].mean(axis=0)
    np.testing.assert_allclose(after, 1.37 * before, rtol=1e-4)
    next(node for node in world.node_tree.nodes if node.type == "TEX_SKY").sun_elevation += 0.2
    with pytest.raises(RuntimeError, match='"Sky" was changed or moved'):
        bpy.ops.radiosity.relight()


@pytest.mark.skipif("world_override" not in bpy.types.ViewLayer.bl_rna.properties, reason="there is none of them here")
def test_a_view_layer_may_have_a_world_of_its_own():
    bpy.context.scene.world, bpy.context.view_layer.world_override = (
        add_world(name, Color=(*colour, 1.0))[0]
        for name, colour in (("Of All", (1.0, 0.0, 0.0)), ("Own", (0.2, 0.3, 0.4)))
    )
    plane = add_plane(select=True)
    bake_selected("ORIGINAL")
    # An unoccluded plane under an even world gets the radiance of the world over pi times pi.
    assert colours_of(plane.data, "Irradiance")[:, :3] == pytest.approx(np.tile((0.2, 0.3, 0.4), (4, 1)), rel=1e-3)
