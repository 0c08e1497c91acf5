# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes against a converged path tracer (tests/core/data/make_references.py makes the references)."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.settings import BakeSettings

from bench.scenes import SCENES
from tests.core.building import cornell_box, values_at

FOLDER = Path(__file__).parent / "data"

MOST_RMS = 0.02
"""Relative RMS error at area-uniform points that a bake at GOOD may have, and"""

MOST_RMS_AT_HIGH = 0.01
"""one at HIGH."""

MOST_PESSIMISTIC = 3.0
"""Times that the estimated error may be larger than the true one; it may never be smaller."""

MOST_FACE_BIAS = 0.03
"""How far the mean over any face may be off."""

FEWEST_PROBES = 30


class Compared:
    """A bake at the probes of the reference."""

    def __init__(self, name, scene, settings):
        with np.load(FOLDER / f"reference_{name}.npz") as stored:
            self.truth = stored["irradiance"].astype(float)
            self.variance = float(stored["variance"])
            mesh, triangle = stored["mesh"].astype(int), stored["triangle"].astype(int)
            position = stored["position"].astype(float)
        self.report = (result := bake(scene, settings)).report
        self.values = np.full_like(self.truth, np.nan)
        for baked in result.meshes:
            rows = mesh == baked.mesh
            self.values[rows] = values_at(baked, triangle[rows], position[rows], baked.irradiance)
        self.error = self.values - self.truth
        # Fans of quadrilaterals: triangles 2 k and 2 k + 1 are one face, but for the walls that are bent along the cut.
        self.face = mesh * 100 + triangle // 2

    @property
    def rms(self) -> float:
        return float(np.sqrt((self.error**2).mean() - self.variance) / self.truth.mean())

    def face_biases(self) -> dict[int, float]:
        found = {}
        for face in np.unique(self.face):
            rows = self.face == face
            if rows.sum() >= FEWEST_PROBES:
                found[int(face)] = float(self.error[rows].mean() / self.truth[rows].mean())
        return found


@cache
def compared(name: str, quality: str) -> Compared:
    scene = cornell_box() if name == "cornell_box" else SCENES[name]()
    return Compared(name, scene, BakeSettings(quality=quality))


@pytest.fixture(scope="module")
def good():
    return compared("cornell_box", "GOOD")


def test_the_probes_lie_on_the_box(good):
    assert np.isfinite(good.values).all()
    assert len(good.values) == 4000


def test_the_error_at_good_is_at_most_two_percent(good):
    assert good.rms <= MOST_RMS


def test_the_mean_of_every_face_at_good_is_within_three_percent(good):
    biases = good.face_biases()
    # Five walls, ten sides of blocks; the narrowest have 58 probes, whose values the bake interpolates to 5% each.
    assert len(biases) >= 14
    assert {face: bias for face, bias in biases.items() if abs(bias) > MOST_FACE_BIAS} == {}


def test_the_mean_over_all_faces_at_good_is_within_a_percent(good):
    assert abs(good.error.mean() / good.truth.mean()) < 0.01


def test_a_draft_is_worse_than_good_but_not_useless(good):
    assert good.rms < compared("cornell_box", "DRAFT").rms < 0.05


@pytest.mark.parametrize(
    ("name", "quality", "most"),
    [
        ("cornell_box", "DRAFT", 0.05),
        ("cornell_box", "GOOD", MOST_RMS),
        ("cornell_box", "HIGH", MOST_RMS_AT_HIGH),
        ("corridor", "DRAFT", 0.1),
        ("corridor", "GOOD", MOST_RMS),
        ("corridor", "HIGH", MOST_RMS_AT_HIGH),
        ("furnished_room", "DRAFT", 0.07),
        ("furnished_room", "GOOD", MOST_RMS),
        ("paper_scene_1", "DRAFT", 0.06),
        ("paper_scene_1", "GOOD", MOST_RMS),
        ("pillar_hall", "DRAFT", 0.08),
        ("statue", "GOOD", MOST_RMS),
    ],
)
def test_the_estimated_error_bounds_the_true_one_and_not_by_far(name, quality, most):
    found = compared(name, quality)
    assert found.rms <= most
    assert found.rms <= found.report["estimated_error"] <= MOST_PESSIMISTIC * found.rms
