# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The output mesh fits together: no T-junctions, the surface neither lost nor turned."""

import numpy as np
import pytest
from radiosity_bake.core import templates
from radiosity_bake.core.coarse_patches import coarse_patches
from radiosity_bake.core.patches import PatchTree
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.subdivision import conforming_faces, input_faces
from radiosity_bake.core.surfaces import join

from tests.core.building import DARK, areas, block, crosses, grid, t_junctions
from tests.scenes import exact


def uneven_tree(surfaces, seed=0, times=4, deep=7) -> PatchTree:
    """Split at random, and at one corner far deeper than anywhere else."""
    tree = coarse_patches(surfaces, 0.5)
    rng = np.random.default_rng(seed)
    node = tree.leaves()[:1]
    for _ in range(deep):
        node = tree.split(node)[[0]]
    for _ in range(times):
        leaves = tree.leaves()
        tree.split(np.sort(rng.choice(leaves, len(leaves) // 5, replace=False)))
    return tree


MESHES = {
    "room": lambda: exact.closed_room((1, 2, 0.7), reflectance=0.5),
    "sphere": lambda: exact.furnace_sphere(levels=1)[0].meshes[0],
    "grid": lambda: grid("grid", 3),
    "slender": lambda: exact.rectangle("strip", (0, 0, 0), (20, 0, 0), (0, 1, 0)),
    "block": lambda: block("block", (0, 0, 0), (1, 2, 3), turned=20, bottom=False),
}


def conforming(surfaces, tree: PatchTree):
    """Return the conforming faces of all shells."""
    return conforming_faces(surfaces, tree, np.ones(len(surfaces.closed), dtype=bool))


@pytest.fixture(scope="module", params=MESHES)
def uneven(request):
    surfaces = join(Scene((MESHES[request.param](),), DARK))
    tree = uneven_tree(surfaces)
    return surfaces, tree, conforming(surfaces, tree.copy())


def test_the_brute_force_check_finds_a_t_junction():
    points = np.array([(0, 0, 0), (2, 0, 0), (1, 1, 0), (1, 0, 0), (0.5, -1, 0)], dtype=float)
    assert t_junctions(points, np.array([(0, 1, 2), (0, 4, 3)])) == 1
    assert t_junctions(points, np.array([(0, 3, 2), (3, 1, 2), (0, 4, 3)])) == 0


def test_leaves_that_were_split_unevenly_leave_t_junctions(uneven):
    _, tree, _ = uneven
    assert t_junctions(tree.points, tree.corners[tree.leaves()]) > 10


def test_no_vertex_lies_within_an_edge_of_the_conforming_mesh(uneven):
    _, _, faces = uneven
    assert t_junctions(faces.points, faces.corners) == 0


def test_the_conforming_mesh_covers_every_input_triangle_exactly(uneven):
    surfaces, _, faces = uneven
    total = np.bincount(faces.triangle, weights=areas(faces.points[faces.corners]))
    np.testing.assert_allclose(total, surfaces.areas, rtol=1e-10)


def test_every_face_looks_as_its_input_triangle_does(uneven):
    surfaces, _, faces = uneven
    normal = crosses(faces.points, faces.corners)
    cosine = np.einsum("fx,fx->f", normal, surfaces.normals[faces.triangle]) / np.linalg.norm(normal, axis=1)
    np.testing.assert_allclose(cosine, 1.0, atol=1e-9)


def test_weights_give_the_position_of_every_corner(uneven):
    surfaces, _, faces = uneven
    corners = surfaces.points[surfaces.triangles[faces.triangle]]
    np.testing.assert_allclose(faces.weights @ corners, faces.points[faces.corners], atol=1e-9)
    assert faces.weights.min() >= 0
    np.testing.assert_allclose(faces.weights.sum(axis=2), 1.0, atol=1e-12)


def test_closed_meshes_stay_closed():
    surfaces = join(Scene((MESHES["room"](),), DARK))
    faces = conforming(surfaces, uneven_tree(surfaces))
    start, end = faces.corners.ravel(), np.roll(faces.corners, -1, axis=1).ravel()
    forward = set(zip(start.tolist(), end.tolist(), strict=True))
    assert len(forward) == len(start)
    assert all((b, a) in forward for a, b in forward)


def test_every_face_lies_in_the_leaf_that_it_names():
    surfaces = join(Scene((MESHES["sphere"](),), DARK))
    tree = uneven_tree(surfaces)
    faces = conforming(surfaces, tree)
    leaves = tree.leaves()
    assert set(faces.node.tolist()) == set(leaves.tolist())
    total = np.bincount(faces.node, weights=areas(faces.points[faces.corners]), minlength=len(tree))
    np.testing.assert_allclose(total[leaves], areas(tree.points[tree.corners[leaves]]), rtol=1e-10)


def test_even_leaves_are_the_faces():
    surfaces = join(Scene((MESHES["grid"](),), DARK))
    tree = PatchTree(surfaces)
    tree.split(tree.leaves())
    faces = conforming(surfaces, tree)
    assert np.array_equal(np.sort(faces.corners, axis=1), np.sort(tree.corners[tree.leaves()], axis=1))


def test_meshes_that_are_not_baked_have_no_faces():
    meshes = exact.closed_box()[0].meshes
    quiet = type(meshes[0])(
        *(
            getattr(meshes[0], f)
            for f in ("name", "vertices", "triangles", "corner_normals", "reflectance", "emission")
        ),
        baked=False,
    )
    surfaces = join(Scene((quiet, *meshes[1:]), DARK))
    for faces in (conforming(surfaces, PatchTree(surfaces)), input_faces(surfaces)):
        assert 0 not in surfaces.mesh_of_triangle[faces.triangle]
        assert set(surfaces.mesh_of_triangle[faces.triangle]) == {1, 2, 3, 4, 5}


def test_normals_between_corners_are_interpolated_and_of_length_one():
    surfaces = join(Scene((MESHES["sphere"](),), DARK))
    vertices = surfaces.points / np.linalg.norm(surfaces.points, axis=1)[:, None]
    smooth = type(surfaces)(**{**vars(surfaces), "corner_normals": -vertices[surfaces.triangles]})
    faces = conforming(smooth, uneven_tree(smooth))
    normals = faces.corner_normals(smooth)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=2), 1.0, atol=1e-12)
    middle = faces.points[faces.corners]
    middle = middle / np.linalg.norm(middle, axis=2, keepdims=True)
    # Interpolated normals of a flat triangle of half-angle a differ from radial ones by less than a^3: 0.3^3.
    assert np.abs(normals + middle).max() < 0.03


@pytest.mark.parametrize("bits", range(8))
@pytest.mark.parametrize("long_edge", [0, 1, 2])
def test_every_template_tiles_its_triangle_and_uses_every_vertex_on_its_edges(bits, long_edge):
    corners = np.roll(np.array([(0, 0, 0), (3, 0, 0), (0.4, 1, 0)], dtype=float), long_edge, axis=0)
    share = np.array([0.3, 0.5, 0.8])[:, None]
    on_edges = corners * (1 - share) + np.roll(corners, -1, axis=0) * share
    points, six = np.concatenate([corners, on_edges]), np.arange(6)[None]
    present = np.array([[bool(bits & 1), bool(bits & 2), bool(bits & 4)]])
    member, piece = templates.cut(points, six, present)
    assert (member == 0).all()
    assert len(piece) == 1 + present.sum()
    assert set(piece.ravel()) == {0, 1, 2, *(3 + np.flatnonzero(present[0]))}
    normal = crosses(points, piece)[:, 2]
    assert (normal > 0).all()
    assert normal.sum() == pytest.approx(crosses(points, np.array([[0, 1, 2]]))[0, 2], rel=1e-12)
    assert t_junctions(points, piece) == 0


@pytest.mark.parametrize("bits", [3, 5, 6])
def test_quadrilaterals_are_cut_along_their_shorter_diagonal(bits):
    rng = np.random.default_rng(bits)
    for _ in range(20):
        corners = np.append(rng.random((3, 2)), np.zeros((3, 1)), axis=1)
        share = rng.uniform(0.1, 0.9, (3, 1))
        points = np.concatenate([corners, corners * (1 - share) + np.roll(corners, -1, axis=0) * share])
        present = np.array([[bool(bits & 1), bool(bits & 2), bool(bits & 4)]])
        _, piece = templates.cut(points, np.arange(6)[None], present)
        edges = {frozenset(e) for p in piece.tolist() for e in ((p[0], p[1]), (p[1], p[2]), (p[2], p[0]))}
        # The quadrilateral: the two corners and the two new points that the tip's triangle leaves.
        new = [3 + k for k in range(3) if present[0, k]]
        tip = ({new[0] - 3, (new[0] - 2) % 3} & {new[1] - 3, (new[1] - 2) % 3}).pop()
        rest = [k for k in range(3) if k != tip]
        diagonals = [(m, k) for m in new for k in rest if k not in {m - 3, (m - 2) % 3}]
        length = {d: np.linalg.norm(points[d[0]] - points[d[1]]) for d in diagonals}
        assert frozenset(min(diagonals, key=length.get)) in edges


def test_many_triangles_are_cut_at_once_in_their_order():
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.5, 0, 0), (0.5, 0.5, 0), (0, 0.5, 0)], dtype=float)
    present = np.array([[(b >> k) & 1 for k in range(3)] for b in (7, 0, 3, 5, 7, 1)], dtype=bool)
    member, _ = templates.cut(points, np.tile(np.arange(6), (6, 1)), present)
    assert member.tolist() == sorted(member.tolist())
    np.testing.assert_array_equal(np.bincount(member), 1 + present.sum(axis=1))
