# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps whose nodes make them brighter in one direction than in another, as IES files and slides do.

Cycles lights the inside of a ball around the lamp, once with its nodes and once without.
"""

from dataclasses import dataclass, replace

import bpy
import numpy as np
from mathutils import Matrix

from ..core.errors import BakeError
from ..core.scene import Floats, PointLamp, Profile
from .light_paths import as_diffuse_rays_see
from .node_links import all_trees, own_trees
from .scratch import bake_in, scratch_scene

ROWS, COLUMNS = 180, 240
"""Directions that are looked at: from the lamp's axis outwards, in the middles of as many even steps, and around it."""

EVEN = 1e-4
"""Deviation up to which a lamp counts as equally bright to all sides, and two channels as alike."""

_DARK = 1e-3
"""Share of the most light below which the edge of a spot is too dark to compare with."""

_ATTRIBUTE = "Radiosity Scratch"


class NoProfileError(Exception):
    """The nodes of a lamp could not be evaluated; the text says why, in brackets."""


def may_have_profile(light: bpy.types.Light) -> bool:
    """Return whether what the nodes of a lamp make of it depends on the direction at most, and not on the distance."""
    if light.type not in {"POINT", "SPOT"}:
        return False
    nodes = [node for tree in all_trees(light.node_tree) for node in tree.nodes]
    return not any(_asks_for_distance(node) for node in nodes)


def _asks_for_distance(node: bpy.types.Node) -> bool:
    linked = {socket.identifier for socket in node.outputs if socket.is_linked}
    if node.type == "LIGHT_FALLOFF":
        smooth = node.inputs["Smooth"]
        return bool(linked - {"Quadratic"}) or (bool(linked) and (smooth.is_linked or smooth.default_value != 0.0))
    return node.type == "LIGHT_PATH" and "Ray Length" in linked


@dataclass(frozen=True, eq=False)
class Profiles:
    """What the nodes of a lamp multiply its light by.

    Attributes
    ----------
    most : (3,) float
        In the brightest direction of each channel.
    reach : float, radians
        As of `Profile`.
    shares : (3, rows, columns) float or None
        Those of `Profile`, of each channel; None where the lamp is equally bright to all sides.
    """

    most: Floats
    reach: float
    shares: Floats | None


def unturned(light: bpy.types.Light, axes: Floats) -> Floats:
    """Return axes in which the nodes of a lamp tell the same of its own directions: where they can be, unturned ones.

    Lamps of the same data, each turned otherwise, then have the same.
    """
    if any(_asks_for_world(node) for tree in all_trees(light.node_tree) for node in tree.nodes):
        return axes
    # The stretch that comes before the turn (polar decomposition).
    _, lengths, ways = np.linalg.svd(axes)
    # Rounding may leave zeros of either sign, which tell lamps apart.
    return np.round((ways.T * lengths) @ ways, 6) + 0.0


def _asks_for_world(node: bpy.types.Node) -> bool:
    linked = {socket.identifier for socket in node.outputs if socket.is_linked}
    if node.type == "TEX_COORD":
        return bool(linked - {"Normal", "UV", "Generated"}) or node.object is not None
    return node.type in {"NEW_GEOMETRY", "VECT_TRANSFORM", "CAMERA", "OBJECT_INFO", "SCRIPT"}


def profiles_of(light: bpy.types.Light, axes: Floats) -> Profiles:
    """Return what the nodes of a lamp multiply its light by.

    Parameters
    ----------
    light : Light
        The original data of a point or spot lamp.
    axes : (3, 3) float
        From its space to the world's, without its place: as of `unturned`.

    Raises
    ------
    NoProfileError
    """
    reach = np.pi if light.type == "POINT" else light.spot_size / 2.0
    try:
        factors = _factors(light, axes, reach)
    except (BakeError, RuntimeError) as error:
        raise NoProfileError(str(error).removeprefix("Error: ").strip().rstrip(".")) from error
    most = factors.max(axis=(0, 1))
    shares = np.moveaxis(factors / np.where(most > 0.0, most, 1.0), 2, 0)
    return Profiles(most, reach, shares if np.ptp(shares, axis=(1, 2)).max() > EVEN else None)


def with_profile(lamp: PointLamp, profiles: Profiles, axes: Floats) -> tuple[PointLamp, ...]:
    """Return what stands for a lamp with nodes: itself, or one for each channel that is brighter elsewhere than others.

    Parameters
    ----------
    lamp : PointLamp
        As it is without nodes.
    axes : (3, 3) float
        From its space to the world's, without its place.
    """
    strength = lamp.strength * profiles.most
    lit = np.flatnonzero(strength > 0.0)
    if profiles.shares is None or not len(lit):
        return (replace(lamp, strength=strength),)
    shares = profiles.shares[lit]
    inverse = np.linalg.inv(axes)
    if np.abs(shares - shares[0]).max() <= EVEN:
        return (replace(lamp, strength=strength, profile=Profile(inverse, profiles.reach, shares[0])),)
    return tuple(
        replace(lamp, strength=np.eye(3)[k] * strength, profile=Profile(inverse, profiles.reach, of_channel))
        for k, of_channel in zip(lit, shares, strict=True)
    )


def _factors(light: bpy.types.Light, axes: Floats, reach: float) -> Floats:
    """Return what the nodes multiply the light by in each direction, (rows, columns, 3)."""
    with scratch_scene() as scene:
        scene.frame_current = bpy.context.scene.frame_current
        ball = _ball(axes, reach)
        scene.collection.objects.link(ball)
        plain = bpy.data.lights.new(_ATTRIBUTE, light.type)
        made = light.copy()
        trees = list(own_trees(made.node_tree))
        as_diffuse_rays_see(trees)
        found = []
        for data in (made, plain):
            _make_a_point(data)
            if light.type == "SPOT":
                data.spot_size, data.spot_blend = light.spot_size, 0.0
            shown = bpy.data.objects.new(_ATTRIBUTE, data)
            shown.matrix_world = Matrix(axes).to_4x4()
            scene.collection.objects.link(shown)
            bake_in(scene, ball, type="DIFFUSE", pass_filter={"DIRECT"}, target="VERTEX_COLORS")
            colours = np.empty(4 * len(ball.data.vertices), dtype=np.float32)
            ball.data.color_attributes[_ATTRIBUTE].data.foreach_get("color", colours)
            found.append(colours.reshape(ROWS, COLUMNS, 4)[..., :3].astype(np.float64))
            scene.collection.objects.unlink(shown)
    factors, even = np.maximum(np.nan_to_num(found[0], posinf=0.0), 0.0), found[1]
    compared = even[..., 0] > _DARK * even.max()
    factors[compared] /= even[compared]
    # The rim of a spot is as what is beside it.
    for row in range(1, ROWS):
        factors[row] = np.where(compared[row][:, None], factors[row], factors[row - 1])
    return factors


def _make_a_point(light: bpy.types.Light) -> None:
    """Have a copied lamp shine white from one point through everything."""
    light.color, light.energy, light.shadow_soft_size, light.use_shadow = (1.0, 1.0, 1.0), 1.0, 0.0, False
    for name, value in (("exposure", 0.0), ("use_temperature", False), ("normalize", True)):
        if hasattr(light, name):
            setattr(light, name, value)


def _ball(axes: Floats, reach: float) -> bpy.types.Object:
    """Return an object that faces inwards, its vertices the directions in which a profile is looked at."""
    away, turn = np.meshgrid(
        (np.arange(ROWS) + 0.5) * (reach / ROWS), np.arange(COLUMNS) * (2.0 * np.pi / COLUMNS), indexing="ij"
    )
    local = np.stack([np.sin(away) * np.cos(turn), np.sin(away) * np.sin(turn), -np.cos(away)], axis=-1)
    ways = local.reshape(-1, 3) @ axes.T
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    corner = np.arange(ROWS * COLUMNS).reshape(ROWS, COLUMNS)
    after = np.roll(corner, -1, axis=1)
    faces = np.stack([corner[:-1], corner[1:], after[1:], after[:-1]], axis=-1).reshape(-1, 4)
    inwards = faces if np.linalg.det(axes) > 0.0 else faces[:, ::-1]
    mesh = bpy.data.meshes.new(_ATTRIBUTE)
    mesh.from_pydata(ways.tolist(), [], inwards.tolist())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), dtype=bool))
    mesh.normals_split_custom_set_from_vertices((-ways).tolist())
    mesh.color_attributes.active_color = mesh.color_attributes.new(_ATTRIBUTE, "FLOAT_COLOR", "POINT")
    return bpy.data.objects.new(_ATTRIBUTE, mesh)
