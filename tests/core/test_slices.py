# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Slivers become rows of pieces: as many as their length asks for, whatever their shape."""

import numpy as np
import pytest
from radiosity_bake.core.coarse_patches import LARGEST_ASPECT, LONGEST_ROW, coarse_patches
from radiosity_bake.core.patches import PatchTree
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.slices import parts_of_edges, sliced
from radiosity_bake.core.surfaces import join

from tests.core.building import DARK, areas, node_triangles, t_junctions
from tests.scenes import exact

# The third corner over the base from (0, 0) to (1, 0): needles with either end sharp, caps, and round ones.
CORNERS = {
    "needle": (1.0, 1e-3),
    "needle from the other end": (0.0, 1e-3),
    "cap": (0.5, 1e-4),
    "cap aside": (0.13, 1e-2),
    "right": (0.5, 0.5),
    "almost flat": (0.7, 1e-7),
}


def triangle(name: str, first: int):
    """Return a triangle whose base begins at this corner."""
    return np.roll(np.array([(0, 0, 0), (1, 0, 0), (*CORNERS[name], 0)], dtype=float), first, axis=0)


def cut(corners, longest: float):
    """Slices of one triangle, and the parts of its edges."""
    lengths = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)[None]
    parts = parts_of_edges(lengths, np.array([longest]))
    return sliced(lengths, parts), parts[0]


@pytest.mark.parametrize("first", [0, 1, 2])
@pytest.mark.parametrize("name", CORNERS)
@pytest.mark.parametrize("longest", [0.6, 0.3, 0.01])
def test_pieces_tile_their_triangle_and_use_every_vertex_on_its_edges(name, first, longest):
    corners = triangle(name, first)
    pieces, parts = cut(corners, longest)
    assert (pieces.of == 0).all()
    # A polygon of n vertices is n - 2 triangles.
    assert len(pieces.of) == parts.sum() - 2
    np.testing.assert_allclose(pieces.weights.sum(axis=2), 1.0, atol=1e-15)
    made = pieces.weights @ corners
    turned = np.cross(made[:, 1] - made[:, 0], made[:, 2] - made[:, 0])[:, 2]
    assert (turned > 0.0).all()
    assert turned.sum() == pytest.approx(CORNERS[name][1], rel=1e-12)
    points, number = np.unique(np.round(pieces.weights.reshape(-1, 3), 12), axis=0, return_inverse=True)
    assert len(points) == parts.sum()
    assert t_junctions(points, number.reshape(-1, 3)) == 0


def test_edges_are_halved_until_they_are_short_enough_and_no_more():
    assert parts_of_edges(np.array([[1.0, 2.0, 2.1]]), np.array([0.5])).tolist() == [[2, 4, 8]]
    assert parts_of_edges(np.array([[0.1, 0.5, 0.2]]), np.array([0.5])).tolist() == [[1, 1, 1]]


def test_triangles_cut_at_once_are_cut_as_each_alone():
    corners = np.stack([triangle(name, first) for name in CORNERS for first in range(3)])
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    longest = np.resize([0.6, 0.2, 0.05, 0.01], len(corners))
    parts = parts_of_edges(lengths, longest)
    together = sliced(lengths, parts)
    for k in range(len(corners)):
        alone = sliced(lengths[k : k + 1], parts[k : k + 1])
        np.testing.assert_array_equal(together.weights[together.of == k], alone.weights)
        np.testing.assert_array_equal(together.beyond[together.of == k], alone.beyond)


@pytest.mark.parametrize("name", CORNERS)
def test_a_point_finds_the_piece_that_it_lies_in(name):
    shape = surface_mesh("sliver", triangle(name, 1), [(0, 1, 2)])
    surfaces = join(Scene((shape,), DARK))
    tree = PatchTree(surfaces)
    lengths = np.linalg.norm(np.roll(triangle(name, 1), -1, axis=0) - triangle(name, 1), axis=1)[None]
    tree.slice(np.array([0]), parts_of_edges(lengths, np.array([0.02])))
    leaves = tree.leaves()
    rng = np.random.default_rng(2)
    piece = rng.choice(leaves, 3000)
    # Well inside, as weights of single precision blur the borders of 64 pieces by 64 times their rounding.
    inside = 0.98 * rng.dirichlet((1.0, 1.0, 1.0), len(piece)) + 0.02 / 3.0
    w = np.einsum("nk,nkx->nx", inside, tree.weights[piece])[:, 1:].astype(np.float32)
    for found, weights in (tree.descend(0 * piece, w), tree.descend_to_coarse(0 * piece, w)):
        np.testing.assert_array_equal(found, piece)
        np.testing.assert_allclose(weights, inside[:, 1:], atol=64 * 4 * np.finfo(np.float32).eps / 0.02)


def test_a_point_finds_its_piece_in_triangles_that_were_cut_before():
    tree = PatchTree(strip_of(1.0, 1e-3))
    tree.bisect(np.array([0, 1]), np.array([0, 1]), np.array([0.3, 0.4]))
    leaves = tree.leaves()
    lengths = np.linalg.norm(np.diff(tree.points[tree.corners[leaves][:, [0, 1, 2, 0]]], axis=1), axis=2)
    tree.slice(leaves, parts_of_edges(lengths, np.full(len(leaves), 0.02)))
    rng = np.random.default_rng(4)
    piece = rng.choice(tree.leaves(), 3000)
    inside = 0.98 * rng.dirichlet((1.0, 1.0, 1.0), len(piece)) + 0.02 / 3.0
    w = np.einsum("nk,nkx->nx", inside, tree.weights[piece])[:, 1:].astype(np.float32)
    found, _ = tree.descend(tree.triangle[piece], w)
    np.testing.assert_array_equal(found, piece)


def test_every_point_has_weights_within_the_piece_that_it_finds():
    tree = coarse_patches(join(Scene((surface_mesh("sliver", triangle("cap", 0), [(0, 1, 2)]),), DARK)), 1e-5)
    w = np.random.default_rng(3).dirichlet((1.0, 1.0, 1.0), 20_000)[:, 1:].astype(np.float32)
    w = np.concatenate([w, [(0, 0), (1, 0), (0, 1), (1.0000001, 0), (-1e-7, 0.5)]]).astype(np.float32)
    found, inside = tree.descend(np.zeros(len(w), dtype=np.int64), w)
    assert (tree.first_child[found] < 0).all()
    assert inside.min() >= 0.0 and inside.sum(axis=1).max() <= 1.0 + 1e-6


def strip_of(length: float, width: float):
    return join(Scene((exact.rectangle("strip", (0, 0, 0), (length, 0, 0), (0, width, 0)),), DARK))


@pytest.mark.parametrize("length", [10.0, 100.0, 500.0])
def test_a_strip_has_as_many_pieces_as_are_well_shaped(length):
    leaves = coarse_patches(strip_of(length, 1.0), 1e-9).leaves()
    # Parts of two to four widths, on each of the edges and on the diagonal from both of its sides.
    assert 2 * 2 * length / LARGEST_ASPECT <= len(leaves) + 4 <= 2 * 2 * (2 * length / LARGEST_ASPECT) + 4


@pytest.mark.parametrize("width", [1e-4, 1e-5])
def test_a_strip_has_so_many_pieces_at_most(width):
    tree = coarse_patches(strip_of(1.0, width), 1e-12)
    assert len(tree.leaves()) == 2 * (2 * LONGEST_ROW - 1)
    assert areas(node_triangles(tree, tree.leaves())).sum() == pytest.approx(width, rel=1e-9)


def test_a_strip_too_thin_to_have_two_edges_is_one_patch_a_triangle():
    tree = coarse_patches(strip_of(1.0, 1e-9), 1e-12)
    assert len(tree.leaves()) == 2
