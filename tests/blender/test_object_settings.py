# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist sets for one object, and its ray visibility."""

from pathlib import Path

import bpy
import numpy as np
import pytest
import radiosity_bake
from radiosity_bake.operators.extraction import extract

from tests.blender.making import (
    add_collection,
    add_cube,
    add_lamp_mesh,
    add_object,
    add_plane,
    bake_selected,
    colours_of,
    diffuse_material,
    emission_material,
    linked_from_library,
    report,
    select_also,
)

SETTINGS = ("use_reflectance", "reflectance", "emits", "receives", "casts")


def mesh_of(name, *wanted):
    """Return what the bake of `wanted`, or of that object, is given of the object called `name`."""
    scene = extract(bpy.context, wanted or [bpy.data.objects[name]]).scene
    (mesh,) = (mesh for mesh in scene.meshes if mesh.name == name)
    return mesh


def test_by_default_nothing_is_changed():
    add_plane(materials=[emission_material(strength=2.0)])
    mesh = mesh_of("Plane")
    assert mesh.seen and mesh.shadow and mesh.baked
    assert mesh.emission[0] == pytest.approx([2.0] * 3)


def test_the_reflectance_can_be_overridden():
    settings = add_plane(materials=[diffuse_material()]).radiosity_settings
    settings.reflectance = (0.1, 0.2, 0.3)
    assert mesh_of("Plane").reflectance[0] == pytest.approx([0.2, 0.4, 0.6])
    settings.use_reflectance = True
    assert mesh_of("Plane").reflectance == pytest.approx(np.array([[0.1, 0.2, 0.3]] * 2))


@pytest.mark.parametrize(
    ("change", "seen", "shadow"),
    [
        ({"visible_diffuse": False}, False, True),
        ({"visible_shadow": False}, True, False),
        ({"visible_camera": False}, True, True),
        ({"visible_glossy": False}, True, True),
        ({"is_shadow_catcher": True}, True, True),
        ({"is_holdout": True}, True, True),
    ],
)
def test_ray_visibility_means_what_it_means_in_cycles(change, seen, shadow):
    plane = add_plane(materials=[emission_material()])
    for name, value in change.items():
        setattr(plane, name, value)
    mesh = mesh_of("Plane")
    assert (mesh.seen, mesh.shadow, bool(mesh.emission.any())) == (seen, shadow, seen)


@pytest.mark.parametrize("flag", ["holdout", "indirect_only"])
def test_collections_that_the_camera_alone_does_not_see_take_part(flag):
    add_plane("Inside", collection=add_collection("Some"))
    setattr(bpy.context.view_layer.layer_collection.children["Some"], flag, True)
    mesh = mesh_of("Inside", add_cube())
    assert mesh.seen and mesh.shadow


def test_what_casts_nothing_is_met_by_no_ray():
    add_plane().radiosity_settings.casts = False
    mesh = mesh_of("Plane")
    assert not mesh.seen and not mesh.shadow and mesh.baked


def test_what_does_not_receive_takes_part_unbaked_and_is_named():
    cube, plane = add_cube(), add_plane()
    plane.radiosity_settings.receives = False
    select_also(cube, plane)
    extraction = extract(bpy.context, [cube, plane])
    assert [target.name for target in extraction.targets] == ["Cube"]
    assert {mesh.name for mesh in extraction.scene.meshes} == {"Cube", "Plane"}
    (warning,) = extraction.warnings
    assert '"Plane"' in warning and "does not receive" in warning


@pytest.mark.usefixtures("quick_bake")
@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_what_does_not_emit_glows_and_lights_nothing(output, quick_bake):
    shade = add_plane("Shade", materials=[emission_material(strength=3.0)])
    shade.radiosity_settings.emits = False
    select_also(shade)
    bake_selected(output)
    (scene, _), *_ = quick_bake
    assert not scene.meshes[0].emission.any()
    (name,) = report()["objects"]
    mesh = bpy.data.objects[name].data
    # The bake that tests use gives irradiance the half of radiosity, and no emission to either.
    glow = colours_of(mesh)[:, :3] - 2.0 * colours_of(mesh, "Irradiance")[:, :3]
    assert glow == pytest.approx(3.0, abs=1e-6)


def test_settings_of_an_instancer_and_of_what_it_instances_both_count():
    library = bpy.data.collections.new("Library")
    leaf = add_plane("Leaf", collection=library)
    instancer = add_object("Instancer", None)
    instancer.instance_type, instancer.instance_collection = "COLLECTION", library
    cube = add_cube()
    assert mesh_of("Leaf", cube).shadow
    instancer.visible_shadow = False
    leaf.radiosity_settings.use_reflectance = True
    leaf.radiosity_settings.reflectance = (0.1, 0.1, 0.1)
    mesh = mesh_of("Leaf", cube)
    assert mesh.seen and not mesh.shadow and mesh.reflectance[0] == pytest.approx([0.1] * 3)
    instancer.radiosity_settings.casts = False
    assert not mesh_of("Leaf", cube).seen


def test_lamps_of_an_instancer_that_diffuse_rays_do_not_see_give_no_light():
    library = bpy.data.collections.new("Library")
    library.objects.link(bpy.data.objects.new("Bulb", bpy.data.lights.new("Bulb", "POINT")))
    instancer = add_object("Instancer", None)
    instancer.instance_type, instancer.instance_collection = "COLLECTION", library
    assert len(extract(bpy.context, [add_cube()]).scene.lamps) == 1
    instancer.visible_diffuse = False
    assert extract(bpy.context, [bpy.data.objects["Cube"]]).scene.lamps == ()


@pytest.mark.usefixtures("quick_bake")
def test_instances_that_do_not_receive_are_named():
    library = bpy.data.collections.new("Library")
    add_plane("Leaf", collection=library).radiosity_settings.receives = False
    add_cube("Box", collection=library)
    instancer = add_object("Instancer", None, select=True)
    instancer.instance_type, instancer.instance_collection = "COLLECTION", library
    bake_selected("REFINED")
    (warning,) = report()["warnings"]
    assert '"Leaf"' in warning and '"Instancer"' in warning


@pytest.mark.usefixtures("quick_bake")
def test_settings_outlive_bake_and_restore():
    cube = add_cube(select=True)
    cube.radiosity_settings.casts = False
    bake_selected("REFINED")
    bake_selected("ORIGINAL")
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert not cube.radiosity_settings.casts


def test_settings_are_kept_in_the_file(tmp_path):
    settings = add_cube().radiosity_settings
    settings.use_reflectance, settings.reflectance = True, (0.25, 0.5, 0.75)
    settings.emits = settings.receives = settings.casts = False
    path = str(tmp_path / "room.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    settings = bpy.data.objects["Cube"].radiosity_settings
    assert settings.use_reflectance and tuple(settings.reflectance) == (0.25, 0.5, 0.75)
    assert not (settings.emits or settings.receives or settings.casts)


def test_settings_of_an_override_are_kept_in_the_file_however_often_it_is_saved(tmp_path):
    add_cube("Linked")
    cube = linked_from_library(tmp_path, "objects", "Linked").override_create()
    bpy.context.scene.collection.objects.link(cube)
    cube.radiosity_settings.casts = False
    path = str(tmp_path / "room.blend")
    for _ in range(3):
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
        (cube,) = (obj for obj in bpy.data.objects if obj.override_library is not None)
        assert not cube.radiosity_settings.casts and cube.radiosity_settings.receives


@pytest.mark.parametrize("name", SETTINGS)
def test_every_setting_has_a_tooltip_and_stands_in_the_guide(name):
    item = add_cube().radiosity_settings.bl_rna.properties[name]
    assert len(item.description) > 20 and not item.description.endswith(".")
    guide = (Path(__file__).parents[2] / "docs" / "guide.md").read_text(encoding="utf-8")
    assert f"`{name}`" in guide


def test_both_panels_show_the_settings_of_what_has_faces():
    add_lamp_mesh()
    for panel in (bpy.types.VIEW3D_PT_radiosity_object, bpy.types.OBJECT_PT_radiosity):
        bpy.context.view_layer.objects.active = add_cube()
        assert panel.poll(bpy.context)
        bpy.context.view_layer.objects.active = add_object("Empty", None)
        assert not panel.poll(bpy.context)


def test_unregistering_takes_the_settings_with_it():
    radiosity_bake.unregister()
    try:
        assert not hasattr(bpy.types.Object, "radiosity_settings")
    finally:
        radiosity_bake.register()
