# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which colour attributes are written: names, domain, type, exposure, parts of the light and light groups."""

import dataclasses

import bpy
import numpy as np
import pytest
from radiosity_bake.core.result import GroupLight

from tests.blender.making import (
    add_cube,
    add_object,
    add_plane,
    bake_selected,
    colours_of,
    corner_positions,
    diffuse_material,
    emission_material,
    position_bake,
    report,
    select_also,
)
from tests.blender.state import differences, file_state

OUTPUTS = ["REFINED", "ORIGINAL"]
BRIGHT = 3.0
"""What is added to positions from -1 to 1, so that they are light."""


@pytest.fixture
def bright_bake(run_instead):
    """Bake light that is the position of each corner, moved to where all of it is positive and some above 1.

    Returns what the bakes are given.
    """
    given = []

    def bake(scene, settings, progress):
        given.append((scene, settings))
        result = position_bake(scene, settings, progress, back=True)
        meshes = []
        for mesh in result.meshes:
            light = {
                name: getattr(mesh, name) + BRIGHT
                for name in ("radiosity", "irradiance", "radiosity_back", "irradiance_back")
            }
            names = [group.name for group in scene.light_groups] + [""] if settings.light_groups else []
            groups = [
                GroupLight(name, *(value / (index + 2.0) for value in light.values()))
                for index, name in enumerate(names)
            ]
            meshes.append(dataclasses.replace(mesh, **light, groups=tuple(groups)))
        return dataclasses.replace(result, meshes=tuple(meshes))

    run_instead(bake)
    return given


def bake(*objects, output="REFINED", **settings):
    for name, value in settings.items():
        setattr(bpy.context.scene.radiosity, name, value)
    bpy.ops.object.select_all(action="DESELECT")
    select_also(*objects)
    bake_selected(output)
    return bpy.context.object


def names_of(obj):
    return [attribute.name for attribute in obj.data.color_attributes]


@pytest.mark.parametrize("output", OUTPUTS)
def test_a_prefix_begins_the_names_of_all_attributes_and_its_radiosity_is_shown(bright_bake, output):
    obj = bake(add_cube(materials=[diffuse_material()]), output=output, prefix="Night ")
    assert names_of(obj) == [
        "Night Radiosity",
        "Night Irradiance",
        "Night Radiosity Back",
        "Night Irradiance Back",
    ]
    assert obj.data.color_attributes.active_color.name == "Night Radiosity"
    nodes = obj.material_slots[0].material.node_tree.nodes
    shown = {node.layer_name for node in nodes if node.type == "VERTEX_COLOR"}
    assert shown == {"Night Radiosity", "Night Radiosity Back"}


@pytest.mark.parametrize("output", OUTPUTS)
def test_restoring_takes_back_attributes_of_any_name(bright_bake, output):
    cube = add_cube(materials=[diffuse_material()])
    cube.data.color_attributes.new("Night Radiosity", "BYTE_COLOR", "POINT")
    cube.lightgroup = "Key"
    select_also(cube)
    before = file_state()
    bake(cube, output=output, prefix="Night ", light_groups=True, data_type="BYTE", domain="POINT")
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert differences(before, file_state()) == []


def test_another_prefix_replaces_the_attributes_of_an_earlier_bake_in_place(bright_bake):
    cube = add_cube()
    cube.data.color_attributes.new("Mine", "FLOAT_COLOR", "CORNER")
    bake(cube, output="ORIGINAL", prefix="Day ")
    bake(cube, output="ORIGINAL", prefix="Night ", light="IRRADIANCE")
    assert names_of(cube) == ["Mine", "Night Irradiance", "Night Irradiance Back"]


@pytest.mark.parametrize("output", OUTPUTS)
def test_lighting_only_writes_and_shows_the_irradiance_alone(bright_bake, output):
    obj = bake(add_cube(), output=output, light="IRRADIANCE")
    assert names_of(obj) == ["Irradiance", "Irradiance Back"]
    assert obj.data.color_attributes.active_color.name == "Irradiance"
    (emission, *_) = (n for n in obj.material_slots[0].material.node_tree.nodes if n.type == "EMISSION")
    assert emission.inputs["Color"].links[0].from_node.layer_name == "Irradiance"


@pytest.mark.parametrize("light", ["DIRECT", "INDIRECT"])
def test_a_part_of_the_light_is_asked_of_the_bake_and_named_as_the_whole(bright_bake, light):
    obj = bake(add_cube(), light=light)
    assert bright_bake[0][1].light == light
    assert names_of(obj)[:2] == ["Radiosity", "Irradiance"]


def test_indirect_light_on_textures_is_shown_without_what_the_material_emits(bright_bake):
    obj = bake(add_cube(materials=[emission_material()]), light="INDIRECT", material="TEXTURED")
    tree = obj.material_slots[0].material.node_tree
    colours = [tuple(n.inputs["Color"].default_value)[:3] for n in tree.nodes if n.type == "EMISSION"]
    assert set(colours) == {(0.0, 0.0, 0.0)}


@pytest.mark.parametrize("output", OUTPUTS)
def test_bytes_hold_the_light_up_to_the_brightest_and_the_report_says_how_much_that_is(bright_bake, output):
    obj = bake(add_cube(), output=output, data_type="BYTE")
    attribute = obj.data.color_attributes["Radiosity"]
    assert (attribute.data_type, attribute.domain) == ("BYTE_COLOR", "CORNER")
    told = report()["exposure"]
    assert told["Radiosity"] == {"maximum": BRIGHT + 1.0, "stops": 2.0, "clipped": 0}
    assert told["Irradiance"]["maximum"] == BRIGHT + 0.5
    # Between neighbouring bytes sRGB grows by at most 2.4 / 1.055 / 255 of 1, and rounding is off by half of that.
    half_a_step = 0.5 * 2.4 / 1.055 / 255
    stored = colours_of(obj.data)[:, :3] * told["Radiosity"]["maximum"]
    assert stored == pytest.approx(corner_positions(obj) + BRIGHT, abs=half_a_step * told["Radiosity"]["maximum"])
    strengths = {
        node.inputs["Strength"].default_value
        for node in obj.material_slots[0].material.node_tree.nodes
        if node.type == "EMISSION"
    }
    assert strengths == {BRIGHT + 1.0}


def test_a_maximum_that_was_asked_for_is_kept_and_what_is_brighter_is_counted(bright_bake):
    obj = bake(add_cube(), data_type="BYTE", byte_maximum=3.5)
    told = report()["exposure"]["Radiosity"]
    values = corner_positions(obj) + BRIGHT
    behind = -corner_positions(obj) + BRIGHT
    assert told["maximum"] == 3.5
    assert told["clipped"] == sum(int((part.max(axis=1) > 3.5).sum()) for part in (values, behind)) > 0
    assert colours_of(obj.data)[:, :3].max() == 1.0


def test_floats_have_no_exposure(bright_bake):
    bake(add_cube())
    assert report()["exposure"] is None


@pytest.mark.parametrize("output", OUTPUTS)
def test_vertices_have_the_mean_of_their_corners(bright_bake, output):
    obj = bake(add_cube(), output=output, domain="POINT")
    attribute = obj.data.color_attributes["Radiosity"]
    assert (attribute.data_type, attribute.domain) == ("FLOAT_COLOR", "POINT")
    places = np.array([vertex.co for vertex in obj.data.vertices])
    assert colours_of(obj.data)[:, :3] == pytest.approx(places + BRIGHT, abs=1e-6)


def test_the_mean_of_a_vertex_goes_by_angles_not_by_the_number_of_triangles():
    from radiosity_bake.operators.colours import of_vertices

    mesh = bpy.data.meshes.new("Fan")
    # A square beside two triangles that make another: at vertex 1 both of them have half of its angle.
    vertices = [(-1, 0, 0), (0, 0, 0), (0, 1, 0), (-1, 1, 0), (1, 0, 0), (1, 1, 0)]
    mesh.from_pydata(vertices, [], [(0, 1, 2, 3), (1, 4, 5), (1, 5, 2)])
    colours = np.zeros((10, 3))
    colours[:4] = 1.0
    found = of_vertices(mesh, colours)
    assert found[[0, 3], 0] == pytest.approx([1.0, 1.0])
    assert found[[1, 2], 0] == pytest.approx([0.5, 0.5])
    assert found[[4, 5], 0] == pytest.approx([0.0, 0.0])


def add_groups():
    """Return a cube, with a lamp of the group Key, a glowing plane of the group Panel, and a lamp of none."""
    for name, group in (("Sun", "Key"), ("Bulb", "")):
        lamp = bpy.data.lights.new(name, "POINT")
        add_object(name, lamp).lightgroup = group
    panel = add_plane("Panel", materials=[emission_material()])
    panel.lightgroup = "Panel"
    dark = add_plane("Dark", materials=[diffuse_material()])
    dark.lightgroup = "Nothing"
    world = bpy.context.scene.world = bpy.data.worlds.new("World")
    world.lightgroup = "Key"
    return add_cube()


def test_light_groups_are_read_as_blender_has_them(bright_bake):
    bake(add_groups(), light_groups=True)
    ((scene, settings),) = bright_bake
    assert settings.light_groups
    found = {
        group.name: (
            sorted(scene.meshes[index].name for index in group.meshes),
            sorted(scene.lamps[index].name for index in group.lamps),
            group.world,
        )
        for group in scene.light_groups
    }
    assert found == {"Key": ([], ["Sun"], True), "Panel": (["Panel"], [], False)}


@pytest.mark.parametrize(("light", "quantity"), [("ALL", "Radiosity"), ("IRRADIANCE", "Irradiance")])
@pytest.mark.parametrize("output", OUTPUTS)
def test_each_light_group_has_an_attribute_of_its_own(bright_bake, output, light, quantity):
    obj = bake(add_groups(), output=output, light_groups=True, light=light)
    fronts = [f"{quantity} {group}" for group in ("Key", "Panel", "Ungrouped")]
    backs = [f"{name} Back" for name in fronts]
    assert sorted(name for name in names_of(obj) if name.count(" ") and "Back" not in name) == sorted(fronts)
    assert set(backs) <= set(names_of(obj))
    share = {"Radiosity": 1.0, "Irradiance": 0.5}[quantity]
    expected = (share * corner_positions(obj) + BRIGHT) / 3.0
    assert colours_of(obj.data, fronts[1])[:, :3] == pytest.approx(expected, abs=1e-6)
    assert obj.data.color_attributes.active_color.name == quantity


@pytest.mark.parametrize(("light", "glow"), [("ALL", 3.0), ("DIRECT", 3.0), ("INDIRECT", 0.0)])
def test_what_glows_without_lighting_is_direct_light_of_no_group_and_fits_into_the_bytes(bright_bake, light, glow):
    plane = add_plane(materials=[emission_material(strength=3.0)])
    plane.radiosity_settings.emits = False
    obj = bake(plane, light=light, light_groups=True, data_type="BYTE")
    told = report()["exposure"]["Radiosity"]
    assert told["maximum"] == pytest.approx(BRIGHT + 1.0 + glow)
    assert told["clipped"] == 0
    ungrouped = colours_of(obj.data, "Radiosity Ungrouped")[:, :3] * told["maximum"]
    half_a_step = 0.5 * 2.4 / 1.055 / 255
    expected = (corner_positions(obj) + BRIGHT) / 2.0 + glow
    assert ungrouped == pytest.approx(expected, abs=half_a_step * told["maximum"])


@pytest.mark.parametrize("output", OUTPUTS)
def test_baking_a_part_of_the_scene_again_leaves_the_others_as_they_are(bright_bake, output):
    first, second = add_cube("First"), add_cube("Second")
    bake(first, second, output=output)
    shown = {name: bpy.data.objects.get(f"{name} Radiosity") or bpy.data.objects[name] for name in ("First", "Second")}
    before = colours_of(shown["Second"].data).tobytes(), shown["Second"].data.name, names_of(shown["Second"])
    first.data.vertices[0].co.x -= 1.0
    bake(shown["First"], output=output, data_type="BYTE", prefix="New ")
    again = bpy.data.objects.get("First Radiosity") or first
    assert "New Radiosity" in names_of(again)
    second = bpy.data.objects.get("Second Radiosity") or second
    assert (colours_of(second.data).tobytes(), second.data.name, names_of(second)) == before
    (material,) = {slot.material for slot in second.material_slots}
    assert next(n for n in material.node_tree.nodes if n.type == "VERTEX_COLOR").layer_name == "Radiosity"


def test_a_vertex_group_of_a_name_that_is_needed_is_refused(bright_bake):
    cube = add_cube()
    cube.vertex_groups.new(name="Night Radiosity")
    bake(cube, output="ORIGINAL")
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    bpy.context.scene.radiosity.prefix = "Night "
    with pytest.raises(RuntimeError, match='vertex group named "Night Radiosity"'):
        bpy.ops.radiosity.bake()
