# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimated error, of functions whose own is known."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.checks import FEWEST, MOST, VERTICES_FOR_A_CHECK, check_places
from radiosity_bake.core.error_estimate import SAFETY, Expected, interpolation_error, neighbours, relative_error
from radiosity_bake.core.gather import Gathered
from radiosity_bake.core.scene import Scene, SunLamp, surface_mesh
from radiosity_bake.core.settings import BakeSettings

from tests.scenes import exact

CELLS = 8


def strips(width, length):
    """Corners (f, 3, 3) and their numbers (f, 3) of a plane cut into cells of a width and a length, two faces each."""
    x, y = np.meshgrid(width * np.arange(CELLS + 1), length * np.arange(CELLS + 1), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    first = ((CELLS + 1) * np.arange(CELLS)[:, None] + np.arange(CELLS)).ravel()
    a, b, c, d = first, first + CELLS + 1, first + CELLS + 2, first + 1
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return points[faces], faces


@pytest.mark.parametrize("slenderness", [1.0, 10.0, 100.0])
@pytest.mark.parametrize("axis", [0, 1])
def test_the_error_over_cells_follows_their_extent_along_which_light_changes(axis, slenderness):
    width = 0.1
    corners, of_corner = strips(width, slenderness * width)
    extent = (width, slenderness * width)[axis]
    found = interpolation_error(corners, neighbours(corners, of_corner), corners[..., [axis]] ** 2)
    # Faces on the border have no neighbour behind it that would tell.
    along = corners[..., axis]
    inside = (along.min(axis=1) > 0.5 * extent) & (along.max(axis=1) < (CELLS - 0.5) * extent)
    # Chords of x^2 miss h^2 / 4 in the middle of a cell. Where cells are longer than wide, the estimate may take the
    # edge for up to two altitudes.
    assert found[inside].min() >= (1.0 - 1e-9) * 0.25 * extent**2
    assert found[inside].max() <= (1.0 + 1e-9) * 0.5 * extent**2


@pytest.mark.parametrize(("fall", "least", "most"), [(0.0, 0.0, 0.0), (0.1, 0.1**2 / 8.0, 0.01), (1.0, 0.4, 0.5)])
def test_a_face_without_neighbours_misses_as_much_as_a_smooth_fall_or_a_shadow_would(fall, least, most):
    corners, of_corner = strips(1.0, 1.0)
    alone = np.array([[[1.0], [1.0], [1.0 - fall]]])
    found = interpolation_error(corners[:1], neighbours(corners[:1], of_corner[:1]), alone)
    # Chords of an exponential miss an eighth of the square of its fall, and a shadow's border up to half of the light.
    assert least <= found[0] <= most


def test_the_places_that_are_checked_stand_for_the_area_there_is_and_for_nothing_else():
    areas = np.random.default_rng(3).uniform(0.0, 1.0, 5000) ** 8
    areas[::7] = 0.0
    checks = check_places(areas, 20000)
    assert len(checks.row) == 20000 // VERTICES_FOR_A_CHECK
    assert (areas[checks.row] > 0.0).all()
    np.testing.assert_allclose(checks.weights.sum(axis=1), 1.0)
    # Half of the places are spread by area, and bring no error; the sum over the others has that of a mean of 312
    # areas, whose spread is about twice their mean and of which stratification takes nothing away.
    assert checks.areas.sum() == pytest.approx(areas.sum(), rel=3.0 * 2.0 / np.sqrt(312))


@pytest.mark.parametrize(("vertices", "places"), [(10, FEWEST), (10**7, MOST)])
def test_there_are_neither_too_few_nor_too_many_checks(vertices, places):
    assert len(check_places(np.ones(9), vertices).row) == places
    assert len(check_places(np.zeros(9), vertices).row) == 0


def checked(shown, gathered, hidden=None):
    """Checks of four faces of area 1, and what relative_error wants to know of them: all show and find one light."""
    checks = check_places(np.ones(4), 0)
    count = len(checks.row)
    light = np.full((count, 3), gathered)
    hidden = np.zeros(count, dtype=bool) if hidden is None else hidden(checks)
    found = replace(Gathered.none(0), irradiance=light, hidden=hidden)
    return replace(checks, gathered=found), np.full((4, 3, 3), shown)


def nothing_expected(light, fronts=4):
    """That light shown by four faces of area 1 is right, as far as they tell."""
    ones, zeros = np.ones(4), np.zeros(4)
    return Expected(ones, light * ones, zeros, zeros, np.arange(4) < fronts)


def test_what_the_checks_find_counts_for_half_of_what_interpolation_misses():
    checks, irradiance = checked(2.0, 2.2)
    assert relative_error(nothing_expected(2.0), checks, 4, irradiance, 0.0) == pytest.approx(SAFETY * 0.1 / np.sqrt(2))


def test_what_is_expected_noise_and_lost_light_are_added_in_squares():
    checks, irradiance = checked(2.0, 2.0)
    ones = np.ones(4)
    expected = replace(nothing_expected(2.0), missed=0.04**2 * ones, noise=0.06**2 * ones)
    found = relative_error(expected, checks, 4, irradiance, 0.01)
    assert found == pytest.approx(SAFETY * np.sqrt(0.02**2 / 2 + 0.03**2 / 2 + 0.01**2))


def test_bright_backs_do_not_hide_what_is_wrong_with_dim_fronts():
    checks, irradiance = checked(1.0, 1.1)
    back = checks.row >= 2
    irradiance[2:] = 100.0
    checks.gathered.irradiance[back] = 100.0
    expected = nothing_expected(np.array([1.0, 1.0, 100.0, 100.0]), fronts=2)
    assert relative_error(expected, checks, 2, irradiance, 0.0) == pytest.approx(SAFETY * 0.1 / np.sqrt(2))


def test_what_is_hidden_is_not_wrong():
    checks, irradiance = checked(1.0, 2.0, lambda checks: checks.row > 0)
    # A quarter of the area shows 1 where 2 is right; the rest is dark, and as good as left out.
    found = relative_error(nothing_expected(1.0), checks, 4, irradiance, 0.0)
    assert found == pytest.approx(SAFETY / np.sqrt(2), rel=1e-2)


def test_there_is_no_error_in_the_dark():
    checks, irradiance = checked(0.0, 0.0)
    assert relative_error(nothing_expected(0.0), checks, 4, irradiance, 0.0) == 0.0


@pytest.mark.parametrize(("output", "advice"), [("ORIGINAL", "Refined Mesh"), ("REFINED", "Minimum Size")])
def test_light_that_a_mesh_cannot_show_is_told(output, advice):
    floor = exact.rectangle("floor", (-2, -2, 0), (4, 0, 0), (0, 4, 0), reflectance=0.5)
    # A pane that shines a millimetre over the middle of a floor of two triangles.
    pane = exact.rectangle("pane", (-0.5, -0.5, 1e-3), (0, 1, 0), (1, 0, 0), emission=10.0)
    settings = BakeSettings(quality="DRAFT", output=output, minimum_size=1.0, keep_transport=False)
    report = bake(Scene((floor, pane), np.zeros(3)), settings).report
    assert report["estimated_error"] > 0.5
    assert any("estimated error" in warning and advice in warning for warning in report["warnings"])


def test_faces_that_share_no_vertex_with_others_are_split_at_the_border_of_a_shadow():
    vertices, triangles = exact.icosphere(1)
    flat_ball = surface_mesh("ball", 0.5 * vertices + [0.0, 0.0, 2.0], triangles)
    ground = exact.rectangle("ground", (-20, -20, 0), (40, 0, 0), (0, 40, 0))
    screen = exact.rectangle("screen", (0.05, -3, 4), (6, 1, 0), (0, 6, 0))
    sun = SunLamp("sun", np.array([0.0, 0.0, -1.0]), 0.0, np.pi * np.ones(3))
    settings = BakeSettings(quality="GOOD", threads=2)
    baked = bake(Scene((flat_ball, ground, screen), np.zeros(3), (sun,)), settings).meshes[0]
    corners = baked.vertices[baked.triangles]
    longest = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
    crossed = np.ptp(baked.irradiance[..., 0], axis=1) > 0.3
    # Edges of the ball are 0.27 and 0.31 long; two rounds of splitting leave a quarter.
    assert crossed.any()
    assert longest[crossed].max() < 0.1
