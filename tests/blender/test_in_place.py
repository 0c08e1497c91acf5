# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The original output: values on the corners that the meshes have."""

from functools import partial

import bpy
import numpy as np
import pytest
from radiosity_bake.operators.local_mesh import local_mesh
from radiosity_bake.operators.transfer import nearest_corners

from tests.blender.making import (
    add_cube,
    add_mesh,
    add_object,
    add_plane,
    bake_selected,
    colours_of,
    corner_positions,
    diffuse_material,
    linked_from_library,
    position_bake,
    report,
    select_also,
)

pytestmark = pytest.mark.usefixtures("quick_bake")


def bake(*objects):
    select_also(*objects)
    bake_selected("ORIGINAL")


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-1.0, 2.0, 1.0)])
def test_every_corner_of_the_mesh_gets_its_value(scale):
    cube = add_cube()
    cube.scale = scale
    mesh = cube.data
    bake(cube)
    assert cube.data == mesh
    assert len(mesh.polygons) == 6
    assert colours_of(mesh)[:, :3] == pytest.approx(corner_positions(cube), abs=1e-6)
    assert colours_of(mesh, "Irradiance")[:, :3] == pytest.approx(0.5 * corner_positions(cube), abs=1e-6)
    assert report()["warnings"] == []


def test_radiosity_is_active_for_the_viewport_and_the_renderer():
    cube = add_cube()
    cube.data.color_attributes.new("Paint", "BYTE_COLOR", "POINT")
    bake(cube)
    colours = cube.data.color_attributes
    assert colours.active_color.name == "Radiosity"
    assert colours[colours.render_color_index].name == "Radiosity"
    assert "Paint" in colours


def test_modifiers_that_keep_the_corners_need_no_transfer():
    cube = add_cube()
    cube.modifiers.new("Shift", "DISPLACE").strength = 0.0
    bake(cube)
    assert report()["warnings"] == []
    assert colours_of(cube.data)[:, :3] == pytest.approx(corner_positions(cube), abs=1e-6)


def test_modifiers_that_change_the_faces_are_said_and_values_come_from_the_nearest_point():
    plane = add_plane()
    modifier = plane.modifiers.new("Subdivision", "SUBSURF")
    modifier.subdivision_type, modifier.levels, modifier.render_levels = "SIMPLE", 3, 3
    bake(plane)
    (warning,) = report()["warnings"]
    assert '"Plane"' in warning and "modifiers" in warning
    # The look-up goes a thousandth inwards.
    assert colours_of(plane.data)[:, :3] == pytest.approx(corner_positions(plane), abs=2e-3)


@pytest.mark.parametrize("no_number", [np.nan, np.inf])
def test_a_transfer_leaves_out_what_has_coordinates_that_are_no_numbers(no_number):
    vertices, faces = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (5, 0, 0), (6, 0, 0), (5, 1, 0)], [(0, 1, 2), (3, 4, 5)]
    sound = local_mesh(add_mesh("sound", vertices, faces).data)
    broken = local_mesh(add_mesh("broken", [(no_number, 0, 0), *vertices[1:]], faces).data)
    light = np.repeat([1.0, 2.0], 9).reshape(2, 3, 3)
    # The second triangle is the nearest that there is for all corners, however far.
    assert (nearest_corners(sound, broken, {"light": light})["light"] == 2.0).all()
    carried = nearest_corners(broken, sound, {"light": light})["light"]
    assert (carried[3:] == 2.0).all()
    assert np.isfinite(carried).all()


def test_a_transfer_keeps_to_the_side_that_the_corner_faces():
    plane = add_plane()
    modifier = plane.modifiers.new("Thick", "SOLIDIFY")
    modifier.thickness, modifier.offset = 0.02, 1.0
    bake(plane)
    assert colours_of(plane.data)[:, 2] == pytest.approx(np.full(4, 0.02), abs=1e-4)


def test_an_object_that_shares_its_mesh_gets_a_copy_of_its_own():
    first = add_cube("First")
    second = add_object("Second", first.data)
    second.location.x = 5.0
    mesh = first.data
    bake(first, second)
    assert first.data != second.data and mesh not in (first.data, second.data)
    assert len(mesh.color_attributes) == 0
    assert colours_of(first.data)[:, :3] == pytest.approx(corner_positions(first), abs=1e-6)
    assert colours_of(second.data)[:, :3] == pytest.approx(corner_positions(second), abs=1e-6)


def test_a_users_attribute_of_the_same_name_is_kept_aside():
    cube = add_cube()
    theirs = cube.data.color_attributes.new("Radiosity", "BYTE_COLOR", "POINT")
    theirs.data[0].color = (1.0, 0.0, 0.0, 1.0)
    bake(cube)
    assert cube.data.color_attributes["Radiosity"].data_type == "FLOAT_COLOR"
    (aside,) = (a for a in cube.data.color_attributes if a.data_type == "BYTE_COLOR")
    assert tuple(aside.data[0].color) == (1.0, 0.0, 0.0, 1.0)


def test_a_vertex_group_of_the_same_name_is_a_sentence_before_anything_is_done(capfd, quick_bake):
    cube = add_cube()
    cube.vertex_groups.new(name="Radiosity")
    with pytest.raises(RuntimeError, match='vertex group named "Radiosity"'):
        bake(cube)
    assert quick_bake == []
    assert len(cube.data.color_attributes) == 0
    assert cube.radiosity.kind == "NONE"
    assert "could not be created" not in "".join(capfd.readouterr())


@pytest.mark.parametrize("name", ["Radiosity", "Irradiance"])
def test_a_uv_map_of_the_same_name_is_kept_aside(name, capfd):
    cube = add_cube()
    cube.data.uv_layers.new(name=name)
    bake(cube)
    assert [layer.name for layer in cube.data.uv_layers] == [f"{name} (before bake)"]
    bpy.ops.radiosity.restore()
    assert [layer.name for layer in cube.data.uv_layers] == [name]
    assert "could not be created" not in "".join(capfd.readouterr())


def test_the_display_material_takes_all_slots_and_the_materials_are_kept():
    red, blue = diffuse_material("Red"), diffuse_material("Blue")
    cube = add_cube(materials=[red, blue])
    bake(cube)
    (material,) = {slot.material for slot in cube.material_slots}
    assert material not in (red, blue)
    assert (red.users, blue.users) == (1, 1)


def test_an_object_without_slots_gets_one():
    cube = add_cube()
    bake(cube)
    assert len(cube.material_slots) == 1


def test_baking_again_uses_the_own_materials_and_keeps_what_is_remembered(quick_bake):
    paint = diffuse_material(colour=(0.25, 0.5, 0.75, 1.0))
    cube = add_cube(materials=[paint])
    bake(cube)
    bake(cube)
    (mesh,) = quick_bake[-1][0].meshes
    assert mesh.reflectance[0] == pytest.approx([0.25, 0.5, 0.75])
    assert not np.any(mesh.emission)
    assert [slot.material for slot in cube.radiosity.slots] == [paint]
    assert sorted(a.name for a in cube.data.color_attributes) == ["Irradiance", "Radiosity"]


def test_values_of_the_back_are_removed_when_a_second_bake_has_none(run_instead):
    plane = add_plane()
    run_instead(partial(position_bake, back=True))
    bake(plane)
    assert "Radiosity Back" in plane.data.color_attributes
    run_instead(position_bake)
    bake(plane)
    assert "Radiosity Back" not in plane.data.color_attributes
    assert len([m for m in bpy.data.materials if "radiosity_display" in m]) == 1


def test_a_local_object_with_a_linked_mesh_gets_a_local_copy(tmp_path):
    add_cube("Linked")
    mesh = linked_from_library(tmp_path, "meshes", "Linked")
    cube = add_object("Local", mesh)
    bake(cube)
    assert cube.data.library is None
    assert colours_of(cube.data)[:, :3] == pytest.approx(corner_positions(cube), abs=1e-6)
    bpy.ops.radiosity.restore()
    assert cube.data == mesh
