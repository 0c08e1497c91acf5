# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry as it renders: modifiers, parents, instances, mirrors and far places."""

import math

import bpy
import numpy as np
import pytest
from radiosity_bake.core.errors import NothingToBakeError
from radiosity_bake.operators.extraction import extract

from tests.blender.making import (
    add_collection,
    add_cube,
    add_mesh,
    add_object,
    add_plane,
    diffuse_material,
    emission_material,
    node_material,
    select_also,
    use_image,
)


def extracted(*objects):
    return extract(bpy.context, objects)


def the_mesh(extraction, name):
    (mesh,) = (mesh for mesh in extraction.scene.meshes if mesh.name == name)
    return mesh


def own_normals(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)


def area(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()


def test_a_cube_has_twelve_triangles_that_face_outwards():
    mesh = the_mesh(extracted(add_cube()), "Cube")
    assert mesh.triangles.shape == (12, 3)
    assert mesh.vertices.dtype == np.float64
    centres = mesh.vertices[mesh.triangles].mean(axis=1)
    assert np.all(np.einsum("ij,ij->i", own_normals(mesh), centres) > 0.0)


def test_flat_shading_gives_each_corner_the_normal_of_its_face():
    mesh = the_mesh(extracted(add_cube()), "Cube")
    assert mesh.corner_normals == pytest.approx(np.repeat(own_normals(mesh)[:, None], 3, axis=1), abs=1e-6)


def test_smooth_shading_gives_interpolated_corner_normals():
    cube = add_cube()
    cube.data.shade_smooth()
    mesh = the_mesh(extracted(cube), "Cube")
    corner_directions = mesh.vertices[mesh.triangles] / math.sqrt(3.0)
    assert np.einsum("tkj,tkj->tk", mesh.corner_normals, corner_directions).min() > 0.99


def test_modifiers_are_applied():
    cube = add_cube()
    cube.modifiers.new("Subdivision", "SUBSURF").levels = 1
    cube.modifiers["Subdivision"].render_levels = 1
    assert len(the_mesh(extracted(cube), "Cube").triangles) == 48


def test_modifiers_count_as_they_render_and_are_left_as_they_were():
    cube = add_cube()
    subdivision = cube.modifiers.new("Subdivision", "SUBSURF")
    subdivision.levels, subdivision.render_levels, subdivision.show_viewport = 0, 2, False
    assert len(the_mesh(extracted(cube), "Cube").triangles) == 192
    assert (subdivision.levels, subdivision.render_levels, subdivision.show_viewport) == (0, 2, False)


def test_curves_and_metaballs_have_the_resolution_of_renders_and_keep_their_own():
    ball = bpy.data.metaballs.new("Ball")
    ball.elements.new()
    ball.resolution, ball.render_resolution = 0.4, 0.1
    add_object("Ball", ball)
    curve = bpy.data.curves.new("Pipe", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.bevel_resolution = "3D", 0.1, 0
    for _ in range(2):
        spline = curve.splines.new("BEZIER")
        spline.bezier_points.add(1)
        spline.bezier_points[1].co = (1.0, 0.0, 0.0)
    curve.resolution_u, curve.render_resolution_u = 3, 20
    curve.splines[1].resolution_u = 7
    add_object("Pipe", curve)
    fine = extracted(add_cube())
    # Four sides around each of two splines, cut along into as many pieces as renders have, two triangles each.
    assert len(the_mesh(fine, "Pipe").triangles) == 2 * 4 * 20 * 2
    assert (curve.resolution_u, [spline.resolution_u for spline in curve.splines]) == (3, [3, 7])
    assert ball.resolution == pytest.approx(0.4)
    ball.render_resolution = 0.4
    rough = extracted(bpy.data.objects["Cube"])
    assert len(the_mesh(fine, "Ball").triangles) > 8 * len(the_mesh(rough, "Ball").triangles)


def test_a_screw_has_the_steps_of_renders_and_keeps_its_own():
    line = add_mesh("Line", [(1, 0, 0), (1, 0, 1)], [])
    line.data.edges.add(1)
    line.data.edges[0].vertices = (0, 1)
    screw = line.modifiers.new("Screw", "SCREW")
    screw.steps, screw.render_steps = 8, 32
    assert len(the_mesh(extracted(add_cube()), "Line").triangles) == 64
    assert screw.steps == 8


def test_children_of_particles_are_as_many_as_in_renders():
    ground, leaf = add_plane("Ground"), add_plane("Leaf")
    ground.modifiers.new("Leaves", "PARTICLE_SYSTEM")
    settings = ground.particle_systems[0].settings
    settings.type, settings.count, settings.render_type, settings.instance_object = "HAIR", 5, "OBJECT", leaf
    settings.child_type, settings.child_percent, settings.rendered_child_count = "SIMPLE", 2, 6
    names = [mesh.name for mesh in extracted(add_cube()).scene.meshes]
    assert names.count("Leaf") == 1 + 5 * 6
    assert settings.child_percent == 2


def test_a_parents_transform_is_included():
    parent = add_object("Parent", None)
    parent.location, parent.scale = (10.0, 0.0, 0.0), (2.0, 2.0, 2.0)
    plane = add_plane()
    plane.parent, plane.location = parent, (1.0, 0.0, 0.0)
    mesh = the_mesh(extracted(plane), "Plane")
    assert mesh.vertices.min(axis=0) == pytest.approx([10.0, -2.0, 0.0])
    assert mesh.vertices.max(axis=0) == pytest.approx([14.0, 2.0, 0.0])


@pytest.mark.parametrize("scale", [(-1.0, 1.0, 1.0), (-1.0, -2.0, -3.0), (1.0, 1.0, -0.5)])
def test_a_mirrored_object_keeps_its_front_outside(scale):
    cube = add_cube()
    cube.scale, cube.rotation_euler = scale, (0.3, 0.4, 0.5)
    mesh = the_mesh(extracted(cube), "Cube")
    centres = mesh.vertices[mesh.triangles].mean(axis=1)
    assert np.all(np.einsum("ij,ij->i", own_normals(mesh), centres) > 0.0)
    assert np.einsum("tj,tkj->tk", own_normals(mesh), mesh.corner_normals).min() > 1.0 - 1e-5


def test_normals_stay_perpendicular_under_uneven_scale():
    cube = add_cube()
    cube.scale, cube.rotation_euler = (5.0, 1.0, 0.1), (0.5, 0.1, 0.9)
    mesh = the_mesh(extracted(cube), "Cube")
    assert np.einsum("tj,tkj->tk", own_normals(mesh), mesh.corner_normals).min() > 1.0 - 1e-5


def test_a_flattened_object_is_read_without_failing():
    cube = add_cube()
    cube.scale.z = 0.0
    mesh = the_mesh(extracted(cube), "Cube")
    assert np.all(np.isfinite(mesh.corner_normals))
    assert area(mesh) == pytest.approx(8.0)


def test_far_from_the_origin_nothing_is_rounded():
    plane = add_plane()
    plane.data.vertices[0].co.x = -1.0001
    plane.location.x = 65536.0
    mesh = the_mesh(extracted(plane), "Plane")
    # In single precision, coordinates of this size are 1/128 apart.
    assert mesh.vertices[:, 0].min() - 65536.0 == pytest.approx(-1.0001, abs=1e-6)


def test_materials_are_read_for_each_face():
    red, blue = diffuse_material("Red", (0.9, 0.1, 0.1, 1.0)), diffuse_material("Blue", (0.1, 0.1, 0.9, 1.0))
    cube = add_cube(materials=[red, blue])
    cube.data.polygons[5].material_index = 1
    mesh = the_mesh(extracted(cube), "Cube")
    top = own_normals(mesh)[:, 2] > 0.9
    assert mesh.reflectance[top] == pytest.approx(np.broadcast_to((0.1, 0.1, 0.9), (2, 3)))
    assert mesh.reflectance[~top] == pytest.approx(np.broadcast_to((0.9, 0.1, 0.1), (10, 3)))


def test_a_slot_of_the_object_overrides_the_one_of_the_mesh():
    plane = add_plane(materials=[diffuse_material("Mesh's", (0.1, 0.1, 0.1, 1.0))])
    plane.material_slots[0].link = "OBJECT"
    plane.material_slots[0].material = diffuse_material("Object's", (0.7, 0.7, 0.7, 1.0))
    assert the_mesh(extracted(plane), "Plane").reflectance[0] == pytest.approx([0.7, 0.7, 0.7])


def test_an_empty_slot_of_the_object_is_grey_whatever_the_mesh_has():
    cube = add_cube(materials=[diffuse_material("Of Mesh", (0.9, 0.9, 0.1, 1.0))])
    cube.material_slots[0].link = "OBJECT"
    mesh = the_mesh(extracted(cube), "Cube")
    own = mesh.reflectance if mesh.own_reflectance is None else mesh.own_reflectance
    assert own == pytest.approx(np.full((12, 3), 0.8))


def test_the_material_override_of_the_view_layer_counts_for_all_faces():
    cube = add_cube(materials=[diffuse_material("A"), emission_material()])
    cube.data.polygons[5].material_index = 1
    bpy.context.view_layer.material_override = diffuse_material("Clay", (0.5, 0.5, 0.5, 1.0))
    mesh = the_mesh(extracted(cube), "Cube")
    assert mesh.reflectance == pytest.approx(np.full((12, 3), 0.5)) and not mesh.emission.any()


def test_an_empty_slot_and_no_slot_are_grey():
    for name, materials in (("A", [None]), ("B", [])):
        mesh = the_mesh(extracted(add_plane(name, materials=materials)), name)
        # From Blender 5 on it is the grey of a Principled BSDF, with its gloss, which others get.
        glossy = bpy.app.version >= (5, 0, 0)
        assert (mesh.own_reflectance if glossy else mesh.reflectance)[0] == pytest.approx([0.8] * 3)
        assert (mesh.reflectance[0] > 0.8).all() == glossy


def test_a_face_whose_slot_does_not_exist_takes_the_last_one():
    plane = add_plane(materials=[diffuse_material("A"), diffuse_material("B", (0.5, 0.5, 0.5, 1.0))])
    plane.data.polygons[0].material_index = 9
    assert the_mesh(extracted(plane), "Plane").reflectance[0] == pytest.approx([0.5] * 3)


def test_unselected_meshes_take_part_unbaked():
    baked, other = add_cube("Baked"), add_plane("Other", materials=[emission_material(strength=3.0)])
    extraction = extracted(baked)
    assert the_mesh(extraction, "Baked").baked
    assert not the_mesh(extraction, "Other").baked
    assert the_mesh(extraction, "Other").emission[0] == pytest.approx([3.0] * 3)
    assert other.name == "Other"


def test_objects_hidden_in_renders_do_not_take_part():
    plane, hidden = add_plane(), add_cube("Hidden")
    hidden.hide_render = True
    assert [mesh.name for mesh in extracted(plane).scene.meshes] == ["Plane"]


@pytest.mark.parametrize("how", ["hide_render", "exclude", "parent_hide_render"])
def test_objects_of_collections_that_do_not_render_do_not_take_part(how):
    outer = add_collection("Outer")
    inner = add_collection("Inner", parent=outer)
    add_cube("Inside", collection=inner)
    layer_collection = bpy.context.view_layer.layer_collection.children["Outer"].children["Inner"]
    if how == "hide_render":
        inner.hide_render = True
    elif how == "exclude":
        layer_collection.exclude = True
    else:
        outer.hide_render = True
    assert [mesh.name for mesh in extracted(add_plane()).scene.meshes] == ["Plane"]


def test_an_object_renders_when_one_of_its_collections_does():
    hidden = add_collection("Hidden")
    hidden.hide_render = True
    cube = add_cube("Both", collection=hidden)
    bpy.context.scene.collection.objects.link(cube)
    assert {mesh.name for mesh in extracted(add_plane()).scene.meshes} == {"Both", "Plane"}


@pytest.mark.parametrize("how", ["monitor", "eye", "collection_monitor", "collection_eye"])
def test_objects_hidden_in_the_viewport_only_take_part_and_stay_hidden(how):
    collection = add_collection("Collection")
    cube, plane = add_cube(collection=collection), add_plane()
    layer_collection = bpy.context.view_layer.layer_collection.children["Collection"]
    if how == "monitor":
        cube.hide_viewport = True
    elif how == "eye":
        cube.hide_set(True)
    elif how == "collection_monitor":
        collection.hide_viewport = True
    else:
        layer_collection.hide_viewport = True
    state = (cube.hide_viewport, cube.hide_get(), collection.hide_viewport, layer_collection.hide_viewport)
    assert {mesh.name for mesh in extracted(plane).scene.meshes} == {"Cube", "Plane"}
    assert state == (cube.hide_viewport, cube.hide_get(), collection.hide_viewport, layer_collection.hide_viewport)
    assert not cube.visible_get()


def test_the_background_scene_takes_part_and_stays_as_it_is():
    cube = add_cube("Front")
    behind = bpy.data.scenes.new("Behind")
    box, unseen = (bpy.data.objects.new(name, cube.data) for name in ("Box", "Unseen"))
    for obj in (box, unseen):
        behind.collection.objects.link(obj)
    unseen.hide_render = True
    box.hide_set(True, view_layer=behind.view_layers[0])
    bpy.context.scene.background_set = behind
    names = sorted(mesh.name for mesh in extracted(cube).scene.meshes)
    assert names == ["Box", "Front"] and box.hide_get(view_layer=behind.view_layers[0])


def collection_instance(collection, name="Instance"):
    instance = add_object(name, None)
    instance.instance_type, instance.instance_collection = "COLLECTION", collection
    return instance


def test_instances_of_a_collection_take_part_where_they_stand():
    library = bpy.data.collections.new("Library")
    add_plane("Leaf", collection=library)
    collection_instance(library, "A").location.x = 10.0
    collection_instance(library, "B").location.x = 20.0
    meshes = [mesh for mesh in extracted(add_cube()).scene.meshes if mesh.name == "Leaf"]
    assert sorted(mesh.vertices[:, 0].mean() for mesh in meshes) == pytest.approx([10.0, 20.0])


def test_instances_of_a_baked_object_take_part_unbaked():
    collection = add_collection("Collection")
    plane = add_plane(collection=collection)
    collection_instance(collection).location.x = 10.0
    meshes = extracted(plane).scene.meshes
    assert sorted((mesh.vertices[:, 0].mean(), mesh.baked) for mesh in meshes) == [(0.0, True), (10.0, False)]


def test_members_of_an_instanced_collection_take_part_if_they_render():
    library = bpy.data.collections.new("Library")
    add_plane("Shown", collection=library)
    add_plane("Hidden", collection=library).hide_render = True
    add_plane("Monitor", collection=library).hide_viewport = True
    inner = bpy.data.collections.new("Inner")
    library.children.link(inner)
    inner.hide_render = True
    add_plane("Inner", collection=inner)
    collection_instance(library)
    assert {mesh.name for mesh in extracted(add_cube()).scene.meshes} == {"Cube", "Shown", "Monitor"}


def test_a_hidden_instancer_hides_its_instances():
    library = bpy.data.collections.new("Library")
    add_plane("Leaf", collection=library)
    collection_instance(library).hide_render = True
    assert {mesh.name for mesh in extracted(add_cube()).scene.meshes} == {"Cube"}


def scattering_nodes(instanced):
    """Return a geometry node group that keeps its mesh and puts an instance of an object on every vertex."""
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    nodes, links = tree.nodes, tree.links
    group_input, group_output = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    points, join = nodes.new("GeometryNodeInstanceOnPoints"), nodes.new("GeometryNodeJoinGeometry")
    links.new(group_input.outputs[0], points.inputs["Points"])
    if instanced is None:
        cube = nodes.new("GeometryNodeMeshCube")
        links.new(cube.outputs[0], points.inputs["Instance"])
    else:
        info = nodes.new("GeometryNodeObjectInfo")
        info.inputs["Object"].default_value = instanced
        info.inputs["As Instance"].default_value = True
        links.new(info.outputs["Geometry"], points.inputs["Instance"])
    links.new(group_input.outputs[0], join.inputs[0])
    links.new(points.outputs[0], join.inputs[0])
    links.new(join.outputs[0], group_output.inputs[0])
    return tree


@pytest.mark.parametrize("made_of", ["object", "mesh primitive"])
def test_instances_of_geometry_nodes_take_part(made_of):
    leaf = add_plane("Leaf") if made_of == "object" else None
    ground = add_plane("Ground")
    ground.modifiers.new("Scatter", "NODES").node_group = scattering_nodes(leaf)
    for output, baked in (("REFINED", 5), ("ORIGINAL", 1)):
        extraction = extract(bpy.context, [ground], output)
        assert [mesh.baked for mesh in extraction.scene.meshes].count(True) == baked
        assert len(extraction.scene.meshes) == (6 if leaf else 5)
        assert len(extraction.targets) == 1


@pytest.mark.parametrize(("kind", "instances"), [("VERTS", 4), ("FACES", 1)])
def test_what_is_instanced_on_vertices_or_faces_does_not_take_part_itself_as_in_cycles(kind, instances):
    ground, leaf = add_plane("Ground"), add_plane("Leaf")
    leaf.parent, ground.instance_type = ground, kind
    assert [mesh.name for mesh in extracted(ground).scene.meshes].count("Leaf") == instances
    ground.hide_render = True
    assert [mesh.name for mesh in extracted(add_cube()).scene.meshes] == ["Cube"]


def test_a_shadow_of_what_is_instanced_on_vertices_is_where_cycles_throws_it(monkeypatch):
    from tests.blender import test_lamps

    # The question is whether there is a shadow, which few samples of a sun tell.
    monkeypatch.setattr(test_lamps, "SAMPLES", 4)
    floor = test_lamps.add_room()
    bpy.data.objects.remove(bpy.data.objects["Board"])
    test_lamps.add_lamp("SUN", energy=3.0, angle=0.0)
    ground, box = add_plane("Ground"), add_cube("Box")
    for vertex in ground.data.vertices:
        # The shadow's edges fall between the floor's vertices, which are 0.2 apart.
        vertex.co.x = vertex.co.y = 0.5
    box.parent, ground.instance_type = ground, "VERTS"
    box.scale, box.location = (0.25, 0.25, 0.25), (0.0, 0.0, 1.0)
    ground.show_instancer_for_render = False
    select_also(floor)
    dark = [test_lamps.by_cycles(floor) < 0.5, test_lamps.by_us(floor) < 0.5]
    assert 4 <= dark[0].sum() <= 25
    np.testing.assert_array_equal(*dark)


@pytest.mark.parametrize("in_render", [True, False])
def test_an_instancer_is_itself_there_as_it_renders_whatever_the_viewport_shows(in_render):
    ground, leaf = add_plane("Ground"), add_plane("Leaf")
    leaf.parent, ground.instance_type = ground, "FACES"
    ground.show_instancer_for_render, ground.show_instancer_for_viewport = in_render, not in_render
    names = [mesh.name for mesh in extracted(add_cube()).scene.meshes]
    assert names.count("Ground") == in_render and names.count("Leaf") == 1
    assert ground.show_instancer_for_viewport is not in_render


def test_text_curves_and_metaballs_take_part_as_the_meshes_they_render():
    text = bpy.data.curves.new("Text", "FONT")
    text.body = "A"
    add_object("Text", text)
    ball = bpy.data.metaballs.new("Ball")
    ball.elements.new()
    add_object("Ball", ball)
    meshes = extracted(add_cube()).scene.meshes
    assert sorted(mesh.name for mesh in meshes) == ["Ball", "Cube", "Text"]
    assert all(len(mesh.triangles) for mesh in meshes)


def test_materials_that_blender_evaluates_are_named_once_with_their_objects():
    wood = node_material("Wood", "ShaderNodeBsdfPrincipled")
    use_image(wood)
    extraction = extracted(add_cube("Table", materials=[wood]), add_plane("Chair", materials=[wood]))
    assert extraction.evaluated == ('Material "Wood" of "Chair", "Table": Image Texture',)
    assert extraction.warnings == ()


def test_the_order_of_the_meshes_does_not_depend_on_when_they_were_made():
    for name in ("C", "A", "B"):
        add_plane(name)
    assert [mesh.name for mesh in extracted(bpy.data.objects["B"]).scene.meshes] == ["A", "B", "C"]


def test_a_mesh_without_faces_is_skipped_with_a_warning_beside_others():
    empty = add_mesh("Points", [(0, 0, 0)], [])
    (warning,) = extracted(empty, add_cube()).warnings
    assert '"Points"' in warning and "no faces" in warning


def test_only_meshes_without_faces_is_an_error_that_names_them():
    with pytest.raises(NothingToBakeError, match=r'"Points" .*no faces'):
        extracted(add_mesh("Points", [(0, 0, 0)], []))


def test_what_is_no_mesh_is_named_when_nothing_else_is_selected():
    with pytest.raises(NothingToBakeError, match='"Empty" is not a mesh'):
        extracted(add_object("Empty", None))


def test_copies_of_a_material_are_named_in_one_sentence():
    for number in range(5):
        paint = node_material(f"Paint {number}", "ShaderNodeBsdfDiffuse", Color=(0.5, 0.5, 0.5, 1.0))
        bump = paint.node_tree.nodes.new("ShaderNodeBump")
        paint.node_tree.links.new(bump.outputs["Normal"], paint.node_tree.nodes["Diffuse BSDF"].inputs["Normal"])
        add_cube(f"Cube {number}", materials=[paint])
    (warning,) = extracted(bpy.data.objects["Cube 0"]).warnings
    assert warning == (
        'Materials "Paint 0", "Paint 1", "Paint 2" and 2 more of "Cube 0", "Cube 1", "Cube 2" and 2 more: '
        "its bump is left out; the mesh's own normals count"
    )


def test_a_selected_object_that_does_not_render_is_named():
    cube, hidden = add_cube(), add_plane("Hidden")
    hidden.hide_render = True
    (warning,) = extracted(cube, hidden).warnings
    assert '"Hidden"' in warning and "renders" in warning


def test_what_is_transparent_all_over_is_not_baked_and_hides_nothing():
    air = node_material("Air", "ShaderNodeBsdfTransparent")
    extraction = extracted(add_cube("Glass", materials=[air]), add_plane("Floor"))
    assert [target.name for target in extraction.targets] == ["Floor"]
    assert extraction.warnings == ('"Glass" was skipped: it is transparent all over',)
    glass = next(mesh for mesh in extraction.scene.meshes if mesh.name == "Glass")
    assert glass.clear.all() and not glass.baked


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_numbers_that_are_none_go_on_without_a_word_on_the_console():
    broken, turned = add_cube("broken"), add_cube("turned")
    broken.data.vertices[0].co.x = math.inf
    turned.matrix_world[0][0] = math.nan
    light = bpy.data.lights.new("endless", "POINT")
    light.energy, light.color = math.inf, (1.0, 0.0, 1.0)
    add_object("endless", light)
    assert {mesh.name for mesh in extracted(broken, turned).scene.meshes} == {"broken", "turned"}
