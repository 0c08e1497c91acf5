# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The hierarchy of patches: children tile their parent, and a point finds the leaf it lies in."""

import numpy as np
import pytest
from radiosity_bake.core.coarse_patches import LARGEST_ASPECT, clustered_patches, coarse_patches
from radiosity_bake.core.location import DEEPEST_TABLE, Locator
from radiosity_bake.core.patches import PatchTree
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.surfaces import join

from tests.core.building import DARK, areas, dense, inside_weights, node_triangles
from tests.scenes import exact


def surfaces_of(*meshes):
    return join(Scene(meshes, DARK))


def slender_strip():
    """A strip of 100 x 1 beside a square, in one mesh each."""
    return surfaces_of(
        exact.rectangle("strip", (0, 0, 0), (100, 0, 0), (0, 1, 0)),
        exact.rectangle("square", (0, 2, 0), (100, 0, 0), (0, 100, 0)),
    )


def split_at_random(tree: PatchTree, times: int, seed: int = 0) -> PatchTree:
    """Split a quarter of all leaves at a time."""
    rng = np.random.default_rng(seed)
    for _ in range(times):
        leaves = tree.leaves()
        tree.split(np.sort(rng.choice(leaves, max(1, len(leaves) // 4), replace=False)))
    return tree


@pytest.fixture(scope="module")
def tree():
    """Sliced strip and square, split unevenly, and one corner split far deeper than the tables go."""
    tree = split_at_random(coarse_patches(slender_strip(), 0.5), 4)
    node = tree.leaves()[:1]
    for _ in range(DEEPEST_TABLE + 3):
        node = tree.split(node)[[0]]
    return tree


def test_split_children_tile_their_parent():
    tree = PatchTree(surfaces_of(exact.rectangle("square", (0, 0, 0), (1, 0, 0), (0.2, 1, 0.3))))
    parent = areas(node_triangles(tree, np.array([0, 1])))
    children = tree.split(np.array([0, 1]))
    np.testing.assert_allclose(areas(node_triangles(tree, children)), np.repeat(parent / 4, 4), rtol=1e-12)


@pytest.mark.parametrize("edge", [0, 1, 2])
def test_bisected_children_tile_their_parent(edge):
    tree = PatchTree(surfaces_of(exact.rectangle("square", (0, 0, 0), (1, 0, 0), (0.2, 1, 0.3))))
    parent = areas(node_triangles(tree, np.array([0])))
    children = tree.bisect(np.array([0]), np.array([edge]))
    np.testing.assert_allclose(areas(node_triangles(tree, children)), np.repeat(parent / 2, 2), rtol=1e-12)
    assert not set(tree.corners[0][[edge, (edge + 1) % 3]]) <= set(tree.corners[children[0]])


def test_leaves_tile_the_surfaces(tree):
    corners = node_triangles(tree, tree.leaves())
    total = np.bincount(tree.triangle[tree.leaves()], weights=areas(corners))
    np.testing.assert_allclose(total, [50, 50, 5000, 5000], rtol=1e-12)


def test_leaves_face_as_their_triangle_does(tree):
    corners = node_triangles(tree, tree.leaves())
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normal[:, 2] > 0).all()


def test_weights_give_the_position_of_every_corner(tree):
    whole = tree.points[tree.corners[tree.triangle]]
    assert (tree.triangle[:4] == np.arange(4)).all()
    np.testing.assert_allclose(tree.weights @ whole, node_triangles(tree, np.arange(len(tree))), atol=1e-12)
    np.testing.assert_allclose(tree.weights.sum(axis=2), 1.0, atol=1e-15)


def test_triangles_of_a_mesh_share_the_midpoints_of_their_edges():
    tree = PatchTree(surfaces_of(exact.closed_room((1, 2, 3), reflectance=0.5)))
    for _ in range(3):
        tree.split(tree.leaves())
    used = np.unique(tree.corners[tree.leaves()])
    assert len(np.unique(tree.points[used], axis=0)) == len(used)
    # Euler: a closed surface of f triangles has f / 2 + 2 vertices.
    assert len(used) == len(tree.leaves()) // 2 + 2


def test_vertices_that_were_split_in_the_data_share_their_midpoints():
    quad = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    tree = PatchTree(surfaces_of(surface_mesh("split", quad, [(0, 1, 2), (3, 4, 5)])))
    tree.split(tree.leaves())
    assert len(tree.points) == 6 + 5


def test_different_meshes_share_nothing():
    square = exact.rectangle("a", (0, 0, 0), (1, 0, 0), (0, 1, 0))
    tree = PatchTree(surfaces_of(square, square))
    tree.split(tree.leaves())
    used = [set(tree.corners[tree.leaves()][tree.triangle[tree.leaves()] < 2].ravel())]
    used.append(set(tree.corners[tree.leaves()][tree.triangle[tree.leaves()] >= 2].ravel()))
    assert not used[0] & used[1]


def test_splitting_a_copy_leaves_the_tree_as_it_was(tree):
    before = {name: value.copy() for name, value in vars(tree).items() if isinstance(value, np.ndarray)}
    split_at_random(tree.copy(), 2, seed=5)
    for name, value in before.items():
        assert np.array_equal(value, getattr(tree, name)), name


def random_points(tree: PatchTree, count: int, seed: int = 1):
    """Random points of the surfaces' triangles: triangle, float32 weights, positions of exactly those weights."""
    rng = np.random.default_rng(seed)
    triangle = rng.integers(0, 4, count)
    w = rng.random((count, 2))
    w = np.where(w.sum(axis=1, keepdims=True) > 1, 1 - w, w).astype(np.float32)
    # Many in the first triangle's corner, where the tree is deepest.
    close = count // 4
    first = int(np.flatnonzero(tree.level == tree.level.max())[0])
    corner = tree.weights[first].mean(axis=0)[1:]
    triangle[:close] = tree.triangle[first]
    w[:close] = corner + (w[:close] - 1 / 3) * (0.5 ** rng.integers(0, 14, (close, 1)))
    w = np.clip(w, 0, 1).astype(np.float32)
    inside = w.sum(axis=1) <= 1
    triangle, w = triangle[inside], w[inside]
    full = np.stack([1.0 - w[:, 0].astype(float) - w[:, 1], w[:, 0], w[:, 1]], axis=1)
    return triangle, w, np.einsum("nk,nkx->nx", full, node_triangles(tree, triangle))


def test_descending_finds_the_leaf_that_holds_a_point(tree):
    triangle, w, position = random_points(tree, 4000)
    leaf, inside = tree.descend(triangle, w)
    corners = node_triangles(tree, leaf)
    weights = inside_weights(position, corners)
    # float32 weights are off by 6e-8 of the triangle, which is larger in units of a smaller leaf; and a leaf's own
    # weights double that error with each level.
    size = np.sqrt(areas(node_triangles(tree, triangle)) / areas(corners))
    assert (weights.min(axis=1) >= -1e-6 * size).all()
    np.testing.assert_array_less(np.abs(weights[:, 1:] - inside).max(axis=1), 1e-6 * size)


def test_every_point_lies_in_one_leaf_only(tree):
    triangle, w, position = random_points(tree, 300)
    leaves = tree.leaves()
    found, _ = tree.descend(triangle, w)
    for at, (row, leaf) in enumerate(zip(triangle, found, strict=True)):
        own = leaves[tree.triangle[leaves] == row]
        weights = inside_weights(np.broadcast_to(position[at], (len(own), 3)), node_triangles(tree, own))
        best = own[weights.min(axis=1).argmax()]
        holds = weights.min(axis=1) > 1e-3  # well inside: then no other can claim it
        assert holds.sum() <= 1
        if holds.any():
            assert leaf == best


def test_the_table_names_the_leaf_that_descending_finds(tree):
    triangle, w, _ = random_points(tree, 50_000, seed=2)
    leaf, inside = tree.descend(triangle, w)
    locator = Locator(tree)
    on_patch = w.copy()
    root = locator.coarse(triangle.astype(np.int32), on_patch)
    found = locator.leaves(root, on_patch)
    differ = np.flatnonzero(found != leaf)
    # Only a point within rounding of a border may go to the leaf on its other side.
    assert len(differ) < 1e-3 * len(leaf)
    border = np.minimum(inside.min(axis=1), 1 - inside.sum(axis=1))
    assert (border[differ] < 1e-6 * 2.0 ** (tree.level[leaf[differ]] + 8)).all()


def test_the_table_takes_points_on_corners_edges_and_a_little_outside(tree):
    locator = Locator(tree)
    edge = np.array(
        [(0, 0), (1, 0), (0, 1), (0.5, 0.5), (0.5, 0), (0, 0.5), (1.0000001, 0), (-1e-7, 0.3), (0.5, 0.5000001)],
        dtype=np.float32,
    )
    for row in range(4):
        w = edge.copy()
        root = locator.coarse(np.full(len(edge), row, dtype=np.int32), w)
        leaf = locator.leaves(root, w)
        assert (tree.first_child[leaf] < 0).all()
        assert (tree.triangle[leaf] == row).all()


def test_a_tree_without_splits_is_its_own_table():
    tree = PatchTree(surfaces_of(exact.rectangle("square", (0, 0, 0), (1, 0, 0), (0, 1, 0))))
    w = np.random.default_rng(0).random((100, 2)).astype(np.float32) / 2
    root = np.arange(100, dtype=np.int32) % 2
    np.testing.assert_array_equal(Locator(tree).leaves(root, w), root)


def aspect(tree: PatchTree, nodes):
    corners = node_triangles(tree, nodes)
    longest = tree.sizes(nodes)
    return longest**2 / (2 * areas(corners))


@pytest.mark.parametrize("length", [10, 30, 100])
def test_slender_triangles_are_sliced_into_better_shaped_ones(length):
    surfaces = surfaces_of(exact.rectangle("strip", (0, 0, 0), (length, 0, 0), (0, 1, 0)))
    before, tree = PatchTree(surfaces), coarse_patches(surfaces, 0.1)
    assert aspect(before, before.leaves()).min() > length
    leaves = tree.leaves()
    shape, area = aspect(tree, leaves), areas(node_triangles(tree, leaves))
    # The far ends of a triangle stay pointed however it is cut, so most of the area counts, not every piece.
    assert area[shape < 0.7 * length].sum() > 0.5 * length


def test_no_coarse_patch_of_a_strip_is_much_longer_than_the_strip_is_wide():
    tree = coarse_patches(surfaces_of(exact.rectangle("strip", (0, 0, 0), (100, 0, 0), (0, 1, 0))), 0.1)
    assert tree.sizes(tree.leaves()).max() <= LARGEST_ASPECT * 1.0


@pytest.mark.parametrize("smallest", [0.1, 0.02])
def test_a_strip_is_cut_into_few_patches_however_small_n_is(smallest):
    tree = coarse_patches(surfaces_of(exact.rectangle("strip", (0, 0, 0), (100, 0, 0), (0, 1, 0))), smallest)
    # 200 right isosceles triangles of the strip's width would do; ten times as many are still few.
    assert len(tree.leaves()) <= 2000


def test_well_shaped_triangles_stay_whole():
    tree = coarse_patches(slender_strip(), 0.1)
    square = tree.leaves()[tree.triangle[tree.leaves()] >= 2]
    assert len(square) == 2


def test_slicing_stops_where_refinement_would_have_no_room():
    tree = coarse_patches(slender_strip(), 5.0)
    made = tree.leaves()[tree.leaves() >= 4]
    # Halves of an edge of 4 n and more.
    assert tree.sizes(made).min() >= 2 * 5.0 - 1e-9
    assert len(made) < 100


def test_slivers_do_not_hang_the_triangulation():
    sliver = surface_mesh("sliver", [(0, 0, 0), (1, 0, 0), (0.5, 1e-6, 0)], [(0, 1, 2)])
    tree = coarse_patches(surfaces_of(sliver), 0.05)
    assert len(tree.leaves()) < 64


def test_the_key_of_a_patch_does_not_depend_on_what_else_is_split_nor_on_the_order():
    surfaces = join(exact.furnace()[0])
    one, other = PatchTree(surfaces), PatchTree(surfaces)
    one.split(np.array([0, 1]))
    one.split(one.leaves()[-8:])
    other.split(np.array([3]))
    other.split(np.array([1]))
    other.split(np.array([0]))
    other.split(other.leaves())

    def key_of_corners(tree):
        return {tree.points[corners].tobytes(): int(key) for corners, key in zip(tree.corners, tree.key, strict=True)}

    known, found = key_of_corners(one), key_of_corners(other)
    both = known.keys() & found.keys()
    assert len(both) > len(surfaces.triangles) + 8
    assert all(known[corners] == found[corners] for corners in both)


def test_no_two_nodes_have_the_same_key():
    tree = clustered_patches(join(dense(exact.furnace()[0], 3)), 0.2)
    tree.by_key = True
    for _ in range(3):
        tree.divide(tree.patches())
    elements = np.arange(2 * len(tree))
    assert len(np.unique(tree.keys(elements))) == len(elements)
