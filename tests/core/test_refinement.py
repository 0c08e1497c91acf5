# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's loop: what is split, what is kept, what is traced, and how it ends."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core import refinement
from radiosity_bake.core.transport import Transport

from tests.core.building import grid, hits_by_row, inside_weights, node_triangles, room_with_block, transport_of
from tests.scenes import exact

RAYS = 64
MANY = 10**9


class Recorded(Transport):
    """Transport that remembers what was traced."""

    def trace(self, elements, report=lambda share: None):
        self.__dict__.setdefault("traced", []).extend(int(e) for e in elements)
        super().trace(elements, report)


def prepared(scene, smallest, rays=RAYS) -> Recorded:
    transport = transport_of(scene, smallest=smallest, rays=rays)
    transport.__class__ = Recorded
    transport.traced = []
    return transport


def seeds(transport):
    """Every element that takes part: fronts, and backs that light reaches."""

    def give():
        leaves = transport.tree.leaves()
        elements = np.sort(np.concatenate([2 * leaves, 2 * leaves + 1]))
        return elements[~transport.unlit_side[2 * transport.tree.triangle[elements >> 1] + (elements & 1)]]

    return give


def refined(scene, smallest, threshold=0.02, method="ADAPTIVE", most=MANY, rays=RAYS):
    transport = prepared(scene, smallest, rays)
    if method == "ADAPTIVE":
        return transport, refinement.refine(transport, seeds(transport), threshold, smallest, most)
    return transport, refinement.refine_uniformly(transport, seeds(transport), smallest, most)


def counted_factors(transport):
    """Receiver, source, share and its standard error of all pairs, counted anew from the rays."""
    for element, hits in hits_by_row(transport).items():
        valid = int((hits != -2).sum())
        for source, count in Counter(hits[hits >= 0].tolist()).items():
            padded = (count + 1) / (valid + 2)
            yield element, source, count / valid, np.sqrt(padded * (1 - padded) / valid)


@pytest.fixture(scope="module")
def room():
    """A room refined adaptively at n = 0.12."""
    return refined(room_with_block(), 0.12)


@pytest.fixture(scope="module")
def uniform_room():
    return refined(room_with_block(), 0.12, method="UNIFORM")


def test_at_the_end_no_fragment_above_the_threshold_is_large_enough_to_split(room):
    transport, rounds = room
    size = transport.tree.sizes(np.arange(len(transport.tree)))
    for _, source, share, error in counted_factors(transport):
        assert share <= 0.02 + error or size[source >> 1] < 2 * 0.12
    assert rounds.rounds[-1].largest_form_factor <= 0.02


def test_where_rays_cannot_tell_the_closed_form_decides():
    # Parallel squares seen from afar: their halves receive 0.5 * 0.0345 = 0.017 and 0.5 * 0.0425 = 0.021 of the energy.
    for distance, split in ((2.9, False), (2.5, True)):
        transport, rounds = refined(exact.aligned_squares(distance=distance)[0], 0.6, threshold=0.02)
        assert (len(transport.tree.leaves()) > 4) == split, distance
        assert rounds.ended == refinement.THRESHOLD_MET


def test_rays_name_leaves_only(room):
    transport, _ = room
    for element, hits in hits_by_row(transport).items():
        assert transport.tree.first_child[element >> 1] < 0
        assert (transport.tree.first_child[hits[hits >= 0] >> 1] < 0).all()


def test_every_element_that_takes_part_has_a_row(room):
    transport, _ = room
    assert transport.has_row()[seeds(transport)()].all()
    assert len(transport.met_but_untraced()) == 0


@pytest.mark.parametrize("which", ["room", "uniform_room"])
def test_no_fragment_made_by_splitting_is_smaller_than_n(which, request):
    transport, _ = request.getfixturevalue(which)
    tree = transport.tree
    made = tree.leaves()[tree.level[tree.leaves()] > 0]
    assert len(made) > 100
    assert tree.sizes(made).min() >= 0.12 - 1e-9


def test_only_new_receivers_are_traced(room):
    transport, rounds = room
    assert len(set(transport.traced)) == len(transport.traced)
    assert sum(entry.rays for entry in rounds.rounds) == RAYS * len(transport.traced)
    assert sum(entry.new_rows for entry in rounds.rounds) == len(transport.traced)


def test_few_fragments_are_traced_that_are_split_afterwards(room):
    # What a fragment sees is the mean of what its parts see, so the rays of the whole name most of the next splits.
    # Tracing each round's fragments took 1.33 times the rows that are left in the end.
    transport, rounds = room
    assert any(entry.split and not entry.new_rows for entry in rounds.rounds)
    assert len(transport.traced) < 1.25 * transport.row_count()


def test_later_rounds_trace_fewer_rows_than_there_are_fragments(room):
    _, rounds = room
    assert len(rounds.rounds) > 2
    assert rounds.rounds[2].new_rows < 2 * rounds.rounds[2].fragments
    assert sum(entry.rays_moved for entry in rounds.rounds) > 0


def test_fragments_grow_by_three_for_each_split(room):
    transport, rounds = room
    for before, after in zip(rounds.rounds, rounds.rounds[1:], strict=False):
        assert after.fragments == before.fragments + 3 * before.split
    assert rounds.rounds[-1].split == 0
    assert rounds.rounds[-1].fragments == len(transport.tree.leaves())


@pytest.fixture(scope="module")
def after_a_split():
    """A traced room before and after some of its patches were split, and what was counted."""
    transport = prepared(room_with_block(), 0.12)
    for _ in range(2):
        transport.tree.split(transport.tree.leaves())
    transport.follow_splits()
    refinement.trace_all(transport, seeds(transport), lambda share: None)
    before, rays = hits_by_row(transport), transport.rays.rays
    chosen = transport.tree.leaves()[::5]
    transport.tree.split(chosen)
    moved = transport.follow_splits()
    return transport, before, set(chosen.tolist()), moved, transport.rays.rays - rays


def test_rows_of_fragments_that_are_not_split_are_kept(after_a_split):
    transport, before, split, _, _ = after_a_split
    after = hits_by_row(transport)
    assert set(after) == {element for element in before if element >> 1 not in split}


def test_hits_on_fragments_that_are_not_split_stay_byte_for_byte(after_a_split):
    transport, before, split, _, _ = after_a_split
    for element, hits in hits_by_row(transport).items():
        untouched = ~np.isin(before[element] >> 1, list(split))
        assert hits[untouched].tobytes() == before[element][untouched].tobytes()


def test_hits_on_a_split_fragment_move_to_one_of_its_children(after_a_split):
    transport, before, split, _, _ = after_a_split
    for element, hits in hits_by_row(transport).items():
        stale = np.isin(before[element] >> 1, list(split))
        parent, child = before[element][stale] >> 1, hits[stale] >> 1
        first = transport.tree.first_child[parent]
        assert ((child >= first) & (child < first + 4)).all()
        assert ((before[element][stale] & 1) == (hits[stale] & 1)).all()


def test_no_ray_is_traced_for_a_hit_that_moves(after_a_split):
    _, before, split, moved, rays = after_a_split
    assert rays == 0
    kept = [hits for element, hits in before.items() if element >> 1 not in split]
    assert moved == sum(int(np.isin(hits >> 1, list(split)).sum()) for hits in kept) > 0


def test_moved_hits_are_those_that_tracing_again_finds(after_a_split):
    transport, _, _, _, _ = after_a_split
    again = Transport(transport.surfaces, transport.tree, transport.rays, np.ones((99, 2), bool), RAYS, transport.seed)
    again.unlit_side = transport.unlit_side
    again.trace(np.sort(transport.tables[0].element))
    moved, traced = hits_by_row(transport), hits_by_row(again)
    different = sum(int((moved[element] != traced[element]).sum()) for element in moved)
    # Rays do not depend on their batch but for the last bit of a product; a hit on a border may then change sides.
    assert different <= 1e-4 * RAYS * len(moved)


def test_moved_hits_lie_in_the_child_they_moved_to(after_a_split):
    transport, _, _, _, _ = after_a_split
    tree, table = transport.tree, transport.tables[0]
    hit = table.hits >= 0
    u, v = table.weights[hit].astype(float).T
    corners = node_triangles(tree, table.root[hit])
    position = corners[:, 0] * (1 - u - v)[:, None] + corners[:, 1] * u[:, None] + corners[:, 2] * v[:, None]
    weights = inside_weights(position, node_triangles(tree, table.hits[hit] >> 1))
    # float32 weights of the coarse patch, up to 8 times larger in its great-grandchildren.
    assert weights.min() > -1e-5


def test_uniform_fragments_all_have_sizes_between_n_and_2n(uniform_room):
    transport, rounds = uniform_room
    assert transport.tree.sizes(transport.tree.leaves()).max() < 2 * 0.12
    assert rounds.ended == refinement.UNIFORM_MET


def test_uniform_fragments_are_the_same_whatever_the_light(uniform_room):
    dark = room_with_block()
    transport, _ = refined(type(dark)(dark.meshes, np.ones(3)), 0.12, method="UNIFORM")
    assert len(transport.tree.leaves()) == len(uniform_room[0].tree.leaves())


def test_adaptive_never_has_more_fragments_or_rays_than_uniform(room, uniform_room):
    assert len(room[0].tree.leaves()) < len(uniform_room[0].tree.leaves())
    for smallest in (0.5, 0.3):
        adaptive, uniform = (refined(room_with_block(), smallest, method=m)[0] for m in ("ADAPTIVE", "UNIFORM"))
        assert len(adaptive.tree.leaves()) <= len(uniform.tree.leaves())


def test_a_higher_threshold_gives_no_more_fragments():
    counts = [len(refined(room_with_block(), 0.2, t)[0].tree.leaves()) for t in (0.005, 0.02, 0.05, 0.2, 1.0)]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] > 2 * counts[-1]


def test_a_smaller_n_gives_no_fewer_fragments():
    counts = [len(refined(room_with_block(), n)[0].tree.leaves()) for n in (1.0, 0.5, 0.25, 0.12)]
    assert counts == sorted(counts)


def test_a_threshold_that_nothing_exceeds_ends_at_once():
    transport, rounds = refined(room_with_block(), 0.05, threshold=1.0)
    assert rounds.ended == refinement.THRESHOLD_MET
    assert len(rounds.rounds) == 1
    assert (transport.tree.level[transport.tree.leaves()] == 0).all()


def test_far_apart_squares_end_below_the_threshold():
    transport, rounds = refined(exact.aligned_squares(distance=3.0)[0], 0.01, threshold=0.02)
    assert rounds.ended == refinement.THRESHOLD_MET
    assert all(share <= 0.02 + error for _, _, share, error in counted_factors(transport))
    assert transport.tree.sizes(transport.tree.leaves()).min() > 2 * 0.01


def test_touching_squares_end_at_the_minimum_size_along_their_edge_alone():
    transport, rounds = refined(exact.perpendicular_squares()[0], 0.05)
    assert rounds.ended == refinement.SIZE_MET
    tree, leaves = transport.tree, transport.tree.leaves()
    corners = node_triangles(tree, leaves)
    touching = ((np.abs(corners[..., 0]) < 1e-9) & (np.abs(corners[..., 2]) < 1e-9)).sum(axis=1) == 2
    # The factor across the edge stays at 0.2 whatever the size, so only the size ends it there.
    assert tree.sizes(leaves[touching]).max() < 2 * 0.05
    far = corners.max(axis=(1, 2)) > 0.9
    assert tree.sizes(leaves[far]).max() >= 2 * 0.05


def test_the_memory_limit_ends_the_subdivision_and_says_so():
    for method in ("ADAPTIVE", "UNIFORM"):
        transport, rounds = refined(room_with_block(), 0.05, method=method, most=300)
        assert rounds.ended == refinement.LIMIT_MET
        assert len(transport.tree.leaves()) <= 300
        assert transport.has_row()[seeds(transport)()].all()


def test_what_no_ray_meets_takes_nothing_off_the_memory_limit(room):
    # 2,048 triangles behind the room's walls, which are not baked: their rows would take most of what is allowed.
    inside = room_with_block()
    far = grid("far", 32)
    far = replace(far, vertices=far.vertices + [0.0, 0.0, 9.0])
    allowed = int(1.3 * RAYS * room[0].row_count())
    transport = prepared(replace(inside, meshes=(*inside.meshes, far)), 0.12)
    own = sum(len(mesh.triangles) for mesh in inside.meshes)

    def of_the_room():
        elements = seeds(transport)()
        return elements[transport.tree.triangle[elements >> 1] < own]

    rounds = refinement.refine(transport, of_the_room, 0.02, 0.12, allowed)
    assert 0.5 * allowed < RAYS * 2048
    assert rounds.ended != refinement.LIMIT_MET


def test_the_report_holds_plain_numbers(room):
    _, rounds = room
    for entry in rounds.as_report():
        assert set(entry) == {"fragments", "new_rows", "rays", "split", "rays_moved", "largest_form_factor"}
        assert all(type(value) in (int, float) for value in entry.values())
