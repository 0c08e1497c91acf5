# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""By which normals faces are lit: as Cycles shades flat faces that are not planar, and smooth ones of few polygons."""

import bpy
import numpy as np
import pytest
from mathutils import Vector

from tests.blender.making import add_mesh, add_object, bake_selected, colours_of, diffuse_material

BENT = [(0, 0, 0), (1, 0, 0), (1, 1, 0.6), (0, 1, 0), (2, 0, 0), (2, 1, 0.6)]
TOWARD_SUN = np.array((3.0, -4.0, 5.0)) / 50.0**0.5


def add_sun(toward=TOWARD_SUN):
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle = np.pi, 0.0
    sun = add_object("Sun", light)
    sun.rotation_euler = (-Vector(toward)).to_track_quat("-Z", "Y").to_euler()
    return sun


def add_bent_quad(beside=False):
    """Return a flat quad of two triangles (0, 1, 2) and (0, 2, 3) that lean against each other, maybe with a plane."""
    faces = [(0, 1, 2, 3), (1, 4, 5, 2)] if beside else [(0, 1, 2, 3)]
    vertices = BENT if beside else BENT[:4]
    return add_mesh("Bent", vertices, faces, materials=[diffuse_material(colour=(0, 0, 0, 1))], select=True)


def cosine(a, b, c):
    """Return what the sun sends to a triangle of vertices of `BENT`."""
    a, b, c = np.array(BENT)[[a, b, c]]
    normal = np.cross(b - a, c - a)
    return normal @ TOWARD_SUN / np.linalg.norm(normal)


def test_each_triangle_of_a_bent_flat_face_is_lit_by_its_own_normal():
    add_bent_quad()
    add_sun()
    bake_selected("REFINED")
    refined = bpy.data.objects["Bent Radiosity"].data
    found = colours_of(refined, "Irradiance")[:, 0]
    # The two triangles meet above the diagonal y = x.
    of_first = np.repeat([face.center.x > face.center.y for face in refined.polygons], 3)
    assert found[of_first] == pytest.approx(cosine(0, 1, 2), rel=1e-5)
    assert found[~of_first] == pytest.approx(cosine(0, 2, 3), rel=1e-5)


def test_a_corner_that_two_triangles_share_in_place_takes_the_first_as_cycles_does():
    bent = add_bent_quad()
    add_sun()
    bake_selected("ORIGINAL")
    first, second = cosine(0, 1, 2), cosine(0, 2, 3)
    assert colours_of(bent.data, "Irradiance")[:, 0] == pytest.approx([first, first, first, second], rel=1e-5)


def test_where_edges_are_sharp_between_smooth_faces_flat_ones_take_the_normals_of_corners_as_in_cycles():
    bent = add_bent_quad(beside=True)
    bent.data.polygons[1].use_smooth = True
    bent.data.edges[0].use_edge_sharp = True
    add_sun()
    bake_selected("ORIGINAL")
    normal = np.array(bent.data.corner_normals[3].vector)
    assert colours_of(bent.data, "Irradiance")[3, 0] == pytest.approx(normal @ TOWARD_SUN, rel=1e-5)


@pytest.mark.parametrize(("offset", "reaches"), [(0.1, True), (0.0, False)])
def test_light_that_grazes_smooth_faces_ends_where_the_geometry_offset_of_the_object_says(offset, reaches):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=8, ring_count=6)
    ball = bpy.context.object
    ball.data.shade_smooth()
    owner = ball if hasattr(ball, "shadow_terminator_geometry_offset") else ball.cycles
    owner.shadow_terminator_geometry_offset = offset
    add_sun()
    bpy.context.scene.radiosity.quality = "DRAFT"
    bake_selected("REFINED")
    refined = bpy.data.objects[f"{ball.name} Radiosity"].data
    cosine = np.maximum(normals_of(refined) @ TOWARD_SUN, 0.0)
    missing = (cosine - colours_of(refined, "Irradiance")[:, 0]).max()
    # Blender keeps the normals of a refined mesh to some thousandths; a face that is dark as a whole misses 0.3.
    assert missing < 0.01 if reaches else missing > 0.1


def normals_of(mesh):
    """Return (c, 3) the normals of the face corners."""
    normals = np.empty(3 * len(mesh.loops), dtype=np.float32)
    mesh.corner_normals.foreach_get("vector", normals)
    return normals.reshape(-1, 3)
