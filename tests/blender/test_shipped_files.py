# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The .blend files that ship with Blender: what has faces in them is baked, and comes back as it was."""

from pathlib import Path

import bpy
import numpy as np
import pytest
from radiosity_bake.operators.targets import shows_surfaces

from tests.blender.making import add_cube, add_object, add_plane, bake_selected, colours_of, report, select_also
from tests.blender.state import differences, file_state

FOLDER = Path(bpy.utils.resource_path("LOCAL"))
FILES = sorted(FOLDER.rglob("*.blend"))


def name_of(path):
    return str(path.relative_to(FOLDER))


def opened(path):
    """Open a file and return what has faces in it, in object mode, in light."""
    bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    things = [obj for obj in bpy.context.view_layer.objects if shows_surfaces(obj) and not obj.hide_render]
    if things and not any(obj.type == "LIGHT" for obj in bpy.context.scene.objects):
        light = bpy.data.lights.new("Sun", "SUN")
        add_object("Sun", light)
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in things)
    return things


def check_bakes(things):
    bpy.context.scene.radiosity.quality = "DRAFT"
    before = file_state()
    for output in ("REFINED", "ORIGINAL"):
        bake_selected(output)
        baked = [bpy.data.objects[name] for name in report()["objects"]]
        assert len(baked) == len(things)
        for obj in baked:
            colours = colours_of(obj.data)
            assert np.isfinite(colours).all() and colours[:, :3].max() > 0.0
        assert bpy.ops.radiosity.restore() == {"FINISHED"}
        assert differences(before, file_state()) == []


@pytest.mark.skipif(bool(bpy.app.binary_path), reason="a distribution may package Blender without them")
def test_the_files_are_found():
    assert FILES


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_what_has_faces_in_a_shipped_file_is_baked_and_restored(path):
    things = opened(path)
    if things:
        check_bakes(things)


def test_the_default_scene_is_baked_and_restored():
    bpy.ops.wm.read_factory_settings(use_empty=False)
    select_also(bpy.data.objects["Cube"])
    check_bakes([bpy.data.objects["Cube"]])


def assets_of(path):
    """Return the names of the geometry node groups in a file that are meant for meshes."""
    with bpy.data.libraries.load(str(path)) as (there, wanted):
        wanted.node_groups = list(there.node_groups)
    return sorted(
        group.name
        for group in wanted.node_groups
        if group.bl_idname == "GeometryNodeTree" and group.asset_data is not None and is_for_meshes(group)
    )


def is_for_meshes(group):
    sockets = [item for item in group.interface.items_tree if item.item_type == "SOCKET"]
    geometry = {item.in_out for item in sockets if item.socket_type == "NodeSocketGeometry"}
    return group.is_modifier and geometry == {"INPUT", "OUTPUT"}


@pytest.mark.usefixtures("quick_bake")
@pytest.mark.parametrize("path", [path for path in FILES if "node" in path.parent.name], ids=name_of)
def test_node_groups_that_ship_with_blender_are_read_as_modifiers(path):
    # Some of them need other objects or curves and then give no faces: that is said, and is no failure.
    for name in assets_of(path):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        with bpy.data.libraries.load(str(path)) as (_, wanted):
            wanted.node_groups = [name]
        plane = add_plane()
        plane.modifiers.new("Asset", "NODES").node_group = bpy.data.node_groups[name]
        select_also(add_cube(), plane)
        before = file_state()
        bake_selected("REFINED")
        assert report()["objects"][0] == "Cube Radiosity"
        said = " ".join(report()["warnings"])
        assert len(report()["objects"]) == 2 or '"Plane"' in said, name
        bpy.ops.radiosity.restore()
        assert differences(before, file_state()) == [], name
