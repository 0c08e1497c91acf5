# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The converged reference: irradiance at points by `path_tracer`, in parts that are kept on disk.

Agreement with exact answers: `python -m bench.agreement` prints it.
"""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from radiosity_bake.core.scene import Floats, Scene

from tools.package import ROOT

from .path_tracer import trace

CACHE = ROOT / ".cache" / "reference"

# Part of the cache's key: to be raised whenever `path_tracer` changes its numbers.
METHOD = 3

# Paths for each point in one piece of a reference: minutes, so that little is lost when it is stopped.
SAMPLES_OF_A_PART = 16384

# Times the mean above which a point is traced longer.
BRIGHT = 10.0


@dataclass(frozen=True, eq=False)
class Reference:
    """Irradiance over pi at points, and how sure it is.

    Attributes
    ----------
    irradiance : (n, 3) float, W m^-2 sr^-1
        Irradiance over pi, linear RGB.
    standard_error : (n, 3) float
        One sigma of `irradiance`, from the spread of independent passes.
    samples : int
        Paths for each point.
    seconds : float
        What it took when it was computed, scene setup included.
    """

    irradiance: Floats
    standard_error: Floats
    samples: int
    seconds: float

    @property
    def noise(self) -> float:
        """Standard error, root mean square over points and channels, relative to the mean."""
        return float(np.sqrt((self.standard_error**2).mean()) / self.irradiance.mean())


def irradiance(
    scene: Scene,
    points: Floats,
    normals: Floats,
    shading_normals: Floats | None = None,
    *,
    samples: int = SAMPLES_OF_A_PART,
    passes: int = 16,
    seed: int = 0,
    cache: bool = True,
) -> Reference:
    """Return the irradiance over pi at points of surfaces.

    Parameters
    ----------
    points, normals : (n, 3) float
        Where, in scene units, and the side: the geometric normal there.
    shading_normals : (n, 3) float or None
        Normals that the cosine is taken to; None takes `normals`.
    samples : int
        Paths for each point, over all passes.
    passes : int
        Independent repetitions, at least 2; the standard error has a relative uncertainty of 1/sqrt(2 (passes - 1)).
    """
    shading = normals if shading_normals is None else shading_normals
    path = CACHE / f"{digest(scene, points, normals, shading, samples, passes, seed)}.npz"
    if cache and path.exists():
        with np.load(path) as stored:
            return Reference(stored["irradiance"], stored["standard_error"], samples, float(stored["seconds"]))
    start = time.perf_counter()
    means = trace(scene, points, normals, shading, max(1, samples // passes), passes, seed)
    mean = means.mean(axis=0)
    error = means.std(axis=0, ddof=1) / np.sqrt(passes) if passes > 1 else np.full_like(mean, np.nan)
    result = Reference(mean, error, samples, time.perf_counter() - start)
    if cache:
        CACHE.mkdir(parents=True, exist_ok=True)
        temporary = path.with_suffix(f".{os.getpid()}.npz")
        np.savez(temporary, irradiance=mean, standard_error=error, seconds=result.seconds)
        temporary.replace(path)
    return result


def converged(
    scene: Scene, points: Floats, normals: Floats, shading_normals: Floats, parts: int = 1, bright_parts: int = 0
) -> Reference:
    """Return the mean of independent references, each cached by itself, so that what was begun can be continued.

    Parameters
    ----------
    parts : int
        Times `SAMPLES_OF_A_PART` paths for each point.
    bright_parts : int
        The same for points of more than `BRIGHT` times the mean, whose noise would be that of the whole: the ceiling a
        tenth of a millimetre above a lamp. They are chosen by the first part's mean, which their noise hardly moves.
    """
    found = combined(
        [irradiance(scene, points, normals, shading_normals, seed=k) for k in range(parts)],
    )
    luminance = found.irradiance.mean(axis=1)
    bright = np.flatnonzero(luminance > BRIGHT * luminance.mean())
    if not bright_parts or len(bright) == 0:
        return found
    more = irradiance(
        scene,
        points[bright],
        normals[bright],
        shading_normals[bright],
        samples=bright_parts * SAMPLES_OF_A_PART,
        seed=parts,
    )
    found.irradiance[bright], found.standard_error[bright] = more.irradiance, more.standard_error
    return Reference(found.irradiance, found.standard_error, found.samples, found.seconds + more.seconds)


def combined(parts: Sequence[Reference]) -> Reference:
    """Return the mean of independent references of equally many samples."""
    mean = np.mean([part.irradiance for part in parts], axis=0)
    error = np.sqrt(np.sum([part.standard_error**2 for part in parts], axis=0)) / len(parts)
    return Reference(mean, error, sum(part.samples for part in parts), sum(part.seconds for part in parts))


def digest(scene: Scene, *parts: object) -> str:
    """Return a name for everything that the reference depends on."""
    h = hashlib.sha256(f"method {METHOD}".encode())
    arrays: list[Any] = [scene.world]
    for mesh in scene.meshes:
        arrays += [mesh.vertices, mesh.triangles, mesh.reflectance, mesh.emission]
    for part in (*arrays, *parts):
        a = np.ascontiguousarray(part)
        h.update(f"{a.dtype} {a.shape}".encode())
        h.update(a.tobytes())
    return h.hexdigest()[:24]
