# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Irradiance at points by Mitsuba 3's path tracer, which shares nothing with `core`.

At each point the first ray is cosine distributed about the shading normal (rays below the geometric surface count
nothing, as in Cycles); what it brings comes from Mitsuba's own `path` integrator without a limit of depth. Light that a
first ray meets at once is combined with a ray to a sampled emitter by the balance heuristic (Veach 1995), so that small
lamps do not make noise. First rays are a Kronecker sequence, shifted at random for each point and pass; the spread of
the passes gives the standard error.
"""

from __future__ import annotations

import ctypes.util
import os
import re
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from radiosity_bake.core.scene import Floats, Scene

from .backs import back_can_be_seen

# Mitsuba moves the origin of a ray by 9e-5 (1 + |p|): at an extent of 1000 units the 1 is negligible, and the shift
# stays at 5e-5 of the scene, under the narrowest gap of our scenes (the Cornell lamp's, 2e-4).
EXTENT = 1000.0

# A first ray starts this far above its point: 170 times the rounding of float32 at the scene's border.
ORIGIN_OFFSET = 1e-5 * EXTENT

# The back of an emitter is a second emitter this far behind it (Mitsuba's emit on one side only).
BACK_OFFSET = 2e-6 * EXTENT

# Paths in flight at once: about 1 GB.
RAYS_AT_ONCE = 1 << 22

# Fractional parts of the powers of the root of x^6 = x + 1 (Roberts 2018, the R_5 sequence), as 32-bit fractions.
KRONECKER = np.floor(2.0**32 * (1.1347241384015194 ** -np.arange(1.0, 6.0))).astype(np.uint32)


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
