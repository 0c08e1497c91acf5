# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of the light: what is direct and what is reflected, and what each light group gives.

All of them travel the same ways, so that a part is the whole scene lit again with the rest dark, without a ray.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .errors import BakeError
from .result import BakedMesh, GroupLight
from .scene import Floats, LightGroup, Scene
from .settings import BakeSettings


class NotDividedError(BakeError):
    """The parts of the light cannot be told apart."""


@dataclass(frozen=True, eq=False)
class Part:
    """Some of the light.

    Attributes
    ----------
    name : str
        Of the light group, empty for all of the light and for that of no group.
    scene : Scene
        What it leaves surfaces by: with the reflectance that they have, and emission of this light alone.
    irradiance : (f, 3, 3) float, W m^-2 sr^-1
        At the corners of face sides.
    """

    name: str
    scene: Scene
    irradiance: Floats


def wants_parts(settings: BakeSettings) -> bool:
    """Whether anything but the whole light is asked for."""
    return settings.light in ("DIRECT", "INDIRECT") or settings.light_groups


def divided(
    scene: Scene, settings: BakeSettings, whole: Floats, irradiance_of: Callable[[Scene], Floats]
) -> tuple[Part, list[Part]]:
    """The light that was asked for, and its parts by light groups, which sum up to it.

    Parameters
    ----------
    whole : (f, 3, 3) float, W m^-2 sr^-1
        Irradiance over pi by all of the light.
    irradiance_of : callable
        Gives the same for the scene in other colours.
    """
    direct = None if settings.light in ("ALL", "IRRADIANCE") else np.minimum(irradiance_of(unreflecting(scene)), whole)
    asked = Part("", _leaving(scene, settings), _chosen(settings, whole, direct))
    if not settings.light_groups:
        return asked, []
    groups = [group_alone(scene, group) for group in all_groups(scene)]
    wholes = drawn_to_sum([irradiance_of(lit) for lit in groups], whole)
    if direct is None:
        directs: list[Floats | None] = [None] * len(groups)
    else:
        directs = [*drawn_to_sum([irradiance_of(unreflecting(lit)) for lit in groups], direct)]
    chosen = [_chosen(settings, *both) for both in zip(wholes, directs, strict=True)]
    # A group's direct light may exceed its own whole by rounding.
    chosen = drawn_to_sum([np.maximum(light, 0.0) for light in chosen], asked.irradiance)
    named = zip(all_groups(scene), groups, chosen, strict=True)
    return asked, [Part(group.name, _leaving(lit, settings), light) for group, lit, light in named]


def _chosen(settings: BakeSettings, whole: Floats, direct: Floats | None) -> Floats:
    if direct is None:
        return whole
    return direct if settings.light == "DIRECT" else whole - direct


def _leaving(scene: Scene, settings: BakeSettings) -> Scene:
    """The scene by which light leaves surfaces: emission is direct light."""
    return (
        replace(scene, meshes=tuple(m.without_emission() for m in scene.meshes))
        if (settings.light == "INDIRECT")
        else scene
    )


def unreflecting(scene: Scene) -> Scene:
    """The scene with black surfaces, on which all light is direct."""
    return replace(scene, meshes=tuple(mesh.without_reflectance() for mesh in scene.meshes))


def all_groups(scene: Scene) -> list[LightGroup]:
    """The light groups that give light, and one without a name for what gives light in no group."""
    named = list(scene.light_groups)
    rest = LightGroup(
        "",
        frozenset(range(len(scene.meshes))).difference(*(group.meshes for group in named)),
        frozenset(range(len(scene.lamps))).difference(*(group.lamps for group in named)),
        not any(group.world for group in named),
    )
    return [group for group in (*named, rest) if gives_light(scene, group)]


def gives_light(scene: Scene, group: LightGroup) -> bool:
    """Whether anything in a group is not dark."""
    return bool(
        (group.world and np.any(scene.world))
        or any(np.any(scene.lamps[lamp].strength) for lamp in group.lamps)
        or any(scene.meshes[mesh].emits() for mesh in group.meshes)
    )


def group_alone(scene: Scene, group: LightGroup) -> Scene:
    """The scene with everything dark that is not in a group."""
    return replace(
        scene,
        meshes=tuple(
            mesh if index in group.meshes else mesh.without_emission() for index, mesh in enumerate(scene.meshes)
        ),
        lamps=tuple(
            lamp if index in group.lamps else replace(lamp, strength=np.zeros(3))
            for index, lamp in enumerate(scene.lamps)
        ),
        world=scene.world if group.world else np.zeros(3),
    )


def drawn_to_sum(parts: list[Floats], whole: Floats) -> list[Floats]:
    """The parts times what makes them sum up to the whole.

    Light adds up, but what it is interpolated and solved with does so only to within the noise: how steep it is
    decides what rays see of a patch, and a balance is solved to a residual.
    """
    total = sum(parts, np.zeros_like(whole))
    share = np.divide(whole, total, out=np.zeros_like(whole), where=total > 0.0)
    drawn = [part * share for part in parts]
    if drawn:
        drawn[-1] = np.where(total > 0.0, drawn[-1], whole)
    return drawn


def with_groups(
    meshes: tuple[BakedMesh, ...], groups: list[tuple[str, tuple[BakedMesh, ...]]]
) -> tuple[BakedMesh, ...]:
    """The meshes with the values of groups, given as meshes of their own."""
    return tuple(
        replace(
            mesh,
            groups=tuple(
                GroupLight(
                    name,
                    lit[index].radiosity,
                    lit[index].irradiance,
                    lit[index].radiosity_back,
                    lit[index].irradiance_back,
                )
                for name, lit in groups
            ),
        )
        for index, mesh in enumerate(meshes)
    )
