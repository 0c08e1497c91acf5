# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever renders as faces is baked: text, curves, surfaces, metaballs, and the instances that an object makes."""

import bpy
import numpy as np
import pytest

from tests.blender.making import (
    add_cube,
    add_mesh,
    add_object,
    add_plane,
    bake_selected,
    colours_of,
    corner_positions,
    diffuse_material,
    report,
    select_also,
)
from tests.blender.state import differences, file_state

without_rays = pytest.mark.usefixtures("quick_bake")


def add_text(name="Text"):
    curve = bpy.data.curves.new(name, "FONT")
    curve.body, curve.extrude = "Ab", 0.1
    return add_object(name, curve)


def add_curve(name="Curve"):
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.1
    spline = curve.splines.new("POLY")
    spline.points.add(2)
    for point, place in zip(spline.points, [(0, 0, 0, 1), (1, 0, 0, 1), (2, 1, 0, 1)], strict=True):
        point.co = place
    return add_object(name, curve)


def add_surface(name="Surface"):
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()
    surface = bpy.context.object
    surface.name = name
    surface.select_set(False)
    return surface


def add_ball(name="Ball"):
    ball = bpy.data.metaballs.new(name)
    ball.elements.new()
    return add_object(name, ball)


def add_instancer(collection, name="Instancer"):
    instancer = add_object(name, None)
    instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
    return instancer


@pytest.fixture
def library():
    """Return a collection of a red leaf, turned and moved, and a blue box, which is in the scene only by instances."""
    collection = bpy.data.collections.new("Library")
    leaf = add_plane("Leaf", collection=collection, materials=[diffuse_material("Red", (0.8, 0.1, 0.1, 1.0))])
    leaf.location, leaf.rotation_euler, leaf.scale = (0.5, 0.2, 1.0), (0.3, 0.1, 0.2), (0.5, 1.0, -2.0)
    add_cube("Box", collection=collection, materials=[diffuse_material("Blue", (0.1, 0.1, 0.8, 1.0))])
    return collection


def shows_its_own_place(output):
    """Return whether the colours of a bake that writes positions are where they belong."""
    colours, places = colours_of(output.data)[:, :3], corner_positions(output)
    return len(places) > 0 and np.allclose(colours, places, atol=1e-5)


def front_normals(obj):
    """Return (f, 3) world normals of the faces as Blender shows them: turned over where the transform mirrors."""
    matrix = np.array(obj.matrix_world)[:3, :3]
    places = (np.array([obj.data.vertices[i].co for f in obj.data.polygons for i in f.vertices]) @ matrix.T).reshape(
        -1, 3, 3
    )
    cross = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    return cross / np.linalg.norm(cross, axis=1, keepdims=True) * np.sign(np.linalg.det(matrix))


@without_rays
@pytest.mark.parametrize("add", [add_text, add_curve, add_surface, add_ball])
def test_what_renders_as_a_mesh_gets_its_colours_in_a_refined_mesh_in_its_place(add):
    thing = add()
    thing.location, thing.rotation_euler, thing.scale = (1.0, 2.0, 3.0), (0.3, 0.4, 0.5), (1.0, 2.0, 0.5)
    thing.visible_camera, thing.pass_index = False, 7
    select_also(thing)
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    assert output.name == f"{thing.name} Radiosity" and output.type == "MESH"
    assert thing.hide_render and shows_its_own_place(output)
    assert not output.visible_camera and output.pass_index == 7
    np.testing.assert_allclose(output.matrix_world, thing.matrix_world, atol=1e-6)


@without_rays
@pytest.mark.parametrize("add", [add_text, add_curve, add_surface, add_ball])
def test_restore_brings_back_what_is_no_mesh_as_it_was(add):
    select_also(add())
    before = file_state()
    bake_selected("REFINED")
    bake_selected("REFINED")
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert differences(before, file_state()) == []


@without_rays
def test_a_refined_text_keeps_its_parent_constraints_and_animation():
    holder, text = add_cube("Holder"), add_text()
    text.parent = holder
    text.constraints.new("LIMIT_LOCATION").max_x = 0.5
    text.location.x = 0.25
    text.keyframe_insert("location", frame=1)
    text.location.x = 1.0
    text.keyframe_insert("location", frame=11)
    select_also(text)
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    assert output.parent == holder and output.constraints[0].max_x == 0.5
    bpy.context.scene.frame_set(11)
    assert output.location.x == 1.0


@without_rays
@pytest.mark.parametrize("add", [add_text, add_ball, lambda: add_instancer(bpy.data.collections["Library"])])
def test_what_has_no_mesh_of_its_own_says_that_refined_mesh_bakes_it(add, library):
    thing = add()
    select_also(thing)
    with pytest.raises(RuntimeError, match=f'"{thing.name}" has no mesh of its own; Refined Mesh bakes it'):
        bake_selected("ORIGINAL")


@without_rays
def test_a_metaball_of_a_family_is_baked_with_the_first_of_it():
    first, second = add_ball("Ball"), add_ball("Ball.001")
    second.location.x = 1.0
    select_also(second)
    bake_selected("REFINED")
    assert report()["objects"] == ["Ball Radiosity"]
    assert shows_its_own_place(bpy.data.objects["Ball Radiosity"]) and first.hide_render


@without_rays
def test_an_instancer_gets_its_instances_in_one_refined_mesh(library):
    instancer = add_instancer(library)
    instancer.location, instancer.scale, instancer.rotation_euler = (4.0, 0.0, 1.0), (1.0, -1.5, 1.0), (0.1, 0.2, 0.3)
    select_also(instancer)
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    assert output.name == "Instancer Radiosity" and shows_its_own_place(output)
    # Two triangles of the leaf and twelve of the box, each cut in two.
    assert len(output.data.polygons) == 28
    assert instancer.hide_render and instancer.hide_viewport
    assert report()["warnings"] == []


@without_rays
def test_the_faces_of_instances_keep_their_front(library, quick_bake):
    instancer = add_instancer(library)
    instancer.scale, instancer.rotation_euler = (1.0, -1.5, 1.0), (0.1, 0.2, 0.3)
    select_also(instancer)
    bake_selected("REFINED")
    expected = []
    for mesh in quick_bake[0][0].meshes:
        corners = mesh.vertices[mesh.triangles]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        # The bake cuts each triangle in two and lists the first halves of a mesh first.
        expected += 2 * [cross / np.linalg.norm(cross, axis=1, keepdims=True)]
    found = front_normals(bpy.context.selected_objects[0])
    np.testing.assert_allclose(found, np.concatenate(expected), atol=1e-4)


@without_rays
def test_materials_of_instances_get_a_slot_each(library):
    instancer = add_instancer(library)
    select_also(instancer)
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    slots = np.array([face.material_index for face in output.data.polygons])
    assert len(output.material_slots) == 2 and np.bincount(slots).tolist() in ([4, 24], [24, 4])


@without_rays
def test_layers_of_instances_are_kept_and_are_empty_where_an_instance_has_none(library):
    leaf, box = library.objects
    leaf.data.uv_layers.new(name="Map")
    leaf.data.attributes.new("Wetness", "FLOAT", "FACE").data[0].value = 0.75
    box.vertex_groups.new(name="Top").add([1, 3], 0.5, "REPLACE")
    select_also(add_instancer(library))
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    mesh = output.data
    wetness = sorted({item.value for item in mesh.attributes["Wetness"].data})
    assert wetness == [0.0, 0.75]
    wet = {polygon.index: mesh.attributes["Wetness"].data[polygon.index].value > 0 for polygon in mesh.polygons}
    uvs = np.array([tuple(item.uv) for item in mesh.uv_layers["Map"].data])
    wet_corners = np.array([wet[polygon.index] for polygon in mesh.polygons for _ in polygon.vertices])
    assert sum(wet.values()) == 4
    assert (uvs[~wet_corners] == 0.0).all() and uvs[wet_corners].max() == 1.0
    weights = [[group.weight for group in vertex.groups] for vertex in mesh.vertices]
    assert weights.count([0.5]) >= 2 and set(map(tuple, weights)) <= {(), (0.5,), (0.25,)}


@without_rays
def test_an_instancer_is_restored_and_baked_again(library):
    instancer = add_instancer(library)
    select_also(instancer)
    before = file_state()
    bake_selected("REFINED")
    bpy.context.selected_objects[0].location.x = 5.0
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    assert output.location.x == 5.0 and shows_its_own_place(output)
    output.location.x = 0.0
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert differences(before, file_state()) == []


@without_rays
def test_lamps_in_an_instanced_collection_are_said_to_be_hidden_with_it(library):
    library.objects.link(bpy.data.objects.new("Bulb", bpy.data.lights.new("Bulb", "POINT")))
    select_also(add_instancer(library))
    bake_selected("REFINED")
    (warning,) = report()["warnings"]
    assert 'lamps that "Instancer" instances' in warning


@without_rays
def test_a_mesh_with_vertex_instances_is_baked_with_them():
    ground, leaf = add_plane("Ground"), add_plane("Leaf")
    leaf.parent, ground.instance_type = ground, "VERTS"
    leaf.scale = (0.1, 0.1, 0.1)
    select_also(ground)
    bake_selected("REFINED")
    output = bpy.data.objects["Ground Radiosity"]
    assert len(output.data.polygons) == 2 * 2 * 5 and shows_its_own_place(output)


@without_rays
def test_a_mesh_with_instances_is_baked_alone_in_place_and_says_so():
    ground, leaf = add_plane("Ground"), add_plane("Leaf")
    leaf.parent, ground.instance_type = ground, "VERTS"
    select_also(ground)
    bake_selected("ORIGINAL")
    assert shows_its_own_place(ground)
    assert any('instances that "Ground" makes' in warning for warning in report()["warnings"])


@without_rays
def test_a_mesh_deformed_by_its_parent_is_not_deformed_twice():
    lattice = add_object("Lattice", bpy.data.lattices.new("Lattice"))
    cube = add_cube()
    cube.parent, cube.parent_type = lattice, "LATTICE"
    for point in lattice.data.points:
        point.co_deform = point.co * 2.0
    select_also(cube)
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    shown = output.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    assert len(shown.vertices) == len(output.data.vertices)
    for vertex, baked in zip(shown.vertices, output.data.vertices, strict=True):
        assert tuple(vertex.co) == pytest.approx(tuple(baked.co), abs=1e-5)
    assert max(vertex.co.x for vertex in output.data.vertices) > 1.2
    output.location.x = 5.0
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert cube.parent_type == "LATTICE" and cube.location.x == 5.0


@without_rays
def test_a_sheared_mesh_is_baked_where_it_is_seen():
    holder = add_object("Holder", None)
    holder.scale, cube = (1.0, 3.0, 1.0), add_cube()
    cube.parent, cube.rotation_euler = holder, (0.0, 0.0, 0.7)
    select_also(cube)
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    assert shows_its_own_place(output)
    np.testing.assert_allclose(output.matrix_world, cube.matrix_world, atol=1e-6)


@without_rays
def test_shape_keys_count_as_they_stand_at_the_current_frame():
    plane = add_plane()
    plane.shape_key_add(name="Basis")
    up = plane.shape_key_add(name="Up")
    for point in up.data:
        point.co.z = 2.0
    up.value = 0.0
    up.keyframe_insert("value", frame=1)
    up.value = 1.0
    up.keyframe_insert("value", frame=11)
    bpy.context.scene.frame_set(6)
    select_also(plane)
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    heights = corner_positions(output)[:, 2]
    assert heights == pytest.approx(up.value * 2.0, abs=1e-5) and 0.5 < heights[0] < 1.5


@without_rays
def test_an_armature_counts_in_its_pose():
    armature = add_object("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.data.edit_bones.new("Bone")
    bone.tail = (0.0, 0.0, 1.0)
    bpy.ops.object.mode_set(mode="OBJECT")
    plane = add_plane()
    plane.vertex_groups.new(name="Bone").add([0, 1, 2, 3], 1.0, "REPLACE")
    plane.modifiers.new("Armature", "ARMATURE").object = armature
    armature.pose.bones["Bone"].location = (0.0, 3.0, 0.0)
    select_also(plane)
    armature.select_set(False)
    bake_selected("REFINED")
    output = bpy.data.objects["Plane Radiosity"]
    assert corner_positions(output)[:, 2] == pytest.approx(3.0, abs=1e-5)
    assert shows_its_own_place(output)


@without_rays
def test_users_of_one_mesh_get_a_result_each():
    first = add_plane("First")
    second = add_object("Second", first.data)
    second.location.x = 3.0
    select_also(first, second)
    for output in ("REFINED", "ORIGINAL"):
        bake_selected(output)
        carriers = [bpy.data.objects[name] for name in report()["objects"]]
        assert len({carrier.data for carrier in carriers}) == 2
        assert all(shows_its_own_place(carrier) for carrier in carriers)


@without_rays
def test_hair_curves_point_clouds_and_volumes_are_left_out_by_name():
    add_object("Volume", bpy.data.volumes.new("Volume"))
    add_object("Fur", bpy.data.hair_curves.new("Fur"))
    select_also(add_mesh("Floor", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
    bake_selected("REFINED")
    (warning,) = report()["warnings"]
    assert '"Volume"' in warning and '"Fur"' in warning and "left out" in warning


@without_rays
def test_particle_hair_is_left_out_by_name():
    ground = add_plane("Ground")
    ground.modifiers.new("Grass", "PARTICLE_SYSTEM")
    settings = ground.particle_systems[0].settings
    settings.type, settings.count = "HAIR", 3
    select_also(ground)
    bake_selected("REFINED")
    (warning,) = report()["warnings"]
    assert 'hair of "Ground" was left out' in warning


@without_rays
def test_objects_that_particles_instance_are_baked_with_what_carries_the_particles():
    ground, leaf = add_plane("Ground"), add_plane("Leaf")
    ground.modifiers.new("Leaves", "PARTICLE_SYSTEM")
    settings = ground.particle_systems[0].settings
    settings.type, settings.count, settings.render_type, settings.instance_object = "HAIR", 5, "OBJECT", leaf
    select_also(ground)
    bake_selected("REFINED")
    output = bpy.data.objects["Ground Radiosity"]
    assert len(output.data.polygons) == 2 * 2 * (1 + 5) and shows_its_own_place(output)
    assert len(output.modifiers) == 0 and report()["warnings"] == []


@without_rays
@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_instances_that_would_show_the_light_of_another_place_are_named(output):
    parts = bpy.data.collections.new("Parts")
    bpy.context.scene.collection.children.link(parts)
    cube = add_cube(collection=parts, select=True)
    instancer = add_instancer(parts)
    instancer.location.x = 5.0
    bake_selected(output)
    (warning,) = report()["warnings"]
    assert 'instances of "Cube" that "Instancer" makes' in warning
    if output == "REFINED":
        select_also(cube, instancer)
        bake_selected(output)
        assert report()["warnings"] == []


@without_rays
def test_textured_materials_of_instances_are_those_of_each(library):
    bpy.context.scene.radiosity.material = "TEXTURED"
    select_also(add_instancer(library))
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    names = {output.material_slots[face.material_index].material.name for face in output.data.polygons}
    counted = [output.material_slots[face.material_index].material.name for face in output.data.polygons]
    red, blue = sorted(names, key=counted.count)
    assert (counted.count(red), counted.count(blue)) == (4, 24)
    assert "Red" in red and "Blue" in blue


@without_rays
def test_instances_without_a_material_stay_without_beside_others(library):
    bpy.context.scene.radiosity.material = "TEXTURED"
    library.objects["Box"].data.materials.clear()
    for face in library.objects["Box"].data.polygons:
        face.material_index = 3
    select_also(add_instancer(library))
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    counted = [output.material_slots[face.material_index].material.name for face in output.data.polygons]
    assert sum("Red" in name for name in counted) == 4 and len(counted) == 28


@without_rays
@pytest.mark.parametrize("add", [add_text, lambda: add_instancer(bpy.data.collections["Library"])])
def test_a_bake_of_what_is_no_mesh_is_one_step_of_undo(add, library):
    name = add().name
    select_also(bpy.data.objects[name])
    bpy.ops.ed.undo_push(message="Made")
    before = file_state()
    bake_selected("REFINED")
    bpy.ops.ed.undo_push(message="Bake")
    bpy.ops.ed.undo()
    assert differences(before, file_state()) == []
    bpy.ops.ed.redo()
    assert shows_its_own_place(bpy.data.objects[f"{name} Radiosity"])


def test_instances_get_the_light_that_objects_in_their_places_get(library):
    bpy.context.scene.radiosity.quality = "DRAFT"
    add_object("Sun", bpy.data.lights.new("Sun", "SUN")).rotation_euler = (0.5, 0.3, 0.0)
    instancer = add_instancer(library)
    select_also(instancer)
    bake_selected("REFINED")
    joined = bpy.data.objects["Instancer Radiosity"].data
    corners = colours_of(joined, "Irradiance")
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    bpy.data.objects.remove(instancer)
    bpy.context.scene.collection.children.link(library)
    select_also(*library.objects)
    bake_selected("REFINED")
    apart = [colours_of(bpy.data.objects[f"{name} Radiosity"].data, "Irradiance") for name in ("Box", "Leaf")]
    # The same arrays go to the same bake; joining them changes no value. The leaf is mirrored, and the faces of its own
    # object run the other way round.
    np.testing.assert_array_equal(*(np.sort(c.reshape(-1, 3, 4), axis=1) for c in (corners, np.concatenate(apart))))


@pytest.mark.parametrize("add", [add_text, add_surface])
def test_what_is_no_mesh_is_lit_as_the_mesh_that_it_converts_to(add):
    bpy.context.scene.radiosity.quality = "DRAFT"
    add_object("Sun", bpy.data.lights.new("Sun", "SUN")).rotation_euler = (0.5, 0.3, 0.0)
    thing = add()
    select_also(thing)
    bake_selected("REFINED")
    colours = colours_of(bpy.data.objects[f"{thing.name} Radiosity"].data, "Irradiance")
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    bpy.ops.object.convert(target="MESH")
    bake_selected("REFINED")
    np.testing.assert_array_equal(colours, colours_of(bpy.data.objects[f"{thing.name} Radiosity"].data, "Irradiance"))
