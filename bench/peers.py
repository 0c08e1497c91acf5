# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Other programs on the same scenes and probes: Mitsuba 3, Radiance `rtrace -I`, Cycles' bake to vertices.

Mitsuba and Radiance compute at the probes themselves, so they have no interpolation error and as many points as there
are probes; both favour them. Cycles bakes the vertices of a uniform subdivision, and the probes interpolate it, as they
do for us.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from radiosity_bake.core.bake import bake
from radiosity_bake.core.result import BakedMesh, BakeResult
from radiosity_bake.core.scene import Floats, Ints, Scene
from radiosity_bake.core.settings import BakeSettings

from tools.package import ROOT

from . import reference
from .accuracy import irradiance_at_probes
from .measure import Judged

BOUNCES = 64


@dataclass(frozen=True, eq=False)
class Answer:
    """What a program says about the probes, and what it took.

    Attributes
    ----------
    irradiance : (n, 3) float, W m^-2 sr^-1
        Irradiance over pi at the probes.
    seconds : float
        Wall clock of computing, without starting the program where it can be told apart.
    points : int
        Places that were computed: probes, or vertices of a mesh.
    """

    irradiance: Floats
    seconds: float
    points: int


# ---------------------------------------------------------------------------------------------------------- Mitsuba


def mitsuba(case: Judged, samples: int) -> Answer:
    """Path tracing from each probe, lamps sampled at every bounce; kernels are compiled before the clock runs."""
    p = case.probes

    def run() -> reference.Reference:
        return reference.irradiance(
            case.scene, p.position, p.normal, p.shading_normal, samples=samples, passes=1, seed=1, cache=False
        )

    run()
    found = run()
    return Answer(found.irradiance, found.seconds, len(p))


# --------------------------------------------------------------------------------------------------------- Radiance


@dataclass(frozen=True)
class RadianceEffort:
    """Options of `rtrace` that trade time for accuracy: ambient accuracy, divisions, super-samples, resolution."""

    name: str
    accuracy: float
    divisions: int
    super_samples: int
    resolution: int


RADIANCE_EFFORTS = (
    RadianceEffort("low", 0.3, 64, 16, 32),
    RadianceEffort("medium", 0.2, 128, 32, 64),
    RadianceEffort("high", 0.15, 512, 128, 128),
)

# Ambient bounces: each costs a level of the cache, and 0.7^8 is 6%, of which little is left where light is even.
RADIANCE_BOUNCES = 8


def radiance(case: Judged, effort: RadianceEffort) -> Answer:
    """Irradiance at each probe with Radiance's ambient cache; `oconv` is inside the clock.

    Its `light` material reflects nothing, so what a lamp reflects is missing (1% in the Cornell box).
    """
    import pyradiance

    programs = Path(pyradiance.__file__).parent
    environment = {**os.environ, "RAYPATH": str(programs / "lib")}
    p = case.probes
    offset = 1e-5 * float(np.ptp(p.position, axis=0).max())
    rows = np.concatenate([p.position + offset * p.normal, p.shading_normal], axis=1).astype(np.float32)
    with tempfile.TemporaryDirectory() as folder:
        scene, octree = Path(folder) / "scene.rad", Path(folder) / "scene.oct"
        scene.write_text(radiance_scene(case.scene))
        start = time.perf_counter()
        with octree.open("wb") as file:
            subprocess.run(
                [str(programs / "bin" / "oconv"), "-w", scene.name],
                cwd=folder,
                stdout=file,
                env=environment,
                check=True,
            )
        command = [
            str(programs / "bin" / "rtrace"),
            "-I+",
            "-h",
            "-w",
            "-fff",
            "-n",
            str(os.cpu_count()),
            "-ab",
            str(RADIANCE_BOUNCES),
        ]
        command += ["-aa", str(effort.accuracy), "-ad", str(effort.divisions), "-as", str(effort.super_samples)]
        command += ["-ar", str(effort.resolution), "-ds", "0.05", "-dj", "0.7", "-dt", "0", "-dc", "1", "-lw", "1e-5"]
        done = subprocess.run(
            [*command, octree.name],
            cwd=folder,
            input=rows.tobytes(),
            stdout=subprocess.PIPE,
            env=environment,
            check=True,
        )
        seconds = time.perf_counter() - start
    values = np.frombuffer(done.stdout, dtype=np.float32).reshape(len(p), 3)
    return Answer(values / np.pi, seconds, len(p))


def radiance_scene(scene: Scene) -> str:
    """Return the scene in Radiance's language: a material for each colour, a polygon for each triangle."""
    lines: list[str] = []
    names: dict[tuple[float, ...], str] = {}
    count = 0
    for mesh in scene.meshes:
        for triangle, rho, light in zip(mesh.triangles, mesh.reflectance, mesh.emission, strict=True):
            key = (*rho, *light)
            if key not in names:
                names[key] = f"material_{len(names)}"
                lines.append(_radiance_material(names[key], rho, light))
            corners = " ".join(f"{x:.9g}" for x in mesh.vertices[triangle].ravel())
            lines.append(f"{names[key]} polygon p{count}\n0\n0\n9 {corners}\n")
            count += 1
    if np.any(scene.world > 0.0):
        r, g, b = scene.world
        lines.append(f"void glow sky\n0\n0\n4 {r} {g} {b} 0\nsky source everywhere\n0\n0\n4 0 0 1 360\n")
    return "\n".join(lines)


def _radiance_material(name: str, rho: Floats, light: Floats) -> str:
    if np.any(light > 0.0):
        return f"void light {name}\n0\n0\n3 {light[0]} {light[1]} {light[2]}\n"
    return f"void plastic {name}\n0\n0\n5 {rho[0]} {rho[1]} {rho[2]} 0 0\n"


# ----------------------------------------------------------------------------------------------------------- Cycles


def cycles(case: Judged, samples: int, minimum_size: float) -> Answer:
    """Bake to the vertices of our uniform subdivision, with 64 bounces and no clamping, and interpolate at the probes.

    Runs in a process of its own; the clock is that of `bpy.ops.object.bake` alone. Vertices are split where normals
    differ, as a vertex on a hard edge would be of one side only.
    """
    mesh_of, split = subdivided(case.scene, minimum_size)
    with tempfile.TemporaryDirectory() as folder:
        given, answered = Path(folder) / "scene.npz", Path(folder) / "baked.npz"
        arrays: dict[str, np.ndarray] = {"samples": np.array(samples), "bounces": np.array(BOUNCES)}
        arrays["world"] = case.scene.world
        for k, mesh in enumerate(case.scene.meshes):
            part = split.get(k)
            vertices, triangles = (part.vertices, part.triangles) if part else (mesh.vertices, mesh.triangles)
            parent = part.parent if part else np.arange(len(mesh.triangles))
            arrays[f"vertices_{k}"], arrays[f"triangles_{k}"] = vertices, triangles
            arrays[f"reflectance_{k}"], arrays[f"emission_{k}"] = mesh.reflectance[parent], mesh.emission[parent]
            arrays[f"baked_{k}"] = np.array(part is not None)
            arrays[f"smooth_{k}"] = np.array(part is not None and part.smooth)
        np.savez(given, **arrays)
        script = Path(__file__).with_name("cycles_bake.py")
        subprocess.run(
            [sys.executable, str(script), str(given), str(answered)], cwd=ROOT, check=True, stdout=subprocess.DEVNULL
        )
        with np.load(answered) as found:
            seconds = float(found["seconds"])
            colours = {k: found[f"irradiance_{k}"] for k in split}
    meshes = tuple(_with_irradiance(mesh_of[k], colours[k][split[k].triangles]) for k in split)
    values = irradiance_at_probes(BakeResult(meshes, {}), case.probes)
    return Answer(values, seconds, sum(len(part.vertices) for part in split.values()))


@dataclass(frozen=True, eq=False)
class SplitMesh:
    """A baked mesh's triangles with a vertex for each pair of place and normal."""

    vertices: Floats
    triangles: Ints
    parent: Ints
    smooth: bool


def subdivided(scene: Scene, minimum_size: float) -> tuple[dict[int, BakedMesh], dict[int, SplitMesh]]:
    """Return our uniform subdivision of each baked mesh, as we store it and with split vertices, by mesh index."""
    settings = BakeSettings(method="UNIFORM", minimum_size=minimum_size, quality="DRAFT")
    baked, split = {}, {}
    for mesh in bake(scene, settings).meshes:
        original = scene.meshes[mesh.mesh]
        if np.all(np.any(original.emission > 0.0, axis=1)):
            continue
        corners = mesh.triangles.ravel()
        key = np.column_stack([corners, np.round(mesh.corner_normals.reshape(-1, 3) * 1e3)])
        _, first, index = np.unique(key, axis=0, return_index=True, return_inverse=True)
        flat = np.allclose(mesh.corner_normals, mesh.corner_normals[:, :1], atol=1e-6)
        triangles = index.reshape(-1, 3)
        baked[mesh.mesh] = mesh
        split[mesh.mesh] = SplitMesh(mesh.vertices[corners[first]], triangles, mesh.parent_triangle, not flat)
    return baked, split


def _with_irradiance(mesh: BakedMesh, irradiance: Floats) -> BakedMesh:
    return BakedMesh(
        mesh.mesh,
        mesh.vertices,
        mesh.triangles,
        mesh.parent_triangle,
        mesh.barycentric,
        mesh.corner_normals,
        irradiance,
        irradiance,
    )
