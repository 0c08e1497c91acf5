# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What must not change a bake: how the same scene is turned, cut into objects, numbered or traced.

`test_bake` holds translation, scale, the order of meshes and the number of threads.
"""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core import workers
from radiosity_bake.core.bake import bake
from radiosity_bake.core.scene import PointLamp, Scene, SurfaceMesh
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import DARK, block, mean_over, room_with_block
from tests.scenes import exact

SETTINGS = BakeSettings(quality="DRAFT", keep_transport=False)


@pytest.fixture(scope="module")
def scene():
    """A room in one mesh, a block in it and a lamp of each kind: one that is met by rays, one that is not."""
    room = exact.closed_room((2, 2, 2), reflectance=(0.7, 0.5, 0.3))
    lamp = exact.rectangle("lamp", (0.7, 0.7, 1.95), (0, 0.6, 0), (0.6, 0, 0), emission=(5.0, 4.0, 3.0))
    solid = block("block", (0.5, 0.6, 0.0), (1.1, 1.2, 0.8), turned=25.0)
    bulb = PointLamp("bulb", np.array([1.6, 1.5, 1.2]), 0.05, np.array([0.3, 0.4, 0.5]))
    return Scene((room, lamp, solid), DARK, (bulb,))


@pytest.fixture(scope="module")
def plain(scene):
    return bake(scene, SETTINGS)


def assert_as_bright(one, other):
    """The mean light of the room and of the block agree within the error that both bakes state for their vertices."""
    error = np.hypot(one.report["estimated_error"], other.report["estimated_error"])
    room = mean_over(one.meshes[:1])
    for meshes, others in ((one.meshes[:1], other.meshes[:1]), (one.meshes[2:3], other.meshes[2:])):
        # Of a mean over hundreds of vertices it is a wide bound; the room's light is what the error is relative to.
        np.testing.assert_allclose(mean_over(others), mean_over(meshes), atol=error * room.max())


def changed(scene: Scene, change) -> Scene:
    return replace(scene, meshes=tuple(change(mesh) for mesh in scene.meshes))


def numbered(mesh: SurfaceMesh, triangles) -> SurfaceMesh:
    """The mesh with some of its triangles, in an order."""
    fields = ("triangles", "corner_normals", "reflectance", "emission")
    return replace(mesh, **{name: getattr(mesh, name)[triangles] for name in fields})


@pytest.mark.parametrize("degrees", [17.0, 90.0])
def test_turning_the_scene_changes_the_light_by_less_than_its_error(scene, plain, degrees):
    angle, axis = np.radians(degrees), np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    cross = np.cross(np.eye(3), axis)
    turn = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    turned = changed(scene, lambda m: replace(m, vertices=m.vertices @ turn, corner_normals=m.corner_normals @ turn))
    bulb = replace(scene.lamps[0], centre=scene.lamps[0].centre @ turn)
    assert_as_bright(plain, bake(replace(turned, lamps=(bulb,)), SETTINGS))


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_lamps_of_the_square_of_the_power_light_a_larger_scene_as_brightly(scene, plain, scale):
    bulb = scene.lamps[0]
    bulb = replace(bulb, centre=bulb.centre * scale, radius=bulb.radius * scale, strength=bulb.strength * scale**2)
    larger = changed(scene, lambda m: replace(m, vertices=m.vertices * scale))
    assert_as_bright(plain, bake(replace(larger, lamps=(bulb,)), SETTINGS))


def test_the_order_of_faces_changes_the_light_by_less_than_its_error(scene, plain):
    rng = np.random.default_rng(3)
    shuffled = changed(scene, lambda m: numbered(m, rng.permutation(len(m.triangles))))
    assert_as_bright(plain, bake(shuffled, SETTINGS))


def test_the_corner_that_triangles_begin_with_changes_the_light_by_less_than_its_error(scene, plain):
    rolled = changed(
        scene,
        lambda m: replace(
            m, triangles=np.roll(m.triangles, 1, axis=1), corner_normals=np.roll(m.corner_normals, 1, axis=1)
        ),
    )
    assert_as_bright(plain, bake(rolled, SETTINGS))


def test_the_diagonal_of_quads_changes_the_light_by_less_than_its_error(scene, plain):
    def other_diagonal(mesh: SurfaceMesh) -> SurfaceMesh:
        # Quads are (a, b, c), (a, c, d).
        a, b, c = mesh.triangles[::2].T
        d = mesh.triangles[1::2, 2]
        return replace(mesh, triangles=np.stack([b, c, d, b, d, a], axis=1).reshape(-1, 3))

    assert_as_bright(plain, bake(changed(scene, other_diagonal), SETTINGS))


def test_splitting_an_object_changes_the_light_by_less_than_its_error(scene, plain):
    room, lamp, solid = scene.meshes
    half = len(solid.triangles) // 2
    parts = (numbered(solid, slice(0, half)), numbered(solid, slice(half, None)))
    assert_as_bright(plain, bake(replace(scene, meshes=(room, lamp, *parts)), SETTINGS))


def test_joining_objects_changes_the_light_by_less_than_its_error():
    scene = room_with_block()
    walls = scene.meshes[:6]
    first = np.cumsum([0] + [len(wall.vertices) for wall in walls])
    room = replace(
        walls[0],
        vertices=np.concatenate([wall.vertices for wall in walls]),
        triangles=np.concatenate([wall.triangles + k for wall, k in zip(walls, first, strict=False)]),
        **{
            name: np.concatenate([getattr(wall, name) for wall in walls])
            for name in ("corner_normals", "reflectance", "emission")
        },
    )
    apart, together = bake(scene, SETTINGS), bake(Scene((room, *scene.meshes[6:]), DARK), SETTINGS)
    error = np.hypot(apart.report["estimated_error"], together.report["estimated_error"])
    light = mean_over(apart.meshes[:6])
    np.testing.assert_allclose(mean_over(together.meshes[:1]), light, rtol=error)
    np.testing.assert_allclose(mean_over(together.meshes[2:]), mean_over(apart.meshes[7:]), atol=error * light.max())


def test_the_size_of_batches_changes_nothing_but_rounding(scene, plain, monkeypatch):
    monkeypatch.setattr(workers, "RAYS_PER_BATCH", 5000)
    other = bake(scene, SETTINGS)
    assert other.report["rays"] == pytest.approx(plain.report["rays"], rel=1e-3)
    # Products of float32 may be rounded differently in batches of another shape: a ray in a thousand at a border.
    np.testing.assert_allclose(mean_over(other.meshes), mean_over(plain.meshes), rtol=1e-3)
