# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The patch limit: never a failure, and the coarsest honest answer."""

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.lighting import LARGEST_IMBALANCE
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import block, cornell_box, dense, mean_over, room_with_block, transport_of
from tests.scenes import exact

WITHIN = 1.1
"""What is promised of a limit."""


def baked(scene: Scene, limit: int, **settings: object):
    """The result of a bake with a patch limit, and its warnings of it."""
    result = bake(scene, BakeSettings(quality="DRAFT", patch_limit=limit, keep_transport=False, **settings))
    return result, [warning for warning in result.report["warnings"] if "patch limit" in warning.lower()]


@pytest.mark.parametrize("limit", [40, 300, 1500])
@pytest.mark.parametrize("method", ["ADAPTIVE", "UNIFORM"])
def test_no_more_patches_are_made_than_the_limit_allows_and_not_far_fewer(limit, method):
    result, warnings = baked(cornell_box(), limit, method=method, threshold=1e-3)
    # A uniform round makes four of each, so that up to three quarters of the room may be left; others fill it.
    least = limit / 4 if method == "UNIFORM" else limit / WITHIN
    assert least <= result.report["patches"] <= WITHIN * limit
    assert len(warnings) == 1 and f"{result.report['patches']:,} patches" in warnings[0]
    assert result.report["ended"] == "the patch limit allows no more fragments"


def test_a_limit_that_is_not_reached_changes_nothing_and_is_not_mentioned():
    free, _ = baked(cornell_box(), 0)
    roomy, warnings = baked(cornell_box(), free.report["patches"])
    assert warnings == []
    for one, other in zip(free.meshes, roomy.meshes, strict=True):
        assert np.array_equal(one.irradiance, other.irradiance)


def test_dense_meshes_are_clustered_more_coarsely_for_the_limit():
    free, _ = baked(dense(cornell_box(), 3), 0, threshold=1.0)
    result, warnings = baked(dense(cornell_box(), 3), 60, threshold=1.0)
    assert free.report["patches"] > 4 * 60
    assert result.report["patches"] <= WITHIN * 60
    # The size alone was made for it, as far as it had to be.
    assert warnings == []


def test_what_cannot_be_joined_stays_apart_and_the_warning_says_how_much_it_is():
    blocks = tuple(block(f"block {k}", (3.0 * k, 0.0, 0.5), (1.0, 1.0, 1.0)) for k in range(8))
    result, warnings = baked(
        Scene((*blocks, exact.rectangle("floor", (-1, -1, 0), (26, 0, 0), (0, 2, 0))), np.ones(3)), 5
    )
    assert result.report["patches"] > 5
    assert len(warnings) == 1 and f"{result.report['patches']:,} patches at least" in warnings[0]


def test_the_light_of_few_patches_is_that_of_the_room_within_the_error_that_is_told():
    free, _ = baked(room_with_block(), 0)
    few, _ = baked(room_with_block(), 60)
    assert few.report["estimated_error"] > free.report["estimated_error"]
    assert mean_over(few.meshes) == pytest.approx(mean_over(free.meshes), rel=few.report["estimated_error"])


def test_what_few_patches_exchange_is_not_left_to_chance():
    room = exact.closed_room((2, 2, 2), reflectance=0.8)
    lamp = exact.rectangle("lamp", (0.7, 0.7, 1.93), (0, 0.6, 0), (0.6, 0, 0), emission=5.0)
    for seed in range(4):
        result, _ = baked(Scene((room, lamp), np.zeros(3)), 20, seed=seed, output="ORIGINAL")
        # A row of ordinary length each, and as few points on the ceiling above the lamp, miss up to a seventh of it.
        assert abs(result.report["energy"]["imbalance"]) < LARGEST_IMBALANCE


def test_a_hair_that_the_limit_left_in_few_pieces_is_not_split_into_a_lawn():
    hair = exact.rectangle("hair", (-1, 0, 0), (2, 0, 0), (0, 1e-6, 0))
    result, _ = baked(Scene((hair,), np.ones(3)), 10)
    # Its eight pieces may be 256 faces each, and some more to fit; without an end there were half a million.
    assert result.report["triangles"] < 10_000


def test_the_parts_of_patches_are_as_many_as_dividing_them_makes():
    tree = transport_of(dense(cornell_box(), 3), smallest=0.2, clustered=True).tree
    for _ in range(3):
        patches = tree.patches()
        expected = int(tree.parts(patches).sum())
        tree.divide(patches)
        assert len(tree.patches()) == expected
