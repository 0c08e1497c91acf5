# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The places that rays met: the same rows as arrays that are copied would have, without copies."""

import numpy as np
import pytest
from radiosity_bake.core.aimed_light import AimedLight
from radiosity_bake.core.direct_light import DirectLight
from radiosity_bake.core.met_places import MetPlaces, MetTable
from radiosity_bake.core.scene import LUMINANCE


@pytest.fixture
def tables():
    """Two tables of six and four receivers with three rays each, all places different."""
    return np.arange(18, dtype=np.int32).reshape(6, 3), np.arange(100, 112, dtype=np.int32).reshape(4, 3)


def met(places):
    """The places of receivers that aimed no rays, row by row."""
    return MetPlaces.of(MetTable.of(places))


def test_receivers_put_together_and_chosen_have_the_places_that_they_had(tables):
    one, other = tables
    which = np.array([9, 0, 6, 3, 8])
    found = met(one).joined(met(other)).taken(which)
    np.testing.assert_array_equal(found.places(found.rows[:, 0]), np.concatenate([one, other])[which])
    np.testing.assert_array_equal(found.places(found.rows[1:3, 0]), np.concatenate([one, other])[which[1:3]])


def test_new_receivers_take_their_own_places_among_old_ones(tables):
    one, other = tables
    taken, rows = np.array([0, 1, 0, 2, 0, 0, 5]), np.array([0, 2, 4, 5])
    expected = one[taken]
    expected[rows] = other
    found = met(one).with_more(taken, met(other), rows)
    np.testing.assert_array_equal(found.places(found.rows[:, 0]), expected)


def test_a_table_that_two_have_in_common_is_there_once(tables):
    one, other = tables
    common = met(one)
    found = common.joined(met(other).joined(common))
    assert len(found.tables) == 2
    np.testing.assert_array_equal(found.places(found.rows[:, 0]), np.concatenate([one, other, one]))


def test_no_place_is_copied(tables):
    one, other = tables
    found = met(one).joined(met(other)).taken(np.arange(3, 9))
    assert found.tables[0].places is one
    assert found.tables[1].places is other


def test_where_some_places_are_not_kept_none_are(tables):
    one, _ = tables
    found = met(one).joined(met(np.empty((2, 0), dtype=np.int32)))
    assert (len(found), found.rays, found.tables) == (8, 0, ())
    assert found.places(np.arange(8)).shape == (8, 0)


def test_a_mean_names_the_rows_of_those_that_it_is_of(tables):
    one, other = tables
    both = met(one).joined(met(other))
    mixed = both.mixed(np.array([[7, 2], [3, 3]]), np.array([[0.25, 0.75], [0.5, 0.5]]))
    values = np.arange(10.0) ** 2
    np.testing.assert_allclose(mixed.of_receivers(np.arange(10), values), [0.25 * 49 + 0.75 * 4, 9.0])
    np.testing.assert_array_equal(mixed.named(), [2, 3, 7])


def test_a_mean_of_means_names_each_row_once(tables):
    one, _ = tables
    own = met(one)
    first = own.joined(own.mixed(np.array([[0, 1], [1, 2]]), np.full((2, 2), 0.5)))
    second = first.mixed(np.array([[6, 7]]), np.full((1, 2), 0.5))
    np.testing.assert_array_equal(second.rows, [[0, 1, 2]])
    np.testing.assert_allclose(second.weights, [[0.25, 0.5, 0.25]])


def test_places_that_go_on_from_others_do_not_have_their_tables_twice(tables):
    one, other = tables
    own = met(one)
    more = own.mixed(np.array([[0, 5]]), np.full((1, 2), 0.5)).joined(met(other))
    found = own.joined(more)
    assert len(found.tables) == 2
    np.testing.assert_array_equal(found.rows[6], [0, 5])
    np.testing.assert_array_equal(found.places(found.rows[7:, 0]), other)


def test_errors_that_may_go_together_are_not_averaged_away(tables):
    one, _ = tables
    mixed = met(one).mixed(np.array([[0, 1, 2]]), np.array([[0.8, 0.6, -0.4]]))
    np.testing.assert_allclose(mixed.errors_of_receivers(np.arange(3), np.ones(3)), 1.8, rtol=1e-6)


def test_receivers_keep_the_light_of_bright_places_that_they_had(tables):
    one, other = (MetPlaces.of(MetTable(table, lit(len(table), 1.0 + k))) for k, table in enumerate(tables))
    radiance = np.array([[0.0, 0.0, 0.0], [3.0, 2.0, 1.0]], dtype=np.float32)
    found = one.joined(other).taken(np.array([9, 0, 6, 3]))
    light, difference = found.aimed_at(found.rows[:, 0], radiance)
    np.testing.assert_array_equal(light[:, 1], 2.0 * np.array([5.0, 1.0, 2.0, 4.0]))
    # All of it came by even rays.
    np.testing.assert_allclose(difference, light @ LUMINANCE)
    assert set(found.places_aimed_at()) == {1}


def lit(count, first):
    """Receivers that see place 1 by weights from `first` on."""
    some = np.arange(count)
    return AimedLight(DirectLight.of(count, some, np.ones(count, int), first + some), DirectLight.none(count))
