# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Low-polygon meshes that are shaded smooth: lit as the curved surface that they stand for, not face by face."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.lit_points import LitPoints
from radiosity_bake.core.scene import Scene, SunLamp, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.surfaces import join
from radiosity_bake.core.terminator import raised_shares, rises

from tests.core.building import DARK
from tests.scenes import exact

TOWARD_SUN = np.array([0.6, 0.0, 0.8])
SUN = SunLamp("sun", -TOWARD_SUN, 0.0, np.pi * np.ones(3))


def smooth_ball(levels=0):
    """Return an icosahedron about the origin that is shaded as the unit sphere, or one of more faces."""
    vertices, triangles = exact.icosphere(levels)
    return surface_mesh("ball", vertices, triangles, corner_normals=vertices[triangles])


def places_on(mesh, count=4):
    """Return triangles, barycentric weights and places, spread evenly over all triangles, corners and edges too."""
    steps = [(i, j, count - i - j) for i in range(count + 1) for j in range(count + 1 - i)]
    triangle = np.repeat(np.arange(len(mesh.triangles)), len(steps))
    weights = np.tile(np.array(steps) / count, (len(mesh.triangles), 1))
    return triangle, weights, np.einsum("nk,nkx->nx", weights, mesh.vertices[mesh.triangles[triangle]])


def test_shadow_rays_start_between_a_ball_and_the_tangent_planes_of_its_corners():
    mesh = smooth_ball()
    triangle, weights, places = places_on(mesh)
    rise = rises(join(Scene((mesh,), DARK)), triangle, np.zeros(len(triangle), dtype=int), weights)
    corner = weights.max(axis=1) == 1.0
    assert rise[corner] == pytest.approx(0.0, abs=1e-12)
    above = np.linalg.norm(places + rise, axis=1)[~corner]
    # The planes of an icosahedron's corners meet 26% above the unit sphere.
    assert (above > 1.0).all() and (above < 1.26).all()


def test_flat_faces_and_objects_with_an_offset_of_zero_have_no_surface_above_them():
    flat = surface_mesh("flat", *exact.icosphere(0))
    for mesh in (flat, replace(smooth_ball(), grazing=0.0)):
        triangle, weights, _ = places_on(mesh)
        assert not rises(join(Scene((mesh,), DARK)), triangle, np.zeros(len(triangle), dtype=int), weights).any()


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_every_vertex_of_a_smooth_ball_has_the_light_of_its_shading_normal(output):
    ball = smooth_ball()
    scene = Scene((ball,), DARK, (SUN,))
    (baked,) = bake(scene, BakeSettings(quality="GOOD", output=output, threads=2)).meshes
    cosine = np.maximum(baked.corner_normals @ TOWARD_SUN, 0.0)
    # Nothing is sampled: the sun is a point, the ball does not reflect, and rays start clear of it.
    assert baked.irradiance[..., 0] == pytest.approx(cosine, abs=1e-9)


def test_what_stands_before_a_low_polygon_ball_still_throws_its_shadow():
    ball = smooth_ball()
    screen = exact.rectangle("screen", (-3, -3, 1.5), (6, 0, 0), (0, 6, 0))
    scene = Scene((ball, screen), DARK, (replace(SUN, direction=np.array([0.0, 0.0, -1.0])),))
    baked, _ = bake(scene, BakeSettings(quality="DRAFT", threads=2)).meshes
    assert not baked.irradiance.any()


def test_an_emitting_face_lights_what_is_turned_to_it_as_a_lamp_of_its_shape_does():
    ball = smooth_ball()
    far = np.array([6.0, 0.0, 8.0])
    across, up = np.array([0.0, 0.2, 0.0]), 0.2 * np.array([0.8, 0.0, -0.6])
    panel = surface_mesh(
        "panel", [far - across - up, far + across - up, far + up], [(0, 1, 2)], emission=(1, 1, 1), baked=False
    )
    (baked,) = bake(Scene((ball, panel), DARK), BakeSettings(quality="DRAFT", threads=2)).meshes
    cosine = np.maximum(baked.corner_normals @ TOWARD_SUN, 0.0)
    light = baked.irradiance[..., 0]
    # The panel is 10 away and the ball 1 large: distances differ by a tenth, and squares by a fifth.
    assert light / light.max() == pytest.approx(cosine, abs=0.25 * cosine.max())
    assert (light[cosine > 0.1] > 0.0).all()


@pytest.mark.parametrize(
    ("shading", "face", "share"),
    [(0.5, 0.2, 0.0), (0.5, 0.05, 0.5), (0.5, -0.3, 1.0), (0.05, 0.1, 0.5), (0.0, 0.2, 0.0)],
)
def test_the_start_rises_where_light_is_grazing(shading, face, share):
    way = np.array([0.0, 0.0, 1.0])

    def leaning(cosine):
        return np.array([[np.sqrt(1.0 - cosine**2), 0.0, cosine]])

    at = LitPoints(
        np.zeros((1, 3)),
        leaning(shading),
        leaning(face),
        np.ones((1, 3)),
        np.array([0.1]),
        np.zeros(1, dtype=np.int64),
        np.zeros(1, dtype=np.int64),
    )
    assert raised_shares(at, way.astype(np.float32).reshape(1, 1, 3)) == pytest.approx(share, abs=1e-6)
