# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Light on a traced scene: all of a bake that needs colours and no rays, for the bake itself and for relighting."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .balance import Balance, check_solved, energy, left_emission, seen_radiance, unreflected_light
from .cells import Cells, Radiance
from .checks import Checks
from .clock import Clock
from .cut_edges import CutEdges
from .cutting import cut_faces, drawn_to_cut, values_on_outlines
from .direct import Emitters
from .direct_light import DirectLight
from .error_estimate import Expected, error_warnings, relative_error
from .errors import NoLightError
from .gather import Gathered, look_again
from .interpolation import InterpolatedRadiance, PlacesOnFaces
from .lit import Lit
from .output import baked_meshes
from .parts import Part, wants_parts, with_groups
from .result import BakedMesh, BakeResult
from .sampling import Singles
from .scene import Floats, Ints, Scene
from .settings import BakeSettings
from .solve import Solution, solve_balance
from .subdivision import Faces
from .surfaces import Surfaces
from .workers import Workers

FEWEST_LOOKS, FEWEST_LOOKS_BESIDE_WALLS, MOST_LOOKS = 2, 6, 24
"""Times that gather rays are looked up again in the light of the vertices: each is one more bounce on the finest mesh.
What patches under a thin wall let through to its dark side becomes less with each, and so does what a patch has too
much of where two surfaces meet at a sharp angle: light between them goes to and fro many times."""

SETTLED = 0.005
"""Change of the light at the vertices by one more look, RMS relative to their mean, up to which it is the last."""

LARGEST_IMBALANCE = 0.03
"""Share of the power that may be missing, or too much, before the report warns of it."""


@dataclass(frozen=True, eq=False)
class TracedPatches:
    """What the rays of the patches told.

    Attributes
    ----------
    nodes : int
        Of the patch tree.
    balance : Balance
        Of m elements.
    emitters : Emitters
    direct : DirectLight
        Of the m elements.
    cells : Cells
    """

    nodes: int
    balance: Balance
    emitters: Emitters
    direct: DirectLight
    cells: Cells

    def recoloured(self, surfaces: Surfaces) -> TracedPatches:
        """The same patches, with the colours that `surfaces` have."""
        return replace(self, balance=self.balance.recoloured(surfaces), emitters=self.emitters.recoloured(surfaces))


@dataclass(frozen=True, eq=False)
class PatchLight:
    """The solved light of the patches.

    Attributes
    ----------
    solution : Solution
    seen : (places, 3) float, W m^-2 sr^-1
        What rays see of it.
    reflectance : (cells, 3) float32
    translucence : (cells, 3) float32 or None
    """

    solution: Solution
    seen: Floats
    reflectance: Singles
    translucence: Singles | None


@dataclass(frozen=True, eq=False)
class TracedCuts:
    """Edges of faces that are cut, and the light gathered before and beyond each cut.

    Attributes
    ----------
    edges : CutEdges
    seen, hidden : Gathered
    """

    edges: CutEdges
    seen: Gathered
    hidden: Gathered


def check_light(surfaces: Surfaces) -> None:
    """Raise where nothing emits.

    Raises
    ------
    NoLightError
    """
    lamps = any(lamp.strength.any() for lamp in surfaces.lamps)
    if lamps or surfaces.emission.any() or surfaces.world.any():
        return
    if surfaces.lamps:
        first, more = surfaces.lamps[0].name, len(surfaces.lamps) - 1
        gives = f"and {more:,} more give none: their" if more else "gives none: its"
        raise NoLightError(
            f'Nothing in the scene emits light, as "{first}" {gives} power or colour is zero or negative; raise it'
        )
    raise NoLightError(
        "Nothing in the scene emits light; add a lamp, or give a material some Emission or the World a colour"
    )


def light_of_patches(patches: TracedPatches, surfaces: Surfaces) -> PatchLight:
    """Solve the energy balance.

    Raises
    ------
    UnsolvableError
        When light is trapped.
    """
    balance, emitters = patches.balance, patches.emitters
    direct = unreflected_light(balance, patches.direct, emitters, surfaces)
    solution = solve_balance(balance.exchange, balance.reflectance, direct, balance.areas, balance.translucence)
    check_solved(solution, surfaces)
    cells = patches.cells
    seen_of_element = seen_radiance(patches.nodes, balance, solution, emitters, surfaces)
    seen = seen_of_element[cells.element]
    reflectance = surfaces.reflectance[cells.triangle].astype(np.float32)
    translucence = None
    if surfaces.reflectance_texture is not None or surfaces.let_pass().any():
        # The patch has one irradiance, but rays see what the texture makes of it.
        varied = np.flatnonzero(surfaces.vary(cells.triangle))
        triangle, corners = cells.triangle[varied], cells.corners(varied)
        whole = surfaces.reflectance_over(triangle, corners)
        reflectance[varied] = surfaces.of_opaque_parts(whole, triangle, corners)
        # The twin of a patch that is covered in part may have no cell, and be the last element.
        incident = np.zeros_like(seen_of_element)
        incident[balance.elements] = solution.incident
        if surfaces.translucence is not None:
            translucence = np.zeros_like(reflectance)
            whole = surfaces.translucence_over(triangle, corners)
            translucence[varied] = surfaces.of_opaque_parts(whole, triangle, corners)
        for side, other in ((2 * varied, 2 * varied + 1), (2 * varied + 1, 2 * varied)):
            seen[side] = incident[cells.element[side]] * reflectance[varied]
            if translucence is not None:
                seen[side] += incident[cells.element[other]] * translucence[varied]
    return PatchLight(solution, seen, reflectance, translucence)


def looked_again(
    workers: Workers,
    patches: TracedPatches,
    light: PatchLight,
    surfaces: Surfaces,
    shown: Lit,
    on_faces: PlacesOnFaces,
) -> tuple[Lit, Radiance]:
    """Look the gather rays up again in the light of the vertices; returns the faces' light and what rays saw last."""
    left = left_emission(surfaces, patches.emitters)
    interpolated = InterpolatedRadiance(on_faces, light.reflectance, left, light.seen, light.translucence)
    fewest = FEWEST_LOOKS_BESIDE_WALLS if on_faces.beside_walls else FEWEST_LOOKS
    for look in range(1, MOST_LOOKS + 1):
        before = shown.gathered
        radiance = Radiance.of(patches.cells, interpolated.at(shown), surfaces.world)
        shown = replace(shown, gathered=look_again(workers, radiance, before))
        if look >= fewest and _change(before, shown.gathered) <= SETTLED:
            break
    return shown, radiance


def _change(before: Gathered, after: Gathered) -> float:
    """How far the light at vertices that something sees has changed, RMS relative to their mean; 0 in the dark."""
    seen = np.flatnonzero(~after.hidden)
    light = after.irradiance[seen]
    square, mean = float(((light - before.irradiance[seen]) ** 2).sum()), float(light.sum())
    return math.sqrt(square * light.size) / mean if mean > 0.0 else 0.0


def relit(workers: Workers, emitters: Emitters, radiance: Radiance, gathered: Gathered) -> Gathered:
    """What was gathered, with other light: the emitters' and what the same rays see of everything else."""
    direct = gathered.direct.irradiance(emitters.strengths)
    return look_again(workers, radiance, replace(gathered, direct_irradiance=direct))


@dataclass(frozen=True, eq=False)
class Story:
    """What is to be told of a bake beside its values, and does not depend on colours.

    Attributes
    ----------
    settings : BakeSettings
    counts : dict
        Entries of the report.
    warnings : tuple of str
        Of limits that were met.
    """

    settings: BakeSettings
    counts: dict[str, Any]
    warnings: tuple[str, ...]


def result_of(
    scene: Scene,
    surfaces: Surfaces,
    lit: NDArray[np.bool_],
    patches: TracedPatches,
    solution: Solution,
    expected: Expected,
    cut: tuple[Faces, Ints, Floats],
    checks: Checks,
    story: Story,
    clock: Clock,
    parts_of: Callable[[Floats], tuple[Part, list[Part]]],
) -> BakeResult:
    """Sort the light of the faces back to the meshes, and write the report.

    Parameters
    ----------
    lit : (shells, 2) bool
    expected : Expected
        Of the faces before they were cut.
    cut
        Faces, face sides and values, as `cut_light` gives them.
    checks : Checks
        On these.
    parts_of : callable
        Gives the light that was asked for and its groups, of all the light at the corners of the faces.
    """
    faces, face, irradiance = cut
    from_lamps, from_suns = (patches.direct.irradiance(patches.emitters.lamps_alone(suns)) for suns in (False, True))
    from_linked = patches.direct.irradiance(patches.emitters.linked_alone())
    balance = energy(patches.balance, solution, from_lamps, from_suns, from_linked, surfaces)
    error = relative_error(expected, checks, len(faces.triangle), irradiance, balance["imbalance"])
    output = story.settings.output

    def meshes_of(part: Part) -> tuple[tuple[BakedMesh, ...], list[str]]:
        coloured = surfaces if part.scene is scene else surfaces.recoloured(part.scene)
        return baked_meshes(part.scene, coloured, lit, faces, face, part.irradiance, output)

    asked, groups = parts_of(irradiance) if wants_parts(story.settings) else (Part("", scene, irradiance), [])
    meshes, warnings = meshes_of(asked)
    meshes = with_groups(meshes, [(group.name, meshes_of(group)[0]) for group in groups])
    clock.stop()
    report: dict[str, Any] = {
        **story.counts,
        "vertices": sum(len(np.unique(mesh.triangles)) for mesh in meshes),
        "triangles": sum(len(mesh.triangles) for mesh in meshes),
        "seconds": clock.seconds,
        "iterations": solution.iterations,
        "residual": solution.residual,
        "converged": solution.converged,
        "estimated_error": error,
        "energy": balance,
        "settings": asdict(story.settings),
        "warnings": [
            *surfaces.warnings,
            *surfaces.colour_warnings,
            *warnings,
            *story.warnings,
            *_solution_warnings(solution),
            *error_warnings(error, story.settings.quality, output),
            # Light that surfaces both receive and let pass is there twice.
            *(imbalance_warnings(balance) if surfaces.shadow[surfaces.seen].all() else ()),
        ],
    }
    return BakeResult(meshes, report)


def cut_light(shown: Lit, cuts: TracedCuts | None) -> tuple[Faces, Ints, Floats]:
    """Cut the faces that are hidden in part, where the hidden part begins; returns faces, face sides and values."""
    if cuts is None:
        return shown.faces, shown.face, shown.corner_irradiance()
    count, gathered, edges = len(shown.faces.triangle), shown.gathered, cuts.edges
    start, end = edges.seen, edges.hidden
    seen = drawn_to_cut(gathered.irradiance[start], cuts.seen.irradiance, edges.change, cuts.seen.hidden)
    beyond = drawn_to_cut(gathered.irradiance[end], cuts.hidden.irradiance, edges.beyond, cuts.hidden.hidden)
    beyond = np.where(edges.beyond[:, None] > 0.0, beyond, cuts.hidden.irradiance)
    whole = np.flatnonzero(edges.whole)
    corner, light = values_on_outlines(
        shown.places.of_corner[:count], edges.taken(whole), seen[whole], ~cuts.seen.hidden[whole]
    )
    values = shown.corner_irradiance()
    values[:count] = gathered.irradiance[shown.places.of_corner[:count]]
    values.reshape(-1, 3)[corner] = light
    cut = np.flatnonzero(~edges.whole)
    sides = seen[cut], beyond[cut]
    return cut_faces(shown.faces, shown.face, shown.places, gathered.hidden, edges.taken(cut), values, *sides)


def _solution_warnings(solution: Solution) -> list[str]:
    """A sentence on a balance that was not solved."""
    if solution.converged:
        return []
    return [f"The energy balance was solved to a residual of {solution.residual:.1e} only"]


def imbalance_warnings(balance: dict[str, float]) -> list[str]:
    """A sentence when emitted and absorbed light do not add up."""
    if abs(balance["imbalance"]) <= LARGEST_IMBALANCE:
        return []
    return [
        f"{abs(balance['imbalance']):.0%} of the light is unaccounted for, so the result is wrong somewhere; "
        "try a smaller minimum size or a higher quality, and look for a lamp that almost touches another surface"
    ]
