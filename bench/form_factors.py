# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Form factors beside programs that compute nothing else: `python -m bench.form_factors`.

raystrack 2 (Monte Carlo, numba) and pyViewFactor (semi-analytic pairs, visibility by one ray between middles), on cases
whose answer is known: error against time, ours by the rows that a bake traces. Those two need a numpy that Blender's
newest does not ship, so they run in an environment of their own.
"""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from radiosity_bake.core.rows import ESCAPED
from radiosity_bake.core.scene import Floats, Scene

from tests.core.building import areas, node_triangles, transport_of
from tests.scenes import exact
from tools.package import ROOT

from .machine import OUT, write_json
from .stopwatch import timed_once

ENVIRONMENT = ROOT / ".venv" / "form-factors"

OURS = "Radiosity Bake, traced rows"

# Of each triangle, as at GOOD; for more rays the triangles are split, as a bake does.
RAYS_PER_ROW = 64
LEAST_RAYS = tuple(4**k for k in range(5, 11))
RAYS_OF_RAYSTRACK = tuple(4**k for k in range(5, 11))

# What is sampled is sampled with each of these; the error is the root mean square, and the shortest time counts.
SEEDS = (0, 1, 2, 3)

# Times that the triangles are split into four for pyViewFactor: its pairs are exact, but seen whole or not at all.
LEVELS = (0, 1, 2, 3)

# Pairs above which it is not asked: it would take minutes.
MOST_PAIRS = 500_000

# Side of the sheet in the blocked case, halfway between two unit squares at distance 1.
SHEET = 0.5

# Of the Gauss rule by which that case is integrated; 16 gives the same 12 digits.
POINTS = 24


@dataclass(frozen=True)
class Case:
    """Two meshes of a scene, the factor from the first to the second, and how that is known."""

    name: str
    scene: Scene
    sender: int
    receiver: int
    truth: float
    source: str


def cases() -> list[Case]:
    """Return the cases, the hardest last."""
    parallel, known = reflecting(exact.aligned_squares())
    near, near_known = reflecting(exact.aligned_squares(distance=0.1))
    corner, corner_known = reflecting(exact.perpendicular_squares())
    spheres, spheres_known = exact.concentric_spheres(levels=2)
    sheet = exact.rectangle(
        "sheet", (0.5 - SHEET / 2, 0.5 - SHEET / 2, 0.5), (SHEET, 0, 0), (0, SHEET, 0), reflectance=0.5
    )
    blocked = Scene((*parallel.meshes, sheet), parallel.world)
    catalogue = "closed form"
    return [
        Case("parallel unit squares, 1 apart", parallel, 0, 1, known["form_factor"], catalogue),
        Case("parallel unit squares, 0.1 apart", near, 0, 1, near_known["form_factor"], catalogue),
        Case("unit squares at a right angle", corner, 0, 1, corner_known["form_factor"], catalogue),
        Case("hollow sphere to the ball in it", spheres, 1, 0, spheres_known["form_factors"][1, 0], "ratio of areas"),
        Case("parallel unit squares, a sheet between", blocked, 0, 1, half_blocked_factor(), "quadrature"),
    ]


def reflecting(case: exact.Case) -> exact.Case:
    """Return the case with grey surfaces: rays that meet a side that no light reaches count as starting in a solid."""
    scene, known = case
    meshes = (replace(mesh, reflectance=np.full_like(mesh.reflectance, 0.5)) for mesh in scene.meshes)
    return Scene(tuple(meshes), scene.world), known


def half_blocked_factor(points: int = POINTS) -> float:
    """Return the factor between the aligned unit squares with the sheet between them, by Gauss quadrature.

    From a point of the lower square the sheet, halfway up, hides of the upper one a square of twice its side, cut off
    where it leaves the upper square: a rectangle, whose factor is known. That is smooth between the lines on which the
    hidden square meets a border of the upper one, which here are the middles.
    """
    node, weight = np.polynomial.legendre.leggauss(points)
    at = np.concatenate([0.25 + 0.25 * node, 0.75 + 0.25 * node])
    share = np.tile(0.25 * weight, 2)
    hidden = 0.0
    for x, wx in zip(at, share, strict=True):
        for y, wy in zip(at, share, strict=True):
            low = np.maximum(1.0 - np.array([x, y]) - SHEET, 0.0)
            high = np.minimum(1.0 - np.array([x, y]) + SHEET, 1.0)
            corner = (*low, 1.0)
            seen = exact.rectangle_seen_from_below([(x, y, 0.0)], corner, *(float(s) for s in high - low))
            hidden += float(wx * wy * seen[0])
    return exact.parallel_factor(1.0, 1.0, 1.0) - hidden


def entry(
    case: Case, method: str, setting: str, factors: Sequence[float], cost: dict[str, Any], work: int
) -> dict[str, Any]:
    """Return one measurement as JSON holds it: factors by seed; `work` is rays or pairs."""
    errors = np.array(factors) / case.truth - 1.0
    return {
        "case": case.name,
        "truth": case.truth,
        "source": case.source,
        "method": method,
        "setting": setting,
        "factor": float(np.mean(factors)),
        "error": float(np.sqrt((errors**2).mean())),
        "work": work,
        **{key: round(value, 6) for key, value in cost.items()},
    }


# ---------------------------------------------------------------------------------------------------------------- ours


def ours(case: Case) -> Iterator[dict[str, Any]]:
    """Yield our factor with more and more rays; the ray library's scene is built inside the clock."""
    traced_factor(case, LEAST_RAYS[0], SEEDS[0])  # the first also pays for loading libraries
    last = 0
    for least in LEAST_RAYS:
        if least <= last:
            continue  # a mesh of many triangles begins with many rays
        runs = [timed_once(lambda least=least, seed=seed: traced_factor(case, least, seed)) for seed in SEEDS]
        last = runs[0][0][1]
        cost = min((cost for _, cost in runs), key=lambda cost: cost.seconds)
        yield entry(case, OURS, f"{last:,} rays", [factor for (factor, _), _ in runs], cost.as_json(), last)


def traced_factor(case: Case, least_rays: int, seed: int) -> tuple[float, int]:
    """Return the factor by counting the rays of all triangles of the sending mesh, and how many they are.

    The triangles are split until they trace at least so many.
    """
    transport = transport_of(case.scene, rays=RAYS_PER_ROW, seed=seed)
    tree = transport.tree
    mesh_of_triangle = transport.surfaces.mesh_of_triangle
    senders = tree.leaves()[mesh_of_triangle[tree.triangle[tree.leaves()]] == case.sender]
    while len(senders) * RAYS_PER_ROW < least_rays:
        senders = tree.split(senders)
    transport.follow_splits()
    transport.trace(2 * senders)
    shares = transport.shares()
    mesh = mesh_of_triangle[tree.triangle]
    wanted = (shares.source != ESCAPED) & (mesh[shares.source >> 1] == case.receiver)
    total = np.bincount(shares.receiver[wanted], weights=shares.share[wanted], minlength=2 * len(tree))
    area = areas(node_triangles(tree, senders))
    return float((total[2 * senders] * area).sum() / area.sum()), len(senders) * RAYS_PER_ROW


# --------------------------------------------------------------------------------------------------------------- peers


def peer_python() -> str | None:
    """Return a Python that has both programs, or None."""
    if all(importlib.util.find_spec(name) for name in ("raystrack", "pyviewfactor")):
        return sys.executable
    own = ENVIRONMENT / "bin" / "python"
    return str(own) if own.exists() else None


def peers(case: Case, python: str) -> Iterator[dict[str, Any]]:
    """Yield what the two programs find, in a process of their own."""
    with tempfile.TemporaryDirectory() as folder:
        given = Path(folder) / "case.npz"
        np.savez(given, **case_arrays(case))
        script = Path(__file__).with_name("form_factor_programs.py")
        done = subprocess.run([python, str(script), str(given)], check=True, stdout=subprocess.PIPE, text=True)
    for found in json.loads(done.stdout):
        yield entry(case, found["method"], found["setting"], found["factors"], found["cost"], found["work"])


def case_arrays(case: Case) -> dict[str, np.ndarray]:
    """Return the case as the programs' script reads it: corners of triangles, split and whole, and what to run."""
    arrays: dict[str, np.ndarray] = {"rays": np.array(RAYS_OF_RAYSTRACK), "seeds": np.array(SEEDS)}
    roles = {case.sender: "sender", case.receiver: "receiver"}
    for k, mesh in enumerate(case.scene.meshes):
        corners = mesh.vertices[mesh.triangles]
        role = roles.get(k, "obstacle")
        arrays[role] = corners
        if role != "obstacle":
            for level in LEVELS:
                if level:
                    corners = split(corners)
                arrays[f"{role}_{level}"] = corners
    kept = [k for k in LEVELS if len(arrays[f"sender_{k}"]) * len(arrays[f"receiver_{k}"]) <= MOST_PAIRS]
    return {**arrays, "levels": np.array(kept)}


def split(corners: Floats) -> Floats:
    """Return each triangle as four by its edge midpoints: (4 n, 3, 3)."""
    a, b, c = corners.transpose(1, 0, 2)
    ab, bc, ca = (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0
    children = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (bc, ca, ab)]
    return np.concatenate([np.stack(child, axis=1) for child in children])


# ---------------------------------------------------------------------------------------------------------------- all


def measure_all() -> list[dict[str, Any]]:
    """Measure all cases and print them as they come."""
    results: list[dict[str, Any]] = []
    python = peer_python()
    if python is None:
        print("raystrack and pyViewFactor are not installed (python -m tools.environments bench): ours alone")
    print(f"{'case':<40}{'method':<30}{'setting':<26}{'seconds':>9}{'cpu':>8}{'factor':>11}{'error':>11}")
    for case in cases():
        for each in (ours(case), peers(case, python) if python else ()):
            for found in each:
                results.append(found)
                line = f"{case.name:<40}{found['method']:<30}{found['setting']:<26}{found['seconds']:>9.4f}"
                print(f"{line}{found['processor_seconds']:>8.3f}{found['factor']:>11.7f}{found['error']:>11.2e}")
    return results


def write() -> None:
    """Measure, and write `out/form_factors.json`."""
    run = datetime.now(UTC).isoformat(timespec="seconds")
    write_json(OUT / "form_factors.json", {"run": run, "results": measure_all()})


if __name__ == "__main__":
    write()
