# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Relighting: other emission, reflectance and world on the transport of a bake, without tracing a ray."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import partial
from hashlib import blake2b
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .cells import Radiance
from .checks import Checks
from .clock import Clock
from .errors import BakeError
from .interpolation import PlacesOnFaces
from .lighting import (
    PatchLight,
    Story,
    TracedCuts,
    TracedPatches,
    check_light,
    cut_light,
    light_of_patches,
    looked_again,
    relit,
    result_of,
)
from .lit import Lit
from .parts import NotDividedError, Part, divided
from .progress import ProgressCallback, no_progress
from .result import BakeResult
from .scene import Floats, Ints, Lamp, LightLinking, Scene, SurfaceMesh
from .subdivision import Faces
from .surfaces import Surfaces
from .workers import Workers

LOST_LIGHT = 0.001
"""Share of an emitting triangle's light that may come from where it was dark: cells that a piece's border cuts."""


class ChangedSceneError(BakeError):
    """The scene is not the one that was baked."""


@dataclass(frozen=True, eq=False)
class KeptTransport:
    """All of a bake that does not depend on colours.

    Attributes
    ----------
    shapes : tuple of bytes
        Of the scene's meshes and lamps, to notice that one was changed.
    surfaces : Surfaces
        With the colours of the bake.
    lit : (shells, 2) bool
    patches : TracedPatches
    shown : Lit
        Faces and what was gathered at them.
    on_faces : PlacesOnFaces or None
        None where rays are not looked up in the light of the vertices.
    diagonals : (faces, 3) int or None
        How the faces are redrawn when they have their light.
    cuts : TracedCuts or None
    checks : Checks
        On the faces, cut.
    story : Story
    """

    shapes: tuple[bytes, ...]
    surfaces: Surfaces
    lit: NDArray[np.bool_]
    patches: TracedPatches
    shown: Lit
    on_faces: PlacesOnFaces | None
    diagonals: Ints | None
    cuts: TracedCuts | None
    checks: Checks
    story: Story


@dataclass(frozen=True)
class NotKept:
    """Why the transport of a bake was not kept, as a sentence."""

    why: str


def keep(kept: KeptTransport) -> KeptTransport | NotKept:
    """Give back the transport, or say why it cannot be kept: it would take more than the memory limit."""
    limit = kept.story.settings.memory_limit
    if is_complete(kept) and size_of(kept) <= limit * 2**20:
        return kept
    return NotKept(
        f"What the rays of the last bake met is larger than the memory limit of {limit:,} MiB and was not kept; "
        "raise the limit and bake again to relight"
    )


def is_complete(kept: KeptTransport) -> bool:
    """Whether all places that rays met are known, which the memory limit may have prevented."""
    gathers = [kept.shown.gathered, kept.checks.gathered]
    gathers += [kept.cuts.seen, kept.cuts.hidden] if kept.cuts else []
    return all(len(gathered.places) == 0 or gathered.places.rays > 0 for gathered in gathers)


def size_of(value: object) -> int:
    """Bytes of all arrays that a value consists of, each counted once."""
    arrays = {id(array): array for array in _arrays(value, set())}
    return sum(array.nbytes for array in arrays.values())


def _arrays(value: object, known: set[int]) -> Iterator[NDArray[Any]]:
    if id(value) in known:
        return
    known.add(id(value))
    if isinstance(value, np.ndarray):
        yield value if value.base is None or not isinstance(value.base, np.ndarray) else value.base
    elif isinstance(value, tuple | list):
        for part in value:
            yield from _arrays(part, known)
    elif is_dataclass(value):
        for field in fields(value):
            yield from _arrays(getattr(value, field.name), known)
    elif type(value).__module__.startswith(__package__ or "core"):
        yield from _arrays(list(vars(value).values()), known)


def shape_of(mesh: SurfaceMesh) -> bytes:
    """A number that changes with anything about a mesh but its colours and its name."""
    digest = blake2b(digest_size=16)
    flags = np.array([mesh.baked, mesh.seen, mesh.shadow])
    marks = [
        np.zeros(0, dtype=bool) if mark is None or not mark.any() else mark for mark in (mesh.clear, mesh.front_only)
    ]
    digest.update(_linking_code(mesh.linking))
    digest.update(np.float64(mesh.grazing).tobytes())
    for array in (mesh.vertices, mesh.triangles, mesh.corner_normals, flags, *marks, *_transmittance_of(mesh)):
        digest.update(repr((array.shape, array.dtype.str)).encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.digest()


def _transmittance_of(mesh: SurfaceMesh) -> list[NDArray[Any]]:
    """All that tells what goes through a mesh and which of its triangles are translucent; nothing where none is."""
    share, texture, glass = mesh.transmittance, mesh.transmittance_texture, mesh.refraction
    silky = mesh.translucent()
    found: list[NDArray[Any]] = [silky] if silky.any() else []
    found += [] if share is None or not share.any() else [share]
    found += [] if texture is None else [texture.triangle, texture.along, texture.colours]
    return found if glass is None or (glass == 1.0).all() else [*found, glass]


def shape_of_lamp(lamp: Lamp) -> bytes:
    """A number that changes with anything about a lamp but its strength and its name."""
    digest = blake2b(type(lamp).__name__.encode(), digest_size=16)
    digest.update(_linking_code(lamp.linking))
    parts = [getattr(lamp, name, None) for name in ("cone", "profile", "falloff")]
    for part in (lamp, *(part for part in parts if part is not None)):
        for field in fields(part):
            if field.name not in {"name", "strength", "cone", "profile", "falloff", "linking"}:
                digest.update(np.asarray(getattr(part, field.name), dtype=np.float64).tobytes())
    return digest.digest()


def _linking_code(linking: LightLinking) -> bytes:
    sets = (linking.receivers, linking.blockers)
    return repr([None if chosen is None else sorted(chosen) for chosen in sets]).encode()


def shapes_of(scene: Scene) -> tuple[bytes, ...]:
    """The shape of each mesh, then of each lamp."""
    return (*(shape_of(mesh) for mesh in scene.meshes), *(shape_of_lamp(lamp) for lamp in scene.lamps))


def sources_of(scene: Scene) -> NDArray[np.bool_]:
    """Which lamps give light, which triangles of the meshes, the world, and whether that differs by direction.

    A bake can be relit, as far as this tells, by no more than gave light in it.
    """
    lamps = [lamp.strength.any() for lamp in scene.lamps]
    faces = [_gives_light(mesh) for mesh in scene.meshes]
    return np.concatenate([np.array(lamps, dtype=bool), *faces, [scene.world.any(), scene.world.ndim > 1]])


def _gives_light(mesh: SurfaceMesh) -> NDArray[np.bool_]:
    gives, texture = mesh.emission.any(axis=1), mesh.emission_texture
    if texture is not None:
        ends = np.cumsum(texture.along**2)
        gives[texture.triangle] = [part.any() for part in np.split(texture.colours, ends[:-1])]
    return gives


def relight(kept: KeptTransport, scene: Scene, progress: ProgressCallback = no_progress) -> BakeResult:
    """Give the scene that was baked other light: solve again, and look up again what its rays met.

    Parameters
    ----------
    kept : KeptTransport
        Not changed.
    scene : Scene
        The same meshes and lamps, with any reflectance, emission, strengths and world.

    Returns
    -------
    As the bake would: the same meshes with other values.

    Raises
    ------
    ChangedSceneError
        When the meshes are not those that were baked, or something gives light that gave none.
    BakeError
        As `bake` raises them for light that cannot be solved.
    """
    clock = Clock(progress)
    clock.start("Preparing", 0.0, 0.1)
    check_shapes(kept, scene)
    surfaces = kept.surfaces.recoloured(scene)
    check_sources(kept, scene, surfaces)
    check_light(surfaces)
    with closing(Workers(kept.story.settings.threads)) as workers:
        return _relight(kept, scene, surfaces, workers, clock)


def _relight(kept: KeptTransport, scene: Scene, surfaces: Surfaces, workers: Workers, clock: Clock) -> BakeResult:
    clock.start("Solving", 0.1, 0.4)
    patches = kept.patches.recoloured(surfaces)
    light = light_of_patches(patches, surfaces)

    clock.start("Gathering", 0.4, 0.9)
    shown, cut, radiance = _gathered_again(kept, patches, light, surfaces, workers)
    checks = replace(kept.checks, gathered=relit(workers, patches.emitters, radiance, kept.checks.gathered))

    clock.start("Reconstructing", 0.9, 1.0)
    counts = {**kept.story.counts, "relit": True, "rays": 0, "rays_known": 0, "seconds_in_ray_library": 0.0}
    counts["rays_by_kind"] = dict.fromkeys(counts["rays_by_kind"], 0)
    story = replace(kept.story, counts=counts)
    parts = partial(parts_of, kept, scene, workers)
    return result_of(
        scene,
        surfaces,
        kept.lit,
        patches,
        light.solution,
        shown.expected_error(surfaces),
        cut,
        checks,
        story,
        clock,
        parts,
    )


def _gathered_again(
    kept: KeptTransport, patches: TracedPatches, light: PatchLight, surfaces: Surfaces, workers: Workers
) -> tuple[Lit, tuple[Faces, Ints, Floats], Radiance]:
    """The faces in the light of the patches, redrawn as in the bake, the same cut, and what rays saw last."""
    radiance = Radiance.of(patches.cells, light.seen, surfaces.world)
    shown = replace(kept.shown, gathered=relit(workers, patches.emitters, radiance, kept.shown.gathered))
    if kept.on_faces is not None:
        shown, radiance = looked_again(workers, patches, light, surfaces, shown, kept.on_faces)
    shown = shown.redrawn(kept.diagonals)
    if kept.cuts is None:
        return shown, cut_light(shown, None), radiance
    seen, hidden = (relit(workers, patches.emitters, radiance, side) for side in (kept.cuts.seen, kept.cuts.hidden))
    cut = cut_light(shown, TracedCuts(kept.cuts.edges, seen, hidden))
    return shown, cut, radiance


def parts_of(kept: KeptTransport, scene: Scene, workers: Workers, whole: Floats) -> tuple[Part, list[Part]]:
    """The light that the settings ask for, and its groups, as `divided` gives them.

    Parameters
    ----------
    whole : (f, 3, 3) float, W m^-2 sr^-1
        Irradiance over pi at the corners of face sides, by all of the light.

    Raises
    ------
    NotDividedError
        When what the rays met was not kept.
    """
    if not is_complete(kept):
        raise NotDividedError(
            "The memory limit leaves no room to tell the parts of the light apart; raise it, or bake everything"
        )

    def irradiance_of(other: Scene) -> Floats:
        surfaces = kept.surfaces.recoloured(other)
        patches = kept.patches.recoloured(surfaces)
        light = light_of_patches(patches, surfaces)
        _, (_, _, irradiance), _ = _gathered_again(kept, patches, light, surfaces, workers)
        return irradiance

    return divided(scene, kept.story.settings, whole, irradiance_of)


def check_shapes(kept: KeptTransport, scene: Scene) -> None:
    """Refuse a scene whose meshes and lamps are not those that were baked.

    Raises
    ------
    ChangedSceneError
    """
    lamps = kept.patches.emitters.lamps
    if len(scene.lamps) != len(lamps):
        raise ChangedSceneError(
            "Lamps, or bright parts of the World, were added, removed or hidden since the bake; bake again"
        )
    if len(scene.meshes) + len(lamps) != len(kept.shapes):
        raise ChangedSceneError("Objects were added, removed or hidden since the bake; bake again")
    for part, shape, before in zip((*scene.meshes, *scene.lamps), shapes_of(scene), kept.shapes, strict=True):
        if shape != before:
            raise ChangedSceneError(f'"{part.name}" was changed or moved since the bake; bake again')


def check_sources(kept: KeptTransport, scene: Scene, surfaces: Surfaces) -> None:
    """Refuse light from what gave none in the bake, whose shadows were not traced and whose ways nobody walked.

    Raises
    ------
    ChangedSceneError
    """
    before = kept.surfaces
    new = np.flatnonzero(surfaces.emission.any(axis=1) & ~before.emission.any(axis=1))
    if len(new):
        raise ChangedSceneError(_gave_no_light(scene, surfaces, new[0]))
    texture, emitters = surfaces.emission_texture, kept.patches.emitters
    if texture is not None:
        total = surfaces.areas * surfaces.emission.sum(axis=1)
        radiance = surfaces.emission_over(emitters.triangle, emitters.within).sum(axis=1)
        shown = np.bincount(emitters.triangle, weights=emitters.areas * radiance, minlength=len(total))
        # Pieces of a texture that were dark were left out.
        dark = texture.triangle[(shown < (1.0 - LOST_LIGHT) * total)[texture.triangle]]
        if len(dark):
            raise ChangedSceneError(_gave_no_light(scene, surfaces, dark[0]))
    for lamp, earlier in zip(surfaces.lamps, before.lamps, strict=True):
        if lamp.strength.any() and not earlier.strength.any():
            raise ChangedSceneError(f'"{lamp.name}" gave no light when the scene was baked; bake again')
    if scene.world.ndim > before.world.ndim:
        raise ChangedSceneError("The World was the same to all sides when the scene was baked; bake again")
    if surfaces.world.any() and not before.world.any():
        raise ChangedSceneError("The World gave no light when the scene was baked; bake again")


def _gave_no_light(scene: Scene, surfaces: Surfaces, triangle: int) -> str:
    name = scene.meshes[surfaces.mesh_of_triangle[triangle]].name
    return f'"{name}" gave no light where it does now when the scene was baked; bake again'
