# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lamps: what is read of them, and that they light a room as in Cycles."""

from contextlib import contextmanager

import bpy
import numpy as np
import pytest
from radiosity_bake.core.scene import AreaLamp, PointLamp, SunLamp
from radiosity_bake.operators.extraction import extract
from radiosity_bake.operators.lamp_profiles import profiles_of
from radiosity_bake.operators.scratch import NoCyclesError

from tests.blender.making import (
    add_collection,
    add_cube,
    add_mesh,
    add_object,
    bake_selected,
    colours_of,
    diffuse_material,
    emission_material,
    node_tree,
    report,
    select_also,
)

CELLS = 10
SAMPLES = 1024


def add_lamp(kind, name="Lamp", location=(0.3, -0.2, 1.6), rotation=(0.0, 0.0, 0.0), scale=(1.0, 1.0, 1.0), **values):
    light = bpy.data.lights.new(name, kind)
    for key, value in values.items():
        setattr(light, key, value)
    obj = add_object(name, light)
    obj.location, obj.rotation_euler, obj.scale = location, rotation, scale
    return obj


def warnings_of_lamps():
    """Of the last bake; that the mesh is too coarse between its corners, where it is not judged, is no matter here."""
    return [warning for warning in report()["warnings"] if "estimated error" not in warning]


def lamps_read():
    bpy.context.view_layer.update()
    cube = bpy.data.objects.get("Cube") or add_cube()
    extraction = extract(bpy.context, [cube])
    return extraction.scene.lamps, extraction.warnings


def add_room():
    """Return a floor of many vertices, with a wall beside it and a board that floats above it."""
    paint = diffuse_material(colour=(0.5, 0.5, 0.5, 1.0))
    side = np.linspace(-1.0, 1.0, CELLS + 1)
    row = CELLS + 1
    quads = [(a, a + 1, a + row + 1, a + row) for j in range(CELLS) for a in range(j * row, j * row + CELLS)]
    floor = add_mesh("Floor", [(x, y, 0.0) for y in side for x in side], quads, materials=[paint])
    add_mesh("Wall", [(-1.2, -2, 0), (-1.2, 2, 0), (-1.2, 2, 2), (-1.2, -2, 2)], [(0, 1, 2, 3)], materials=[paint])
    board = [(-0.13, -0.37, 0.6), (0.43, -0.17, 0.6), (0.23, 0.41, 0.6), (-0.33, 0.21, 0.6)]
    add_mesh("Board", board, [(0, 1, 2, 3)], materials=[paint])
    return floor


def by_cycles(floor):
    """Return (v,) what Cycles' DIFFUSE bake without colour gives the floor's vertices, in red."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    for key, value in {
        "device": "CPU",
        "samples": SAMPLES,
        "use_adaptive_sampling": False,
        "use_denoising": False,
        "sample_clamp_direct": 0.0,
        "sample_clamp_indirect": 0.0,
        "light_sampling_threshold": 0.0,
        "max_bounces": 64,
        "diffuse_bounces": 64,
    }.items():
        setattr(scene.cycles, key, value)
    attribute = floor.data.color_attributes.new("Cycles", "FLOAT_COLOR", "POINT")
    floor.data.color_attributes.active_color = attribute
    bpy.ops.object.bake(type="DIFFUSE", pass_filter={"DIRECT", "INDIRECT"}, target="VERTEX_COLORS")
    values = colours_of(floor.data, "Cycles")[:, 0]
    floor.data.color_attributes.remove(floor.data.color_attributes["Cycles"])
    return values


def by_us(floor):
    """Return (v,) our irradiance at the floor's vertices, in red."""
    bake_selected("ORIGINAL")
    assert warnings_of_lamps() == []
    corners = np.empty(len(floor.data.loops), dtype=np.int32)
    floor.data.loops.foreach_get("vertex_index", corners)
    irradiance = colours_of(floor.data, "Irradiance")[:, 0]
    return np.bincount(corners, weights=irradiance) / np.bincount(corners)


@pytest.mark.parametrize(
    "lamp",
    [
        {"kind": "POINT", "shadow_soft_size": 0.0},
        {"kind": "POINT", "shadow_soft_size": 0.25, "use_soft_falloff": True},
        {"kind": "POINT", "shadow_soft_size": 0.25, "use_soft_falloff": False, "scale": (2.0, 2.0, 2.0)},
        {"kind": "POINT", "shadow_soft_size": 0.1, "use_shadow": False},
        {"kind": "SPOT", "shadow_soft_size": 0.15, "spot_size": 1.4, "spot_blend": 0.4, "rotation": (0.2, 0.3, 0.0)},
        {"kind": "SPOT", "shadow_soft_size": 0.1, "spot_size": 1.2, "spot_blend": 0.9, "scale": (1.0, 2.0, 1.5)},
        {"kind": "AREA", "shape": "SQUARE", "size": 0.5},
        {
            "kind": "AREA",
            "shape": "RECTANGLE",
            "size": 0.3,
            "size_y": 0.8,
            "scale": (2, 1, 3),
            "rotation": (0.3, 0.2, 1),
        },
        {"kind": "AREA", "shape": "DISK", "size": 0.6, "scale": (-1.0, 1.0, 1.0)},
        {"kind": "AREA", "shape": "ELLIPSE", "size": 0.6, "size_y": 0.3, "spread": 1.5},
        {"kind": "SUN", "angle": 0.1, "rotation": (0.4, 0.2, 0.0)},
        {"kind": "SUN", "angle": 0.0, "rotation": (-0.5, 0.3, 0.0)},
    ],
    ids=lambda lamp: "-".join(str(value) for value in lamp.values()),
)
def test_a_room_is_lit_as_in_cycles(lamp):
    check_against_cycles(lamp)


@pytest.mark.skipif("normalize" not in bpy.types.Light.bl_rna.properties, reason="lamps have none of them here")
@pytest.mark.parametrize(
    "lamp",
    [
        {"kind": "POINT", "shadow_soft_size": 0.3, "use_soft_falloff": False, "normalize": False},
        {"kind": "SPOT", "shadow_soft_size": 0.2, "spot_size": 1.4, "normalize": False},
        {"kind": "AREA", "shape": "DISK", "size": 0.5, "spread": 2.0, "normalize": False},
        {"kind": "SUN", "angle": 0.3, "normalize": False},
        {"kind": "AREA", "exposure": 1.5},
        {"kind": "POINT", "use_temperature": True, "temperature": 4000.0, "color": (0.5, 1.0, 1.0)},
    ],
    ids=lambda lamp: "-".join(str(value) for value in lamp.values()),
)
def test_what_newer_versions_have_lights_a_room_as_in_cycles(lamp):
    check_against_cycles(lamp)


def linked(name, states):
    """Return a collection for light linking that includes and excludes objects by their names."""
    collection = bpy.data.collections.new(name)
    for number, (thing, state) in enumerate(states.items()):
        collection.objects.link(bpy.data.objects[thing])
        collection.collection_objects[number].light_linking.link_state = state
    return collection


@pytest.mark.parametrize(
    ("shines", "receivers", "blockers"),
    [
        ("lamp", {"Wall": "INCLUDE", "Board": "INCLUDE"}, {}),
        ("lamp", {"Wall": "EXCLUDE"}, {"Board": "EXCLUDE"}),
        ("mesh", {"Wall": "EXCLUDE"}, {}),
        ("mesh", {"Floor": "INCLUDE", "Board": "EXCLUDE"}, {"Wall": "INCLUDE"}),
    ],
    ids=str,
)
def test_linked_light_lights_a_room_as_in_cycles(shines, receivers, blockers):
    floor = add_room()
    if shines == "lamp":
        source = add_lamp("POINT", shadow_soft_size=0.2, energy=10.0)
    else:
        glow = emission_material(strength=4.0)
        corners = [(-0.1, -0.5, 1.5), (-0.1, 0.1, 1.5), (0.6, 0.1, 1.5), (0.6, -0.5, 1.5)]
        source = add_mesh("Panel", corners, [(0, 1, 2, 3)], materials=[glow])
    if receivers:
        source.light_linking.receiver_collection = linked("Receivers", receivers)
    if blockers:
        source.light_linking.blocker_collection = linked("Blockers", blockers)
    compare_with_cycles(floor)


def check_against_cycles(lamp):
    floor = add_room()
    add_lamp(**lamp, energy=10.0)
    compare_with_cycles(floor)


def compare_with_cycles(floor):
    select_also(floor)
    theirs, ours = by_cycles(floor), by_us(floor)
    # At the border our light is gathered a little inside the face, and the other way round where the board's shadow
    # ends between two vertices. A mean over vertices is what the two agree on, to 2% of the mean light.
    difference = np.abs(ours - theirs)
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.01)
    assert difference.mean() < 0.02 * theirs.mean()


def add_measured_lamp(kind="POINT", **values):
    """Return a turned lamp with the profile of an IES file, brighter to one side and dark behind."""
    lamp = add_lamp(kind, location=(0.1, 0.05, 1.5), rotation=(0.3, 0.2, 0.4), energy=10.0, **values)
    text = bpy.data.texts.new("lamp.ies")
    angles = "0 15 30 60 90 135 180\n0 90 180 270 360\n"
    sides = ("1000 1200 900 400 100 0 0\n", "1000 800 500 300 100 50 0\n", "1000 600 300 100 20 0 0\n")
    candela = "".join(sides[k] for k in (0, 1, 2, 1, 0))
    text.write(f"IESNA91\nTILT=NONE\n1 1000 1 7 5 1 2 0.1 0.1 0\n1 1 50\n{angles}{candela}")
    tree = node_tree(lamp.data)
    shine, measured = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeTexIES")
    measured.ies, measured.inputs["Strength"].default_value = text, 0.01
    tree.links.new(measured.outputs[0], shine.inputs["Strength"])
    tree.links.new(shine.outputs[0], tree.nodes[0].inputs["Surface"])
    return lamp


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        ("POINT", {"shadow_soft_size": 0.1}),
        ("POINT", {"shadow_soft_size": 0.0, "scale": (1.0, 2.0, -0.5)}),
        ("SPOT", {"shadow_soft_size": 0.05, "spot_size": 2.0, "spot_blend": 0.3}),
    ],
)
def test_a_lamp_with_an_ies_file_lights_a_room_as_in_cycles(kind, values):
    floor = add_room()
    add_measured_lamp(kind, **values)
    compare_with_cycles(floor)
    assert report()["evaluated_by_blender"] == ['The directions in which "Lamp" shines']


def test_a_slide_in_a_spot_is_thrown_in_its_colours_as_in_cycles():
    floor = add_room()
    lamp = add_lamp("SPOT", rotation=(0.1, 0.2, 0.7), energy=20.0, shadow_soft_size=0.0, spot_size=1.8)
    tree = node_tree(lamp.data)
    shine, where, slide = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Emission", "TexCoord", "TexNoise"))
    slide.inputs["Scale"].default_value = 2.0
    tree.links.new(where.outputs["UV"], slide.inputs["Vector"])
    tree.links.new(slide.outputs[1], shine.inputs["Color"])
    tree.links.new(shine.outputs[0], tree.nodes[0].inputs["Surface"])
    compare_with_cycles(floor)
    lamps = lamps_read()[0]
    assert [np.count_nonzero(lamp.strength) for lamp in lamps] == [1, 1, 1]


def test_lamps_of_one_ies_file_are_evaluated_once_however_they_are_turned(monkeypatch):
    lamp = add_measured_lamp()
    for turn in (0.5, 1.0):
        other = lamp.copy()
        bpy.context.scene.collection.objects.link(other)
        other.rotation_euler = (turn, 0.1, 2.0 * turn)
    asked = []
    monkeypatch.setattr(
        "radiosity_bake.operators.scene_reader.profiles_of", lambda *given: asked.append(given) or profiles_of(*given)
    )
    lamps, warnings = lamps_read()
    assert len(asked) == 1 and len(lamps) == 3 and not warnings
    shares = [lamp.profile.shares for lamp in lamps]
    assert shares[0].max() == 1.0 and shares[0].min() == pytest.approx(0.0, abs=1e-6)
    assert not np.allclose(lamps[0].profile.inverse, lamps[1].profile.inverse)


def test_without_cycles_a_lamp_with_an_ies_file_shines_to_all_sides_and_says_so(monkeypatch):
    add_measured_lamp()

    @contextmanager
    def no_cycles():
        raise NoCyclesError("Turn on Cycles")
        yield

    monkeypatch.setattr("radiosity_bake.operators.lamp_profiles.scratch_scene", no_cycles)
    (lamp,), warnings = lamps_read()
    assert lamp.profile is None and lamp.strength.any()
    assert "IES Texture" in warnings[0] and "could not be evaluated (Turn on Cycles)" in warnings[1]


def test_lamps_are_read_in_the_order_of_their_names():
    for name, kind in (("C", "POINT"), ("A", "SUN"), ("B", "AREA")):
        add_lamp(kind, name)
    lamps, warnings = lamps_read()
    assert [(lamp.name, type(lamp)) for lamp in lamps] == [("A", SunLamp), ("B", AreaLamp), ("C", PointLamp)]
    assert not warnings


def test_a_lamp_that_does_not_render_is_left_out():
    add_lamp("POINT").hide_render = True
    assert lamps_read() == ((), ())


def test_a_lamp_that_diffuse_rays_do_not_see_gives_no_light():
    add_lamp("POINT").visible_diffuse = False
    assert lamps_read() == ((), ())


def test_a_portal_gives_no_light():
    add_lamp("AREA").data.cycles.is_portal = True
    assert lamps_read() == ((), ())


def test_lamps_in_instanced_collections_shine_where_the_instances_are():
    collection = add_collection("Parts")
    light = bpy.data.lights.new("Bulb", "POINT")
    add_object("Bulb", light, collection=collection).location = (0, 0, 1)
    bpy.context.scene.collection.children.unlink(collection)
    for x in (1.0, 2.0):
        instancer = add_object(f"Instance {x}", None)
        instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
        instancer.location = (x, 0, 0)
    lamps, _ = lamps_read()
    np.testing.assert_allclose([lamp.centre for lamp in lamps], [(1, 0, 1), (2, 0, 1)])


def test_an_emission_node_colours_the_lamp():
    light = add_lamp("SUN", energy=2.0, color=(1.0, 0.5, 1.0)).data
    tree = node_tree(light)
    shine = tree.nodes.new("ShaderNodeEmission")
    shine.inputs["Color"].default_value, shine.inputs["Strength"].default_value = (0.5, 1.0, 1.0, 1.0), 3.0
    tree.links.new(shine.outputs[0], tree.nodes[0].inputs["Surface"])
    (lamp,), warnings = lamps_read()
    np.testing.assert_allclose(lamp.strength, [3.0, 3.0, 6.0], rtol=1e-6)
    assert not warnings


@pytest.mark.parametrize(
    ("kind", "radius", "output", "smooth"),
    [("POINT", 0.0, "Constant", 0.0), ("POINT", 0.15, "Linear", 0.4), ("SPOT", 0.1, "Quadratic", 1.5)],
)
def test_a_lamp_falls_off_by_its_node_as_in_cycles(kind, radius, output, smooth):
    floor = add_room()
    lamp = add_lamp(kind, energy=10.0, shadow_soft_size=radius)
    if kind == "SPOT":
        lamp.data.spot_size = 1.5
    tree = node_tree(lamp.data)
    shine, falloff = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeLightFalloff")
    falloff.inputs["Strength"].default_value, falloff.inputs["Smooth"].default_value = 2.0, smooth
    shine.inputs["Color"].default_value = (0.5, 0.7, 1.0, 1.0)
    tree.links.new(falloff.outputs[output], shine.inputs["Strength"])
    tree.links.new(shine.outputs[0], tree.nodes[0].inputs["Surface"])
    compare_with_cycles(floor)
    assert warnings_of_lamps() == []


def test_a_node_that_is_not_read_is_named_with_the_lamp():
    light = add_lamp("SUN", "Key").data
    tree = node_tree(light)
    shine, falloff = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeLightFalloff")
    tree.links.new(falloff.outputs["Linear"], shine.inputs["Strength"])
    tree.links.new(shine.outputs[0], tree.nodes[0].inputs["Surface"])
    _, (warning,) = lamps_read()
    assert '"Key"' in warning and "Light Falloff" in warning


def test_a_sum_and_a_quadratic_falloff_in_a_lamp_are_read():
    light = add_lamp("POINT", "Key").data
    (plain,), _ = lamps_read()
    tree = node_tree(light)
    shine, falloff, product = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Emission", "LightFalloff", "Math"))
    product.operation = "MULTIPLY"
    product.inputs[0].default_value, product.inputs[1].default_value = 1.5, 2.0
    tree.links.new(product.outputs[0], falloff.inputs["Strength"])
    tree.links.new(falloff.outputs["Quadratic"], shine.inputs["Strength"])
    tree.links.new(shine.outputs[0], tree.nodes[0].inputs["Surface"])
    (lamp,), warnings = lamps_read()
    assert warnings == () and lamp.strength == pytest.approx(3.0 * plain.strength)


def test_an_area_lamp_of_no_size_is_named():
    add_lamp("AREA", shape="RECTANGLE", size=1.0, size_y=0.0)
    lamps, warnings = lamps_read()
    assert lamps == ()
    assert warnings == ('Lamp "Lamp": its size is 0, and it gives no light',)


def test_an_area_lamp_without_an_area_is_named():
    add_lamp("AREA", "Key", scale=(1.0, 1.0, 0.0))
    lamps, (warning,) = lamps_read()
    assert not lamps and '"Key"' in warning


@pytest.mark.parametrize(
    ("kind", "values", "sentence"),
    [
        ("POINT", {"energy": -1.0}, "negative"),
        ("AREA", {"spread": 0.001}, "1 degree"),
        ("SUN", {"angle": 3.0}, "120 degrees"),
    ],
)
def test_values_outside_of_what_is_supported_are_named(kind, values, sentence):
    add_lamp(kind, "Key", **values)
    _, (warning,) = lamps_read()
    assert '"Key"' in warning and sentence in warning


def test_a_lamp_of_few_bounces_goes_on_and_is_named():
    add_lamp("AREA").data.cycles.max_bounces = 2
    (warning,) = lamps_read()[1]
    assert warning == 'Lamp "Lamp": its light goes on after the 2 bounces that it is limited to'


def test_relighting_follows_the_power_of_a_lamp_but_not_its_place():
    floor = add_room()
    lamp = add_lamp("POINT", energy=10.0)
    bpy.context.scene.radiosity.quality = "DRAFT"
    select_also(floor)
    before = by_us(floor)
    lamp.data.energy = 20.0
    assert bpy.ops.radiosity.relight() == {"FINISHED"}
    np.testing.assert_allclose(colours_of(floor.data, "Irradiance")[:, 0].mean(), 2 * before.mean(), rtol=0.05)
    lamp.location.z += 0.1
    with pytest.raises(RuntimeError, match='"Lamp" was changed or moved'):
        bpy.ops.radiosity.relight()
