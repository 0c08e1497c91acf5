# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the benchmarks compute themselves: an exact factor behind a sheet, references in parts, clocks, pictures."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from radiosity_bake.core.result import BakedMesh, BakeResult
from radiosity_bake.core.scene import Scene, surface_mesh

from bench import form_factors, picture, stopwatch
from bench.accuracy import Accuracy
from bench.backs import back_can_be_seen
from bench.reference import Reference, combined
from bench.scenes import SCENES, even_size
from bench.survey import Finding
from bench.varied_scenes import VARIED_SCENES
from tests.scenes import exact
from tools.rooms import Camera

ROOT = Path(__file__).resolve().parents[2]


def test_the_half_blocked_factor_is_that_of_random_pairs_of_points():
    rng, count = np.random.default_rng(1), 400_000
    low, high = rng.random((2, count, 2))
    apart = ((high - low) ** 2).sum(axis=1) + 1.0
    middle = np.abs((low + high) / 2 - 0.5).max(axis=1)
    kernel = np.where(middle < form_factors.SHEET / 2, 0.0, 1.0 / (np.pi * apart**2))
    # 4 sigma: wrong by chance once in 16,000 seeds.
    assert form_factors.half_blocked_factor() == pytest.approx(kernel.mean(), abs=4 * kernel.std() / np.sqrt(count))


def test_traced_rows_count_the_factor_of_the_catalogue():
    case = form_factors.cases()[0]
    factor, rays = form_factors.traced_factor(case, 4096, seed=0)
    assert rays >= 4096
    # 4 sigma of as many independent rays; low-discrepancy rays do better.
    assert factor == pytest.approx(case.truth, abs=4 * np.sqrt(case.truth * (1 - case.truth) / rays))


def test_parts_of_a_reference_are_averaged_and_their_errors_too():
    parts = [Reference(np.full((2, 3), x), np.full((2, 3), 0.2), 16, 1.0) for x in (1.0, 2.0, 3.0, 4.0)]
    whole = combined(parts)
    assert whole.irradiance == pytest.approx(np.full((2, 3), 2.5))
    # A quarter of the variance, half of the error.
    assert whole.standard_error == pytest.approx(np.full((2, 3), 0.1))
    assert (whole.samples, whole.seconds) == (64, 4.0)


def test_the_back_of_a_lamp_shines_where_something_may_see_it():
    floor, lamp = exact.lamp_over_floor()[0].meshes
    ceiling = exact.rectangle("ceiling", (-1, -1, 3), (0, 2, 0), (2, 0, 0))
    dark = np.zeros(3)
    assert not back_can_be_seen(Scene((floor, lamp), dark), 1)
    assert back_can_be_seen(Scene((floor, lamp, ceiling), dark), 1)


def test_the_inside_of_a_closed_lamp_shines_where_something_is_in_it():
    vertices, triangles = exact.icosphere(1)
    lamp = surface_mesh("lamp", vertices, triangles, emission=exact.rgb(1.0))
    beside = exact.rectangle("beside", (2, 0, 0), (1, 0, 0), (0, 1, 0))
    inside = exact.rectangle("inside", (-0.1, -0.1, 0), (0.2, 0, 0), (0, 0.2, 0))
    assert not back_can_be_seen(Scene((lamp, beside), np.zeros(3)), 0)
    assert back_can_be_seen(Scene((lamp, inside), np.zeros(3)), 0)


def test_an_even_subdivision_has_about_the_patches_that_were_asked_for():
    scene = SCENES["cornell_box"]()
    # Patches of size 2n and area n^2 would be half as many; those of size n and area n^2 / 4 twice as many.
    from radiosity_bake.core.bake import bake
    from radiosity_bake.core.settings import BakeSettings

    settings = BakeSettings(method="UNIFORM", quality="DRAFT", minimum_size=even_size(scene, 1000))
    assert 500 <= bake(scene, settings).report["patches"] <= 2000


def test_a_busy_loop_costs_processor_time_and_a_sleep_costs_none():
    # In a process of its own: threads that earlier tests left spinning would count here too.
    code = f"""
import sys, time
sys.path.insert(0, {str(ROOT)!r})
from bench import stopwatch

def busy():
    end = time.process_time() + 0.2
    while time.process_time() < end:
        pass

for run in (busy, lambda: time.sleep(0.2)):
    cost = stopwatch.timed_once(run)[1]
    print(cost.seconds, cost.processor_seconds, cost.others)
"""
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    (work, busy_for, others), (rest, idle_for, _) = (map(float, line.split()) for line in told.splitlines())
    assert rest >= 0.2
    # Processor clocks tick in hundredths of a second, two of them are added up, and the loop asks a finer one.
    assert abs(busy_for - 0.2) <= 0.05
    assert idle_for <= 0.05
    assert work >= busy_for - 0.05
    assert 0.0 <= others <= 1.0


def test_the_shortest_of_a_few_short_runs_counts():
    delays = iter((0.05, 0.01, 0.03, 0.0))
    _, cost = stopwatch.timed(lambda: time.sleep(next(delays)))
    assert cost.seconds >= 0.01
    assert next(delays) == 0.0, "three runs were made"


def baked_square() -> BakeResult:
    """A square of two triangles in the plane y = 0, a colour ramp from left to right."""
    square = exact.rectangle("square", (-1, 0, -1), (2, 0, 0), (0, 0, 2))
    ramp = np.repeat((square.vertices[square.triangles][..., 0] + 1.0)[..., None] / 2, 3, axis=2)
    weights = np.broadcast_to(np.eye(3), (2, 3, 3))
    mesh = BakedMesh(0, square.vertices, square.triangles, np.arange(2), weights, square.corner_normals, ramp, ramp)
    return BakeResult((mesh,), {})


CAMERA = Camera((0.0, -2.0, 0.0), (0.0, 0.0, 0.0), 36.0, 36.0)


def test_a_picture_shows_the_colours_between_the_vertices():
    shown = picture.render(baked_square(), CAMERA, 40)
    assert shown.shape == (40, 40, 3)
    # From 2 m with a field of 1 : 1, the square of 2 m fills the picture; its ramp grows from left to right.
    assert np.all(np.diff(shown[20, :, 0]) > 0.0)
    assert np.allclose(shown, shown[20][None], atol=1e-6)


def test_edges_are_drawn_where_triangles_meet():
    plain, wired = (picture.render(baked_square(), CAMERA, 60, edges=edges) for edges in (False, True))
    darker = plain[..., 0] - wired[..., 0] > 0.1 * plain[..., 0]
    inner = darker[5:-5, 5:-5]
    # The diagonal alone crosses the middle, from the lower left to the upper right: about one pixel wide, it meets one
    # to three pixels of each of the 50 rows.
    rows, columns = np.nonzero(inner)
    assert set(rows) == set(range(50))
    assert inner.sum() <= 150
    assert np.abs(rows + columns - (inner.shape[0] - 1)).max() <= 1


@pytest.mark.parametrize("name", VARIED_SCENES)
def test_the_shading_of_a_varied_scene_is_on_the_side_of_its_fronts(name):
    for mesh in VARIED_SCENES[name]().meshes:
        a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
        front = np.cross(b - a, c - a)
        assert (np.einsum("tc,tkc->tk", front, mesh.corner_normals) > 0.0).all(), mesh.name


@pytest.mark.parametrize(
    ("rms", "estimate", "misses"),
    [
        (0.019, 0.02, ""),
        (0.021, 0.03, "error"),
        (0.01, 0.009, "estimate"),
        (0.01, 0.031, "estimate"),
        (0.03, 0.01, "error, estimate"),
    ],
)
def test_a_survey_says_what_was_promised_and_not_kept(rms, estimate, misses):
    accuracy = Accuracy(rms, rms, rms, 0.0, rms, 0.0, rms, 1, ())
    assert Finding("GOOD", accuracy, estimate, 3, 1, 64, stopwatch.Cost(1.0, 1.0, 0.0)).misses == misses
