# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sampling patterns: even over triangles and hemispheres, and dependent on nothing but seed and number."""

import numpy as np
import pytest
from radiosity_bake.core.sampling import (
    PATTERNS,
    Patterns,
    cosine_directions,
    frames,
    hashed,
    hemisphere,
    sequence,
    shifted,
    triangle_weights,
)

RAYS = 256


@pytest.fixture(scope="module")
def patterns():
    return Patterns.make(0, RAYS, 5)


def chi_square(counts, expected) -> float:
    return float(((counts - expected) ** 2 / expected).sum())


def largest_chi_square(cells: int) -> float:
    """4 sigma above the mean of a chi-square of so many cells; one in 30,000 at random, and ours have less spread."""
    return cells - 1 + 4 * np.sqrt(2 * (cells - 1))


def test_ray_origins_are_even_over_the_triangle(patterns):
    u, v = patterns.positions[..., 1].ravel().astype(float), patterns.positions[..., 2].ravel().astype(float)
    assert (u >= 0).all() and (v >= 0).all() and (u + v <= 1 + 1e-6).all()
    # The 64 triangles of three splits by midpoints, all of one area.
    side = 8
    i, j = np.minimum((u * side).astype(int), side - 1), np.minimum((v * side).astype(int), side - 1)
    upper = (u * side - i) + (v * side - j) > 1
    counts = np.unique((i * side + j) * 2 + upper, return_counts=True)[1]
    counts = counts[counts > 3]  # borders may round into cells beyond the diagonal
    assert len(counts) == 64
    assert chi_square(counts, len(u) / 64) < largest_chi_square(64)


def test_directions_follow_the_cosine(patterns):
    d = patterns.directions.reshape(-1, 3).astype(float)
    np.testing.assert_allclose(np.linalg.norm(d, axis=1), 1.0, atol=1e-6)
    assert (d[:, 2] >= 0).all()
    # With density cos / pi, z^2 is uniform in 0..1, and so is the angle about the axis: 8 x 8 equal cells.
    ring = np.minimum((d[:, 2] ** 2 * 8).astype(int), 7)
    sector = np.minimum(((np.arctan2(d[:, 1], d[:, 0]) / (2 * np.pi)) % 1.0 * 8).astype(int), 7)
    counts = np.bincount(ring * 8 + sector, minlength=64)
    assert chi_square(counts, len(d) / 64) < largest_chi_square(64)


def test_directions_have_the_moments_of_the_cosine(patterns):
    d = patterns.directions.reshape(-1, 3).astype(float)
    n = len(d)
    # E z = 2/3 (variance 1/18), E z^2 = 1/2 (1/12), E x^2 = E y^2 = 1/4 (5/48), E xy = E x = 0 (1/24, 1/4): 4 sigma of
    # 16,384 independent ones.
    for value, mean, variance in (
        (d[:, 2], 2 / 3, 1 / 18),
        (d[:, 2] ** 2, 1 / 2, 1 / 12),
        (d[:, 0] ** 2, 1 / 4, 5 / 48),
        (d[:, 1] ** 2, 1 / 4, 5 / 48),
        (d[:, 0] * d[:, 1], 0.0, 1 / 24),
        (d[:, 0], 0.0, 1 / 4),
        (d[:, 1], 0.0, 1 / 4),
    ):
        assert value.mean() == pytest.approx(mean, abs=4 * np.sqrt(variance / n))


def test_each_pattern_alone_is_evener_than_random_rays(patterns):
    # The mean of cos over 256 random directions varies by sqrt(1 / 18 / 256) = 0.0147 from pattern to pattern.
    means = patterns.directions[..., 2].mean(axis=1)
    assert means.std() < 0.0147 / 3


def test_origin_and_direction_of_a_ray_are_unrelated(patterns):
    d, p = patterns.directions.reshape(-1, 3).astype(float), patterns.positions.reshape(-1, 3).astype(float)
    for k in range(3):
        for u in (1, 2):
            correlation = np.corrcoef(d[:, k], p[:, u])[0, 1]
            assert abs(correlation) < 4 / np.sqrt(len(d))


def test_a_pattern_goes_on_where_it_ended(patterns):
    first, rest = Patterns.make(0, 100, 5), Patterns.make(100, RAYS - 100, 5)
    for name in ("directions", "positions"):
        joined = np.concatenate([getattr(first, name), getattr(rest, name)], axis=1)
        assert joined.tobytes() == getattr(patterns, name).tobytes()


def test_patterns_depend_on_the_seed_alone(patterns):
    assert Patterns.make(0, RAYS, 5).directions.tobytes() == patterns.directions.tobytes()
    assert not np.array_equal(Patterns.make(0, RAYS, 6).directions, patterns.directions)


def test_a_receivers_pattern_does_not_depend_on_its_batch(patterns):
    keys = np.arange(1000)
    whole = patterns.choose(keys, 7)
    for part in (slice(0, 1), slice(13, 500), slice(999, 1000)):
        for all_of_them, some in zip(whole, patterns.choose(keys[part], 7), strict=True):
            assert all_of_them[part].tobytes() == some.tobytes()


def test_receivers_use_all_patterns_evenly_and_no_two_the_same_rays(patterns):
    pattern, angle = patterns.choose(np.arange(64_000), 7)
    assert chi_square(np.bincount(pattern, minlength=PATTERNS), 1000.0) < largest_chi_square(PATTERNS)
    assert len(np.unique(np.stack([pattern, angle]), axis=1).T) == 64_000


def test_hashed_numbers_are_even_and_unrelated_between_neighbours_and_dimensions():
    drawn = hashed(np.arange(40_000), 3, 0)
    assert (drawn >= 0).all() and (drawn < 1).all()
    for k in range(3):
        counts = np.bincount((drawn[:, k] * 100).astype(int), minlength=100)
        assert chi_square(counts, 400.0) < largest_chi_square(100)
    limit = 4 / np.sqrt(40_000)
    assert abs(np.corrcoef(drawn[1:, 0], drawn[:-1, 0])[0, 1]) < limit
    assert np.abs(np.corrcoef(drawn.T) - np.eye(3)).max() < limit


def test_hashed_numbers_of_seeds_and_keys_do_not_run_into_each_other():
    drawn = np.stack([hashed(np.arange(2000), 2, seed)[:, 0] for seed in range(20)])
    assert len(np.unique(drawn)) == drawn.size


def test_the_sequence_fills_the_square_evenly():
    points = sequence(0, 4096, 2)
    cells = np.bincount((points * 16).astype(int) @ [16, 1], minlength=256)
    # 16 points a cell; independent ones would vary by 4, a low-discrepancy sequence by about 1.
    assert cells.std() < 2.0


def test_shifted_points_stay_in_the_unit_interval():
    points = shifted(sequence(0, 100, 3), hashed(np.arange(50), 3, 1))
    assert points.shape == (50, 100, 3)
    assert (points >= 0).all() and (points < 1).all()


def test_folded_weights_lie_in_the_triangle():
    w = triangle_weights(np.random.default_rng(0).random((1000, 2)))
    assert (w >= 0).all() and (w.sum(axis=1) <= 1).all()


def test_the_pole_and_the_rim_of_the_hemisphere_are_finite():
    d = hemisphere(np.array([[0.0, 0.3], [1.0, 0.3], [1.0 - 1e-17, 0.9]]))
    np.testing.assert_allclose(np.linalg.norm(d, axis=1), 1.0, atol=1e-12)


def test_frames_are_right_handed_and_orthonormal_for_every_normal():
    rng = np.random.default_rng(0)
    normals = rng.normal(size=(500, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    poles = np.array([[0, 0, 1], [0, 0, -1], [0, 0, -1 + 1e-16], [1e-9, 0, -1], [1, 0, 0], [0, -1, 0]], dtype=float)
    normals = np.concatenate([normals, poles])
    frame = frames(normals, rng.random(len(normals)) * 6.3).astype(float)
    eye = np.einsum("nij,nkj->nik", frame, frame)
    # float32 rounding of products of two
    np.testing.assert_allclose(eye, np.broadcast_to(np.eye(3), eye.shape), atol=1e-6)
    np.testing.assert_allclose(np.linalg.det(frame), 1.0, atol=1e-6)
    np.testing.assert_allclose(frame[:, 2], normals, atol=1e-7)


def test_cosine_directions_lean_to_their_normal():
    normals = np.broadcast_to([0.6, 0.0, -0.8], (4000, 3))
    d = cosine_directions(np.random.default_rng(0).random((4000, 2)), normals)
    cosine = np.einsum("nx,nx->n", d, normals)
    assert (cosine >= -1e-7).all()
    assert cosine.mean() == pytest.approx(2 / 3, abs=4 * np.sqrt(1 / 18 / 4000))
