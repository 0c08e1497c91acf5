# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole bake from top to bottom."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import refinement
from .balance import balance_of, check_solved, direct_on_patches, energy, seen_radiance
from .clock import Clock
from .cutting import cut_faces, cut_receivers, find_cuts
from .direct import Emitters, strongest_emitters
from .error_estimate import relative_error
from .errors import NoLightError
from .gather import Gathered, GatherRays, Radiance, corner_values, gather, hidden_receivers
from .output import baked_meshes
from .patches import coarse_patches
from .progress import ProgressCallback, no_progress
from .reachability import lit_sides
from .receivers import Receivers, receivers
from .result import BakeResult
from .scene import Floats, Ints, Scene
from .settings import BakeSettings
from .solve import Solution, solve_balance
from .subdivision import Faces, conforming_faces, input_faces
from .surfaces import Surfaces, join
from .transport import BYTES_PER_RAY, Transport
from .visibility import RayScene


@dataclass(frozen=True)
class Effort:
    """What a quality stands for.

    Attributes
    ----------
    patches : int
        Patches that a uniform subdivision of the scene at the automatic minimum size would have, about.
    rays_per_patch : int
    gather : GatherRays
    """

    patches: int
    rays_per_patch: int
    gather: GatherRays


EFFORTS = {
    "DRAFT": Effort(2_000, 64, GatherRays(64, 16, 32)),
    "GOOD": Effort(16_000, 128, GatherRays(256, 16, 96)),
    "HIGH": Effort(64_000, 256, GatherRays(1024, 32, 384)),
}

WORKING_COPIES = 6
"""Times the traced rays are in memory while they are sorted into form factors: hits, sorted hits, marks and keys."""

RAYS_TO_FIND_CUTS = 64
"""Rays that tell whether a place on an edge is hidden."""

FEWEST_RAYS_PER_PATCH = 16

MOST_RAYS = 2**25
"""Rays of the coarsest patches: above it each gets fewer, as the many patches of a dense mesh average each other out."""


def bake(scene: Scene, settings: BakeSettings, progress: ProgressCallback = no_progress) -> BakeResult:
    """Bake the light of `scene` into the meshes that ask for it.

    Raises
    ------
    BakeError
        One of its kinds, with a sentence that says what to do.
    Cancelled
        When `progress` raised it.
    """
    clock, effort = Clock(progress), EFFORTS[settings.quality]

    clock.start("Preparing", 0.0, 0.02)
    surfaces = join(scene)
    if not (surfaces.emission.any() or surfaces.world.any()):
        raise NoLightError("Nothing in the scene emits light; give a material some Emission, or the World a colour")
    rays = RayScene(surfaces.points, surfaces.triangles, settings.threads)
    lit = lit_sides(surfaces, rays, settings.seed)

    clock.start("Coarse patches", 0.02, 0.03)
    smallest = settings.minimum_size or automatic_size(surfaces, effort)
    tree = coarse_patches(surfaces, smallest)
    most_rays = settings.memory_limit * 2**20 // (BYTES_PER_RAY * WORKING_COPIES)
    per_row = rays_that_fit(effort.rays_per_patch, min(most_rays, MOST_RAYS), len(tree.leaves()))
    transport = Transport(surfaces, tree, rays, lit, per_row, settings.seed)

    clock.start("Form factors", 0.03, 0.4)
    rounds = subdivide(transport, lit, settings, smallest, most_rays // per_row, clock)

    clock.start("Solving", 0.4, 0.5)
    cover = transport.separate_cover(clock.report)
    shares = transport.shares()
    emitters = strongest_emitters(surfaces, lit)
    balance = balance_of(transport, cover, shares)
    direct = direct_on_patches(transport, cover, balance, emitters, clock.report)
    solution = solve_balance(balance.exchange, balance.reflectance, direct, balance.areas)
    check_solved(solution, surfaces)
    traced = rays.rays

    clock.start("Gathering", 0.5, 0.95)
    faces = input_faces(surfaces) if settings.output == "ORIGINAL" else conforming_faces(surfaces, tree)
    face, side = wanted_sides(faces, surfaces, lit)
    places = receivers(surfaces, faces, face, side)
    radiance = seen_radiance(transport, balance, solution, emitters)
    gathered = gather(transport, radiance, emitters, places, effort.gather, clock.report)
    irradiance = corner_values(gathered, places.of_corner)
    error = surface_error(surfaces, faces, face, places, gathered, irradiance)
    if settings.output == "REFINED":
        clock.start("Cutting", 0.95, 0.98)
        faces, face, irradiance = cut_where_hidden(
            transport, radiance, emitters, effort.gather, faces, face, places, gathered, irradiance
        )

    clock.start("Reconstructing", 0.98, 1.0)
    meshes, warnings = baked_meshes(scene, surfaces, faces, face, irradiance, settings.output)
    clock.stop()
    report: dict[str, Any] = {
        "patches": len(tree.leaves()),
        "vertices": sum(len(np.unique(mesh.triangles)) for mesh in meshes),
        "triangles": sum(len(mesh.triangles) for mesh in meshes),
        "rays": rays.rays,
        "rays_by_kind": {"form_factors": traced, "gather": rays.rays - traced},
        "seconds": clock.seconds,
        "seconds_in_ray_library": rays.seconds,
        "iterations": solution.iterations,
        "residual": solution.residual,
        "converged": solution.converged,
        "estimated_error": error,
        "form_factor_standard_error": refinement.largest_standard_error(shares),
        "energy": energy(balance, solution, surfaces),
        "minimum_size": smallest,
        "rounds": rounds.as_report(),
        "ended": rounds.ended,
        "settings": asdict(settings),
        "warnings": [*surfaces.warnings, *warnings, *limit_warnings(rounds, solution, per_row, effort)],
    }
    return BakeResult(meshes, report)


def automatic_size(surfaces: Surfaces, effort: Effort) -> float:
    """The minimum size n at which the baked surfaces, cut uniformly, have about `effort.patches` patches."""
    area = float(surfaces.areas[surfaces.baked].sum())
    # A right isosceles triangle of longest edge s has the area s^2 / 4, and sizes lie between n and 2n.
    return float(np.sqrt(4.0 * area / effort.patches) / np.sqrt(2.0))


def rays_that_fit(wanted: int, most: int, patches: int) -> int:
    """Rays for each patch, halved from `wanted` until all patches together have at most `most`."""
    while wanted > FEWEST_RAYS_PER_PATCH and wanted * patches > most:
        wanted //= 2
    return wanted


def subdivide(
    transport: Transport,
    lit: NDArray[np.bool_],
    settings: BakeSettings,
    smallest: float,
    most_patches: int,
    clock: Clock,
) -> refinement.Refinement:
    """Subdivide by the method asked for; every element that takes part has been traced afterwards."""
    tree, surfaces = transport.tree, transport.surfaces

    def seeds() -> Ints:
        leaves = tree.leaves()
        leaves = leaves[surfaces.baked[tree.triangle[leaves]]]
        behind = leaves[lit[surfaces.shell_of_triangle[tree.triangle[leaves]], 1]]
        return np.sort(np.concatenate([2 * leaves, 2 * behind + 1]))

    def report(share: float) -> None:
        clock.report(share, f"{len(tree.leaves()):,} patches, {transport.rays.rays:,} rays")

    if settings.method == "ADAPTIVE":
        return refinement.refine(transport, seeds, settings.threshold, smallest, most_patches, report)
    return refinement.refine_uniformly(transport, seeds, smallest, most_patches, report)


def wanted_sides(faces: Faces, surfaces: Surfaces, lit: NDArray[np.bool_]) -> tuple[Ints, Ints]:
    """Faces and sides that get values: every front, and the backs that light reaches, both (f,)."""
    count = len(faces.triangle)
    behind = np.flatnonzero(lit[surfaces.shell_of_triangle[faces.triangle], 1])
    face = np.concatenate([np.arange(count), behind])
    return face, np.concatenate([np.zeros(count, dtype=np.int64), np.ones(len(behind), dtype=np.int64)])


def cut_where_hidden(
    transport: Transport,
    radiance: Radiance,
    emitters: Emitters,
    counts: GatherRays,
    faces: Faces,
    face: Ints,
    places: Receivers,
    gathered: Gathered,
    irradiance: Floats,
) -> tuple[Faces, Ints, Floats]:
    """Cut the faces that are hidden in part, where the hidden part begins; returns faces, face sides and values."""
    count = len(faces.triangle)
    cuts = find_cuts(
        faces, places, gathered.hidden, lambda where: hidden_receivers(transport, where, RAYS_TO_FIND_CUTS)
    )
    before, after = (
        gather(transport, radiance, emitters, where, counts, lambda share: None).irradiance
        for where in cut_receivers(faces, places, cuts)
    )
    fronts = gathered.irradiance[places.of_corner[:count]]
    values = np.concatenate([fronts, irradiance[count:]])
    return cut_faces(faces, face, places, gathered.hidden, cuts, values, before, after)


def surface_error(
    surfaces: Surfaces, faces: Faces, face: Ints, places: Receivers, gathered: Gathered, irradiance: Floats
) -> float:
    """Estimated relative RMS error over what was baked, emitters and hidden places left out."""
    counted = ~surfaces.emission[faces.triangle[face]].any(axis=1) & ~gathered.hidden[places.of_corner].all(axis=1)
    corners = faces.points[faces.corners[face]]
    return relative_error(corners, places.of_corner, irradiance, gathered.noise, counted)


def limit_warnings(rounds: refinement.Refinement, solution: Solution, rays_per_patch: int, effort: Effort) -> list[str]:
    """Sentences on limits that the bake ran into."""
    warnings = []
    if rounds.ended == refinement.LIMIT_MET:
        warnings.append("The memory limit ended the subdivision early; raise it or the minimum size for an even result")
    if rays_per_patch < effort.rays_per_patch:
        warnings.append(f"The scene has so many triangles that each patch was given {rays_per_patch} rays only")
    if not solution.converged:
        warnings.append(f"The energy balance was solved to a residual of {solution.residual:.1e} only")
    return warnings
