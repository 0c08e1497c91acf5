# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Agreement of the reference with exact answers: `python -m bench.agreement` prints it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from radiosity_bake.core.scene import Floats, Scene

from tests.scenes import exact, oracle

from .probes import area_uniform_probes
from .reference import irradiance


def agreement() -> list[tuple[str, float, float, float]]:
    """Return (case, mean of reference / truth - 1, its standard error, chi-square of a point) for exact cases.

    For the squares also by how much the mean of the exact values at the probes misses the form factor: the probes' own
    error as a rule of integration.
    """
    rows = []

    def add(name: str, scene: Scene, points: Floats, normals: Floats, truth: Floats, samples: int = 4096) -> None:
        found = irradiance(scene, points, normals, samples=samples, cache=False)
        truth = np.broadcast_to(truth, found.irradiance.shape)
        ratio = found.irradiance / truth - 1.0
        sigma = float(np.sqrt(((found.standard_error / truth) ** 2).mean(axis=1).sum())) / len(points)
        z = ratio * truth / np.maximum(found.standard_error, 1e-7 * truth)
        rows.append((name, float(ratio.mean()), sigma, float((z**2).mean())))

    for reflectance in (0.5, 0.8):
        scene, expected = exact.furnace(reflectance)
        probes = area_uniform_probes_of_all(scene, 200)
        add(f"furnace, rho {reflectance}", scene, *probes, expected["radiosity"])
    scene, expected = exact.white_sky()
    probes = area_uniform_probes(scene, 200)
    add("white sky, front", scene, probes.position, probes.normal, expected["irradiance"], 256)
    add("white sky, back", scene, probes.position, -probes.normal, expected["irradiance"], 256)
    scene, expected = exact.lamp_over_floor()
    probes = area_uniform_probes(scene, 200)
    add("point to rectangle", scene, probes.position, probes.normal, expected["irradiance_at"](probes.position))
    above = probes.position * [1.0, 1.0, -1.0] + [0.0, 0.0, 2.0]
    # A back that no mesh could see is left out of Mitsuba's scene.
    ceiling = exact.rectangle("ceiling", (-1, -1, 3), (0, 2, 0), (2, 0, 0))
    scene = replace(scene, meshes=(*scene.meshes, ceiling))
    add("the lamp's back", scene, above, -probes.normal, expected["irradiance_at"](probes.position))
    scene, expected = exact.wall_and_sky()
    point, up = expected["point"][None], np.array([[0.0, 0.0, 1.0]])
    add("wall and sky", scene, point, up, expected["irradiance"], 1 << 18)
    for name, (scene, expected) in (
        ("aligned squares", exact.aligned_squares()),
        ("perpendicular squares", exact.perpendicular_squares()),
    ):
        probes = area_uniform_probes(scene, 2000)
        lamp = scene.meshes[1].vertices
        factors = [oracle.point_to_polygon(p, n, lamp) for p, n in zip(probes.position, probes.normal, strict=True)]
        add(f"{name}, points", scene, probes.position, probes.normal, np.array(factors)[:, None], 1024)
        off = np.mean(factors) / expected["form_factor"] - 1.0
        rows.append((f"{name}, their mean", float(off), 0.0, float("nan")))
    return rows


def area_uniform_probes_of_all(scene: Scene, count: int) -> tuple[Floats, Floats]:
    """Return positions and normals spread over every surface, emitters too, as the furnace has nothing else."""
    dark = Scene(tuple(replace(m, emission=np.zeros_like(m.emission)) for m in scene.meshes), scene.world)
    probes = area_uniform_probes(dark, count)
    return probes.position, probes.normal


if __name__ == "__main__":
    print(f"{'case':<36}{'bias':>11}{'+-':>11}{'chi^2':>9}")
    for name, bias, sigma, chi in agreement():
        print(f"{name:<36}{bias:>11.5%}{sigma:>11.5%}{chi:>9.2f}")
