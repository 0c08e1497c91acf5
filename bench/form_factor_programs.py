# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""raystrack and pyViewFactor on cases, in a process of their own: `python form_factor_programs.py CASE.npz ...`.

A name of one before the cases runs that one alone.
Reads plain arrays (see `bench.form_factors`), prints a line of JSON for each, and imports nothing of ours. What numba
compiles is compiled before the clock runs.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib.metadata import version
from typing import Any

import numpy as np


def timed(run: Callable[[int], float], seeds: Sequence[int]) -> tuple[list[float], dict[str, float]]:
    """Return what `run` returns for each seed and what the shortest run took."""
    values, costs = [], []
    for seed in seeds:
        start, used = time.perf_counter(), sum(os.times()[:2])
        values.append(run(seed))
        seconds = time.perf_counter() - start
        costs.append({"seconds": seconds, "processor_seconds": sum(os.times()[:2]) - used})
    return values, min(costs, key=lambda cost: cost["seconds"])


def areas(corners: np.ndarray) -> np.ndarray:
    """Return the areas of triangles (n, 3, 3)."""
    return 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)


# ----------------------------------------------------------------------------------------------------------- raystrack


def raystrack_runs(arrays: Mapping[str, np.ndarray]) -> Iterator[dict[str, Any]]:
    """Yield raystrack's factor with more and more rays."""
    import raystrack

    meshes = {}
    for role in ("sender", "receiver", "obstacle"):
        if role in arrays:
            vertices, index = np.unique(arrays[role].reshape(-1, 3), axis=0, return_inverse=True)
            meshes[role] = raystrack.Mesh(vertices.astype(np.float32), index.reshape(-1, 3).astype(np.int32))

    def solve(rays: int, seed: int) -> float:
        query = raystrack.Query.row("sender")
        accuracy = raystrack.Accuracy(max_replicates=10**9, tolerance=0.0)
        options = raystrack.SolveOptions(sampling=raystrack.Sampling(seed=seed), accuracy=accuracy)
        with raystrack.Solver(raystrack.Scene.from_meshes(meshes), device="cpu") as solver:
            result = solver.solve(query, options, raystrack.Budget(rays=rays))
        sides = (raystrack.Channel("surface", "receiver", side) for side in ("front", "back"))
        return float(sum(result.value("sender", side) or 0.0 for side in sides))

    seeds = arrays["seeds"].tolist()
    solve(int(arrays["rays"][0]), seeds[0])
    for rays in arrays["rays"].tolist():
        factors, cost = timed(lambda seed, rays=rays: solve(rays, seed), seeds)
        name = f"raystrack {version('raystrack')}"
        yield {"method": name, "setting": f"{rays:,} rays", "factors": factors, "cost": cost, "work": rays}


# --------------------------------------------------------------------------------------------------------- pyViewFactor


def pyviewfactor_runs(arrays: Mapping[str, np.ndarray]) -> Iterator[dict[str, Any]]:
    """Yield pyViewFactor's factor with smaller and smaller triangles."""
    import pyviewfactor
    import pyvista

    def polygons(corners: np.ndarray) -> Any:
        count = len(corners)
        faces = np.column_stack([np.full(count, 3), np.arange(3 * count).reshape(-1, 3)])
        return pyvista.PolyData(corners.reshape(-1, 3), faces.ravel())

    obstacles = [polygons(arrays["obstacle"])] if "obstacle" in arrays else None

    def solve(level: int) -> float:
        sender, receiver = arrays[f"sender_{level}"], arrays[f"receiver_{level}"]
        matrix = pyviewfactor.compute_viewfactor_matrix(
            polygons(np.concatenate([sender, receiver])), obstacles=obstacles, skip_obstruction=obstacles is None
        )
        # Its rows receive: F[i, j] is the factor from j to i.
        share = matrix[len(sender) :, : len(sender)].sum(axis=0)
        area = areas(sender)
        return float((share * area).sum() / area.sum())

    for level in arrays["levels"][:2].tolist():
        solve(level)
    for level in arrays["levels"].tolist():
        # Nothing is drawn by chance here; the same three runs only find the shortest time.
        factors, cost = timed(lambda _, level=level: solve(level), range(3))
        count = len(arrays[f"sender_{level}"]) + len(arrays[f"receiver_{level}"])
        yield {
            "method": f"pyViewFactor {version('pyviewfactor')}",
            "setting": f"{count:,} triangles",
            "factors": factors,
            "cost": cost,
            "work": count * (count - 1) // 2,
        }


PROGRAMS = {"raystrack": raystrack_runs, "pyViewFactor": pyviewfactor_runs}


def main(given: str, names: Sequence[str]) -> None:
    """Run programs on the case of a file, and print what they find."""
    with np.load(given) as file:
        arrays = dict(file)
    # What they print is not ours to read.
    with contextlib.redirect_stdout(io.StringIO()):
        found = [entry for name in names for entry in PROGRAMS[name](arrays)]
    print(json.dumps(found), flush=True)


if __name__ == "__main__":
    wanted = [name for name in sys.argv[1:] if name in PROGRAMS] or list(PROGRAMS)
    for path in sys.argv[1:]:
        if path not in PROGRAMS:
            main(path, wanted)
