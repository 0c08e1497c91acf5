# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake as a whole: what it gives back, what it repeats, and how values are shared and split."""

import json

import numpy as np
import pytest
from radiosity_bake.core import detail
from radiosity_bake.core.bake import EFFORTS, bake
from radiosity_bake.core.rows import BYTES_PER_RAY
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import (
    DARK,
    areas,
    block,
    crosses,
    flipped,
    mean_over,
    moved,
    room_with_block,
    t_junctions,
)
from tests.scenes import exact

COARSE = {"quality": "DRAFT", "minimum_size": 0.4}
VALUES = ("radiosity", "irradiance", "radiosity_back", "irradiance_back")


def same_bytes(one, other) -> bool:
    return all(
        np.asarray(getattr(a, name)).tobytes() == np.asarray(getattr(b, name)).tobytes()
        for a, b in zip(one.meshes, other.meshes, strict=True)
        for name in (*vars(a),)
        if getattr(a, name) is not None or getattr(b, name) is not None
    )


def values_of_place(mesh, point, values):
    """All corner values of a mesh at a position, (k, 3)."""
    at = np.linalg.norm(mesh.vertices[mesh.triangles] - np.asarray(point), axis=2) < 1e-9
    return values[at]


# ------------------------------------------------------------------------------------------------------- repeatable


@pytest.mark.parametrize("method", ["ADAPTIVE", "UNIFORM"])
def test_the_same_bake_gives_the_same_bytes_whatever_the_threads(method):
    scene = room_with_block()
    one, two, again = (bake(scene, BakeSettings(**COARSE, method=method, threads=threads)) for threads in (1, 2, 2))
    assert same_bytes(one, two)
    assert same_bytes(two, again)
    for key in ("patches", "vertices", "rays", "iterations", "residual", "energy", "rounds"):
        assert one.report[key] == two.report[key]


@pytest.mark.parametrize("most_alone", [0.0, 1.0])
def test_it_makes_no_difference_which_faces_are_made_anew(most_alone, room_scene, room_draft, monkeypatch):
    monkeypatch.setattr(detail, "MOST_ALONE", most_alone)
    assert same_bytes(room_draft, bake(room_scene, BakeSettings(quality="DRAFT", minimum_size=0.15)))


def test_another_seed_changes_the_values_within_their_noise(room_scene, room_draft):
    settings = BakeSettings(quality="DRAFT", minimum_size=0.15, seed=1)
    other = bake(room_scene, settings)
    assert not same_bytes(room_draft, other)
    first, second = mean_over(room_draft.meshes), mean_over(other.meshes)
    np.testing.assert_allclose(first, second, rtol=0.02)


def test_the_order_of_the_meshes_does_not_matter(room_scene, room_draft):
    turned = bake(Scene(room_scene.meshes[::-1], DARK), BakeSettings(quality="DRAFT", minimum_size=0.15))
    for mesh in room_draft.meshes:
        name = room_scene.meshes[mesh.mesh].name
        if name == "lamp":
            continue
        other = next(m for m in turned.meshes if room_scene.meshes[::-1][m.mesh].name == name)
        # Other numbers, other sampling patterns: noise only.
        np.testing.assert_allclose(mean_over([mesh]), mean_over([other]), rtol=0.06)


@pytest.mark.parametrize(("scale", "by"), [(1e-3, 0.0), (1e3, 0.0), (1.0, 1e5), (1.0, -1e5), (1e-3, 1.0)])
def test_size_and_place_leave_the_result_within_its_noise(room_scene, room_draft, scale, by):
    settings = BakeSettings(quality="DRAFT", minimum_size=0.15 * scale)
    result = bake(moved(room_scene, scale, (by, -by, by / 2)), settings)
    assert result.report["patches"] == pytest.approx(room_draft.report["patches"], rel=0.02)
    for mesh, other in zip(room_draft.meshes, result.meshes, strict=True):
        np.testing.assert_allclose(mean_over([mesh]), mean_over([other]), rtol=0.03, atol=1e-3)


def test_the_automatic_size_scales_with_the_scene(room_scene):
    sizes = [bake(moved(room_scene, s), BakeSettings(quality="DRAFT")).report["minimum_size"] for s in (1.0, 100.0)]
    assert sizes[1] == pytest.approx(100 * sizes[0])


# ---------------------------------------------------------------------------------------------------------- meshes


def test_every_baked_mesh_comes_back_in_order(room_scene, room_draft):
    assert [mesh.mesh for mesh in room_draft.meshes] == list(range(len(room_scene.meshes)))


def test_refined_meshes_begin_with_the_inputs_vertices(room_scene, room_draft):
    for mesh in room_draft.meshes:
        given = room_scene.meshes[mesh.mesh].vertices
        assert mesh.vertices[: len(given)].tobytes() == given.tobytes()


def test_refined_meshes_have_no_t_junctions(cornell_draft):
    for mesh in cornell_draft.meshes:
        assert t_junctions(mesh.vertices, mesh.triangles) == 0


def test_refined_meshes_cover_their_inputs_and_face_as_they_do(cornell_scene, cornell_draft):
    for mesh in cornell_draft.meshes:
        given = cornell_scene.meshes[mesh.mesh]
        corners = mesh.vertices[mesh.triangles]
        area = np.bincount(mesh.parent_triangle, weights=areas(corners), minlength=len(given.triangles))
        np.testing.assert_allclose(area, areas(given.vertices[given.triangles]), rtol=1e-9)
        normal, whole = crosses(mesh.vertices, mesh.triangles), crosses(given.vertices, given.triangles)
        assert (np.einsum("fx,fx->f", normal, whole[mesh.parent_triangle]) > 0).all()


def test_barycentric_coordinates_give_the_positions(cornell_scene, cornell_draft):
    for mesh in cornell_draft.meshes:
        given = cornell_scene.meshes[mesh.mesh]
        whole = given.vertices[given.triangles[mesh.parent_triangle]]
        np.testing.assert_allclose(mesh.barycentric @ whole, mesh.vertices[mesh.triangles], atol=1e-9)


def test_original_meshes_are_the_input(room_scene, room_original):
    for mesh in room_original.meshes:
        given = room_scene.meshes[mesh.mesh]
        assert np.array_equal(mesh.triangles, given.triangles)
        assert np.array_equal(mesh.vertices, given.vertices)
        assert np.array_equal(mesh.parent_triangle, np.arange(len(given.triangles)))
        assert np.array_equal(mesh.barycentric, np.broadcast_to(np.eye(3), (len(given.triangles), 3, 3)))


def test_original_and_refined_agree_at_the_inputs_vertices(room_scene, room_draft, room_original):
    # The same patches light both; receivers lie a share of their faces' size off the vertex, which differs, so corners
    # of the room agree as far as light changes over that: a tenth of the mean. The block's foot is dark below.
    mean = mean_over(room_draft.meshes).mean()
    for refined, original in zip(room_draft.meshes[:6], room_original.meshes[:6], strict=True):
        for point in room_scene.meshes[refined.mesh].vertices:
            fine = values_of_place(refined, point, refined.irradiance).mean(axis=0)
            given = values_of_place(original, point, original.irradiance).mean(axis=0)
            np.testing.assert_allclose(fine, given, atol=0.2 * mean)


def test_meshes_that_are_not_baked_light_the_others_but_do_not_come_back(room_scene, room_draft):
    quiet = tuple(
        type(m)(m.name, m.vertices, m.triangles, m.corner_normals, m.reflectance, m.emission, m.name == "floor")
        for m in room_scene.meshes
    )
    result = bake(Scene(quiet, DARK), BakeSettings(quality="DRAFT", minimum_size=0.15))
    assert [mesh.mesh for mesh in result.meshes] == [0]
    np.testing.assert_allclose(mean_over(result.meshes), mean_over(room_draft.meshes[:1]), rtol=0.05)


# ---------------------------------------------------------------------------------------------------------- values


def test_nothing_is_negative_or_not_a_number(cornell_draft, room_draft, room_original):
    for result in (cornell_draft, room_draft, room_original):
        for mesh in result.meshes:
            for name in VALUES:
                values = getattr(mesh, name)
                if values is not None:
                    assert np.isfinite(values).all() and values.min() >= 0.0


def test_radiosity_is_emission_plus_reflected_irradiance(room_scene, room_draft, room_original):
    for result in (room_draft, room_original):
        for mesh in result.meshes:
            given = room_scene.meshes[mesh.mesh]
            emission = given.emission[mesh.parent_triangle][:, None]
            reflectance = given.reflectance[mesh.parent_triangle][:, None]
            np.testing.assert_allclose(mesh.radiosity, emission + reflectance * mesh.irradiance, rtol=1e-12)


def test_twice_the_light_gives_twice_the_values(room_scene, room_draft):
    twice = Scene(
        tuple(
            type(m)(m.name, m.vertices, m.triangles, m.corner_normals, m.reflectance, 2 * m.emission)
            for m in room_scene.meshes
        ),
        DARK,
    )
    result = bake(twice, BakeSettings(quality="DRAFT", minimum_size=0.15))
    for one, two in zip(room_draft.meshes, result.meshes, strict=True):
        # The solution is exact to its residual.
        np.testing.assert_allclose(2 * one.irradiance, two.irradiance, rtol=1e-3, atol=1e-4)


def test_each_channel_is_lit_by_its_own_light_alone():
    room = room_with_block()
    red = exact.rectangle("lamp", (0.7, 0.7, 1.95), (0, 0.6, 0), (0.6, 0, 0), emission=(5.0, 0.0, 0.0))
    result = bake(Scene((*room.meshes[:6], red, room.meshes[7]), DARK), BakeSettings(**COARSE))
    for mesh in result.meshes[:6]:
        assert mesh.irradiance[..., 0].max() > 0
        assert not mesh.irradiance[..., 1:].any()


def smooth_ball(levels=1, radius=0.5):
    vertices, triangles = exact.icosphere(levels)
    return surface_mesh("ball", radius * vertices, triangles, reflectance=0.5, corner_normals=vertices[triangles])


LAMP = exact.rectangle("lamp", (-0.5, -0.5, 1.5), (0, 1, 0), (1, 0, 0), emission=3.0)


def distinct_at_vertices(mesh, values):
    """The number of different values at each used vertex."""
    vertex, value = mesh.triangles.ravel(), values.reshape(-1, 3)
    pairs = np.unique(np.concatenate([vertex[:, None], value], axis=1), axis=0)
    return np.bincount(pairs[:, 0].astype(int), minlength=len(mesh.vertices))


def test_a_smooth_ball_has_one_value_at_each_vertex():
    mesh = bake(Scene((smooth_ball(), LAMP), DARK), BakeSettings(**COARSE)).meshes[0]
    assert distinct_at_vertices(mesh, mesh.irradiance).max() == 1
    assert distinct_at_vertices(mesh, mesh.radiosity).max() == 1


def test_a_smooth_ball_has_the_normals_of_a_sphere():
    mesh = bake(Scene((smooth_ball(), LAMP), DARK), BakeSettings(**COARSE)).meshes[0]
    radial = mesh.vertices[mesh.triangles]
    radial = radial / np.linalg.norm(radial, axis=2, keepdims=True)
    np.testing.assert_allclose(np.linalg.norm(mesh.corner_normals, axis=2), 1.0, atol=1e-12)
    # Interpolated over a triangle of half-angle 0.3 they are off by less than its cube.
    assert np.abs(mesh.corner_normals - radial).max() < 0.03


def test_a_flat_shaded_cube_has_a_value_for_each_face_at_its_corners():
    cube = block("cube", (-0.4, -0.4, 0), (0.4, 0.4, 0.8), turned=20)
    mesh = bake(Scene((cube, LAMP), np.full(3, 0.3)), BakeSettings(**COARSE)).meshes[0]
    distinct = distinct_at_vertices(mesh, mesh.irradiance)
    assert (distinct[:8] >= 2).all()
    assert distinct[8:].max() <= 2


def test_a_border_of_reflectance_splits_radiosity_but_not_irradiance():
    square = exact.rectangle("square", (-1, -1, 0), (2, 0, 0), (0, 2, 0))
    two = surface_mesh("square", square.vertices, square.triangles, reflectance=[(0.9, 0.9, 0.9), (0.1, 0.1, 0.1)])
    mesh = bake(Scene((two, LAMP), DARK), BakeSettings(**COARSE)).meshes[0]
    on_border = np.flatnonzero(np.abs(mesh.vertices[:, 0] - mesh.vertices[:, 1]) < 1e-9)
    assert len(on_border) > 4
    assert (distinct_at_vertices(mesh, mesh.irradiance)[on_border] == 1).all()
    assert (distinct_at_vertices(mesh, mesh.radiosity)[on_border] == 2).all()


def test_coplanar_neighbours_share_their_irradiance():
    mesh = bake(
        Scene((exact.rectangle("square", (-1, -1, 0), (2, 0, 0), (0, 2, 0), reflectance=0.5), LAMP), DARK),
        BakeSettings(**COARSE),
    ).meshes[0]
    assert distinct_at_vertices(mesh, mesh.irradiance).max() == 1


def test_vertices_split_in_the_data_share_their_values():
    quad = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float)
    split = surface_mesh("square", quad, [(0, 1, 2), (3, 4, 5)], reflectance=0.5)
    mesh = bake(Scene((split, LAMP), DARK), BakeSettings(**COARSE)).meshes[0]
    for point in (quad[0], quad[2]):
        assert len(np.unique(values_of_place(mesh, point, mesh.irradiance), axis=0)) == 1


def test_a_sheet_gets_values_on_both_sides():
    sheet = exact.rectangle("sheet", (-1, -1, 0), (2, 0, 0), (0, 2, 0), reflectance=0.5)
    below = exact.rectangle("below", (-0.5, -0.5, -1.5), (1, 0, 0), (0, 1, 0), emission=1.0)
    mesh = bake(Scene((sheet, LAMP, below), DARK), BakeSettings(**COARSE)).meshes[0]
    assert mesh.irradiance_back is not None
    ratio = mesh.irradiance.mean() / mesh.irradiance_back.mean()
    assert ratio == pytest.approx(3.0, rel=0.02)


def test_a_solid_gets_no_values_inside(room_draft):
    assert room_draft.meshes[7].irradiance_back is None


def test_a_room_with_its_front_outward_is_turned_over_and_says_so(room_scene):
    outward = tuple(flipped(m) if m.name != "lamp" else m for m in (exact.closed_room((2, 2, 2), reflectance=0.5),))
    result = bake(Scene((*outward, *room_scene.meshes[6:]), DARK), BakeSettings(quality="DRAFT", minimum_size=0.15))
    room = exact.closed_room((2, 2, 2), reflectance=0.5)
    right = bake(Scene((room, *room_scene.meshes[6:]), DARK), BakeSettings(quality="DRAFT", minimum_size=0.15))
    assert any("turned over" in warning for warning in result.report["warnings"])
    np.testing.assert_allclose(mean_over(result.meshes[:1]), mean_over(right.meshes[:1]), rtol=0.03)
    # It looks inward now.
    middle = result.meshes[0].vertices[result.meshes[0].triangles].mean(axis=1) - 1.0
    normal = crosses(result.meshes[0].vertices, result.meshes[0].triangles)
    assert (np.einsum("fx,fx->f", normal, middle) < 0).all()


def test_flipping_a_block_warns_and_leaves_the_room_as_it_is(room_scene, room_draft):
    result = bake(
        Scene((*room_scene.meshes[:7], flipped(room_scene.meshes[7])), DARK),
        BakeSettings(quality="DRAFT", minimum_size=0.15, output="ORIGINAL"),
    )
    assert any("block" in warning and "flip its normals" in warning for warning in result.report["warnings"])
    # Its front, inside, sees its own walls, and the floor that its bottom lies on.
    assert mean_over(result.meshes[7:]).mean() < 0.5 * mean_over(result.meshes[7:], "irradiance_back").mean()


# ---------------------------------------------------------------------------------------------------------- report


def test_the_report_is_json(room_draft):
    assert json.loads(json.dumps(room_draft.report)) == room_draft.report


def test_the_report_tells_what_the_contract_asks_for(room_draft):
    names = {
        "patches",
        "vertices",
        "rays",
        "seconds",
        "iterations",
        "residual",
        "estimated_error",
        "energy",
        "warnings",
    }
    assert names <= set(room_draft.report)
    assert room_draft.report["seconds"]["total"] == pytest.approx(
        sum(v for k, v in room_draft.report["seconds"].items() if k != "total"), rel=0.05
    )
    assert room_draft.report["settings"]["threshold"] == 0.02


def test_the_reported_counts_are_those_of_the_result(room_draft):
    report = room_draft.report
    assert report["triangles"] == sum(len(mesh.triangles) for mesh in room_draft.meshes)
    assert report["vertices"] == sum(len(np.unique(mesh.triangles)) for mesh in room_draft.meshes)
    assert report["rays"] == sum(report["rays_by_kind"].values())
    assert report["patches"] == report["rounds"][-1]["fragments"]


def test_a_higher_quality_costs_more_rays(room_draft, room_good):
    assert EFFORTS["DRAFT"].rays_per_patch < EFFORTS["GOOD"].rays_per_patch < EFFORTS["HIGH"].rays_per_patch
    assert room_good.report["rays"] > 1.5 * room_draft.report["rays"]


def test_a_higher_quality_has_a_smaller_estimated_error(room_draft, room_good):
    assert room_good.report["estimated_error"] < room_draft.report["estimated_error"]


def test_no_fragment_has_an_edge_below_half_the_minimum_size():
    result = bake(room_with_block(), BakeSettings(quality="DRAFT", minimum_size=0.3, method="UNIFORM"))
    for mesh in result.meshes[:6]:
        corners = mesh.vertices[mesh.triangles]
        # Right isosceles triangles: the legs of a fragment of size n; cuts and templates may halve one once more.
        longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
        whole = np.isclose(mesh.barycentric * 2.0**8, np.rint(mesh.barycentric * 2.0**8)).all(axis=(1, 2))
        assert longest[whole].min() >= 0.3 / np.sqrt(2.0) - 1e-9


def test_a_minimum_size_that_is_asked_for_is_that_of_faces_and_patches_are_no_smaller_than_the_automatic_ones():
    size = 0.05
    automatic = bake(room_with_block(), BakeSettings(quality="DRAFT")).report["minimum_size"]
    adaptive = bake(room_with_block(), BakeSettings(quality="DRAFT", minimum_size=size))
    uniform = bake(room_with_block(), BakeSettings(quality="DRAFT", minimum_size=size, method="UNIFORM"))
    assert adaptive.report["minimum_face_size"] == uniform.report["minimum_face_size"] == size
    assert adaptive.report["minimum_size"] == automatic > size
    assert uniform.report["minimum_size"] == size
    assert adaptive.report["patches"] < 0.5 * uniform.report["patches"]
    assert adaptive.report["vertices"] < 0.5 * uniform.report["vertices"]
    for mesh in adaptive.meshes:
        corners = mesh.vertices[mesh.triangles]
        longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
        # As above: what cuts have not moved is a fragment or half of one.
        whole = np.isclose(mesh.barycentric * 2.0**8, np.rint(mesh.barycentric * 2.0**8)).all(axis=(1, 2))
        assert longest[whole].min() >= size / np.sqrt(2.0) - 1e-9


def test_on_original_meshes_the_minimum_size_is_that_of_patches():
    settings = BakeSettings(quality="DRAFT", minimum_size=0.05, output="ORIGINAL")
    assert bake(room_with_block(), settings).report["minimum_size"] == 0.05


def test_a_minimum_size_above_the_automatic_one_is_that_of_patches_and_faces():
    report = bake(room_with_block(), BakeSettings(quality="DRAFT", minimum_size=0.4)).report
    assert (report["minimum_size"], report["minimum_face_size"]) == (0.4, 0.4)


# ---------------------------------------------------------------------------------------------------------- memory


def test_the_rays_in_memory_keep_to_the_limit(monkeypatch):
    from radiosity_bake.core.transport import Transport

    largest = [0]
    follow = Transport.follow_splits
    shares = Transport.shares

    def watch(method):
        def watched(self):
            held = sum(table.hits.size for table in self.tables) * BYTES_PER_RAY
            largest[0] = max(largest[0], held)
            return method(self)

        return watched

    monkeypatch.setattr(Transport, "follow_splits", watch(follow))
    monkeypatch.setattr(Transport, "shares", watch(shares))
    settings = BakeSettings(quality="HIGH", minimum_size=0.015, threshold=0.002, memory_limit=64)
    result = bake(Scene(exact.closed_box((2, 2, 2), 0.5)[0].meshes, DARK), settings)
    assert 0 < largest[0] <= 64 * 2**20
    assert "memory limit" in result.report["ended"]
    assert any("memory limit" in warning for warning in result.report["warnings"])
