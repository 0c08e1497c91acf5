# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole bake from top to bottom."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import refinement
from .balance import balance_of, direct_on_patches
from .bright_places import BrightPlaces, bright_places
from .cells import Cells, Radiance
from .checks import check_places, receivers_of_checks
from .clock import Clock
from .coarse_patches import clustered_patches, coarse_count
from .crossings import find_crossings
from .cut_edges import CutEdges, edges_to_outlines, edges_under_walls, find_cuts
from .cutting import cut_receivers
from .dense_meshes import gather_sparsely
from .detail import FaceSizes, GatherAt, counted_share_of_triangles, light_up_in_detail, wanted_sides
from .diagonals import turned_diagonals
from .direct import all_emitters
from .divisions import Divisions, blocked_edges
from .gather import (
    Gathered,
    GatherRays,
    Mixture,
    enough_rays,
    gather,
    gather_indirect,
    hidden_receivers,
    rough_rays,
    with_direct,
)
from .interpolation import PlacesOnFaces, receivers_of_nodes
from .kept_rays import KeptRays
from .lighting import (
    Story,
    TracedCuts,
    TracedPatches,
    check_light,
    cut_light,
    light_of_patches,
    looked_again,
    result_of,
)
from .lit import Lit
from .memory import BYTES_PER_TRIANGLE, WITHIN, Memory
from .met_places import bytes_of_tables
from .patches import PatchTree
from .progress import ProgressCallback, no_progress
from .reachability import lit_sides
from .receivers import Receivers, receivers
from .relight import KeptTransport, keep, parts_of, shapes_of
from .result import BakeResult
from .rows import COVER_GAP
from .scene import Floats, Ints, Scene
from .settings import LARGEST, BakeSettings
from .subdivision import Faces, input_faces
from .surfaces import Surfaces, join
from .surroundings import at_receivers, surroundings_of
from .transport import Transport
from .visibility import RayScene


@dataclass(frozen=True)
class Effort:
    """What a quality stands for.

    Attributes
    ----------
    patches : int
        Patches that a uniform subdivision of the scene at the automatic minimum size would have, about.
    rays_per_patch : int
    tolerance : float
        RMS error of interpolation over the surface, relative to the mean, down to which faces are split.
    gather : GatherRays
    """

    patches: int
    rays_per_patch: int
    tolerance: float
    gather: GatherRays


EFFORTS = {
    "DRAFT": Effort(2_000, 32, 0.04, GatherRays(64, 0.05, 16, 32, 64, 0.06)),
    "GOOD": Effort(4_000, 64, 0.007, GatherRays(384, 0.013, 64, 128, 256, 0.01)),
    "HIGH": Effort(16_000, 128, 0.00375, GatherRays(768, 0.0065, 128, 256, 512, 0.005)),
}

FINER_FACES = 32.0
"""Times smaller than patches that faces may become where light changes fast, when the minimum size is automatic."""

LEAST_SEEING = 1.0 / 12.0
"""Share that what sees anything must have of the area that the automatic sizes are made for; of the ground that a block
or a few houses stand on, more does. Where a wide ground has nearly all of it, they are made for that share."""

MOST_COARSE = 4.0
"""Coarse patches, in those of the quality, above which the sizes are not made smaller for what sees anything: of a lone
ball only slivers at its poles seem to, and of a terrain what lies in its folds."""

LARGEST_PATCH = 1.0 / 16.0
"""Share of the area that the sizes are made for, which a patch counts for at most. Where no ground is wide none is
larger."""

FINER_CUTS = 2.0
"""Times smaller still where the outline of another object crosses them."""

CELLS_ALONG_PATCH = 4.0
"""Cells along the edge of the smallest patch, in which what rays look up is interpolated."""

SPLIT_FROM = 2.0
"""Sizes of the smallest faces from which on faces are split: a mesh that comes with shorter edges is dense."""

CELLS_ALONG_FACE = 2.0
"""The same along that of the smallest face, where faces are not smaller than patches."""

RAYS_TO_FIND_CUTS = 16
"""Rays that tell whether a place on an edge is hidden."""

LEAST_COARSENING, MOST_COARSENING = 1.25, 4.0
"""Times larger that patches are made from one try to the next while there are more than the patch limit."""

ROUND_SHARE = 0.15
"""Share of the remaining progress that one batch of traced rows stands for."""

GATHER_SHARE = 0.6
"""The same for one gather: the first is the largest."""

FEWEST_RAYS_PER_PATCH = 16

MOST_TIMES_RAYS = 16
"""Times as many rays, and points that tell what covers it, that a patch gets at most where the patch limit left few: as
what they miss does not average out, together they get the rays of as many as the quality wants."""

KEPT_RAYS_SHARE = 0.25
"""Share of the memory limit up to which what rays met is kept for the bake of the next frame."""

MOST_RAYS = 2**25
"""Rays of the coarsest patches: above it each gets fewer, as the rays of many patches together average out."""


def bake(
    scene: Scene,
    settings: BakeSettings,
    progress: ProgressCallback = no_progress,
    before: KeptRays | None = None,
    keep_rays: bool = False,
) -> BakeResult:
    """Bake the light of `scene` into the meshes that ask for it.

    Parameters
    ----------
    before : KeptRays or None
        What rays met when the scene was another, of which most may be as it was: that is not traced again.
    keep_rays : bool
        Whether the result holds what rays met, for the bake of the next frame. With either, patches are sampled by what
        stays the same from frame to frame: the noise is another than without, and stays where nothing changes.

    Raises
    ------
    BakeError
        One of its kinds, with a sentence that says what to do.
    Cancelled
        When `progress` raised it.
    """
    clock = Clock(progress)

    clock.start("Preparing", 0.0, 0.02)
    surfaces = join(scene)
    check_light(surfaces)
    kept = int(KEPT_RAYS_SHARE * settings.memory_limit * 2**20) if keep_rays else 0
    with closing(_ray_scene(surfaces, surfaces.seen, surfaces.shadow, settings, before, kept)) as rays:
        result = _bake(scene, surfaces, rays, settings, clock)
        return replace(result, kept_rays=rays.kept())


def _ray_scene(
    surfaces: Surfaces,
    seen: NDArray[np.bool_],
    shadow: NDArray[np.bool_],
    settings: BakeSettings,
    before: KeptRays | None = None,
    most_kept: int = 0,
) -> RayScene:
    return RayScene(
        surfaces.traced_points(),
        surfaces.triangles,
        settings.threads,
        seen,
        shadow,
        surfaces.blockers(),
        surfaces.transmittance,
        before,
        most_kept,
    )


def _lit_sides(surfaces: Surfaces, rays: RayScene, settings: BakeSettings) -> NDArray[np.bool_]:
    """Whether light reaches the front and the back of each shell, (shells, 2), through what lets some of it pass."""
    met = surfaces.seen & surfaces.shadow & ~surfaces.let_pass()
    if met.all():
        return lit_sides(surfaces, rays, settings.seed)
    with closing(_ray_scene(surfaces, met, met, settings)) as solids:
        lit = lit_sides(surfaces, solids, settings.seed)
        rays.rays, rays.seconds = rays.rays + solids.rays, rays.seconds + solids.seconds
    return lit


def _bake(scene: Scene, surfaces: Surfaces, rays: RayScene, settings: BakeSettings, clock: Clock) -> BakeResult:
    effort = EFFORTS[settings.quality]
    lit = _lit_sides(surfaces, rays, settings)

    walked = rays.rays
    memory = Memory(settings.memory_limit * 2**20, effort.rays_per_patch, effort.gather.hemisphere)
    refined = settings.output == "REFINED"
    most_rays = memory.most_traced_rays(len(np.unique(surfaces.triangles[surfaces.baked])), refined)
    transport, rounds, area = subdivided(surfaces, rays, lit, settings, effort, most_rays, clock)
    tree, per_row = transport.tree, transport.rays_per_row
    smallest, finest = minimum_sizes(surfaces, settings, effort, area)
    automatic = not settings.minimum_size and settings.method == "ADAPTIVE"
    finest_cut = finest / FINER_CUTS if automatic else finest

    rays_of_rows = rays.rays - walked

    clock.start("Solving", 0.4, 0.5)
    transport.lengthen_few(clock.report)
    cover = transport.separate_cover(clock.report)
    shares = transport.shares()
    emitters = all_emitters(surfaces, lit, rays, settings.seed)
    balance = balance_of(transport, cover, shares)
    direct = direct_on_patches(transport, cover, balance, emitters, clock.report)
    cells = Cells(
        tree,
        transport.locator,
        transport.unlit_side,
        max(smallest / CELLS_ALONG_PATCH, finest / CELLS_ALONG_FACE),
        cover,
        COVER_GAP * rays.scale * finest,
        memory.most_cells(),
    )
    patches = TracedPatches(len(tree), balance, emitters, direct, cells)
    light = light_of_patches(patches, surfaces)
    surroundings = surroundings_of(balance, light.solution, tree)
    traced = rays.rays

    clock.start("Gathering", 0.5, 0.95)
    radiance = Radiance.of(cells, light.seen, surfaces.world)
    gathering = clock.repeated(GATHER_SHARE, lambda: f"{rays.rays:,} rays")
    most_kept = memory.most_places_kept()
    room = memory.room(transport.kept_rays(), len(cells.node))

    per_receiver = effort.gather
    bright: BrightPlaces | None = None

    def gather_at(places: Receivers, mixture: Mixture | None = None) -> Gathered:
        into = per_receiver, finest, most_kept, gathering, mixture, bright
        return gather(transport, cells, radiance, emitters, places, *into)

    def gather_roughly(places: Receivers) -> Gathered:
        into = rough_rays(per_receiver), finest, 0, gathering, None, bright
        return gather(transport, cells, radiance, emitters, places, *into)

    def indirect_at(places: Receivers) -> Gathered:
        return gather_indirect(transport, cells, radiance, places, per_receiver, finest, most_kept, gathering, bright)

    def light_up_first(faces: Faces, share: Floats, strict: Floats) -> Lit:
        nonlocal per_receiver, bright
        face, side = wanted_sides(faces, surfaces, lit)
        places = receivers(surfaces, faces, face, side)
        at_place = at_receivers(places, strict[face, side])

        def indirect() -> Gathered:
            return gather_sparsely(places, at_place, indirect_at, SPLIT_FROM * finest, effort.tolerance)

        gathered = with_direct(transport, emitters, places, per_receiver, gathering, indirect())
        first, aimed = Lit(faces, face, side, places, gathered, share), False
        while True:
            noise, count = first.noise(surfaces, strict), len(places.points)
            enough = enough_rays(per_receiver, effort.gather.hemisphere, noise, count, most_kept)
            if enough is per_receiver:
                return first
            if not aimed:
                bright = bright_places(cells, balance, light.solution, light.seen, surfaces, surroundings.of_element)
            if aimed or bright is None:
                per_receiver = enough
            aimed = True
            first = replace(first, gathered=first.gathered.with_indirect(indirect()))

    def is_hidden(places: Receivers) -> NDArray[np.bool_]:
        return hidden_receivers(transport, places, finest, RAYS_TO_FIND_CUTS)

    def stands_on(places: Receivers, of_corner: Ints, hidden: NDArray[np.bool_]) -> NDArray[np.bool_]:
        return (blocked_edges(rays, places, of_corner, hidden, finest, ~walls) < 1.0).all(axis=2)

    cuts, on_faces, diagonals, crowded = None, None, None, False
    walls = ~surfaces.closed[surfaces.shell_of_triangle]
    if settings.output == "ORIGINAL":
        faces = input_faces(surfaces)
        share = counted_share_of_triangles(tree, LARGEST_PATCH * area)[faces.triangle]
        shown = light_up_first(faces, share, surroundings.of_triangles(tree, len(surfaces.triangles))[faces.triangle])
        drawn = shown
    else:
        aside = transport.is_aside()
        sizes = FaceSizes(smallest, finest, finest_cut, LARGEST_PATCH * area, room)
        shown, leaves, crowded = light_up_in_detail(
            surfaces,
            lit,
            tree,
            aside.reshape(-1, 2).any(axis=1),
            sizes,
            effort.tolerance,
            surroundings,
            light_up_first,
            gather_at,
            gather_roughly,
            is_hidden,
            stands_on,
        )
        if shown.gathered.places.rays:
            of_cells = aside[cover.base_of(cells.element)]
            of_node = receivers_of_nodes(leaves, shown)
            # Solids hide what is in them; nothing sees it.
            hidden = shown.gathered.hidden
            divisions = Divisions.of(blocked_edges(rays, shown.places, of_node, hidden, finest, walls))
            on_faces = PlacesOnFaces(cells, leaves, shown.gathered.places, of_cells, of_node, hidden, divisions)
            shown, radiance = looked_again(rays.workers, patches, light, surfaces, shown, on_faces)
        clock.start("Cutting", 0.95, 0.98)
        if settings.method == "ADAPTIVE":
            diagonals = turned_diagonals(surfaces, shown, effort.tolerance)
        drawn = shown.redrawn(diagonals)
        hidden, touching = drawn.gathered.hidden, drawn.gathered.touching
        fronts = drawn.places.of_corner[: len(drawn.faces.triangle)]
        ways = blocked_edges(rays, drawn.places, fronts, hidden, finest, walls)
        edges = CutEdges.joined(
            [
                find_cuts(drawn.faces, drawn.places, hidden, is_hidden),
                edges_to_outlines(drawn.faces, drawn.places, hidden, touching),
                edges_under_walls(drawn.faces, drawn.places, hidden, ways),
            ]
        )
        before, beyond = cut_receivers(drawn.faces, drawn.places, edges)
        # What is beyond an edge that ends on the outline is not asked for, and what nothing can see is dark.
        asked = np.flatnonzero(~edges.whole)
        dark = np.ones(len(edges.whole), dtype=bool)
        dark[asked] = is_hidden(beyond.taken(asked))
        cuts = TracedCuts(edges, gather_at(before), gather_unless(dark, beyond, gather_at))

    expected = drawn.expected_error(surfaces)
    cut = cut_light(drawn, cuts)
    checks = check_places(drawn.areas_of(surfaces, cut[0], cut[1]), len(drawn.places.points))
    checks = replace(checks, gathered=gather_at(receivers_of_checks(surfaces, cut[0], cut[1], checks)))

    clock.start("Reconstructing", 0.98, 1.0)
    counts: dict[str, Any] = {
        "relit": False,
        "patches": len(tree.patches()),
        "rays": rays.rays,
        "rays_known": rays.known,
        "rays_by_kind": {
            "walks": walked,
            "form_factors": rays_of_rows,
            "patches": traced - walked - rays_of_rows,
            "gather": rays.rays - traced,
        },
        "seconds_in_ray_library": rays.seconds,
        "threads": rays.workers.threads,
        "form_factor_standard_error": refinement.typical_standard_error(shares, settings.threshold),
        "minimum_size": smallest,
        "minimum_face_size": finest if refined else None,
        "rounds": rounds.as_report(),
        "ended": rounds.ended,
    }
    taken = room.taken(len(shown.places.points), bytes_of_tables(shown.gathered.places))
    taken += BYTES_PER_TRIANGLE * len(surfaces.triangles)
    once = refined and on_faces is None
    warnings = limit_warnings(rounds, per_row, effort, crowded, cells.are_fewer or once, taken, memory.limit)
    warnings += patch_limit_warnings(rounds, len(tree.patches()), settings.patch_limit)
    story = Story(settings, counts, warnings)
    kept = KeptTransport(shapes_of(scene), surfaces, lit, patches, shown, on_faces, diagonals, cuts, checks, story)
    parts = partial(parts_of, kept, scene, rays.workers)
    result = result_of(scene, surfaces, lit, patches, light.solution, expected, cut, checks, story, clock, parts)
    return replace(result, kept=keep(kept)) if settings.keep_transport else result


def gather_unless(dark: NDArray[np.bool_], places: Receivers, gather_at: GatherAt) -> Gathered:
    """Gather light at places, but where it is known to be dark, (n,) bool."""
    lit = gather_at(places.taken(np.flatnonzero(~dark)))
    count = int(np.count_nonzero(dark))
    number = np.empty(len(dark), dtype=np.int64)
    number[~dark], number[dark] = np.arange(len(dark) - count), len(dark) - count + np.arange(count)
    return lit.joined(Gathered.dark(count, lit.places.rays), number)


def minimum_sizes(surfaces: Surfaces, settings: BakeSettings, effort: Effort, area: float) -> tuple[float, float]:
    """The minimum sizes of patches and of faces, scene units.

    A size that was asked for is that of the smallest there are. What rays see is interpolated between the vertices, so
    where faces are split by the light on them, patches are not made smaller than the quality wants them.

    Parameters
    ----------
    area : float, scene units squared
        That the automatic ones are made for: of the whole scene, or less where a wide ground has most of it.
    """
    automatic, asked = automatic_size(area, effort), settings.minimum_size
    if settings.method == "UNIFORM":
        return asked or automatic, asked or automatic
    if not asked:
        baked = float(surfaces.areas[surfaces.baked].sum())
        return automatic, automatic_size(min(area, baked), effort) / FINER_FACES
    if settings.output == "ORIGINAL":
        return asked, asked
    return max(asked, automatic), asked


def automatic_size(area: float, effort: Effort) -> float:
    """The minimum size n at which an area, cut uniformly, has about `effort.patches` patches."""
    # A right isosceles triangle of longest edge s has the area s^2 / 4, and sizes lie between n and 2n.
    return float(np.sqrt(4.0 * area / effort.patches) / np.sqrt(2.0))


def subdivided(
    surfaces: Surfaces,
    rays: RayScene,
    lit: NDArray[np.bool_],
    settings: BakeSettings,
    effort: Effort,
    most_rays: int,
    clock: Clock,
) -> tuple[Transport, refinement.Refinement, float]:
    """The traced patches, how their subdivision went, and the area that their minimum size was made for.

    Where a wide ground has most of the area, a size made for all of it leaves a room on it as a few patches. But what
    takes part in the exchange of light is where surfaces see each other, whatever lies around them. How large that is
    even a few patches tell.
    """
    area, most_patches = float(surfaces.areas.sum()), settings.patch_limit or LARGEST
    while True:
        clock.start("Coarse patches", 0.02, 0.03)
        smallest, _ = minimum_sizes(surfaces, settings, effort, area)
        least = min(smallest, automatic_size(area, effort))
        tree = coarsest_that_fits(surfaces, rays, lit, least, most_patches)
        tree.by_key = rays.remembers
        per_row = rays_that_fit(effort.rays_per_patch, min(most_rays, MOST_RAYS), len(tree.patches()))
        transport = Transport(surfaces, tree, rays, lit, per_row, settings.seed)
        clock.start("Form factors", 0.03, 0.4)
        rounds = subdivide(transport, lit, settings, effort, smallest, most_rays, clock)
        seeing = transport.seeing_area()
        if settings.method == "UNIFORM" or seeing == 0.0 or seeing >= LEAST_SEEING * area:
            return transport, rounds, area
        if minimum_sizes(surfaces, settings, effort, seeing)[0] >= smallest:
            return transport, rounds, area
        if coarse_count(surfaces, automatic_size(seeing, effort)) > MOST_COARSE * effort.patches:
            return transport, rounds, area
        area = seeing


def coarsest_that_fits(
    surfaces: Surfaces, rays: RayScene, lit: NDArray[np.bool_], least: float, most: int
) -> PatchTree:
    """The coarse patches for patches of a size `least`, scene units, or so much larger that there are `most` of them.

    There may be more in the end, of what is of many colours, bent or in many pieces, and cannot be joined.
    """
    largest = float(np.ptp(surfaces.points, axis=0).max(initial=0.0))
    while True:
        tree = clustered_patches(surfaces, least, find_crossings(surfaces, rays, lit, least))
        count = len(tree.patches())
        if count <= most or least > largest:
            return tree
        least *= float(np.clip(np.sqrt(count / most), LEAST_COARSENING, MOST_COARSENING))


def rays_that_fit(wanted: int, most: int, patches: int) -> int:
    """Rays for each patch, halved from `wanted` until all patches together have at most `most`."""
    while wanted > FEWEST_RAYS_PER_PATCH and wanted * patches > most:
        wanted //= 2
    return wanted


def subdivide(
    transport: Transport,
    lit: NDArray[np.bool_],
    settings: BakeSettings,
    effort: Effort,
    smallest: float,
    most_rays: int,
    clock: Clock,
) -> refinement.Refinement:
    """Subdivide by the method asked for; every element that takes part has been traced afterwards."""
    tree, surfaces = transport.tree, transport.surfaces

    wanted = surfaces.baked | surfaces.emission.any(axis=1)
    most = settings.patch_limit or LARGEST

    def seeds() -> Ints:
        patches = tree.patches()
        # What emits is needed for the balance, though few rays may meet it.
        patches = patches[wanted[tree.triangle[patches]]]
        behind = patches[lit[surfaces.shell_of_triangle[tree.triangle[patches]], 1]]
        return np.sort(np.concatenate([2 * patches, 2 * behind + 1]))

    report = clock.repeated(ROUND_SHARE, lambda: f"{len(tree.patches()):,} patches, {transport.rays.rays:,} rays")
    if settings.method == "ADAPTIVE":
        rounds = refinement.refine(transport, seeds, settings.threshold, smallest, most_rays, report, most)
    else:
        rounds = refinement.refine_uniformly(transport, seeds, smallest, most_rays, report, most)
    if rounds.ended == refinement.PATCHES_MET:
        together = min(effort.patches * effort.rays_per_patch, most_rays)
        times = min(together // max(transport.kept_rays(), 1), MOST_TIMES_RAYS)
        if times > 1:
            transport.begin_anew(times)
            refinement.trace_all(transport, seeds, report)
    return rounds


def limit_warnings(
    rounds: refinement.Refinement,
    rays_per_patch: int,
    effort: Effort,
    crowded: bool,
    coarse: bool,
    taken: int,
    memory: int,
) -> tuple[str, ...]:
    """Sentences on limits that the bake ran into.

    Parameters
    ----------
    crowded : bool
        Whether there was room for fewer vertices than were wanted.
    coarse : bool
        Whether there was none for what rays see as finely as was wanted.
    taken, memory : int
        Bytes that the bake took, at least, and may take.
    """
    warnings = []
    if rounds.ended == refinement.LIMIT_MET:
        warnings.append("The memory limit ended the subdivision early; raise it or the minimum size for an even result")
    if rays_per_patch < effort.rays_per_patch:
        warnings.append(
            f"For the memory limit or the number of patches, each patch was given {rays_per_patch} rays only"
        )
    if crowded:
        warnings.append("The memory limit ended the search for shadow borders early; raise it for finer shadows")
    if coarse:
        warnings.append("The memory limit left less room for the light that rays see; raise it for more exact light")
    if taken > WITHIN * memory:
        warnings.append(
            f"The scene itself is larger than the memory limit: its bake took about {taken / 2**20:,.0f} MiB, "
            "which is the least"
        )
    return tuple(warnings)


def patch_limit_warnings(rounds: refinement.Refinement, patches: int, limit: int) -> tuple[str, ...]:
    """A sentence where so many patches were too many for the limit (0: none), or where it ended the subdivision."""
    if limit and patches > limit:
        return (
            f"The scene is {patches:,} patches at least, more than the patch limit of {limit:,}: faces of different "
            "colours, directions or objects are not joined",
        )
    if rounds.ended == refinement.PATCHES_MET:
        return (
            f"The patch limit ended the subdivision early, with {patches:,} patches; raise it for more exact light",
        )
    return ()
