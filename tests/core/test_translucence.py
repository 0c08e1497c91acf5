# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets of which one side sends on light of the other, such as paper and leaves."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.relight import ChangedSceneError, relight
from radiosity_bake.core.scene import PointLamp, Scene, Texture
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.solve import Exchange, Translucence, solve_balance

from tests.core.building import DARK, grid, mean_over
from tests.scenes import exact

SETTINGS = BakeSettings(quality="GOOD", output="ORIGINAL", minimum_size=0.3, keep_transport=True)
LAMP = PointLamp("Lamp", np.array([0.5, 0.4, 1.6]), 0.0, np.full(3, 10.0))


def paper(share, reflectance=0.3, **options):
    """A sheet over the unit square."""
    made = exact.rectangle("paper", (-1, -1, 1), (3, 0, 0), (0, 3, 0), reflectance=reflectance)
    return replace(made, translucence=np.broadcast_to(np.asarray(share, dtype=float), (2, 3)), **options)


def test_each_side_shows_what_it_reflects_and_what_comes_from_the_other():
    (sheet,) = bake(Scene((paper((0.5, 0.4, 0.1)),), DARK, (LAMP,)), SETTINGS).meshes
    share = np.array([0.5, 0.4, 0.1])
    assert sheet.irradiance.mean() > 0.1 and sheet.irradiance_back.mean() < 1e-6
    np.testing.assert_allclose(sheet.radiosity, 0.3 * sheet.irradiance + share * sheet.irradiance_back)
    np.testing.assert_allclose(sheet.radiosity_back, 0.3 * sheet.irradiance_back + share * sheet.irradiance)


@pytest.mark.parametrize("output", ["ORIGINAL", "REFINED"])
def test_what_comes_through_lights_the_floor_as_if_the_sheet_were_lit_from_below(output):
    floor = grid("floor", 4, reflectance=0.0)
    settings = replace(SETTINGS, output=output)
    through = bake(Scene((floor, paper(0.5, 0.0)), DARK, (LAMP,)), settings).meshes[:1]
    # The same light on the other side, which reflects as much; the lamp stands as high above the sheet as below it.
    below = replace(LAMP, centre=LAMP.centre * [1, 1, -1] + [0, 0, 2.0], shadow=False)
    shade = grid("floor", 4, reflectance=0.0)
    lit = bake(Scene((shade, replace(paper(0.0, 0.5), translucence=None)), DARK, (below,)), settings).meshes[:1]
    direct = bake(Scene((shade,), DARK, (below,)), settings).meshes[:1]
    reflected = mean_over(lit)[0] - mean_over(direct)[0]
    # A few patches, and what is left when most of the light is taken away.
    assert mean_over(through)[0] == pytest.approx(reflected, rel=0.02)


def test_paper_that_takes_no_light_away_is_not_seen_in_a_furnace():
    scene, expected = exact.furnace(0.5)
    furnace = float(np.mean(expected["radiosity"]))
    hung = exact.rectangle("paper", (0.1, 0.1, 0.3), (0.8, 0, 0), (0, 0.8, 0), reflectance=0.4)
    hung = replace(hung, translucence=np.full((2, 3), 0.6))
    result = bake(Scene((*scene.meshes, hung), scene.world), SETTINGS)
    # What few patches leave where a board hangs in a furnace.
    for mesh in result.meshes:
        assert mesh.irradiance.mean() == pytest.approx(furnace, rel=0.01)
    assert abs(result.report["energy"]["imbalance"]) < 0.02


def test_the_solver_agrees_with_the_balance_written_out():
    rng = np.random.default_rng(4)
    factors = rng.uniform(0.0, 0.3, (4, 4))
    receiver, source = np.nonzero(factors)
    exchange = Exchange(np.arange(4), np.arange(4) * 4, source, factors[receiver, source].astype(np.float32))
    rho, tau, direct = (rng.uniform(0.1, 0.5, (4, 3)) for _ in range(3))
    other = np.array([1, 0, 3, 2])
    solved = solve_balance(exchange, rho, direct, np.ones(4), Translucence(tau, other))
    for channel in range(3):
        sends = np.diag(rho[:, channel]) + np.diag(tau[:, channel])[:, other]
        light = np.linalg.solve(np.eye(4) - sends @ factors, sends @ direct[:, channel])
        # The solver's residual.
        np.testing.assert_allclose(solved.reflected[:, channel], light, rtol=1e-4)


def test_a_texture_of_one_colour_is_as_good_as_the_colour():
    colours = np.full((32, 3), 0.5, dtype=np.float32)
    texture = Texture(np.arange(2), np.zeros(2, dtype=int), np.full(2, 4), colours)
    floor = grid("floor", 4, reflectance=0.0)
    plain, textured = (
        bake(Scene((floor, sheet), DARK, (LAMP,)), SETTINGS).meshes
        for sheet in (paper(0.5), paper(0.0, translucence_texture=texture))
    )
    for one, other in zip(plain, textured, strict=True):
        np.testing.assert_allclose(one.radiosity, other.radiosity, rtol=1e-5, atol=1e-9)


def test_relighting_gives_paper_another_colour_but_makes_none():
    floor = grid("floor", 4, reflectance=0.0)
    scene = Scene((floor, paper(0.5)), DARK, (LAMP,))
    kept, other = bake(scene, SETTINGS).kept, Scene((floor, paper(0.2)), DARK, (LAMP,))
    again, anew = relight(kept, other).meshes[0], bake(other, SETTINGS).meshes[0]
    # Light decides how many rays there are, and so a bake may take others: the noise of its quality is 1.3%.
    np.testing.assert_allclose(again.irradiance, anew.irradiance, rtol=0.03)
    with pytest.raises(ChangedSceneError, match="paper"):
        relight(kept, Scene((floor, paper(0.0)), DARK, (LAMP,)))
