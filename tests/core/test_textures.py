# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours that vary over triangles: their means, what they do to light, and images made into cells."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core import bake as bake_module
from radiosity_bake.core.bake import bake
from radiosity_bake.core.coarse_patches import coarse_patches
from radiosity_bake.core.emitting_pieces import MISPLACED, emitting_pieces, piece_areas
from radiosity_bake.core.relight import ChangedSceneError, relight
from radiosity_bake.core.scene import Scene, Texture, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.surfaces import join
from radiosity_bake.core.textures import cell_centres, cell_corners, image_of, mean_colours, sampled, with_means

from tests.core.building import DARK, mean_over, values_at
from tests.core.test_bake import same_bytes
from tests.scenes import exact

ALONG = 16
FULL = np.eye(3)[None]


def textured(mesh, colour, what="reflectance", along=ALONG):
    """The mesh with the colour that a function gives for world points (n, 3), cell by cell."""
    count = len(mesh.triangles)
    u, v = cell_centres(along).astype(np.float64).T
    weights = np.stack([1.0 - u - v, u, v], axis=1)
    points = np.einsum("ck,tkx->tcx", weights, mesh.vertices[mesh.triangles]).reshape(-1, 3)
    texture = Texture(
        np.arange(count),
        np.zeros(count, dtype=np.int64),
        np.full(count, along),
        np.asarray(colour(points), dtype=np.float32).reshape(-1, 3),
    )
    return replace(mesh, **{f"{what}_texture": texture})


def halves(axis, border, low, high):
    """A colour below a border of one coordinate and another above it."""
    return lambda points: np.where(points[:, axis, None] < border, low, high) * np.ones(3)


def noise(points):
    return np.random.default_rng(4).random((len(points), 3))


# ------------------------------------------------------------------------------------------------------------ means


def test_the_cells_of_a_triangle_have_equal_areas_and_cover_it():
    corners = cell_corners(cell_centres(5), np.full(25, 5))
    assert piece_areas(corners) == pytest.approx(np.full(25, 1 / 25), rel=1e-5)
    assert corners.min() > -1e-6 and corners.max() < 1 + 1e-6
    assert corners.mean(axis=(0, 1)) == pytest.approx(np.full(3, 1 / 3))


def test_each_cell_is_found_under_its_own_corners():
    mesh = textured(surface_mesh("one", np.eye(3), [(0, 1, 2)]), noise, along=8)
    corners = cell_corners(cell_centres(8), np.full(64, 8))
    found = mean_colours(np.zeros((1, 3)), mesh.reflectance_texture, np.zeros(64, dtype=np.int64), corners)
    assert found == pytest.approx(mesh.reflectance_texture.colours, abs=1e-6)


def test_means_over_the_patches_of_a_triangle_add_up_to_its_own():
    scene = Scene((textured(exact.rectangle("wall", (0, 0, 0), (1, 0, 0), (0, 1, 0)), noise),), np.ones(3))
    surfaces = join(scene)
    tree = coarse_patches(surfaces, 1.0)
    tree.split(tree.split(tree.split(tree.leaves())))
    leaves = tree.leaves()
    means = surfaces.reflectance_over(tree.triangle[leaves], tree.weights[leaves])
    # Patches of midpoint splits consist of whole cells, so this holds to single precision.
    for triangle in (0, 1):
        mean = means[tree.triangle[leaves] == triangle].mean(axis=0)
        assert mean == pytest.approx(surfaces.reflectance[triangle], rel=1e-6)


def test_a_part_that_is_no_triangle_of_cells_has_about_their_mean():
    mesh = textured(surface_mesh("one", np.eye(3), [(0, 1, 2)]), lambda p: p, along=64)
    part = np.array([[[0.7, 0.2, 0.1], [0.1, 0.7, 0.2], [0.2, 0.1, 0.7]]])
    found = mean_colours(np.zeros((1, 3)), mesh.reflectance_texture, np.zeros(1, dtype=np.int64), part)
    # A linear colour has at most half a cell's step at each point, and these cancel.
    assert found[0] == pytest.approx(np.full(3, 1 / 3), abs=0.25 / 64)


def test_colours_that_are_no_numbers_or_too_bright_are_limited():
    wall = exact.rectangle("wall", (0, 0, 0), (1, 0, 0), (0, 1, 0))
    wrong = textured(textured(wall, lambda p: p * 0 + 7.0), lambda p: p * np.nan, "emission")
    surfaces = join(Scene((wrong,), np.ones(3)))
    assert surfaces.reflectance_texture.colours.max() == 1.0
    assert surfaces.emission_texture.colours.tolist() == np.zeros((2 * ALONG**2, 3)).tolist()


def test_textures_follow_their_triangles_past_unsound_ones():
    triangles = [(0, 0, 1), (0, 1, 2), (0, 2, 3)]
    mesh = surface_mesh("mesh", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], triangles)
    colours = np.repeat([[0.1] * 3, [0.2] * 3, [0.3] * 3], 4, axis=0).astype(np.float32)
    texture = Texture(np.arange(3), np.zeros(3, dtype=np.int64), np.full(3, 2), colours)
    plain = exact.rectangle("plain", (0, 0, 1), (1, 0, 0), (0, 1, 0), reflectance=0.9)
    surfaces = join(Scene((plain, replace(mesh, reflectance_texture=texture)), np.ones(3)))
    assert surfaces.reflectance[:, 0] == pytest.approx([0.9, 0.9, 0.2, 0.3])
    assert surfaces.reflectance_texture.triangle.tolist() == [2, 3]


# ------------------------------------------------------------------------------------------------------------ light

COARSE = BakeSettings(quality="GOOD", minimum_size=0.25)
FINE = replace(COARSE, minimum_size=0.1)
NOISE = 0.02
"""Two bakes of one scene in other triangles: each has about 1% error at GOOD."""


def room(east, lamp, baked=True):
    """A room of 2 x 2 x 2 whose east wall and lamp are given."""
    walls = [w for w in exact.box_walls((2, 2, 2), reflectance=0.5) if w.name != "east"]
    return Scene((*walls, *east, *lamp), DARK)


def plain_lamp():
    return [exact.rectangle("lamp", (0.7, 0.7, 1.95), (0, 0.6, 0), (0.6, 0, 0), emission=5.0)]


def plain_east():
    return [exact.rectangle("east", (2, 0, 0), (0, 0, 2), (0, 2, 0), reflectance=0.5)]


def probes_of_floor(result, count=6):
    """Irradiance at a grid on the floor, (count^2, 3)."""
    side = (np.arange(count) + 0.5) / count * 2.0
    points = np.array([(x, y, 0.0) for x in side for y in side])
    floor = result.meshes[0]
    parent = np.where(points[:, 0] > points[:, 1], 0, 1)
    return values_at(floor, parent, points, floor.irradiance)


def test_a_textured_wall_lights_the_room_as_one_that_is_cut_along_its_pattern():
    whole = textured(plain_east()[0], halves(1, 1.0, (0.9, 0.1, 0.1), (0.1, 0.1, 0.9)))
    cut = [
        exact.rectangle("south half", (2, 0, 0), (0, 0, 2), (0, 1, 0), reflectance=(0.9, 0.1, 0.1)),
        exact.rectangle("north half", (2, 1, 0), (0, 0, 2), (0, 1, 0), reflectance=(0.1, 0.1, 0.9)),
    ]
    # Under the border in the pattern the light changes within a face of the coarse floor.
    textured_floor = probes_of_floor(bake(room([whole], plain_lamp()), FINE))
    cut_floor = probes_of_floor(bake(room(cut, plain_lamp()), FINE))
    red = cut_floor[:, 0] / cut_floor[:, 2]
    # Near the two halves of the wall their colours are told apart, so this is no test of means alone.
    assert red.max() > 1.1 and red.min() < 0.9
    assert np.abs(textured_floor / cut_floor - 1.0).max() < NOISE


def test_a_textured_emitter_lights_the_room_as_two_that_are_even():
    lamp = textured(plain_lamp()[0], halves(0, 1.0, (10.0, 0.0, 0.0), (0.0, 0.0, 4.0)), "emission")
    cut = [
        exact.rectangle("one", (0.7, 0.7, 1.95), (0, 0.6, 0), (0.3, 0, 0), emission=(10.0, 0.0, 0.0)),
        exact.rectangle("other", (1.0, 0.7, 1.95), (0, 0.6, 0), (0.3, 0, 0), emission=(0.0, 0.0, 4.0)),
    ]
    # On coarse faces interpolation misses several hundredths, and not the same where the diagonals differ.
    textured_floor = probes_of_floor(bake(room(plain_east(), [lamp]), FINE))
    cut_floor = probes_of_floor(bake(room(plain_east(), cut), FINE))
    assert np.abs(textured_floor[:, [0, 2]] / cut_floor[:, [0, 2]] - 1.0).max() < NOISE


def test_pieces_of_an_even_texture_are_whole_triangles():
    lamp = textured(plain_lamp()[0], lambda p: p * 0 + 3.0, "emission")
    triangle, corners = emitting_pieces(join(Scene((lamp,), DARK)))
    assert triangle.tolist() == [0, 1]
    assert corners.tolist() == np.repeat(FULL, 2, axis=0).tolist()


def test_pieces_keep_the_power_and_show_little_of_it_in_the_wrong_place():
    lamp = textured(plain_lamp()[0], lambda p: (p - 0.7) * [1.0, 1.0, 0.0] + 0.01, "emission", along=64)
    surfaces = join(Scene((lamp,), DARK))
    triangle, corners = emitting_pieces(surfaces)
    share = surfaces.areas[triangle] * piece_areas(corners)
    radiance = surfaces.emission_over(triangle, corners)
    assert share @ radiance == pytest.approx(surfaces.areas @ surfaces.emission, rel=1e-5)
    cells = cell_corners(cell_centres(8), np.full(64, 8))
    parts = surfaces.emission_over(np.repeat(triangle, 64), (cells @ corners[:, None]).reshape(-1, 3, 3))
    wrong = np.abs(parts.reshape(-1, 64, 3) - radiance[:, None]).sum(axis=2).mean(axis=1) * share
    assert len(triangle) > 16
    # In eighths there is a little more that is uneven than in the quarters that the pieces are judged by.
    assert wrong.max() < 1.5 * MISPLACED * (surfaces.areas @ surfaces.emission).sum()


def test_vertices_show_the_texture_filtered_and_without_seams():
    wall = textured(
        plain_east()[0], lambda p: np.stack([p[:, 1] / 2, p[:, 2] / 2, p[:, 1] * 0 + 0.25], axis=1), along=64
    )
    east = next(m for m in bake(room([wall], plain_lamp()), COARSE).meshes if m.mesh == 5)
    corners = east.vertices[east.triangles]
    reflectance = east.radiosity / east.irradiance
    inside = np.all((corners[..., 1:] > 0.3) & (corners[..., 1:] < 1.7), axis=2)
    wanted = np.stack([corners[..., 1] / 2, corners[..., 2] / 2, corners[..., 1] * 0 + 0.25], axis=2)
    # Over the faces around a vertex, which reach 0.2 at most, the gradient of 1/2 does not quite cancel.
    assert np.abs(reflectance - wanted)[inside].max() < 0.05
    of_vertex = {}
    for vertex, colour in zip(east.triangles.ravel(), reflectance.reshape(-1, 3), strict=True):
        of_vertex.setdefault(vertex, []).append(colour)
    assert max(np.ptp(colours, axis=0).max() for colours in of_vertex.values()) < 1e-6


def test_a_texture_of_one_colour_is_that_colour():
    plain = room(plain_east(), plain_lamp())
    wall = textured(replace(plain_east()[0], reflectance=np.zeros((2, 3))), lambda p: p * 0 + 0.5)
    for mine, theirs in zip(bake(room([wall], plain_lamp()), COARSE).meshes, bake(plain, COARSE).meshes, strict=True):
        assert mine.irradiance == pytest.approx(theirs.irradiance, rel=1e-4, abs=1e-6)
        assert mine.radiosity == pytest.approx(theirs.radiosity, rel=1e-4, abs=1e-6)


def test_original_meshes_are_lit_by_textures_too():
    wall = textured(plain_east()[0], halves(1, 1.0, 0.9, 0.1))
    settings = replace(COARSE, output="ORIGINAL")
    light = {lit: bake(room([lit], plain_lamp()), settings) for lit in (wall, replace(wall, reflectance_texture=None))}
    textured_floor, plain_floor = (result.meshes[0].irradiance for result in light.values())
    # The same mean reflectance: the floor's corners beside the bright half and beside the dark one are told apart.
    order = np.argsort((textured_floor / plain_floor)[..., 0].ravel())
    corners = light[wall].meshes[0].vertices[light[wall].meshes[0].triangles].reshape(-1, 3)
    assert corners[order[-1]][:2].tolist() == [2, 0] and corners[order[0]][:2].tolist() == [2, 2]


# ---------------------------------------------------------------------------------------------------------- relight


def test_relighting_with_other_textures_is_a_bake_with_them(monkeypatch):
    # How many rays there are depends on the noise, and that on the colours.
    monkeypatch.setattr(bake_module, "enough_rays", lambda rays, *found: rays)
    settings = replace(COARSE, output="ORIGINAL", keep_transport=True)
    first = room([textured(plain_east()[0], halves(1, 1.0, 0.9, 0.1))], plain_lamp())
    second = room([textured(plain_east()[0], halves(2, 0.5, 0.2, 0.7))], plain_lamp())
    kept = bake(first, settings)
    assert same_bytes(relight(kept.kept, first), kept)
    again, fresh = relight(kept.kept, second), bake(second, settings)
    for mine, theirs in zip(again.meshes, fresh.meshes, strict=True):
        # What vertices get does not depend on the texture but through the light.
        assert mine.radiosity == pytest.approx(theirs.radiosity, rel=1e-5)


def test_relighting_refuses_light_from_what_was_dark_in_a_texture():
    lamp = plain_lamp()[0]
    first = room(plain_east(), [textured(lamp, halves(0, 1.0, 0.0, 4.0), "emission")])
    other = room(plain_east(), [textured(lamp, halves(0, 1.0, 4.0, 4.0), "emission")])
    dimmed = room(plain_east(), [textured(lamp, halves(0, 1.0, 0.0, 1.0), "emission")])
    kept = bake(first, replace(COARSE, quality="DRAFT", keep_transport=True))
    quarter = relight(kept.kept, dimmed)
    assert mean_over(quarter.meshes[:1]) == pytest.approx(mean_over(kept.meshes[:1]) / 4, rel=1e-5)
    with pytest.raises(ChangedSceneError, match="lamp"):
        relight(kept.kept, other)


# ----------------------------------------------------------------------------------------------------------- images


def chessboard(size):
    board = (np.add.outer(np.arange(size), np.arange(size)) % 2).astype(np.float32)
    return np.repeat(board[:, :, None], 3, axis=2)


@pytest.mark.parametrize("shape", [(1, 1), (5, 3), (16, 16), (7, 12)])
def test_smaller_images_keep_the_mean(shape):
    pixels = np.random.default_rng(1).random((*shape, 3)).astype(np.float32)
    for level in image_of(pixels).levels:
        # Single precision, a level after the other.
        assert level.mean(axis=(0, 1)) == pytest.approx(pixels.mean(axis=(0, 1)), rel=1e-5)


def test_the_middle_of_a_pixel_has_its_colour_and_between_two_is_their_mean():
    image = image_of(np.arange(12, dtype=np.float32).reshape(2, 2, 3))
    uv = np.array([[0.25, 0.25], [0.75, 0.75], [0.5, 0.25]])
    assert sampled(image, uv, np.zeros(3)).tolist() == [[0, 1, 2], [9, 10, 11], [1.5, 2.5, 3.5]]


@pytest.mark.parametrize(
    ("extension", "colours"),
    [("REPEAT", [0, 1, 1]), ("MIRROR", [1, 0, 0]), ("EXTEND", [1, 1, 0]), ("CLIP", [0, 0, 0])],
)
def test_what_lies_outside_of_an_image_follows_its_extension(extension, colours):
    image = image_of(np.array([[[0.0], [1.0]]], dtype=np.float32), extension)
    uv = np.array([[1.25, 0.5], [1.75, 0.5], [-0.25, 0.5]])
    assert sampled(image, uv, np.zeros(3))[:, 0].tolist() == colours


def test_a_fine_pattern_seen_from_afar_is_its_mean():
    uv = np.random.default_rng(2).random((100, 2))
    assert sampled(image_of(chessboard(64)), uv, np.full(100, 64.0)) == pytest.approx(np.full((100, 3), 0.5))


def test_means_replace_the_colour_of_what_varies():
    mesh = textured(surface_mesh("one", np.eye(3), [(0, 1, 2)]), lambda p: p * 0 + [0.1, 0.2, 0.3], along=4)
    assert with_means(np.ones((2, 3)), mesh.reflectance_texture) == pytest.approx(
        np.array([[0.1, 0.2, 0.3], [1, 1, 1]])
    )
