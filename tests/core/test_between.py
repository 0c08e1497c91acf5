# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that changes between all corners of a face: a thin bar stands on a window sill, and shades it on one side."""

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.surfaces import join
from radiosity_bake.core.visibility import OFFSET, RayScene

from tests.core.building import block
from tests.scenes import exact

SILL, BAR = 0.9, ((5.1, 1.97, 0.9), (5.15, 2.03, 2.2))


def room():
    """A black room of 5 x 4 x 2.7 m with a window of 2 x 1.3 m and a bar in it."""
    east = ((5, 0, 0), (5.25, 4, SILL)), ((5, 0, 2.2), (5.25, 4, 2.7)), ((5, 0, SILL), (5.25, 1, 2.2))
    solids = *east, ((5, 3, SILL), (5.25, 4, 2.2)), BAR
    sill, *others = (block(f"block {k}", *corners, reflectance=0.0) for k, corners in enumerate(solids))
    walls = exact.box_walls((5, 4, 2.7))
    return Scene((sill, *walls[:3], *walls[4:], *others), np.ones(3))


def light_from_the_sky(scene, points):
    """Share of 4096 rays from places on the sill that leave the scene, (n,): known to 0.008, as if they were random."""
    surfaces = join(scene)
    radius, angle = np.sqrt((np.arange(64) + 0.5) / 64), 2 * np.pi * (np.arange(64) + 0.5) / 64
    flat = radius[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    flat = flat.reshape(-1, 2)
    directions = np.column_stack([flat, np.sqrt(1 - (flat**2).sum(axis=1))]).astype(np.float32)
    rays = RayScene(surfaces.traced_points(), surfaces.triangles, 1, surfaces.seen, surfaces.shadow)
    starts = rays.local(points) + np.float32(OFFSET) * np.array([0, 0, 1], dtype=np.float32)
    found = rays.first_hits(np.repeat(starts, len(directions), axis=0), np.tile(directions, (len(points), 1)))
    return (found.triangle < 0).reshape(len(points), -1).mean(axis=1)


def shown_on_sill(result, points):
    """Irradiance over pi that the baked sill shows at places on its top, (n,)."""
    mesh = result.meshes[0]
    top = np.isclose(mesh.vertices[mesh.triangles][:, :, 2], SILL).all(axis=1)
    corners, light = mesh.vertices[mesh.triangles[top]][:, :, :2], mesh.irradiance[top][:, :, 0]
    system = np.concatenate([corners.transpose(0, 2, 1), np.ones((len(corners), 1, 3))], axis=1)
    sound = np.abs(np.linalg.det(system)) > 1e-12
    inverse, light = np.linalg.inv(system[sound]), light[sound]
    weights = inverse @ np.column_stack([points[:, :2], np.ones(len(points))]).T
    face = weights.min(axis=1).argmax(axis=0)
    return np.einsum("pk,pk->p", weights[face, :, np.arange(len(points))], light[face])


def test_a_shadow_that_is_narrower_than_the_faces_it_falls_on_is_found():
    # Where no corner tells, the sill 1 cm before the bar is shown twelve times as bright as it is, on a face from one
    # side of the bar to the other. 0.05 is a seventh of the light of the open sill; what light falls by along a face
    # twice as long as the least, 1.4 cm, is 0.04 there, and the rays that it is compared with know it to 0.008.
    scene = room()
    along = np.array([5.03, 5.05, 5.07, 5.08, 5.09])
    points = np.column_stack([along, np.full(5, 2.0), np.full(5, SILL)])
    result = bake(scene, BakeSettings(quality="GOOD", keep_transport=False))
    assert shown_on_sill(result, points) == pytest.approx(light_from_the_sky(scene, points), abs=0.05)
