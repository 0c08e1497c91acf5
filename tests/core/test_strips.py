# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How wide the pieces of a surface are, and that long faces on narrow ones are split."""

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.detail import WIDTHS_ON_STRIP
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.strips import extents
from radiosity_bake.core.surfaces import join

from tests.core.building import DARK, block
from tests.scenes import exact


def width_and_length(mesh):
    surfaces = join(Scene((mesh,), DARK))
    return extents(surfaces, np.arange(len(surfaces.triangles)))


def test_the_width_of_a_long_side_is_that_of_a_strip_and_of_a_square_half_its_edge():
    leg, length = width_and_length(block("leg", (0, 0, 0), (0.05, 0.05, 1.0)))
    assert length.max() == pytest.approx(1.05)
    assert leg.max() == pytest.approx(2 * 0.05 * 1.0 / (2 * 1.05))
    assert leg.min() == pytest.approx(0.05 / 2)


@pytest.mark.parametrize("sides, round_surface", [(4, False), (8, True), (24, True)])
def test_a_surface_goes_on_around_a_rod_but_not_around_a_square_one(sides, round_surface):
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1) * 0.01
    vertices = np.concatenate([ring, ring + (0, 0, 1.0)])
    k = np.arange(sides)
    j = (k + 1) % sides
    triangles = np.concatenate([np.stack([k, j, j + sides], 1), np.stack([k, j + sides, k + sides], 1)])
    side = 2 * 0.01 * np.sin(np.pi / sides)
    expected = 1.0 if round_surface else side / (1 + side)
    assert width_and_length(surface_mesh("rod", vertices, triangles))[0] == pytest.approx(np.full(2 * sides, expected))


def test_a_ball_has_no_outline():
    points, triangles = exact.icosphere(2)
    assert np.isinf(width_and_length(surface_mesh("ball", points, triangles))[0]).all()


def test_no_face_of_a_strip_is_longer_than_a_patch():
    floor = exact.rectangle("floor", (-2, -2, 0), (4, 0, 0), (0, 4, 0), reflectance=0.3)
    leg = block("leg", (0, 0, 0.5), (0.03, 0.03, 2.0), reflectance=0.3)
    # Without it, the sizes would be made for the leg alone: of a floor under the sky little sees anything.
    roof = exact.rectangle("roof", (-2, -2, 3), (0, 4, 0), (4, 0, 0), reflectance=0.3)
    result = bake(Scene((floor, leg, roof), np.ones(3)), BakeSettings(quality="DRAFT"))
    mesh = result.meshes[1]
    corners = mesh.vertices[mesh.triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
    size = result.report["minimum_size"]
    assert size > WIDTHS_ON_STRIP * 0.03, "the leg is narrow enough"
    assert longest <= size


def test_noisy_light_gets_more_rays_and_no_more_than_there_is_room_for():
    from radiosity_bake.core.gather import MOST_DOUBLINGS, GatherRays, enough_rays

    counts = GatherRays(256, 0.01, 64, 128, 256, 0.01)
    assert enough_rays(counts, 256, 0.002, 1000, 10**9) is counts
    assert enough_rays(counts, 256, 0.011, 1000, 10**9) is counts
    assert enough_rays(counts, 256, 0.013, 1000, 10**9).hemisphere == 512
    # No more than would do if noise fell as fast as it may: three doublings to an eighth to the power of 3/4.
    assert enough_rays(counts, 256, 0.01 * 2.0**2.3, 1000, 10**9).hemisphere == 256 << 3
    assert enough_rays(counts, 256, 5.0, 1000, 10**9).hemisphere == 256 << MOST_DOUBLINGS
    assert enough_rays(counts, 256, 5.0, 1000, 8 * 1000 * 600).hemisphere == 512
    most = GatherRays(256 << MOST_DOUBLINGS, 0.01, 64, 128, 256, 0.01)
    assert enough_rays(most, 256, 5.0, 1000, 10**9) is most
