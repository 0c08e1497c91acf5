# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that is for some meshes alone, or that some meshes alone hide."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.direct import all_emitters, direct_light
from radiosity_bake.core.lamp_shapes import FEW_LAMPS
from radiosity_bake.core.lit_points import LitPoints
from radiosity_bake.core.relight import ChangedSceneError, relight
from radiosity_bake.core.scene import LightLinking, PointLamp, Scene
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.surfaces import join
from radiosity_bake.core.visibility import RayScene

from tests.core.building import DARK, block
from tests.scenes import exact

FLOOR = exact.rectangle("floor", (-3, -3, 0), (6, 0, 0), (0, 6, 0), reflectance=0.5)
BOARD = block("board", (-0.8, -0.6, 0.3), (0.7, 0.9, 0.35))
PANEL = exact.rectangle("panel", (-0.3, -0.3, 1.5), (0, 0.6, 0), (0.6, 0, 0), emission=(2.0, 2.0, 2.0))
SMALL_PANELS = [
    exact.rectangle("small", (0.02 * k, -0.3, 1.5), (0, 0.6, 0), (0.02, 0, 0), emission=(2.0, 2.0, 2.0))
    for k in range(-10, 10)
]
LAMP = PointLamp("lamp", np.array([0.0, 0.0, 1.4]), 0.1, np.ones(3))
LAMPS = [
    replace(LAMP, centre=np.array([0.01 * k, 0.0, 1.4]), strength=np.ones(3) / FEW_LAMPS) for k in range(FEW_LAMPS + 8)
]
ON_FLOOR, ON_BOARD = 0, 1
FLOOR_ALONE, BOARD_ALONE, NOTHING = frozenset({ON_FLOOR}), frozenset({ON_BOARD}), frozenset[int]()
SETTINGS = BakeSettings(quality="DRAFT", threads=2)

SOURCES = pytest.mark.parametrize(
    ("panels", "lamps"),
    [([PANEL], []), (SMALL_PANELS, []), ([], [LAMP]), ([], LAMPS)],
    ids=["panel", "many panels", "lamp", "many lamps"],
)


def scene_of(panels, lamps, linking):
    shining = [replace(panel, linking=linking) for panel in panels]
    return Scene((FLOOR, BOARD, *shining), DARK, tuple(replace(lamp, linking=linking) for lamp in lamps))


def direct_on_floor(scene, points, mesh=ON_FLOOR):
    """Direct irradiance over pi at points of the floor, in red."""
    surfaces = join(scene)
    rays = RayScene(
        surfaces.points, surfaces.triangles, 1, surfaces.seen, surfaces.shadow, blockers=surfaces.blockers()
    )
    emitters = all_emitters(surfaces, np.ones((len(surfaces.closed), 2), dtype=bool), rays, 0)
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    at = LitPoints.of(points, up, mesh=np.full(len(points), mesh))
    light, _ = direct_light(emitters, rays, at, 64, 0)
    return light.irradiance(emitters.strengths)[:, 0]


def places(count=60):
    """Places of the floor, some of them under the board."""
    return np.append(np.random.default_rng(0).uniform(-2, 2, (count, 2)), np.zeros((count, 1)), axis=1)


@SOURCES
def test_light_reaches_the_meshes_that_it_is_for_as_if_it_were_for_all(panels, lamps):
    at = places()
    lit = direct_on_floor(scene_of(panels, lamps, LightLinking(receivers=FLOOR_ALONE)), at)
    np.testing.assert_array_equal(lit, direct_on_floor(scene_of(panels, lamps, LightLinking()), at))
    assert lit.any()


@SOURCES
def test_light_for_other_meshes_does_not_arrive(panels, lamps):
    scene = scene_of(panels, lamps, LightLinking(receivers=BOARD_ALONE))
    assert not direct_on_floor(scene, places()).any()


@SOURCES
def test_what_is_no_blocker_throws_no_shadow(panels, lamps):
    at = places()
    free = scene_of(panels, lamps, LightLinking(blockers=NOTHING))
    hidden = scene_of(panels, lamps, LightLinking(blockers=BOARD_ALONE))
    without_board = replace(free, meshes=(FLOOR, replace(BOARD, shadow=False), *free.meshes[2:]))
    np.testing.assert_array_equal(direct_on_floor(free, at), direct_on_floor(without_board, at))
    everything = scene_of(panels, lamps, LightLinking())
    # Shadow rays meet the same triangles, in a tree of their own. Many lights take no part in each other's shadow.
    np.testing.assert_allclose(direct_on_floor(hidden, at), direct_on_floor(everything, at), rtol=1e-9)
    assert direct_on_floor(hidden, at).sum() < 0.95 * direct_on_floor(free, at).sum()


def test_light_of_several_linkings_adds_up():
    at = places()
    linkings = (LightLinking(FLOOR_ALONE, NOTHING), LightLinking(), LightLinking(BOARD_ALONE))
    panels = [replace(PANEL, linking=linking) for linking in linkings]
    together = direct_on_floor(Scene((FLOOR, BOARD, *panels), DARK), at)
    alone = [direct_on_floor(Scene((FLOOR, BOARD, panel), DARK), at) for panel in panels]
    # Panels in one place hide each other's rays no more than their own; each has the rays of one.
    np.testing.assert_allclose(together, sum(alone), rtol=1e-9)


def test_linked_light_is_in_the_rays_of_the_report_and_its_energy_adds_up():
    linking = LightLinking(receivers=FLOOR_ALONE, blockers=NOTHING)
    found = bake(scene_of([PANEL], [LAMP], linking), SETTINGS)
    assert found.report["energy"]["imbalance"] == pytest.approx(0.0, abs=0.01)
    assert found.report["energy"]["emitted"] > 0.0
    assert found.report["rays"] == sum(found.report["rays_by_kind"].values())


def test_relighting_keeps_to_the_linking_and_refuses_another():
    scene = scene_of([PANEL], [LAMP], LightLinking(receivers=FLOOR_ALONE))
    first = bake(scene, replace(SETTINGS, keep_transport=True))
    again = relight(first.kept, scene)
    for mesh, before in zip(again.meshes, first.meshes, strict=True):
        np.testing.assert_array_equal(mesh.irradiance, before.irradiance)
    for panels, lamps in (([PANEL], []), ([], [LAMP])):
        part = scene_of(panels, lamps, LightLinking(receivers=FLOOR_ALONE))
        kept = bake(part, replace(SETTINGS, keep_transport=True)).kept
        for other in (LightLinking(), LightLinking(BOARD_ALONE), LightLinking(FLOOR_ALONE, NOTHING)):
            with pytest.raises(ChangedSceneError, match="was changed"):
                relight(kept, scene_of(panels, lamps, other))
