# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What nodes that ask for the ray, or for the angle at which it meets a surface, tell light between diffuse surfaces.

Artists use them for what the camera alone shall see. The light that travels has left a diffuse surface, and meets the
next one at all angles.
"""

from collections.abc import Iterable

import bpy
import numpy as np

from ..core.transmittance import fresnel

_SEEN_BY_DIFFUSE_RAYS = {
    "Is Diffuse Ray": 1.0,
    "Is Reflection Ray": 1.0,
    "Ray Depth": 1.0,
    "Diffuse Depth": 1.0,
}
"""What a Light Path node tells a ray that left a diffuse surface; 0 for the rest."""

FACING = {"FRESNEL", "LAYER_WEIGHT"}
"""Nodes that tell the angle."""

_ANGLES = 32
"""Places of Gauss and Legendre at which Fresnel's formula is averaged over the cosine."""


def seen_by_diffuse_rays(identifier: str) -> float:
    """Return what an output of a Light Path node gives."""
    return _SEEN_BY_DIFFUSE_RAYS.get(identifier, 0.0)


def mean_facing(node: bpy.types.Node, identifier: str) -> float | None:
    """Return the mean of a Fresnel or Layer Weight node over light from all sides, None where its inputs are linked.

    Parameters
    ----------
    identifier : str
        Of its output.
    """
    given = next(socket for socket in node.inputs if socket.identifier in {"IOR", "Blend"})
    if given.is_linked:
        return None
    value = float(given.default_value)
    if node.type == "FRESNEL":
        return mean_fresnel(value)
    if identifier == "Fresnel":
        return mean_fresnel(1.0 / max(1.0 - value, 1e-5))
    # Cycles' own: 1 - cosine^e, of which light from all sides meets the share 1 - 2 / (e + 2).
    blend = min(max(value, 0.0), 1.0 - 1e-5)
    exponent = 2.0 * blend if blend < 0.5 else 0.5 / (1.0 - blend)
    return 1.0 - 2.0 / (exponent + 2.0)


def mean_fresnel(index: float) -> float:
    """Return the share of even light from all sides that a smooth surface of an index of refraction mirrors."""
    if index <= 1.0:
        return 0.0
    place, weight = np.polynomial.legendre.leggauss(_ANGLES)
    cosine = (0.5 + 0.5 * place).astype(np.float32)
    return float(weight @ (cosine * fresnel(cosine, np.full(_ANGLES, index, dtype=np.float32))))


def as_diffuse_rays_see(trees: Iterable[bpy.types.NodeTree]) -> None:
    """Have copied trees give what they give rays that leave a diffuse surface."""
    for tree in trees:
        for node in list(tree.nodes):
            if node.type == "LIGHT_PATH":
                for output in node.outputs:
                    set_output(tree, output, seen_by_diffuse_rays(output.identifier))


def as_seen_from_all_sides(trees: Iterable[bpy.types.NodeTree]) -> None:
    """Have what depends on the angle in copied trees give its mean."""
    for tree in trees:
        for node in list(tree.nodes):
            if node.type not in FACING:
                continue
            for output in node.outputs:
                value = mean_facing(node, output.identifier)
                if value is not None:
                    set_output(tree, output, value)


def set_output(tree: bpy.types.NodeTree, output: bpy.types.NodeSocket, value: float) -> None:
    """Have what is linked to an output of a copied tree take a number instead."""
    sockets = [link.to_socket for link in output.links]
    if sockets:
        constant = tree.nodes.new("ShaderNodeValue")
        constant.outputs[0].default_value = value
        for socket in sockets:
            tree.links.new(constant.outputs[0], socket)
