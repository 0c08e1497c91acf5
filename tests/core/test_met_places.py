# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The places that rays met: the same rows as arrays that are copied would have, without copies."""

import numpy as np
import pytest
from radiosity_bake.core.met_places import MetPlaces


@pytest.fixture
def tables():
    """Two tables of six and four receivers with three rays each, all places different."""
    return np.arange(18, dtype=np.int32).reshape(6, 3), np.arange(100, 112, dtype=np.int32).reshape(4, 3)


def test_receivers_put_together_and_chosen_have_the_places_that_they_had(tables):
    one, other = tables
    which = np.array([9, 0, 6, 3, 8])
    found = MetPlaces.of(one).joined(MetPlaces.of(other)).taken(which)
    np.testing.assert_array_equal(found.between(0, len(found)), np.concatenate([one, other])[which])
    np.testing.assert_array_equal(found.between(1, 3), np.concatenate([one, other])[which[1:3]])


def test_new_receivers_take_their_own_places_among_old_ones(tables):
    one, other = tables
    taken, rows = np.array([0, 1, 0, 2, 0, 0, 5]), np.array([0, 2, 4, 5])
    expected = one[taken]
    expected[rows] = other
    found = MetPlaces.of(one).with_more(taken, MetPlaces.of(other), rows)
    np.testing.assert_array_equal(found.between(0, len(found)), expected)


def test_no_place_is_copied(tables):
    one, other = tables
    found = MetPlaces.of(one).joined(MetPlaces.of(other)).taken(np.arange(3, 9))
    assert found.tables[0] is one
    assert found.tables[1] is other


def test_where_some_places_are_not_kept_none_are(tables):
    one, _ = tables
    found = MetPlaces.of(one).joined(MetPlaces.of(np.empty((2, 0), dtype=np.int32)))
    assert (len(found), found.rays, found.tables) == (8, 0, ())
    assert found.between(0, 8).shape == (8, 0)
