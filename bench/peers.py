# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Other programs on the same scenes and probes: Mitsuba 3, Radiance `rtrace -I`, Cycles' bake to vertices.

At the probes: Mitsuba and Radiance compute at the probes themselves, so they have no interpolation error and as many
points as there are probes; both favour them. To vertices: Mitsuba and Cycles compute the vertices of a uniform mesh,
and the probes interpolate it, as they do for us.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from radiosity_bake.core.scene import Floats, Scene

from tools.package import ROOT

from . import reference
from .measure import Judged
from .methods import CYCLES, MITSUBA, MITSUBA_VERTICES, RADIANCE
from .stopwatch import Cost, Instant, timed
from .uniform_mesh import uniform_mesh

BOUNCES = 64

# Points that Mitsuba's kernels are compiled with.
WARM_UP = 64

# Patches of the uniform meshes whose vertices are computed, about: coarse and fine.
COARSE, FINE = 4_000, 16_000

# Samples of all vertices together above which a program is not asked: it would take minutes.
MOST_MITSUBA_SAMPLES = 14_000_000
MOST_CYCLES_SAMPLES = 2_500_000


@dataclass(frozen=True, eq=False)
class Answer:
    """What a program says about the probes, and what it took.

    Attributes
    ----------
    irradiance : (n, 3) float, W m^-2 sr^-1
        Irradiance over pi at the probes.
    cost : Cost
        Of computing, without starting the program where it can be told apart.
    points : int
        Places that were computed: probes, or vertices of a mesh.
    """

    irradiance: Floats
    cost: Cost
    points: int


@dataclass(frozen=True)
class Run:
    """A program at one of its settings, ready to be run."""

    peer: str
    method: str
    setting: str
    answer: Callable[[Judged], Answer]


# ---------------------------------------------------------------------------------------------------------- Mitsuba


def mitsuba(case: Judged, samples: int) -> Answer:
    """Path tracing from each probe, lamps sampled at every bounce; kernels are compiled before the clock runs."""
    p = case.probes
    irradiance, cost = _path_traced(case.scene, p.position, p.normal, p.shading_normal, samples)
    return Answer(irradiance, cost, len(p))


def mitsuba_to_vertices(case: Judged, samples: int, patches: int) -> Answer:
    """The same at the vertices of a uniform mesh, interpolated at the probes: a bake to vertices with Mitsuba."""
    mesh = uniform_mesh(case.name, patches)
    points = np.concatenate([part.inner_vertices for part in mesh.split.values()])
    normals = np.concatenate([part.normals for part in mesh.split.values()])
    irradiance, cost = _path_traced(case.scene, points, normals, normals, samples)
    ends = np.cumsum([len(part.vertices) for part in mesh.split.values()])
    values = dict(zip(mesh.split, np.split(irradiance, ends[:-1]), strict=True))
    return Answer(mesh.at_probes(case, values), cost, mesh.points)


def _path_traced(scene: Scene, points: Floats, normals: Floats, shading: Floats, samples: int) -> tuple[Floats, Cost]:
    def run(count: int) -> reference.Reference:
        return reference.irradiance(
            scene, points[:count], normals[:count], shading[:count], samples=samples, passes=1, seed=1, cache=False
        )

    run(WARM_UP)  # the kernel is the same for any number of points
    found, cost = timed(lambda: run(len(points)))
    return found.irradiance, cost


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

# Without it, each of `rtrace`'s processes makes a cache of its own, and two take as long as one.
AMBIENT_FILE = "ambient"

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

        def run() -> bytes:
            (Path(folder) / AMBIENT_FILE).unlink(missing_ok=True)
            with octree.open("wb") as file:
                command = [str(programs / "bin" / "oconv"), "-w", scene.name]
                subprocess.run(command, cwd=folder, stdout=file, env=environment, check=True)
            command = [str(programs / "bin" / "rtrace"), *radiance_options(effort), octree.name]
            given = rows.tobytes()
            return subprocess.run(
                command, cwd=folder, input=given, stdout=subprocess.PIPE, env=environment, check=True
            ).stdout

        output, cost = timed(run)
    values = np.frombuffer(output, dtype=np.float32).reshape(len(p), 3)
    return Answer(values / np.pi, cost, len(p))


def radiance_options(effort: RadianceEffort) -> list[str]:
    """Return the options of `rtrace`: irradiance, on all cores, with no sample of a light left out."""
    options = ["-I+", "-h", "-w", "-fff", "-n", str(os.cpu_count()), "-af", AMBIENT_FILE]
    options += ["-ab", str(RADIANCE_BOUNCES)]
    options += ["-aa", str(effort.accuracy), "-ad", str(effort.divisions), "-as", str(effort.super_samples)]
    options += ["-ar", str(effort.resolution), "-ds", "0.05", "-dj", "0.7", "-dt", "0", "-dc", "1"]
    return [*options, "-lw", "1e-5"]


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


def cycles(case: Judged, samples: int, patches: int) -> Answer:
    """Bake to the vertices of a uniform mesh, with 64 bounces and no clamping, and interpolate at the probes.

    Runs in a process of its own; the clock is that of `bpy.ops.object.bake` alone.
    """
    mesh = uniform_mesh(case.name, patches)
    with tempfile.TemporaryDirectory() as folder:
        given, answered = Path(folder) / "scene.npz", Path(folder) / "baked.npz"
        arrays: dict[str, np.ndarray] = {"samples": np.array(samples), "bounces": np.array(BOUNCES)}
        arrays["world"] = case.scene.world
        for k, original in enumerate(case.scene.meshes):
            part = mesh.split.get(k)
            vertices, triangles = (part.vertices, part.triangles) if part else (original.vertices, original.triangles)
            parent = part.parent if part else np.arange(len(original.triangles))
            arrays[f"vertices_{k}"], arrays[f"triangles_{k}"] = vertices, triangles
            arrays[f"reflectance_{k}"] = original.reflectance[parent]
            arrays[f"emission_{k}"] = original.emission[parent]
            arrays[f"baked_{k}"] = np.array(part is not None)
            arrays[f"smooth_{k}"] = np.array(part is not None and part.smooth)
        np.savez(given, **arrays)
        script = Path(__file__).with_name("cycles_bake.py")
        command = [sys.executable, str(script), str(given), str(answered)]
        start = Instant.now()
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        whole = start.cost_until(Instant.now())
        with np.load(answered) as found:
            cost = Cost(float(found["seconds"]), float(found["processor_seconds"]), whole.others)
            colours = {k: found[f"irradiance_{k}"] for k in mesh.split}
    return Answer(mesh.at_probes(case, colours), cost, mesh.points)


# ------------------------------------------------------------------------------------------------------------ all runs


def runs_of(case: Judged, wanted: Callable[[str], bool]) -> list[Run]:
    """Return the runs of the peers whose names are wanted: mitsuba, radiance, cycles."""
    runs: list[Run] = []
    if wanted("mitsuba"):
        runs += [
            Run("mitsuba", MITSUBA, f"{n} samples", lambda c, n=n: mitsuba(c, n)) for n in (16, 64, 256, 1024, 4096)
        ]
        runs += runs_to_vertices(
            case,
            "mitsuba",
            MITSUBA_VERTICES,
            mitsuba_to_vertices,
            ((COARSE, 16), (COARSE, 64), (COARSE, 256), (FINE, 256), (FINE, 1024)),
            MOST_MITSUBA_SAMPLES,
        )
    if wanted("radiance"):
        runs += [Run("radiance", RADIANCE, e.name, lambda c, e=e: radiance(c, e)) for e in RADIANCE_EFFORTS]
    if wanted("cycles"):
        runs += runs_to_vertices(
            case,
            "cycles",
            CYCLES,
            cycles,
            ((COARSE, 16), (COARSE, 64), (COARSE, 256), (FINE, 256)),
            MOST_CYCLES_SAMPLES,
        )
    return runs


def runs_to_vertices(
    case: Judged,
    peer: str,
    method: str,
    answer: Callable[[Judged, int, int], Answer],
    settings: Sequence[tuple[int, int]],
    most_samples: int,
) -> list[Run]:
    """Return runs of a program that computes the vertices of uniform meshes, those that would take minutes left out.

    Parameters
    ----------
    answer : callable
        Of the scene, the samples of each vertex and the patches of the mesh.
    settings : sequence of (patches, samples)
    most_samples : int
        Of all vertices together.
    """
    return [
        Run(peer, method, f"{n} samples, about {p} patches", lambda c, n=n, p=p: answer(c, n, p))
        for p, n in settings
        if n * uniform_mesh(case.name, p).points <= most_samples
    ]
