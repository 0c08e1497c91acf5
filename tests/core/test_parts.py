# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of the light: direct and reflected, and light groups, sum up to the whole and are what they are said to be."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.parts import NotDividedError, all_groups, drawn_to_sum
from radiosity_bake.core.relight import relight
from radiosity_bake.core.scene import LightGroup, PointLamp, Scene
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.world import MAP_CELLS

from tests.core.building import DARK, block
from tests.core.test_bake import same_bytes
from tests.core.test_textures import textured
from tests.scenes import exact

COARSE = {"quality": "DRAFT", "minimum_size": 0.4}
VALUES = ("radiosity", "irradiance")

ROUNDING = 1e-12
"""Of the largest value: sums of a few numbers in double precision."""


def room(groups=True):
    """A block in an open room with a warm panel, a lamp, and a weak sky."""
    walls = exact.box_walls((2, 2, 2), reflectance=0.6)[:-1]
    panel = exact.rectangle("panel", (0.3, 0.8, 1.95), (0, 0.4, 0), (0.4, 0, 0), emission=(8.0, 4.0, 2.0))
    lamp = PointLamp("lamp", np.array([1.6, 1.5, 1.2]), 0.05, np.array([0.2, 0.4, 0.8]))
    meshes = (*walls, panel, block("block", (0.7, 0.7, 0.0), (1.2, 1.2, 0.8), turned=25.0))
    made = (LightGroup("Panel", meshes=frozenset({len(walls)})), LightGroup("Lamp", lamps=frozenset({0})))
    return Scene(meshes, np.full(3, 0.1), (lamp,), made if groups else ())


@pytest.fixture(scope="module", params=["REFINED", "ORIGINAL"])
def bakes(request):
    """The room baked whole, direct and indirect, each with its groups."""
    return {
        light: bake(room(), BakeSettings(**COARSE, output=request.param, light=light, light_groups=True))
        for light in ("ALL", "DIRECT", "INDIRECT")
    }


def joined(meshes, name):
    return np.concatenate([getattr(mesh, name).reshape(-1, 3) for mesh in meshes])


@pytest.mark.parametrize("name", VALUES)
def test_direct_and_indirect_light_sum_up_to_all(bakes, name):
    whole, direct, indirect = (joined(bakes[light].meshes, name) for light in ("ALL", "DIRECT", "INDIRECT"))
    assert np.abs(direct + indirect - whole).max() <= ROUNDING * whole.max()
    assert direct.min() >= 0.0 and indirect.min() >= 0.0
    assert direct.mean() > 0.05 * whole.mean() and indirect.mean() > 0.05 * whole.mean()


@pytest.mark.parametrize("light", ["ALL", "DIRECT", "INDIRECT"])
@pytest.mark.parametrize("name", VALUES)
def test_light_groups_and_the_rest_sum_up_to_the_whole(bakes, light, name):
    for mesh in bakes[light].meshes:
        assert [group.name for group in mesh.groups] == ["Panel", "Lamp", ""]
        total = sum(getattr(group, name) for group in mesh.groups)
        assert np.abs(total - getattr(mesh, name)).max() <= ROUNDING * max(getattr(mesh, name).max(), 1.0)
        assert min(getattr(group, name).min() for group in mesh.groups) >= 0.0


@pytest.mark.parametrize("name", ["Panel", ""])
def test_a_group_is_what_a_bake_of_its_light_alone_gives(name):
    alone = {
        "Panel": replace(room(False), world=DARK, lamps=()),
        "": replace(room(False), meshes=tuple(mesh.without_emission() for mesh in room().meshes), lamps=()),
    }
    settings = BakeSettings(output="ORIGINAL")
    whole, fresh = bake(room(), replace(settings, light_groups=True)), bake(alone[name], settings)
    part = [next(group for group in mesh.groups if group.name == name) for mesh in whole.meshes]
    found, expected = joined(part, "irradiance"), joined(fresh.meshes, "irradiance")
    # Lamps share the shadow rays, so that alone it gets others: the standard error of a half hidden lamp is 0.5 over
    # the root of 64 rays, the fewest that GOOD gives.
    assert np.sqrt(np.mean((found - expected) ** 2)) <= 0.5 / np.sqrt(64) * expected.mean()


def test_direct_light_on_the_floor_of_a_black_room_is_all_there_is():
    scene = room()
    black = replace(scene, meshes=tuple(mesh.without_reflectance() for mesh in scene.meshes))
    settings = BakeSettings(**COARSE, output="ORIGINAL")
    whole, direct = bake(black, settings), bake(black, replace(settings, light="DIRECT"))
    same_bytes(whole, direct)
    indirect = bake(black, replace(settings, light="INDIRECT"))
    assert not joined(indirect.meshes, "irradiance").any()
    assert not joined(indirect.meshes, "radiosity").any()


def test_what_is_asked_for_costs_no_rays_and_leaves_the_whole_as_it_is(bakes):
    plain = bake(room(False), BakeSettings(**COARSE, output=bakes["ALL"].report["settings"]["output"]))
    assert plain.report["rays"] == bakes["ALL"].report["rays"]
    for mesh, other in zip(plain.meshes, bakes["ALL"].meshes, strict=True):
        for name in VALUES:
            assert getattr(mesh, name).tobytes() == getattr(other, name).tobytes()
        assert mesh.groups == ()


@pytest.mark.parametrize("light", ["ALL", "INDIRECT"])
def test_relighting_gives_the_same_parts(bakes, light):
    again = relight(bakes[light].kept, room())
    for mesh, other in zip(again.meshes, bakes[light].meshes, strict=True):
        assert mesh.irradiance.tobytes() == other.irradiance.tobytes()
        for group, before in zip(mesh.groups, other.groups, strict=True):
            assert group.radiosity.tobytes() == before.radiosity.tobytes()


def test_textures_of_the_rest_are_dark_and_black_too():
    scene = room()
    floor = textured(scene.meshes[0], lambda x: np.where(x[..., :1] < 1.0, 0.2, 0.8) * np.ones(3))
    panel = textured(scene.meshes[-2], lambda x: np.where(x[..., 1:2] < 1.0, 2.0, 6.0) * np.ones(3), "emission")
    scene = replace(scene, meshes=(floor, *scene.meshes[1:-2], panel, scene.meshes[-1]))
    result = bake(scene, BakeSettings(**COARSE, light="INDIRECT", light_groups=True))
    for name in VALUES:
        parts = sum(joined([mesh.groups[index] for mesh in result.meshes], name) for index in range(3))
        assert parts == pytest.approx(joined(result.meshes, name), abs=ROUNDING * 6.0)
    # Whatever is emitted is direct light: nothing here is as bright as the darker half of the panel.
    assert 0.0 < joined(result.meshes, "radiosity").max() < 2.0


def test_a_world_that_is_a_map_is_a_part_as_any_other():
    above = np.where(np.arange(MAP_CELLS) % 2, 0.5, 0.1)[:, None] * np.ones(3)
    result = bake(replace(room(), world=above), BakeSettings(**COARSE, light="DIRECT", light_groups=True))
    for mesh in result.meshes:
        assert [group.name for group in mesh.groups] == ["Panel", "Lamp", ""]
        total = sum(group.irradiance for group in mesh.groups)
        assert total == pytest.approx(mesh.irradiance, abs=ROUNDING * max(mesh.irradiance.max(), 1.0))


def test_groups_without_light_are_left_out():
    scene = room()
    dark = LightGroup("Dark", meshes=frozenset({0}))
    assert [group.name for group in all_groups(replace(scene, light_groups=(*scene.light_groups, dark)))] == [
        "Panel",
        "Lamp",
        "",
    ]
    assert [group.name for group in all_groups(replace(scene, world=DARK))] == ["Panel", "Lamp"]


def test_light_that_no_part_accounts_for_goes_to_the_last():
    parts = drawn_to_sum([np.array([1.0, 0.0]), np.array([3.0, 0.0])], np.array([2.0, 5.0]))
    assert np.array(parts).tolist() == [[0.5, 0.0], [1.5, 5.0]]


def test_too_little_memory_to_tell_the_parts_apart_is_an_error(monkeypatch):
    monkeypatch.setattr("radiosity_bake.core.relight.is_complete", lambda kept: False)
    with pytest.raises(NotDividedError, match="memory limit"):
        bake(room(), BakeSettings(**COARSE, output="ORIGINAL", light="DIRECT"))
    bake(room(), BakeSettings(**COARSE, output="ORIGINAL"))
