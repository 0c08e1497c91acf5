# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays aimed at small bright places: the light that comes from them is exact in the mean, and far less noisy."""

from contextlib import closing, nullcontext
from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
from radiosity_bake.core import bake as bake_module
from radiosity_bake.core.bake import bake
from radiosity_bake.core.bright_places import BrightPlaces, aimed_light, shares_of_rays
from radiosity_bake.core.geometry import triangle_areas
from radiosity_bake.core.lit_points import LitPoints
from radiosity_bake.core.relight import relight
from radiosity_bake.core.sampling import frames, hemisphere_lattice
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.surfaces import join
from radiosity_bake.core.visibility import OFFSET, RayScene

from tests.core.building import DARK, block, mean_over
from tests.core.test_bake import same_bytes
from tests.scenes import exact

CORNER, SIDE = (0.3, 0.4, 1.0), 0.2


def bright_square(surfaces, normals_of=-1.0):
    """The square that is the scene's first mesh, as one bright place of two cells; place 2 k is triangle k's front."""
    corners = surfaces.points[surfaces.triangles[:2]]
    sizes = triangle_areas(corners)
    return BrightPlaces(
        of_place=np.array([0, -1, 0, -1, -1, -1, -1], dtype=np.int32),
        cell_of_place=np.array([0, -1, 1, -1], dtype=np.int32),
        reach=np.zeros(4, dtype=np.float32),
        centre=corners.mean(axis=(0, 1))[None],
        vector=surfaces.normals[:1],
        radius=np.array([SIDE]),
        area=np.array([sizes.sum()]),
        flux=np.array([sizes.sum()]),
        place=np.array([0, 2], dtype=np.int32),
        corners=corners,
        normals=surfaces.normals[:2],
        area_before=np.array([0.0, *np.cumsum(sizes)]),
        first=np.array([0, 2]),
    )


def light_at(points, *others, rays_each=384):
    """What receivers that look up get of the square of radiance 1, and what the hemisphere's rays alone tell."""
    square = exact.rectangle("square", CORNER, (0, SIDE, 0), (SIDE, 0, 0))
    surfaces = join(Scene((square, *others), np.ones(3)))
    assert surfaces.normals[0] == pytest.approx([0, 0, -1])
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    with closing(RayScene(surfaces.points, surfaces.triangles)) as rays:
        pattern = hemisphere_lattice(rays_each, 5)
        directions = (pattern @ frames(normals, np.zeros(len(points)))).reshape(-1, 3)
        origins = np.repeat(rays.local(points) + normals.astype(np.float32) * np.float32(OFFSET), rays_each, axis=0)
        found = rays.first_hits(origins, directions)
        places = np.where(found.triangle < 0, -1, 2 * found.triangle + found.back).reshape(-1, rays_each)
        at = LitPoints.of(points, normals)
        places = np.where(places < 4, places, -1).astype(np.int32)
        aimed = aimed_light(bright_square(surfaces), rays, at, found, places, 7)
    radiance = np.zeros((7, 3), dtype=np.float32)
    radiance[[0, 2]] = 1.0
    return aimed.irradiance(radiance)[0][:, 0], np.isin(places, (0, 2)).mean(axis=1)


@pytest.mark.parametrize("distance", [0.02, 0.1, 0.5, 2.0])
def test_near_and_far_a_bright_place_gives_what_its_form_factor_says(distance):
    rng = np.random.default_rng(1)
    points = np.array(CORNER) + rng.random((64, 3)) * [2 * SIDE, 2 * SIDE, 0] - [SIDE / 2, SIDE / 2, distance]
    truth = exact.rectangle_seen_from_below(points, CORNER, SIDE, SIDE)
    light, by_chance = light_at(points)
    error, without = (np.sqrt(((found - truth) ** 2).mean()) / truth.mean() for found in (light, by_chance))
    # A golden lattice of 192 rays is off by about 192^(-3/4), 2%, of what is smooth; close by, where the hemisphere's
    # rays decide, by as much for 384 rays on the square's outline.
    assert error < 0.02
    assert distance < 0.2 or error < 0.2 * without
    assert light.mean() == pytest.approx(truth.mean(), rel=0.005)


def test_half_of_a_bright_place_that_is_hidden_gives_none():
    # The board is so close below the square that from straight below it hides all of it but a strip of half its width.
    x, y, z = CORNER
    board = exact.rectangle("board", (x - 1, y - 1, z - 1e-3), (0, 3, 0), (1 + SIDE / 2, 0, 0))
    points = np.array([[x + SIDE / 2, y + SIDE / 2, 0.0], [x + 0.15, y + 0.05, 0.3]])
    light, _ = light_at(points, board)
    truth = exact.rectangle_seen_from_below(points, (x + SIDE / 2, y, z), SIDE / 2, SIDE)
    # Half of the 192 rays are on the seen half, all but those on the border: 1 of 8 across.
    assert light == pytest.approx(truth, rel=0.05)


def test_a_bent_place_is_aimed_at_from_where_only_its_faces_at_the_edge_are_seen():
    # The ring around the hole of a lampshade, whose faces look down and to its middle: through the hole, a wall sees
    # those on the far side from above.
    angle = 2.0 * np.pi * np.arange(16) / 16
    corners = np.stack([[(r * np.cos(a), r * np.sin(a), z) for a in angle] for r, z in ((0.04, 0.22), (0.1, 0.2))])
    middle = corners.mean(axis=(0, 1))
    inward = np.stack([-0.02 * np.cos(angle), -0.02 * np.sin(angle), np.full(16, -0.06)], axis=1) / np.hypot(0.02, 0.06)
    wall = np.array([[2.0, 0.0, 0.45]])
    assert (np.einsum("kx,kx->k", inward, wall - corners.mean(axis=0)) > 0.0).any()
    square = exact.rectangle("square", CORNER, (0, SIDE, 0), (SIDE, 0, 0))
    ring = replace(
        bright_square(join(Scene((square,), DARK))),
        centre=middle[None],
        vector=inward.mean(axis=0)[None],
        radius=np.array([0.1]),
    )
    toward = np.array([[-1.0, 0.0, 0.0]])
    assert shares_of_rays(ring, wall, toward) == pytest.approx(1.0)
    # A flat one is turned away there.
    flat = replace(ring, vector=np.array([[0.0, 0.0, -1.0]]))
    assert shares_of_rays(flat, wall, toward) == 0.0


def lamp_near_ceiling():
    """A room lit by the ceiling above a lamp whose lower side is hidden by a box that is open above."""
    walls = exact.box_walls((4, 4, 2.5), reflectance=0.7)
    lamp = exact.rectangle("lamp", (1.9, 1.9, 2.42), (0.2, 0, 0), (0, 0.2, 0), emission=40.0)
    tray = block("tray", (1.85, 1.85, 2.36), (2.15, 2.15, 2.38), reflectance=0.5)
    return Scene((*walls, lamp, tray), DARK)


def bake_of(scene, aim=True, **settings):
    with nullcontext() if aim else patch.object(bake_module, "bright_places", lambda *found: None):
        return bake(scene, BakeSettings(quality="DRAFT", **settings))


def test_a_room_lit_by_the_ceiling_above_a_lamp_takes_fewer_rays_and_has_the_same_light():
    aimed, by_chance = bake_of(lamp_near_ceiling()), bake_of(lamp_near_ceiling(), aim=False)
    assert aimed.report["rays"] < 0.6 * by_chance.report["rays"]
    for mine, theirs in zip(aimed.meshes[:6], by_chance.meshes[:6], strict=True):
        # Each vertex is off by the 5% of noise that the quality asks for; the mean over a wall by less.
        assert mean_over([mine]) == pytest.approx(mean_over([theirs]), rel=0.04)


def test_relighting_in_the_same_colours_gives_the_same_bytes_where_rays_are_aimed():
    scene = lamp_near_ceiling()
    result = bake_of(scene, keep_transport=True)
    assert any(table.aimed.even.count for table in result.kept.shown.gathered.places.tables)
    assert len(result.kept.shown.gathered.places.places_aimed_at())
    assert same_bytes(relight(result.kept, scene), result)
