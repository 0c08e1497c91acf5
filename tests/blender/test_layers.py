# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""UV maps, vertex groups, marks and attributes of the original on its refined mesh."""

import bpy
import numpy as np
import pytest

from tests.blender.making import add_cube, add_plane, bake_selected, corner_positions, select_also

pytestmark = pytest.mark.usefixtures("quick_bake")


def refined(obj):
    select_also(obj)
    bake_selected("REFINED")
    return bpy.data.objects[f"{obj.name} Radiosity"]


def positions(mesh, domain):
    """Return (n, 3) the places of the elements of a domain."""
    vertices = np.array([vertex.co for vertex in mesh.vertices])
    if domain == "POINT":
        return vertices
    if domain == "CORNER":
        return vertices[[loop.vertex_index for loop in mesh.loops]]
    if domain == "EDGE":
        return np.array([vertices[list(edge.vertices)].mean(axis=0) for edge in mesh.edges])
    return np.array([polygon.normal for polygon in mesh.polygons])


def values_of(attribute):
    name = next(name for name in ("vector", "color", "value") if hasattr(attribute.data[0], name))
    return np.array([np.array(getattr(item, name)) for item in attribute.data])


def edges_by_place(mesh, marked):
    """Return which of a cube's edges have a mark on them, each as its two fixed coordinates and 0 for the other."""
    ends = np.array([[mesh.vertices[v].co[:] for v in edge.vertices] for edge in mesh.edges])
    return {tuple(np.where(a == b, a, 0.0).tolist()) for (a, b), yes in zip(ends, marked, strict=True) if yes}


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-1.0, 2.0, 1.0)])
@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
@pytest.mark.parametrize(
    ("data_type", "width"), [("FLOAT", 1), ("FLOAT2", 2), ("FLOAT_VECTOR", 3), ("FLOAT_COLOR", 4), ("BYTE_COLOR", 4)]
)
def test_values_that_vary_linearly_are_linear_on_the_refined_mesh(scale, domain, data_type, width):
    cube = add_cube()
    cube.scale = scale
    attribute = cube.data.attributes.new("Mine", data_type, domain)

    def value(places):
        return (0.5 + 0.25 * places @ np.array([[1.0, 0, 0, 1], [0, 1, 0, 0.5], [0, 0, 1, 0.25]]) / 2.0)[:, :width]

    name = {"FLOAT": "value", "FLOAT2": "vector", "FLOAT_VECTOR": "vector"}.get(data_type, "color")
    attribute.data.foreach_set(name, value(positions(cube.data, domain)).astype(np.float32).reshape(-1))
    mesh = refined(cube).data
    carried = mesh.attributes["Mine"]
    assert (carried.data_type, carried.domain) == (data_type, domain)
    # Bytes are steps of sRGB, which are 0.005 apart at most in linear values below 1, and those of the corners mix.
    tolerance = 0.005 if data_type == "BYTE_COLOR" else 1e-6
    found = values_of(carried).reshape(-1, width)
    assert found == pytest.approx(value(positions(mesh, domain)), abs=tolerance)


def test_whole_numbers_switches_and_texts_of_faces_are_those_of_the_face():
    cube = add_cube()
    for name, data_type in (("Number", "INT"), ("Switch", "BOOLEAN"), ("Text", "STRING"), ("Small", "INT8")):
        cube.data.attributes.new(name, data_type, "FACE")
    for index in range(6):
        cube.data.attributes["Number"].data[index].value = 10 + index
        cube.data.attributes["Switch"].data[index].value = index % 2 == 1
        cube.data.attributes["Text"].data[index].value = f"face {index}".encode()
        cube.data.attributes["Small"].data[index].value = -index
    face_of_normal = {tuple(np.round(polygon.normal, 3)): polygon.index for polygon in cube.data.polygons}
    mesh = refined(cube).data
    assert len(mesh.polygons) == 24
    for polygon in mesh.polygons:
        face = face_of_normal[tuple(np.round(polygon.normal, 3))]
        assert mesh.attributes["Number"].data[polygon.index].value == 10 + face
        assert mesh.attributes["Switch"].data[polygon.index].value == (face % 2 == 1)
        assert mesh.attributes["Text"].data[polygon.index].value == f"face {face}".encode()
        assert mesh.attributes["Small"].data[polygon.index].value == -face


@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
def test_whole_numbers_of_points_and_corners_are_those_of_a_corner_of_the_face(domain):
    plane = add_plane()
    attribute = plane.data.attributes.new("Number", "INT", domain)
    attribute.data.foreach_set("value", [10, 20, 30, 40])
    mesh = refined(plane).data
    places = positions(plane.data, domain)
    for place, value in zip(positions(mesh, domain), values_of(mesh.attributes["Number"]), strict=True):
        distance = np.linalg.norm(places - place, axis=1)
        # In the middle of a diagonal the nearest corners are those of the triangle, not of the whole square.
        nearest = np.flatnonzero(distance < distance.min() + 1e-6)
        assert value in 10 * (nearest + 1)


def test_rotations_are_taken_from_the_nearest_corner_and_not_mixed():
    plane = add_plane()
    attribute = plane.data.attributes.new("Turn", "QUATERNION", "POINT")
    turns = [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)]
    for item, turn in zip(attribute.data, turns, strict=True):
        item.value = turn
    found = values_of(refined(plane).data.attributes["Turn"])
    assert {tuple(int(x) for x in turn) for turn in found} == set(turns)
    assert np.all(np.isin(found, (0.0, 1.0)))


def test_uv_maps_keep_their_order_and_which_of_them_is_active_and_rendered():
    plane = add_plane()
    for number, name in enumerate(("First", "Second", "Third")):
        layer = plane.data.uv_layers.new(name=name)
        layer.data.foreach_set("uv", (0.25 * number + 0.5 * positions(plane.data, "CORNER")[:, :2]).reshape(-1))
    plane.data.uv_layers["Second"].active = True
    plane.data.uv_layers["Third"].active_render = True
    output = refined(plane)
    maps = output.data.uv_layers
    assert [layer.name for layer in maps] == ["First", "Second", "Third"]
    assert maps.active.name == "Second"
    assert [layer.name for layer in maps if layer.active_render] == ["Third"]
    for number, layer in enumerate(maps):
        found = np.array([item.uv[:] for item in layer.data])
        assert found == pytest.approx(0.25 * number + 0.5 * corner_positions(output)[:, :2], abs=1e-6)


def test_vertex_groups_keep_names_locks_members_and_weights():
    plane = add_plane()
    left, none = plane.vertex_groups.new(name="Left"), plane.vertex_groups.new(name="None")
    some = plane.vertex_groups.new(name="Some")
    left.add([0, 3], 1.0, "REPLACE")
    left.add([1, 2], 0.0, "REPLACE")
    some.add([1], 0.5, "REPLACE")
    none.lock_weight = True
    plane.vertex_groups.active_index = 2
    output = refined(plane)
    groups = output.vertex_groups
    assert [group.name for group in groups] == ["Left", "None", "Some"]
    assert [group.lock_weight for group in groups] == [False, True, False]
    assert groups.active_index == 2
    for vertex in output.data.vertices:
        weights = {groups[element.group].name: element.weight for element in vertex.groups}
        # 1 at x = -1 and 0 at x = 1.
        assert weights["Left"] == pytest.approx(0.5 - 0.5 * vertex.co.x, abs=1e-6)
        assert "None" not in weights
        at_corner = np.allclose(vertex.co, (1.0, -1.0, 0.0))
        assert not at_corner or weights["Some"] == pytest.approx(0.5)
        far = np.allclose(vertex.co, (-1.0, 1.0, 0.0))
        assert not far or "Some" not in weights
    assert len(plane.vertex_groups) == 3


MARKS = ["use_seam", "use_edge_sharp"] + (["use_freestyle_mark"] if bpy.app.version < (5, 0, 0) else [])


@pytest.mark.parametrize("mark", MARKS)
def test_marks_of_edges_lie_on_the_pieces_of_those_edges_only(mark):
    cube = add_cube()
    setattr(cube.data.edges[2], mark, True)
    setattr(cube.data.edges[7], mark, True)
    before = edges_by_place(cube.data, [getattr(edge, mark) for edge in cube.data.edges])
    mesh = refined(cube).data
    marked = [getattr(edge, mark) for edge in mesh.edges]
    assert edges_by_place(mesh, marked) == before
    assert len(before) == 2
    length = sum(
        (mesh.vertices[edge.vertices[0]].co - mesh.vertices[edge.vertices[1]].co).length
        for edge, yes in zip(mesh.edges, marked, strict=True)
        if yes
    )
    assert length == pytest.approx(4.0)


@pytest.mark.parametrize("name", ["crease_edge", "bevel_weight_edge"])
def test_weights_of_edges_lie_on_the_pieces_of_those_edges_only(name):
    cube = add_cube()
    attribute = cube.data.attributes.new(name, "FLOAT", "EDGE")
    attribute.data[3].value = 0.75
    before = edges_by_place(cube.data, [item.value > 0.0 for item in attribute.data])
    mesh = refined(cube).data
    values = values_of(mesh.attributes[name])
    assert edges_by_place(mesh, values > 0.0) == before
    assert set(np.unique(values)) == {np.float32(0.0), np.float32(0.75)}


def test_attributes_that_modifiers_make_are_carried():
    cube = add_cube()
    cube.modifiers.new("Subdivision", "SUBSURF").render_levels = 1
    layer = cube.data.uv_layers.new(name="Map")
    layer.data.foreach_set("uv", np.linspace(0.0, 1.0, 48, dtype=np.float32))
    mesh = refined(cube).data
    assert len(mesh.polygons) == 2 * 2 * 24
    assert np.ptp(values_of(mesh.attributes["Map"])) > 0.5


def test_a_users_attribute_of_our_name_stands_beside_ours():
    plane = add_plane()
    mine = plane.data.color_attributes.new("Radiosity", "FLOAT_COLOR", "POINT")
    mine.data.foreach_set("color", np.full(16, 0.25, dtype=np.float32))
    mesh = refined(plane).data
    assert mesh.color_attributes["Radiosity"].domain == "CORNER"
    assert np.all(values_of(mesh.attributes["Radiosity (before bake)"]) == 0.25)


def test_loose_vertices_keep_their_values():
    mesh = bpy.data.meshes.new("Loose")
    mesh.from_pydata([(9, 9, 9), (0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(1, 2, 3)])
    obj = bpy.data.objects.new("Loose", mesh)
    bpy.context.scene.collection.objects.link(obj)
    mesh.attributes.new("Mine", "FLOAT", "POINT").data.foreach_set("value", [7.0, 1.0, 1.0, 1.0])
    carried = values_of(refined(obj).data.attributes["Mine"])
    assert carried[0] == 7.0
    assert np.all(carried[1:] == 1.0)
