# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Point-to-triangle form factors against Howell's catalogue, an independent clipped formula, and identities."""

import numpy as np
import pytest
from radiosity_bake.core.form_factors import point_to_triangle

from tests.core.building import Floats
from tests.scenes import exact, oracle

UP = np.array([0.0, 0.0, 1.0])


def triangles_of(corner, u, v) -> Floats:
    """A parallelogram as two triangles, (2, 3, 3)."""
    c, a, b = (np.asarray(x, dtype=np.float64) for x in (corner, u, v))
    return np.array([[c, c + a, c + a + b], [c, c + a + b, c + b]])


def mean_factor(x, wx, y, wy, triangles) -> float:
    """The mean over a horizontal rectangle (facing up) of the factor to triangles, by a product rule."""
    points = np.stack([*np.meshgrid(x, y, indexing="ij"), np.zeros((len(x), len(y)))], axis=-1)
    factor = sum(point_to_triangle(points, np.broadcast_to(UP, points.shape), t) for t in triangles)
    return float(wx @ factor @ wy)


def gauss(n: int):
    x, w = np.polynomial.legendre.leggauss(n)
    return (x + 1) / 2, w / 2


@pytest.mark.parametrize(
    ("side", "other", "nodes", "expected", "tolerance"),
    [
        # The integrand is analytic; its nearest singularity is 1 / side away, so more nodes for the wide ones. Truth is
        # given to 12 digits.
        (1.0, 1.0, 16, 0.199824895698, 1e-9),
        (2.0, 1.0, 16, 0.285875384851, 1e-9),
        (10.0, 10.0, 64, 0.826994522397, 1e-8),
        (0.1, 0.1, 8, 0.003162056839, 1e-12),
    ],
)
def test_aligned_rectangles_agree_with_the_catalogue(side, other, nodes, expected, tolerance):
    x, w = gauss(nodes)
    facing = triangles_of((0, 0, 1), (0, other, 0), (side, 0, 0))
    assert mean_factor(side * x, w, other * x, w, facing) == pytest.approx(expected, abs=tolerance)


@pytest.mark.parametrize(
    ("depth", "height", "expected"),
    [
        (1.0, 1.0, 0.200043776075),
        (1.0, 0.1, 0.043251369401),
        (0.1, 1.0, 0.432513694007),
        (10.0, 10.0, 0.055023979528),
    ],
)
def test_perpendicular_rectangles_with_a_common_edge_agree_with_the_catalogue(depth, height, expected):
    # The double-exponential rule does not mind that the factor has no derivative at the common edge; what is left over
    # is about 1e-8, that of nodes where the point lies within rounding of the wall's plane.
    x, _, w = oracle.tanh_sinh_rule()
    wall = triangles_of((0, 0, 0), (0, 1, 0), (0, 0, height))
    assert mean_factor(depth * x, w, x, w, wall) == pytest.approx(expected, abs=1e-6)


def test_the_catalogue_agrees_with_the_independent_contour_integral():
    floor, wall = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)]
    assert oracle.form_factor(floor, wall) == pytest.approx(0.200043776075, abs=1e-9)
    assert exact.perpendicular_factor(1, 1, 1) == pytest.approx(0.200043776075, abs=1e-9)


def test_what_lies_below_the_horizon_does_not_count():
    # Two corner formulas of a wall of height h at distance d: phi = 1/(2 pi) [atan(L/d) - d/r atan(L/r)].
    d, h, half = 0.7, 1.3, 2.0
    r = np.hypot(d, h)
    expected = (np.arctan(half / d) - d / r * np.arctan(half / r)) / np.pi
    wall = triangles_of((d, -half, -5.0), (0, 2 * half, 0), (0, 0, 5.0 + h))
    assert point_to_triangle(np.zeros(3), UP, wall).sum() == pytest.approx(expected, abs=1e-12)


def test_a_triangle_wholly_below_the_horizon_has_no_factor():
    assert point_to_triangle(np.zeros(3), UP, np.array([[1, 0, -1], [0, 1, -1], [-1, -1, -0.1]], float)) == 0.0


def test_random_triangles_that_cut_the_horizon_agree_with_an_independent_formula():
    rng = np.random.default_rng(1)
    points, triangles = rng.normal(size=(300, 3)), rng.normal(size=(300, 3, 3))
    normals = rng.normal(size=(300, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    found = point_to_triangle(points, normals, triangles)
    # The oracle sees fronts only: one of the two windings shows its front.
    truth = [
        max(oracle.point_to_polygon(p, n, t), oracle.point_to_polygon(p, n, t[::-1]))
        for p, n, t in zip(points, normals, triangles, strict=True)
    ]
    cut = np.ptp(np.sign(np.einsum("nkx,nx->nk", triangles - points[:, None], normals)), axis=1) > 0
    assert cut.sum() > 100
    np.testing.assert_allclose(found, truth, atol=1e-10)


def test_the_winding_does_not_matter():
    rng = np.random.default_rng(2)
    triangles = rng.normal(size=(50, 3, 3)) + UP
    points, normals = np.zeros((50, 3)), np.broadcast_to(UP, (50, 3))
    forward, backward = (point_to_triangle(points, normals, t) for t in (triangles, triangles[:, ::-1]))
    np.testing.assert_allclose(forward, backward, atol=1e-14)


@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.6, 0.0, -0.8)])
def test_a_point_beside_a_triangle_in_its_plane_sees_none_of_it(normal):
    # Within the triangle the factor jumps from 0 on one side of it to 1 on the other; beside it there is no doubt.
    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=float)
    points = np.array([(2.0, 3.0, 0.0), (-1.0, 0.2, 0.0), (0.6, 0.6, 0.0)])
    factor = point_to_triangle(points, np.broadcast_to(normal, (3, 3)), triangle)
    np.testing.assert_allclose(factor, 0.0, atol=1e-15)


def test_a_closed_box_fills_the_hemisphere_of_every_point_in_it():
    corners = np.concatenate([m.vertices[m.triangles] for m in exact.box_walls((2, 1, 3))])
    rng = np.random.default_rng(3)
    points = rng.uniform(0.01, 0.99, size=(200, 1, 3)) * [2, 1, 3]
    normals = rng.normal(size=(200, 1, 3))
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    total = point_to_triangle(points, normals, corners[None]).sum(axis=1)
    np.testing.assert_allclose(total, 1.0, atol=1e-12)


def test_a_point_on_the_wall_of_a_box_sees_all_of_the_other_walls():
    corners = np.concatenate([m.vertices[m.triangles] for m in exact.box_walls((1, 1, 1))])
    point = np.array([0.3, 0.6, 0.0])
    factor = point_to_triangle(point, UP, corners)
    assert factor[2:].sum() == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1e4, 1e9])
def test_the_factor_does_not_change_with_scale(scale):
    rng = np.random.default_rng(4)
    triangles, points = rng.normal(size=(50, 3, 3)), rng.normal(size=(50, 3))
    normals = np.broadcast_to(UP, (50, 3))
    truth = point_to_triangle(points, normals, triangles)
    np.testing.assert_allclose(point_to_triangle(points * scale, normals, triangles * scale), truth, atol=1e-13)


def test_the_factors_of_a_triangles_parts_add_up():
    rng = np.random.default_rng(5)
    triangle = rng.normal(size=(3, 3)) + UP / 2
    a, b, c = triangle
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = np.array([[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]])
    assert point_to_triangle(np.zeros(3), UP, parts).sum() == pytest.approx(
        float(point_to_triangle(np.zeros(3), UP, triangle)), abs=1e-14
    )


def test_no_triangle_gives_a_factor_outside_zero_to_one():
    # Points on corners, edges and faces, triangles without area, points that nearly touch.
    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=float)
    points = np.array([[0, 0, 0], [0.5, 0, 0], [0.2, 0.2, 0], [0.2, 0.2, -1e-14], [0.2, 0.2, -1e-300]])
    normals = np.broadcast_to(UP, points.shape)
    for shape in (triangle, triangle[[0, 1, 1]], triangle[[0, 0, 0]]):
        factor = point_to_triangle(points, normals, shape)
        assert np.isfinite(factor).all() and (factor >= 0).all() and (factor <= 1).all()


def test_a_point_that_nearly_touches_a_triangle_sees_nothing_else():
    triangle = np.array([[-1, -1, 0], [2, -1, 0], [-1, 2, 0]], dtype=float)
    assert point_to_triangle(np.array([0, 0, -1e-9]), UP, triangle) == pytest.approx(1.0, abs=1e-7)
