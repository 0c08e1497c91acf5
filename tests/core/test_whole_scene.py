# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a mesh shows does not depend on which others are baked, and what is missing is said."""

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.lighting import LARGEST_IMBALANCE, imbalance_warnings
from radiosity_bake.core.receivers import receivers
from radiosity_bake.core.refinement import trace_all
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.subdivision import input_faces
from radiosity_bake.core.surfaces import join

from tests.core.building import block
from tests.scenes import exact

DARK = np.zeros(3)


def room(*baked: str) -> Scene:
    """A closed room with a panel under its ceiling and a block, of which only some meshes are baked."""
    meshes = [
        *exact.box_walls((4.0, 4.0, 3.0), reflectance=0.7),
        exact.rectangle("panel", (1.5, 1.5, 2.5), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), reflectance=0.8, emission=10.0),
        block("block", (2.4, 1.4, 0.0), (3.4, 2.4, 1.0), reflectance=0.6),
    ]
    named = [m.name in baked if baked else True for m in meshes]
    return Scene(
        tuple(
            surface_mesh(
                m.name,
                m.vertices,
                m.triangles,
                reflectance=m.reflectance,
                emission=m.emission,
                corner_normals=m.corner_normals,
                baked=flag,
            )
            for m, flag in zip(meshes, named, strict=True)
        ),
        DARK,
    )


@pytest.fixture(scope="module")
def size():
    return BakeSettings(quality="DRAFT", minimum_size=0.2)


def test_a_mesh_baked_alone_is_lit_as_in_the_whole_scene(size):
    whole, alone = bake(room(), size), bake(room("block"), size)
    light = [
        next(m for m in result.meshes if scene.meshes[m.mesh].name == "block").irradiance.mean()
        for result, scene in ((whole, room()), (alone, room("block")))
    ]
    # The seeds differ, so rows are traced in another order; what they meet does not.
    assert light[1] == pytest.approx(light[0], rel=0.02)
    assert abs(alone.report["energy"]["imbalance"]) < 0.02


def test_everything_that_a_ray_met_is_traced_in_the_end(size, monkeypatch):
    transports = []

    def remembering(transport, seeds, report):
        transports.append(transport)
        return trace_all(transport, seeds, report)

    monkeypatch.setattr("radiosity_bake.core.refinement.trace_all", remembering)
    bake(room("block"), size)
    assert len(transports[-1].met_but_untraced()) == 0


def test_light_that_does_not_add_up_is_said():
    assert imbalance_warnings({"imbalance": 0.5 * LARGEST_IMBALANCE}) == []
    (sentence,) = imbalance_warnings({"imbalance": -0.24})
    assert "24%" in sentence


def test_the_report_says_when_light_does_not_add_up(size, monkeypatch):
    monkeypatch.setattr("radiosity_bake.core.lighting.LARGEST_IMBALANCE", -1.0)
    assert any("unaccounted" in warning for warning in bake(room(), size).report["warnings"])


def saddle(count: int = 9):
    """A smooth surface that is hollow one way and bulges the other, and the places of its inner vertices."""
    x, y = np.meshgrid(np.linspace(-1, 1, count), np.linspace(-1, 1, count), indexing="ij")
    points = np.stack([x, y, 0.6 * (x * x - y * y)], axis=-1).reshape(-1, 3)
    corner = np.arange(count * count).reshape(count, count)
    a, b, c, d = (corner[i : count - 1 + i, j : count - 1 + j].ravel() for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    slope = np.stack([-1.2 * points[:, 0], 1.2 * points[:, 1], np.ones(len(points))], axis=1)
    slope /= np.linalg.norm(slope, axis=1, keepdims=True)
    return surface_mesh("saddle", points, triangles, reflectance=0.5, corner_normals=slope[triangles])


def test_light_is_gathered_on_the_faces_of_a_saddle_and_not_below_them():
    surfaces = join(Scene((saddle(),), np.ones(3)))
    faces = input_faces(surfaces)
    places = receivers(surfaces, faces, np.arange(len(faces.triangle)), np.zeros(len(faces.triangle), dtype=np.int64))
    # Of the faces around a receiver, one at least must have it in its plane or below itself; none lies far above it.
    for face, of_corner in enumerate(places.of_corner):
        at = places.points[of_corner]
        vertex = faces.points[faces.corners[face]]
        height = np.einsum("kx,x->k", at - vertex, surfaces.normals[face])
        moved = np.linalg.norm(at - vertex, axis=1)
        assert (height >= -0.5 * moved - 1e-12).all()
    result = bake(Scene((saddle(),), np.ones(3)), BakeSettings(quality="DRAFT"))
    assert result.meshes[0].irradiance.min() > 0.3


def test_a_ceiling_close_above_a_lamp_does_not_streak_the_walls():
    # The lit patch of ceiling is a light of its own, found by few rays. Along a wall its light must change smoothly.
    meshes = [
        *exact.box_walls((4.0, 4.0, 3.0), reflectance=0.7),
        exact.rectangle("panel", (1.5, 1.5, 2.95), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), emission=10.0),
    ]

    def roughness() -> float:
        result = bake(Scene(tuple(meshes), DARK), BakeSettings(quality="GOOD", minimum_size=0.15))
        return float(np.sqrt(np.mean([roughness_of(wall) ** 2 for wall in result.meshes[2:6]])))

    def roughness_of(wall) -> float:
        at = wall.vertices[wall.triangles].reshape(-1, 3)
        light = wall.irradiance.reshape(-1, 3)[:, 0]
        across = int(np.ptp(at[:, 0]) < 1e-9)
        inner = (np.abs(at[:, across] - 2.0) < 1.2) & (np.abs(at[:, 2] - 1.4) < 0.8)
        x, y = at[inner, across] - 2.0, at[inner, 2] - 1.4
        # A polynomial of sixth order follows what is smooth on so short a way; what is left is streaks and noise.
        terms = np.stack([x**i * y**j for i in range(7) for j in range(7 - i)], axis=1)
        left = light[inner] - terms @ np.linalg.lstsq(terms, light[inner], rcond=None)[0]
        return float(np.sqrt(np.mean(left**2)) / light[inner].mean())

    # The eye sees steps of 1%.
    assert roughness() < 0.005
