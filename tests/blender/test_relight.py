# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The relight operator: the light that a fresh bake would give, in place, and a sentence where that cannot be."""

import bpy
import numpy as np
import pytest
import radiosity_bake
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.operators import transports
from radiosity_bake.operators.doors import Watch
from radiosity_bake.operators.relight import reason_not_to_relight

from tests.blender.making import (
    add_cube,
    add_plane,
    bake_selected,
    colours_of,
    diffuse_material,
    emission_material,
    node_tree,
    position_bake,
    report,
    socket_of,
)
from tests.blender.state import file_state

ROUNDING = 1e-5
"""Of the largest value, as in the tests of core."""


def shader_of(material):
    return next(node for node in material.node_tree.nodes if node.type in {"EMISSION", "BSDF_DIFFUSE"})


def set_colour(material, colour):
    socket_of(shader_of(material), "Color").default_value = (*colour, 1.0)


def set_strength(material, strength):
    socket_of(shader_of(material), "Strength").default_value = strength


@pytest.fixture
def room():
    """A floor, a turned and mirrored cube on it, and a lamp above, all selected, to be baked coarsely."""
    floor = add_plane("Floor", materials=[diffuse_material("Boards", (0.7, 0.4, 0.2, 1.0))], select=True)
    floor.scale = (3.0, 3.0, 1.0)
    cube = add_cube("Box", materials=[diffuse_material("Paint", (0.2, 0.6, 0.7, 1.0))], select=True)
    cube.location, cube.rotation_euler.z, cube.scale = (0.5, 0.3, 0.5), 0.4, (-0.5, 0.5, 0.5)
    lamp = add_plane("Lamp", materials=[emission_material("Shine", strength=6.0)], select=True)
    lamp.location.z = 3.0
    settings = bpy.context.scene.radiosity
    settings.quality, settings.minimum_size = "DRAFT", 0.8
    return {"Floor": floor, "Box": cube, "Lamp": lamp}


def relight():
    assert bpy.ops.radiosity.relight() == {"FINISHED"}


def change_the_light():
    set_strength(bpy.data.materials["Shine"], 2.5)
    set_colour(bpy.data.materials["Shine"], (1.0, 0.5, 0.1))
    set_colour(bpy.data.materials["Boards"], (0.1, 0.3, 0.8))


def shown_colours():
    """All colours by object and attribute, (c, 4) each."""
    return {
        (obj.name, attribute.name): colours_of(obj.data, attribute.name)
        for obj in bpy.context.scene.objects
        for attribute in obj.data.color_attributes
    }


def refused(sentence):
    before = file_state()
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.radiosity.relight()
    assert file_state() == before


# ---------------------------------------------------------------------------------------------------------------------
# What it gives


@pytest.mark.parametrize(("output", "method"), [("ORIGINAL", "ADAPTIVE"), ("REFINED", "UNIFORM")])
def test_it_gives_the_colours_of_a_fresh_bake(room, output, method):
    # Uniform, so that the fresh bake has the same vertices.
    bpy.context.scene.radiosity.output, bpy.context.scene.radiosity.method = output, method
    bake_selected()
    before = shown_colours()
    change_the_light()
    relight()
    relit = shown_colours()
    bake_selected()
    fresh = shown_colours()
    assert relit.keys() == fresh.keys() and len(relit) >= 6
    for key, values in fresh.items():
        assert np.abs(relit[key] - values).max() <= ROUNDING * values.max(), key
    assert any(np.abs(before[key] - values).max() > 0.1 for key, values in relit.items())


def test_with_the_same_colours_nothing_changes(room):
    bake_selected()
    before = shown_colours()
    relight()
    after = shown_colours()
    assert all(np.array_equal(before[key], values) for key, values in after.items())


def test_the_refined_objects_stay_and_show_the_new_colours(room):
    bake_selected()
    names = sorted(obj.name for obj in bpy.data.objects)
    meshes = {obj.name: obj.data for obj in bpy.context.scene.objects}
    bpy.data.objects["Box Radiosity"].data.materials[0].name = "My Name For It"
    change_the_light()
    relight()
    assert sorted(obj.name for obj in bpy.data.objects) == names
    assert all(obj.data == meshes[obj.name] for obj in bpy.context.scene.objects)
    shown = bpy.data.objects["Box Radiosity"].data
    assert shown.color_attributes.active_color_name == "Radiosity"
    assert shown.materials[0].name == "My Name For It"


def test_what_the_artist_chose_to_see_stays_chosen(room):
    bake_selected()
    bpy.data.objects["Box Radiosity"].data.color_attributes.active_color_name = "Irradiance"
    relight()
    assert bpy.data.objects["Box Radiosity"].data.color_attributes.active_color_name == "Irradiance"


def test_a_copy_of_a_refined_object_is_lit_as_well(room):
    bake_selected()
    copy = bpy.data.objects["Floor Radiosity"].copy()
    copy.data = copy.data.copy()
    bpy.context.scene.collection.objects.link(copy)
    change_the_light()
    relight()
    np.testing.assert_array_equal(colours_of(copy.data), colours_of(bpy.data.objects["Floor Radiosity"].data))


def test_restore_brings_the_originals_back_after_it(room):
    before = file_state()["objects"]
    bake_selected()
    relight()
    bpy.ops.radiosity.restore()
    assert file_state()["objects"] == before


def test_the_report_says_that_it_was_relit_without_rays(room):
    bake_selected()
    baked = report()
    change_the_light()
    relight()
    relit = report()
    assert not baked["relit"] and relit["relit"]
    assert baked["rays"] > 0 and relit["rays"] == 0
    assert relit["objects"] == baked["objects"]
    assert relit["energy"]["emitted"] < baked["energy"]["emitted"]
    assert relit["seconds"].keys() >= {"extract", "store", "total"}


def test_the_selection_does_not_matter(room):
    bake_selected()
    for obj in bpy.context.scene.objects:
        obj.select_set(False)
    relight()


def test_a_lamp_may_go_dark_and_come_back(room):
    world = bpy.context.scene.world = bpy.data.worlds.new("Sky")
    tree = node_tree(world)
    sky = tree.nodes.new("ShaderNodeBackground")
    tree.links.new(sky.outputs[0], tree.nodes[0].inputs["Surface"])
    bake_selected()
    before = shown_colours()
    set_strength(bpy.data.materials["Shine"], 0.0)
    relight()
    assert shown_colours()["Lamp Radiosity", "Radiosity"][:, :3].max() == 0.0
    set_strength(bpy.data.materials["Shine"], 6.0)
    relight()
    assert all(np.array_equal(before[key], values) for key, values in shown_colours().items())


# ---------------------------------------------------------------------------------------------------------------------
# When the button is grey


def test_the_button_is_grey_before_the_first_bake(room):
    assert reason_not_to_relight(bpy.context).startswith("Bake first")
    assert not bpy.ops.radiosity.relight.poll()
    refused("Bake first")


def test_the_button_is_grey_in_edit_mode_and_while_a_bake_runs(room, monkeypatch):
    bake_selected()
    bpy.ops.object.mode_set(mode="EDIT")
    assert reason_not_to_relight(bpy.context) == "Leave edit mode to relight"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert reason_not_to_relight(bpy.context) is None
    monkeypatch.setattr(Watch, "running", object())
    assert "running" in reason_not_to_relight(bpy.context)


def test_the_button_is_grey_when_nothing_was_kept(room):
    bpy.context.scene.radiosity.keep_transport = False
    bake_selected()
    assert reason_not_to_relight(bpy.context) == "Turn on Keep for Relighting and bake again to relight"
    bpy.context.scene.radiosity.keep_transport = True
    assert "not in memory" in reason_not_to_relight(bpy.context)


def test_the_button_is_grey_when_memory_was_too_small(room, monkeypatch):
    from radiosity_bake.core.relight import size_of

    monkeypatch.setattr("radiosity_bake.core.relight.size_of", lambda kept: size_of(kept) + 2**40)
    bake_selected()
    assert "memory limit of 2,048 MiB" in reason_not_to_relight(bpy.context)
    refused("raise the limit and bake again")


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_the_button_is_grey_once_the_originals_are_back(room, output):
    bpy.context.scene.radiosity.output = output
    bake_selected()
    room["Box"].select_set(True)
    bpy.ops.object.select_all(action="DESELECT")
    shown = bpy.data.objects["Box Radiosity"] if output == "REFINED" else room["Box"]
    shown.select_set(True)
    bpy.ops.radiosity.restore()
    assert reason_not_to_relight(bpy.context) == '"Box" is not baked any more; bake again to relight'


# ---------------------------------------------------------------------------------------------------------------------
# What is refused, and changes nothing


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_an_edited_mesh_is_refused(room, output):
    bpy.context.scene.radiosity.output = output
    bake_selected()
    room["Floor"].data.vertices[0].co.z = 0.1
    refused('"Floor" was changed or moved since the bake; bake again')


def test_a_moved_object_is_refused(room):
    bake_selected()
    bpy.data.objects["Box Radiosity"].location.x += 0.1
    refused('"Box" was changed or moved since the bake; bake again')


def test_a_new_object_is_refused(room):
    bake_selected()
    add_cube("Another")
    refused("added, removed or hidden since the bake")


def test_an_edited_refined_mesh_is_refused(room):
    bake_selected()
    bpy.data.objects["Box Radiosity"].data.vertices[0].co.z += 0.1
    refused('The mesh of "Box Radiosity" was edited since the bake; bake again')


def test_a_new_lamp_is_refused(room):
    bake_selected()
    room["Box"].data.materials[0] = emission_material("Glow")
    refused('"Box" gave no light where it does now')


@pytest.mark.parametrize(("name", "value"), [("quality", "GOOD"), ("output", "ORIGINAL"), ("seed", 3)])
def test_other_settings_are_refused_until_they_are_set_back(room, name, value):
    settings = bpy.context.scene.radiosity
    bake_selected()
    before = getattr(settings, name)
    setattr(settings, name, value)
    refused("The settings were changed since the bake")
    setattr(settings, name, before)
    relight()


def test_settings_that_do_not_change_the_result_may_change(room):
    bake_selected()
    settings = bpy.context.scene.radiosity
    settings.threads, settings.memory_limit = 1, 512
    relight()


def test_a_failure_in_the_middle_takes_back_what_was_written(room, monkeypatch):
    bake_selected()
    change_the_light()
    before = file_state()
    calls = []

    def failing(mesh, values, attributes, journal):
        calls.append(mesh)
        if len(calls) == 2:
            raise RuntimeError("no more")
        from radiosity_bake.operators.colours import rewrite_colours

        rewrite_colours(mesh, values, attributes, journal)

    monkeypatch.setattr("radiosity_bake.operators.relight.rewrite_colours", failing)
    with pytest.raises(RuntimeError, match="no more"):
        bpy.ops.radiosity.relight()
    assert file_state() == before


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_materials_with_textures_show_the_new_colours(room, output):
    bpy.context.scene.radiosity.material = "TEXTURED"
    bake_selected(output)
    paint = bpy.data.materials["Paint"]
    set_colour(paint, (0.5, 0.25, 0.125))
    relight()
    shown = bpy.data.materials["Paint Radiosity"]
    known = [node.inputs[6].default_value[:3] for node in shown.node_tree.nodes if node.type == "MIX"]
    assert known == [pytest.approx((0.5, 0.25, 0.125))]
    assert sorted(material.name for material in bpy.data.materials if "Paint" in material.name) == [
        "Paint",
        "Paint Radiosity",
    ]


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_light_groups_and_bytes_are_relit(room, output):
    room["Lamp"].lightgroup = "Key"
    settings = bpy.context.scene.radiosity
    settings.light_groups, settings.data_type, settings.domain = True, "BYTE", "POINT"
    bake_selected(output)
    before = report()["exposure"]
    set_strength(bpy.data.materials["Shine"], 3.0)
    relight()
    after = report()["exposure"]
    for quantity in ("Radiosity", "Irradiance"):
        assert after[quantity]["maximum"] == pytest.approx(0.5 * before[quantity]["maximum"], rel=ROUNDING)
    for obj in (bpy.data.objects[name] for name in report()["objects"]):
        # The lamp is all the light there is.
        assert colours_of(obj.data, "Radiosity Key").tobytes() == colours_of(obj.data).tobytes()
        assert "Radiosity Ungrouped" not in obj.data.color_attributes


# ---------------------------------------------------------------------------------------------------------------------
# What is in memory, and for how long


def in_memory():
    return list(transports._last.values())


def test_one_bake_at_most_is_in_memory(room):
    bake_selected()
    (first,) = in_memory()
    bake_selected()
    (second,) = in_memory()
    assert second is not first
    other = bpy.data.scenes.new("Other")
    assert transports.remembered_bake(other) is None
    assert transports.remembered_bake(bpy.context.scene) is second


def test_another_files_loading_lets_go_of_it(room):
    bake_selected()
    assert in_memory()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert not in_memory()


def test_unregistering_lets_go_of_it_and_of_the_handlers(room):
    bake_selected()
    handlers = len(bpy.app.handlers.undo_post), len(bpy.app.handlers.load_pre)
    radiosity_bake.unregister()
    try:
        assert not in_memory()
        assert (len(bpy.app.handlers.undo_post), len(bpy.app.handlers.load_pre)) == (handlers[0] - 1, handlers[1] - 1)
    finally:
        radiosity_bake.register()


def test_undo_takes_back_a_relight_as_one_step_and_keeps_the_transport(room):
    bpy.ops.ed.undo_push(message="Room")
    bake_selected()
    bpy.ops.ed.undo_push(message="Bake")
    before = shown_colours()
    change_the_light()
    bpy.ops.ed.undo_push(message="Colours")
    relight()
    bpy.ops.ed.undo_push(message="Relight")
    after = shown_colours()
    bpy.ops.ed.undo()
    assert all(np.array_equal(before[key], values) for key, values in shown_colours().items())
    relight()
    assert all(np.array_equal(after[key], values) for key, values in shown_colours().items())


def test_undo_of_the_bake_lets_go_of_its_transport(room):
    bpy.ops.ed.undo_push(message="Room")
    bake_selected()
    bpy.ops.ed.undo_push(message="Bake")
    assert in_memory()
    bpy.ops.ed.undo()
    assert "Box Radiosity" not in bpy.data.objects
    assert not in_memory()
    bpy.ops.ed.redo()
    assert "Box Radiosity" in bpy.data.objects
    assert "not in memory" in reason_not_to_relight(bpy.context)


def test_a_bake_that_keeps_nothing_lets_go_of_the_one_before(room, run_instead):
    bake_selected()
    run_instead(position_bake)
    bake_selected()
    assert not in_memory()


def test_the_default_is_to_keep(room):
    assert BakeSettings().keep_transport
    assert bpy.context.scene.radiosity.keep_transport
