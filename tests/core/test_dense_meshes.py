# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Indirect light that is not gathered but interpolated, on dense meshes and along the borders of shadows."""

from unittest.mock import patch

import numpy as np
import pytest
from radiosity_bake.core import bake as bake_module
from radiosity_bake.core import detail
from radiosity_bake.core.bake import bake
from radiosity_bake.core.direct import LUMINANCE
from radiosity_bake.core.relight import relight
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import DARK, block, dense, room_with_block
from tests.core.test_bake import same_bytes
from tests.scenes import exact


def ball(rings, around):
    """Return a ball on a post, as a smooth mesh of many vertices, above the floor of a lit room."""
    t = np.pi * (np.arange(rings) + 0.5) / rings
    a = 2.0 * np.pi * np.arange(around) / around
    normals = np.stack(
        [np.outer(np.sin(t), np.cos(a)), np.outer(np.sin(t), np.sin(a)), np.outer(np.cos(t), np.ones(around))], axis=-1
    ).reshape(-1, 3)
    i, k = (x.ravel() for x in np.meshgrid(np.arange(rings - 1), np.arange(around), indexing="ij"))
    j = (k + 1) % around
    one, two, three, four = i * around + k, i * around + j, (i + 1) * around + j, (i + 1) * around + k
    triangles = np.stack([one, three, two, one, four, three], axis=1).reshape(-1, 3)
    centre = np.array([0.6, 1.1, 0.9])
    return surface_mesh("ball", centre + 0.3 * normals, triangles, reflectance=0.7, corner_normals=normals[triangles])


def room_with_ball():
    """A dense ball beside a block under a lamp."""
    room = room_with_block()
    return Scene((*room.meshes, ball(40, 64)), DARK)


def gathered_everywhere():
    """Bakes that gather indirect light at every vertex."""
    return (
        patch.object(
            bake_module, "gather_sparsely", lambda places, strict, indirect_at, longest, tolerance: indirect_at(places)
        ),
        patch.object(detail, "middles_in_between", lambda *known: None),
    )


@pytest.fixture(scope="module")
def bakes():
    """The room with the ball, baked as it is and with all gathered."""
    settings = BakeSettings(quality="GOOD", minimum_size=0.1)
    first, second = gathered_everywhere()
    with first, second:
        everywhere = bake(room_with_ball(), settings)
    return bake(room_with_ball(), settings), everywhere


def interpolated(result):
    """Which receivers have the light of several others."""
    return (result.kept.shown.gathered.places.weights != 0.0).sum(axis=1) > 1


def test_a_third_of_a_dense_mesh_and_more_need_not_be_gathered(bakes):
    result, _ = bakes
    places = result.kept.shown.places
    on_ball = places.mesh == len(room_with_ball().meshes) - 1
    assert interpolated(result)[on_ball].mean() > 1.0 / 3.0


def test_what_is_interpolated_is_what_would_be_gathered(bakes):
    result, everywhere = bakes
    ours, theirs = result.meshes[-1].irradiance @ LUMINANCE, everywhere.meshes[-1].irradiance @ LUMINANCE
    mean = np.concatenate([(mesh.irradiance @ LUMINANCE).ravel() for mesh in everywhere.meshes]).mean()
    # The rays of GOOD leave 1.3% of noise, of which the difference has that of both.
    assert np.sqrt(((ours - theirs) ** 2).mean()) < np.sqrt(2.0) * 0.013 * mean
    # and nothing that goes on over the whole: the mean of thousands of values differs by less than a tolerance.
    assert abs(ours.mean() - theirs.mean()) < 0.007 * mean


def test_rays_are_saved_along_the_borders_of_shadows():
    settings = BakeSettings(quality="GOOD", output="REFINED")
    result = bake(room_with_block(), settings)
    first, second = gathered_everywhere()
    with first, second:
        everywhere = bake(room_with_block(), settings)
    share = interpolated(result).mean()
    saved = 1.0 - result.report["rays"] / everywhere.report["rays"]
    assert share > 0.1
    # Of a vertex, more than half of the rays are those of its hemisphere.
    assert saved > 0.5 * share


@pytest.mark.parametrize("output", ["ORIGINAL", "REFINED"])
def test_interpolated_light_is_relit_to_the_same_bytes(output):
    scene = dense(room_with_block(), 4)
    result = bake(scene, BakeSettings(quality="DRAFT", minimum_size=0.4, output=output))
    assert interpolated(result).mean() > 0.3
    assert same_bytes(result, relight(result.kept, scene))


def test_the_threads_do_not_matter_to_what_is_interpolated():
    scene = dense(room_with_block(), 4)
    one, two = (bake(scene, BakeSettings(quality="DRAFT", minimum_size=0.4, threads=threads)) for threads in (1, 2))
    assert same_bytes(one, two)


def test_nothing_under_a_post_is_interpolated_from_around_it():
    post = block("post", (0.97, 0.97, 0.0), (1.03, 1.03, 1.0))
    scene = Scene((*exact.box_walls((2, 2, 2), reflectance=0.6), lamp(), post), DARK)
    result = bake(scene, BakeSettings(quality="DRAFT"))
    kept = result.kept.shown
    # The post's own underside is there, too.
    floor = (np.abs(kept.places.points[:, 2]) < 1e-6) & (kept.places.normals[:, 2] > 0.0)
    under = floor & (np.abs(kept.places.points[:, :2] - 1.0).max(axis=1) < 0.0299)
    assert under.any()
    assert not interpolated(result)[under].any()
    assert kept.gathered.hidden[under].all()


def lamp():
    """A lamp under a ceiling of 2 m."""
    return exact.rectangle("lamp", (0.2, 0.3, 1.95), (0, 0.5, 0), (0.5, 0, 0), emission=5.0)
