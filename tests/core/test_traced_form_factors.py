# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Form factors counted from rays: against closed forms, the exact oracle, and the identities they must keep."""

import numpy as np
import pytest
from radiosity_bake.core.rows import ESCAPED
from radiosity_bake.core.scene import Scene

from tests.core.building import areas, dense, factor_matrix, fronts, hits_by_row, node_triangles, transport_of
from tests.scenes import exact, oracle


def mesh_factor(transport, sender: int, receiver: int) -> tuple[float, float]:
    """The form factor from the fronts of one mesh to those of another, and its standard error."""
    factor, _ = factor_matrix(transport)
    mesh = transport.surfaces.mesh_of_triangle[transport.tree.triangle]
    leaves = transport.tree.leaves()
    own, other = leaves[mesh[leaves] == sender], leaves[mesh[leaves] == receiver]
    weight = areas(node_triangles(transport.tree, own))
    weight /= weight.sum()
    share = factor[np.ix_(2 * own, 2 * other)].sum(axis=1)
    value = float(weight @ share)
    return value, float(np.sqrt(value * (1 - value) * (weight**2).sum() / transport.rays_per_row))


@pytest.fixture(scope="module")
def box():
    """A closed box of unequal sides, each of its 12 triangles traced by 2,048 rays."""
    scene, _ = exact.closed_box((1.0, 1.5, 0.8))
    transport = transport_of(scene, rays=2048)
    transport.trace(fronts(transport.tree))
    return transport


@pytest.fixture(scope="module")
def box_truth(box):
    """The exact factors between the triangles of the box, (12, 12)."""
    corners = node_triangles(box.tree, box.tree.leaves())
    return np.array([[oracle.form_factor(a, b) for b in corners] for a in corners])


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
@pytest.mark.parametrize(
    ("case", "truth"), [(exact.aligned_squares, 0.199824895698), (exact.perpendicular_squares, 0.200043776075)]
)
def test_facing_and_touching_squares_have_the_factor_of_the_catalogue(case, truth, scale):
    transport = transport_of(case(scale=scale)[0], rays=16384)
    transport.trace(fronts(transport.tree))
    for sender, receiver in ((0, 1), (1, 0)):
        value, error = mesh_factor(transport, sender, receiver)
        # 3 sigma of 32,768 independent rays, 0.0066; low-discrepancy rays do better.
        assert value == pytest.approx(truth, abs=3 * error)


def test_a_sheet_between_two_squares_takes_all_of_the_factor():
    transport = transport_of(exact.blocked_squares()[0], rays=1024)
    transport.trace(fronts(transport.tree))
    assert mesh_factor(transport, 0, 1)[0] == 0.0


def test_rays_of_a_closed_box_all_meet_its_walls(box):
    shares = box.shares()
    assert not (shares.source == ESCAPED).any()
    for table in box.tables:
        assert (table.valid == table.hits.shape[1]).all()


def test_every_row_sums_to_one(box):
    shares = box.shares()
    total = np.bincount(shares.receiver, weights=shares.share)
    # Counts of rays divided by 2,048 are exact in binary.
    assert set(total[fronts(box.tree)]) == {1.0}


def test_rows_of_an_open_scene_sum_to_one_with_what_escapes():
    transport = transport_of(exact.perpendicular_squares()[0], rays=500)
    transport.trace(fronts(transport.tree))
    shares = transport.shares()
    assert (shares.source == ESCAPED).any()
    total = np.bincount(shares.receiver, weights=shares.share)[fronts(transport.tree)]
    np.testing.assert_allclose(total, 1.0, atol=1e-12)


def test_the_standard_error_bounds_the_true_error(box, box_truth):
    factor, error = factor_matrix(box)
    factor, error = factor[::2, ::2], error[::2, ::2]
    pairs = error > 0
    z = (factor - box_truth)[pairs] / error[pairs]
    assert pairs.sum() > 100
    # Independent rays would have a mean square of 1 over 120 pairs, known to within 13%; these have less.
    assert np.sqrt((z**2).mean()) < 1.3
    assert np.abs(z).max() < 4.0


def test_pairs_that_exchange_nothing_have_no_entry(box, box_truth):
    factor, _ = factor_matrix(box)
    assert (factor[::2, ::2][box_truth == 0.0] == 0.0).all()


def test_traced_factors_are_reciprocal(box):
    factor, error = factor_matrix(box)
    area = areas(node_triangles(box.tree, box.tree.leaves()))[:, None]
    sent, sigma = area * factor[::2, ::2], area * error[::2, ::2]
    pairs = np.triu(sigma > 0, 1) & (sigma.T > 0)
    z = (sent - sent.T)[pairs] / np.sqrt(sigma**2 + sigma.T**2)[pairs]
    # 60 pairs: the mean square is known to within 18% of 1.
    assert np.sqrt((z**2).mean()) < 1.4


def test_pairs_within_a_sphere_agree_with_the_exact_factors_of_their_triangles():
    transport = transport_of(exact.sphere_interior(1)[0], rays=8192)
    leaves = transport.tree.leaves()
    transport.trace(2 * leaves[:6])
    factor, error = factor_matrix(transport)
    corners = node_triangles(transport.tree, leaves)
    for i in range(6):
        for j in (20, 33, 47, 61, 79):
            truth = oracle.form_factor(corners[i], corners[j])
            assert factor[2 * i, 2 * j] == pytest.approx(truth, abs=4 * error[2 * i, 2 * j])


def test_far_pairs_within_a_sphere_take_their_share_of_its_area():
    scene, expected = exact.sphere_interior(1)
    transport = transport_of(scene, rays=4096)
    transport.trace(fronts(transport.tree))
    factor = factor_matrix(transport)[0][::2, ::2]
    centre = node_triangles(transport.tree, transport.tree.leaves()).mean(axis=1)
    far = np.linalg.norm(centre[:, None] - centre[None], axis=2) > 1.0
    ratio = factor[far].sum() / expected["form_factors"][far].sum()
    # The flat triangles' own deviation; thousands of pairs leave no noise.
    assert ratio == pytest.approx(1.0, abs=expected["far_tolerance"])


def test_lengthening_a_row_keeps_its_rays_and_adds_three_times_as_many():
    transport = transport_of(exact.closed_box()[0], rays=256)
    elements = fronts(transport.tree)
    transport.trace(elements)
    before = hits_by_row(transport)
    transport.lengthen(elements[3:7])
    after = hits_by_row(transport)
    for element in elements:
        assert len(after[element]) == (1024 if element in elements[3:7] else 256)
        assert after[element][:256].tobytes() == before[element].tobytes()
    assert (transport.tables[1].valid == 1024).all()


def test_what_lengthened_rows_are_the_first_to_meet_gets_rows_as_well():
    lamp = exact.rectangle("lamp", (0.3, 0.3, 0.9), (0, 0.4, 0), (0.4, 0, 0), emission=5.0)
    transport = transport_of(dense(Scene((*exact.box_walls((1, 1, 1)), lamp), np.zeros(3)), 4), rays=2)
    emits = transport.surfaces.emission.any(axis=1)
    lit = fronts(transport.tree)
    transport.trace(lit[emits[transport.tree.triangle[lit >> 1]]][:1])
    while len(met := transport.met_but_untraced()):
        transport.trace(met)
    before = np.count_nonzero(transport.has_row())
    # The lamp's few rows that there are send out all the light that is known, and so get more rays.
    transport.lengthen_few()
    assert len(transport.tables[1].element) > 0
    assert np.count_nonzero(transport.has_row()) > before
    assert len(transport.met_but_untraced()) == 0


def test_a_lengthened_row_is_the_row_that_is_traced_long_at_once():
    short, long = (transport_of(exact.closed_box()[0], rays=n) for n in (256, 1024))
    elements = fronts(short.tree)
    short.trace(elements)
    short.lengthen(elements)
    long.trace(elements)
    rows, whole = hits_by_row(short), hits_by_row(long)
    for element in elements:
        # Turned float32 products may round differently in batches of another shape: a ray in a thousand at a border.
        assert (rows[element] != whole[element]).mean() < 1e-3


def test_lengthened_rows_are_closer_to_the_truth_and_say_so():
    scene, _ = exact.closed_box((1.0, 1.5, 0.8))
    transport = transport_of(scene, rays=256)
    elements = fronts(transport.tree)
    transport.trace(elements)
    corners = node_triangles(transport.tree, transport.tree.leaves())
    truth = np.array([[oracle.form_factor(a, b) for b in corners] for a in corners])
    before, error_before = factor_matrix(transport)
    transport.lengthen(elements)
    after, error_after = factor_matrix(transport)

    def rms(factor):
        return np.sqrt(((factor[::2, ::2] - truth) ** 2).mean())

    # Four times the rays halve the error if they are independent; 120 pairs tell that ratio to about a tenth.
    assert rms(after) < 0.65 * rms(before)
    both = (error_before > 0) & (error_after > 0)
    assert np.median(error_after[both] / error_before[both]) == pytest.approx(0.5, abs=0.05)


def test_rays_that_start_inside_a_solid_are_not_counted():
    # A floor that runs on under a block: its rays from below the block meet the block's inside.
    from tests.core.building import DARK, Scene, block

    floor = exact.rectangle("floor", (0, 0, 0), (1, 0, 0), (0, 1, 0), reflectance=0.5)
    lamp = exact.rectangle("lamp", (0, 0, 2), (0, 1, 0), (1, 0, 0), emission=1.0)
    scene = Scene((floor, lamp, block("block", (0, 0, -0.1), (0.5, 1, 1))), DARK)
    transport = transport_of(scene, rays=4096)
    transport.trace(np.array([0, 2]))
    buried = transport.buried_share()[[0, 2]]
    # The two triangles are halves of the floor along its diagonal: three quarters and one quarter lie under the block.
    # 3 sigma of 4,096 rays.
    np.testing.assert_allclose(np.sort(buried), [0.25, 0.75], atol=3 * np.sqrt(0.25 * 0.75 / 4096))
    total = np.bincount(transport.shares().receiver, weights=transport.shares().share)
    np.testing.assert_allclose(total[[0, 2]], 1.0, atol=1e-12)
