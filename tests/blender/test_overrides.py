# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Library overrides: objects of another file that are changed in this one, and what is remembered of them."""

import bpy
import pytest

from tests.blender.making import (
    add_collection,
    add_cube,
    bake_selected,
    colours_of,
    corner_positions,
    diffuse_material,
    full_disk,
    linked_from_library,
    select_also,
)
from tests.blender.state import differences, file_state

pytestmark = pytest.mark.usefixtures("quick_bake")


@pytest.fixture
def overridden(tmp_path):
    """Return a function that links a cube from a library file and overrides it, with its mesh if asked."""

    def link(with_mesh=False):
        add_cube("Linked", materials=[diffuse_material("Paint")])
        cube = linked_from_library(tmp_path, "objects", "Linked").override_create()
        bpy.context.scene.collection.objects.link(cube)
        if with_mesh:
            cube.data = cube.data.override_create()
        select_also(cube)
        return cube

    return link


def saved_and_opened(tmp_path):
    """Save and open the file, and return the override again."""
    path = str(tmp_path / "room.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    return next(obj for obj in bpy.data.objects if obj.override_library is not None)


@pytest.mark.parametrize("with_mesh", [False, True])
def test_an_override_is_baked_in_place_on_a_mesh_of_its_own(overridden, with_mesh):
    cube = overridden(with_mesh)
    bake_selected("ORIGINAL")
    assert cube.data.library is None and cube.data.override_library is None
    assert colours_of(cube.data)[:, :3] == pytest.approx(corner_positions(cube), abs=1e-6)


@pytest.mark.parametrize("outputs", [("ORIGINAL",), ("REFINED",), ("ORIGINAL", "ORIGINAL"), ("REFINED", "ORIGINAL")])
@pytest.mark.parametrize("with_mesh", [False, True])
def test_a_baked_override_remembers_what_was_there_in_the_saved_file(overridden, tmp_path, outputs, with_mesh):
    overridden(with_mesh)
    for output in outputs:
        bake_selected(output)
    cube = saved_and_opened(tmp_path)
    assert cube.radiosity.kind == ("SOURCE" if outputs[-1] == "REFINED" else "ORIGINAL")
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert not cube.hide_render and not cube.hide_viewport
    assert cube.data.library is not None or cube.data.override_library is not None
    assert [slot.material.name for slot in cube.material_slots] == ["Paint"]
    assert cube.radiosity.kind == "NONE"
    cube = saved_and_opened(tmp_path)
    assert cube.radiosity.kind == "NONE" and not cube.hide_render
    assert [slot.material.name for slot in cube.material_slots] == ["Paint"]


def test_a_bake_of_an_override_that_cannot_be_stored_changes_nothing(overridden):
    overridden()
    before = file_state()
    with full_disk():
        bake_selected("ORIGINAL")
    assert differences(before, file_state()) == []


def test_an_overridden_collection_has_its_refined_objects_beside_it(tmp_path):
    add_cube("Linked", collection=add_collection("Parts"))
    parts = linked_from_library(tmp_path, "collections", "Parts")
    bpy.context.scene.collection.children.link(parts)
    parts.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer)
    cube = next(obj for obj in bpy.context.scene.objects if obj.override_library is not None)
    select_also(cube)
    before = file_state()
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    assert output.users_collection == (bpy.context.scene.collection,) and output.override_library is None
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    # Blender counts one user too many of what is overridden once an override was copied and removed.
    changed = differences(before, file_state())
    assert [change for change in changed if not change.startswith("/objects/Linked [library.blend]/users")] == []
    bake_selected("REFINED")
    cube = saved_and_opened(tmp_path)
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert {obj.name for obj in bpy.context.scene.objects} == {"Linked"} and not cube.hide_render
