# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The converged reference: irradiance at points by Mitsuba 3's path tracer, which shares nothing with `core`.

At each point the first ray is cosine distributed about the shading normal (rays below the geometric surface count
nothing, as in Cycles); what it brings comes from Mitsuba's own `path` integrator without a limit of depth. Light that a
first ray meets at once is combined with a ray to a sampled emitter by the balance heuristic (Veach 1995), so that small
lamps do not make noise. First rays are a Kronecker sequence, shifted at random for each point and pass; the spread of
the passes gives the standard error.

Agreement with exact answers: `python -m bench.reference` prints it.
"""

from __future__ import annotations

import ctypes.util
import hashlib
import os
import re
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from radiosity_bake.core.scene import Floats, Scene, SurfaceMesh

from tools.package import ROOT

CACHE = ROOT / ".cache" / "reference"

# Part of the cache's key: to be raised whenever the method below changes its numbers.
METHOD = 3

# Mitsuba moves the origin of a ray by 9e-5 (1 + |p|): at an extent of 1000 units the 1 is negligible, and the shift
# stays at 5e-5 of the scene, under the narrowest gap of our scenes (the Cornell lamp's, 2e-4).
EXTENT = 1000.0

# A first ray starts this far above its point: 170 times the rounding of float32 at the scene's border.
ORIGIN_OFFSET = 1e-5 * EXTENT

# The back of an emitter is a second emitter this far behind it (Mitsuba's emit on one side only).
BACK_OFFSET = 2e-6 * EXTENT

# Paths for each point in one piece of a reference: minutes, so that little is lost when it is stopped.
SAMPLES_OF_A_PART = 16384

# Times the mean above which a point is traced longer.
BRIGHT = 10.0

# Paths in flight at once: about 1 GB.
RAYS_AT_ONCE = 1 << 22

# Fractional parts of the powers of the root of x^6 = x + 1 (Roberts 2018, the R_5 sequence), as 32-bit fractions.
KRONECKER = np.floor(2.0**32 * (1.1347241384015194 ** -np.arange(1.0, 6.0))).astype(np.uint32)


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


def load_mitsuba(variant: str = "llvm_ad_rgb") -> ModuleType:
    """Return Mitsuba 3 set to an LLVM variant, having told it where the system keeps LLVM."""
    if "DRJIT_LIBLLVM_PATH" not in os.environ:
        library = find_llvm()
        if library is not None:
            os.environ["DRJIT_LIBLLVM_PATH"] = library
    import mitsuba

    if mitsuba.variant() != variant:
        mitsuba.set_variant(variant)
    return mitsuba


def find_llvm() -> str | None:
    """Return the newest LLVM library that the system has where distributions put it, or None."""
    places = ("usr/lib/*/libLLVM*.so*", "usr/lib/llvm-*/lib/libLLVM*.so*", "usr/lib64/libLLVM*.so*")
    places += ("opt/homebrew/opt/llvm*/lib/libLLVM*.dylib", "usr/local/opt/llvm*/lib/libLLVM*.dylib")

    def version(path: str) -> tuple[int, ...]:
        return tuple(int(n) for n in re.findall(r"\d+", Path(path).resolve().name))

    found = [str(path) for place in places for path in Path("/").glob(place) if version(str(path))]
    return max(found, key=version) if found else ctypes.util.find_library("LLVM")


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


def trace(
    scene: Scene, points: Floats, normals: Floats, shading: Floats, samples: int, passes: int, seed: int
) -> Floats:
    """Return the mean of `samples` paths at each point in each of `passes` independent passes: (passes, n, 3)."""
    tracer = Tracer(scene)
    rng = np.random.default_rng(seed)
    means = np.zeros((passes, len(points), 3))
    # Equal batches, so that Mitsuba compiles its kernel once: the last one is filled with points that are thrown away.
    batch = max(1, min(len(points), RAYS_AT_ONCE // samples))
    for k in range(passes):
        shift = rng.integers(0, 1 << 32, size=(len(points), 5), dtype=np.uint32)
        for first in range(0, len(points), batch):
            rows = np.minimum(np.arange(first, first + batch), len(points) - 1)
            values = tracer.gather(
                points[rows], normals[rows], shading[rows], shift[rows], samples, int(rng.integers(1 << 31))
            )
            means[k, rows] = values
    return means


class Tracer:
    """A scene inside Mitsuba, centred and scaled to `EXTENT`."""

    def __init__(self, scene: Scene, rr_depth: int = 6) -> None:
        """Build Mitsuba's scene; paths meet Russian roulette from `rr_depth` on, which leaves no bias."""
        self.mi = load_mitsuba()
        everything = np.concatenate([mesh.vertices for mesh in scene.meshes])
        low, high = everything.min(axis=0), everything.max(axis=0)
        self.centre = 0.5 * (low + high)
        self.scale = EXTENT / float((high - low).max())
        self.scene = self.mi.load_dict(self._description(scene))
        self.integrator = self.mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": rr_depth})
        self.has_emitter = len(self.scene.emitters()) > 0

    def _description(self, scene: Scene) -> dict[str, Any]:
        """Return the scene as Mitsuba wants it: one shape for all triangles of one material."""
        description: dict[str, Any] = {"type": "scene"}
        for k, (corners, reflectance, emission) in enumerate(self._materials(scene)):
            description[f"shape_{k}"] = self._shape(f"shape_{k}", corners, reflectance, emission)
        if np.any(scene.world > 0.0):
            description["world"] = {"type": "constant", "radiance": self._rgb(scene.world)}
        return description

    def _materials(self, scene: Scene) -> list[tuple[Floats, Floats, Floats]]:
        """Return corners (t, 3, 3), reflectance and emission for each material, backs of emitters included."""
        corners, colours = [], []
        for index, mesh in enumerate(scene.meshes):
            placed = ((mesh.vertices - self.centre) * self.scale)[mesh.triangles]
            double_area = np.cross(placed[:, 1] - placed[:, 0], placed[:, 2] - placed[:, 0])
            length = np.linalg.norm(double_area, axis=1)
            colour = np.concatenate([mesh.reflectance, mesh.emission], axis=1)
            keep = length > 0.0
            corners.append(placed[keep])
            colours.append(colour[keep])
            back = keep & np.any(mesh.emission > 0.0, axis=1)
            if np.any(back) and back_can_be_seen(scene, index):
                normal = double_area[back] / length[back, None]
                corners.append(placed[back][:, ::-1] - BACK_OFFSET * normal[:, None, :])
                colours.append(colour[back])
        materials, of_triangle = np.unique(np.concatenate(colours), axis=0, return_inverse=True)
        every = np.concatenate(corners)
        of_triangle = of_triangle.ravel()
        return [(every[of_triangle == k], m[:3], m[3:]) for k, m in enumerate(materials)]

    def _rgb(self, colour: Floats) -> dict[str, Any]:
        return {"type": "rgb", "value": [float(c) for c in colour]}

    def _shape(self, name: str, corners: Floats, reflectance: Floats, emission: Floats) -> Any:
        """Return a flat-shaded, two-sided, diffuse Mitsuba mesh, perhaps an emitter."""
        bsdf = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": self._rgb(reflectance)}}
        properties = self.mi.Properties()
        properties["bsdf"] = self.mi.load_dict(bsdf)
        if np.any(emission > 0.0):
            # Radiance, not reflectance: `rgb` inside an emitter is unbounded.
            properties["emitter"] = self.mi.load_dict({"type": "area", "radiance": self._rgb(emission)})
        mesh = self.mi.Mesh(name, 3 * len(corners), len(corners), props=properties, has_vertex_normals=False)
        parameters = self.mi.traverse(mesh)
        parameters["vertex_positions"] = corners.astype(np.float32).ravel()
        parameters["faces"] = np.arange(3 * len(corners), dtype=np.uint32)
        parameters.update()
        return mesh

    def gather(
        self, points: Floats, normals: Floats, shading: Floats, shift: np.ndarray, samples: int, seed: int
    ) -> Floats:
        """Return the mean of what `samples` paths bring to each point: (n, 3) float, irradiance over pi.

        Parameters
        ----------
        shift : (n, 5) uint32
            Where each point's sequence starts: 2 numbers for the direction, 3 for the emitter sample.
        """
        import drjit as dr

        mi = self.mi
        count = len(points)
        index = dr.arange(mi.UInt32, count * samples)
        point, sample = index // samples, index % samples

        def take(array: Floats) -> Any:
            return dr.gather(mi.Point3f, mi.Point3f(array.T.astype(np.float32)), point)

        geometric = mi.Normal3f(take(normals))
        frame = mi.Frame3f(mi.Normal3f(take(shading)))
        origin = take((points - self.centre) * self.scale) + ORIGIN_OFFSET * geometric
        u = [
            mi.Float((sample * int(KRONECKER[d]) + dr.gather(mi.UInt32, mi.UInt32(shift[:, d]), point)) >> 8) * 2.0**-24
            for d in range(5)
        ]
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed, count * samples)

        radiance = self._hemisphere(origin, geometric, frame, u, sampler)
        if self.has_emitter:
            radiance += self._emitters(origin, geometric, frame, u)
        values = np.array(radiance).T if np.array(radiance).shape[0] == 3 else np.array(radiance)
        return values.reshape(count, samples, 3).mean(axis=1, dtype=np.float64)

    def _hemisphere(self, origin: Any, geometric: Any, frame: Any, u: list[Any], sampler: Any) -> Any:
        """Return what cosine-distributed rays bring: indirect light, and direct light by its share of the heuristic."""
        import drjit as dr

        mi = self.mi
        local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u[0], u[1]))
        direction = frame.to_world(local)
        active = dr.dot(direction, geometric) > 0.0
        ray = mi.RayDifferential3f(mi.Ray3f(origin, direction))
        total = self.integrator.sample(self.scene, sampler, ray, active=active)[0]
        if not self.has_emitter:
            return dr.select(active, total, 0.0)
        hit = self.scene.ray_intersect(mi.Ray3f(origin, direction), active)
        emitter = hit.emitter(self.scene)
        direct = emitter.eval(hit, active)
        reference = dr.zeros(mi.Interaction3f, dr.width(origin))
        reference.p = origin
        found = mi.DirectionSample3f(self.scene, hit, reference)
        other = self.scene.pdf_emitter_direction(reference, found, active)
        own = mi.warp.square_to_cosine_hemisphere_pdf(local)
        weight = dr.select(own > 0.0, own / (own + other), 0.0)
        return dr.select(active, total + (weight - 1.0) * direct, 0.0)

    def _emitters(self, origin: Any, geometric: Any, frame: Any, u: list[Any]) -> Any:
        """Return what one ray to a sampled emitter brings, by its share of the heuristic."""
        import drjit as dr

        mi = self.mi
        reference = dr.zeros(mi.Interaction3f, dr.width(origin))
        reference.p = origin
        # The emitter and the point on it share Mitsuba's two numbers; ours keep the choice of emitter separate.
        emitters = len(self.scene.emitters())
        chosen = dr.minimum(mi.UInt32(u[2] * emitters), emitters - 1)
        first = (mi.Float(chosen) + dr.clip(u[3], 0.0, 1.0 - 2.0**-12)) / emitters
        sample, value = self.scene.sample_emitter_direction(reference, mi.Point2f(first, u[4]), True, True)
        cosine = dr.dot(sample.d, frame.n)
        active = (sample.pdf > 0.0) & (cosine > 0.0) & (dr.dot(sample.d, geometric) > 0.0)
        own = cosine * dr.inv_pi
        weight = sample.pdf / (sample.pdf + own)
        return dr.select(active, value * own * weight, 0.0)


def back_can_be_seen(scene: Scene, index: int) -> bool:
    """Return whether light from the back of an emitting mesh could reach anything else.

    Not for a closed mesh with its front outward that has nothing within its bounds (a lamp), nor for one with its front
    inward that holds everything (a room), nor for a flat one that has nothing behind its planes (a panel in a ceiling);
    `True` where in doubt.
    """
    mesh = scene.meshes[index]
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    others = [m for k, m in enumerate(scene.meshes) if k != index]
    if is_closed(mesh.triangles):
        if not is_outward(mesh):
            return any(np.any((m.vertices < low) | (m.vertices > high)) for m in others)
        # Boxes of triangles, so that a large one that passes through is not missed.
        boxes = [m.vertices[m.triangles] for m in others]
        return any(
            bool(np.any(np.all((t.min(axis=1) < high) & (t.max(axis=1) > low), axis=1))) for t in boxes if len(t)
        )
    corners = mesh.vertices[mesh.triangles[np.any(mesh.emission > 0.0, axis=1)]]
    if len(corners) > 16:
        return True
    everything = np.concatenate([m.vertices for m in scene.meshes])
    slack = 1e-6 * float(np.ptp(everything, axis=0).max())
    for a, b, c in corners:
        normal = np.cross(b - a, c - a)
        length = np.linalg.norm(normal)
        if length > 0.0 and np.any((everything - a) @ normal < -slack * length):
            return True
    return False


def is_outward(mesh: SurfaceMesh) -> bool:
    """Return whether a closed mesh encloses a positive volume."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] - mesh.vertices.mean(axis=0) for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) > 0.0


def is_closed(triangles: np.ndarray) -> bool:
    """Return whether every edge is used once in each direction."""
    edges = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    forward, counts = np.unique(edges, axis=0, return_counts=True)
    backward = np.unique(edges[:, ::-1], axis=0)
    return bool(np.all(counts == 1)) and len(forward) == len(backward) and bool(np.array_equal(forward, backward))


# ---------------------------------------------------------------------------------------------- agreement with truth


def agreement() -> list[tuple[str, float, float, float]]:
    """Return (case, mean of reference / truth - 1, its standard error, chi-square of a point) for exact cases.

    For the squares also by how much the mean of the exact values at the probes misses the form factor: the probes' own
    error as a rule of integration.
    """
    from tests.scenes import exact, oracle

    from .probes import area_uniform_probes

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
    from dataclasses import replace

    from .probes import area_uniform_probes

    dark = Scene(tuple(replace(m, emission=np.zeros_like(m.emission)) for m in scene.meshes), scene.world)
    probes = area_uniform_probes(dark, count)
    return probes.position, probes.normal


if __name__ == "__main__":
    print(f"{'case':<26}{'bias':>11}{'+-':>11}{'chi^2':>9}")
    for name, bias, sigma, chi in agreement():
        print(f"{name:<26}{bias:>11.5%}{sigma:>11.5%}{chi:>9.2f}")
