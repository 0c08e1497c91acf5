# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the shaders of a node tree do to light."""

from typing import NamedTuple

import bpy
import numpy as np

from .gloss import index_at_level, mean_gloss, mean_sheen
from .node_links import input_of, source_of, title_of
from .node_values import ValueReader, mixed, number_of
from .surface import Colour, Surface, alike, surface_of
from .varying import Value, combined, varies

GREY = 0.8
"""Reflectance of a mesh without a material: what Blender's own default shows."""

_DIFFUSE_LIKE = {
    "SUBSURFACE_SCATTERING": "scatters light below the surface",
    "BSDF_TOON": "is no physical shader",
}

GLOSSY = {"BSDF_GLOSSY": "Color", "BSDF_METALLIC": "Base Color"}
"""Shaders that mirror, and the inputs by which they colour what they mirror."""

NOT_DIFFUSE = {
    "BSDF_GLOSSY",
    "BSDF_METALLIC",
    "BSDF_GLASS",
    "BSDF_REFRACTION",
    "BSDF_TRANSPARENT",
    "BSDF_HAIR",
    "BSDF_HAIR_PRINCIPLED",
    "HOLDOUT",
}

_TURNS_NORMALS = {"NORMAL_MAP": "normal map is", "BUMP": "bump is"}

_MIRRORS = "shows no diffuse light and is black itself; what it mirrors lights others, evenly from all sides"


class _Shares(NamedTuple):
    """What happens to the light that meets a shader, as of `Surface`, and what it emits."""

    reflectance: Value = np.zeros(3)
    emission: Value = np.zeros(3)
    through: Value = np.zeros(3)
    translucence: Value = np.zeros(3)
    mirrored: Value = np.zeros(3)
    covered: Value = np.zeros(3)


class ShaderReader:
    """Follows the links of one node tree from its output to what its shaders do.

    Parameters
    ----------
    with_textures, back : bool
        As of `ValueReader`.
    """

    def __init__(self, tree: bpy.types.NodeTree, with_textures: bool = False, back: bool = False) -> None:
        self._tree = tree
        self._values = ValueReader(with_textures, back)
        self._refraction = 1.0

    @property
    def asked_for_side(self) -> bool:
        """Whether something depends on the side that is seen."""
        return self._values.asked_for_side

    def surface(self) -> Surface:
        """Return what the tree does to light."""
        output = self._tree.get_output_node("CYCLES")
        if output is None:
            return surface_of()
        if self._values.with_textures and input_of(output, "Volume").is_linked:
            self._values.notes.append("its volume is left out")
            if not input_of(output, "Surface").is_linked:
                return surface_of(notes=self._values.notes, through=1.0)
        shares = self._shader(input_of(output, "Surface"), ())
        reflectance, emission, through, translucence, mirrored, covered = shares
        if not varies(through):
            through = np.clip(through, 0.0, 1.0)
        if not varies(emission) and np.any(emission < 0.0):
            self._values.notes.append("its emission is negative; it was taken for zero")
            emission = np.maximum(emission, 0.0)
        notes, unread = dict.fromkeys(self._values.notes), dict.fromkeys(self._values.unread)
        covered = combined(number_of, covered)
        return surface_of(
            reflectance, emission, notes, unread, through, self._refraction, translucence, mirrored, covered
        )

    def _shader(self, socket, groups) -> _Shares:
        """Return what happens to light at whatever is linked to a shader socket; an open one is black."""
        output, groups = source_of(socket, groups)
        if output is None:
            return _Shares()
        node = output.node
        self._tell_normal(node, groups)
        if node.type == "BSDF_PRINCIPLED":
            return self._principled(node, groups)
        if node.type in {"EMISSION", "BACKGROUND"}:
            colour, strength = self._values.colour(node, "Color", groups), self._values.value(node, "Strength", groups)
            return _Shares(emission=combined(np.multiply, colour, strength))
        if node.type == "BSDF_DIFFUSE":
            self._tell_roughness(node, "Roughness")
            return _Shares(self._values.colour(node, "Color", groups))
        if node.type == "BSDF_SHEEN":
            share = mean_sheen(self._plain(node, "Roughness"))
            return _Shares(combined(lambda colour: share * colour, self._values.colour(node, "Color", groups)))
        if node.type == "BSDF_TRANSLUCENT":
            return _Shares(translucence=self._values.colour(node, "Color", groups))
        if node.type == "BSDF_TRANSPARENT":
            return _Shares(through=self._values.colour(node, "Color", groups))
        if node.type in {"BSDF_GLASS", "BSDF_REFRACTION"}:
            if node.type == "BSDF_GLASS":
                self._refract(node, groups)
            return _Shares(through=self._values.colour(node, "Color", groups))
        if node.type == "MIX_SHADER":
            share = self._values.share(node, "Fac", groups)
            if not varies(share) and share in (0.0, 1.0):
                return self._shader(node.inputs[1 + int(share)], groups)
            first, second = self._shader(node.inputs[1], groups), self._shader(node.inputs[2], groups)
            return _Shares(*(_mix(share, a, b) for a, b in zip(first, second, strict=True)))
        if node.type == "ADD_SHADER":
            first, second = self._shader(node.inputs[0], groups), self._shader(node.inputs[1], groups)
            return _Shares(*(combined(np.add, a, b) for a, b in zip(first, second, strict=True)))
        return self._unsupported(node, groups)

    def _tell_normal(self, node, groups) -> None:
        """Name what turns the normals by which a shader is lit."""
        normal = next((socket for socket in node.inputs if socket.identifier == "Normal"), None)
        source, _ = (None, ()) if normal is None else source_of(normal, groups)
        # What the geometry has is what an open socket takes.
        if source is not None and (source.node.type, source.identifier) != ("NEW_GEOMETRY", "Normal"):
            what = _TURNS_NORMALS.get(source.node.type, "normals by nodes are")
            self._values.notes.append(f"its {what} left out; the mesh's own normals count")

    def _principled(self, node, groups) -> _Shares:
        opaque = self._values.share(node, "Alpha", groups)
        metal, glass = (self._values.share(node, name, groups) for name in ("Metallic", "Transmission Weight"))
        mirrored = np.zeros(3)
        if varies(metal) or metal > 0.0:
            self._values.notes.append(f"Metallic {_MIRRORS}")
            mirrored = combined(
                np.multiply, self._values.colour(node, "Base Color", groups), combined(np.multiply, opaque, metal)
            )
        diffuse = combined(lambda alpha, m, g: alpha * (1.0 - m) * (1.0 - g), opaque, metal, glass)
        reflectance = np.zeros(3)
        if varies(diffuse) or diffuse > 0.0:
            reflectance = combined(np.multiply, self._values.colour(node, "Base Color", groups), diffuse)
        through = combined(lambda alpha: (1.0 - alpha) * np.ones(3), opaque)
        if varies(glass) or glass > 0.0:
            self._refract(node, groups)
            colour = self._values.colour(node, "Base Color", groups)
            through = combined(_through_glass, through, opaque, metal, glass, colour)
        strength = combined(np.multiply, self._values.value(node, "Emission Strength", groups), opaque)
        emission = np.zeros(3)
        if varies(strength) or strength != 0.0:
            emission = combined(np.multiply, self._values.colour(node, "Emission Color", groups), strength)
        coat = self._coat(node)
        if np.any(coat != 1.0):
            reflectance, emission, mirrored = (
                combined(np.multiply, colour, coat) for colour in (reflectance, emission, mirrored)
            )
        self._tell_roughness(node, "Diffuse Roughness")
        below = input_of(node, "Subsurface Weight")
        if below.is_linked or below.default_value > 0.0:
            self._values.notes.append("light that scatters below its surface counts as diffuse")
        covered = combined(lambda share: self._layers(node) * share * np.ones(3), diffuse)
        return _Shares(reflectance, emission, through, mirrored=combined(np.add, mirrored, covered), covered=covered)

    def _coat(self, node) -> Colour:
        """Return the share of light that the tint of a coat lets through to what is below, and back."""
        weight = np.clip(self._plain(node, "Coat Weight"), 0.0, 1.0)
        return mixed(weight, np.ones(3), np.array(input_of(node, "Coat Tint").default_value[:3]))

    def _tell_roughness(self, node, identifier: str) -> None:
        socket = next((socket for socket in node.inputs if socket.identifier == identifier), None)
        if socket is not None and (socket.is_linked or socket.default_value > 0.0):
            self._values.notes.append(f"the roughness of its diffuse reflection ({identifier}) is left out")

    def _layers(self, node) -> float:
        """Return the share that the clear layers and the sheen of a Principled BSDF mirror."""

        def plain(name: str) -> float:
            return self._plain(node, name)

        index = index_at_level(plain("IOR"), plain("Specular IOR Level"))
        passed = 1.0 - mean_gloss(plain("Roughness"), index)
        passed *= 1.0 - plain("Coat Weight") * mean_gloss(plain("Coat Roughness"), plain("Coat IOR"))
        passed *= 1.0 - plain("Sheen Weight") * mean_sheen(plain("Sheen Roughness"))
        return 1.0 - passed

    @staticmethod
    def _plain(node, identifier: str) -> float:
        """Return the number set on an input, whatever is linked to it, which is near enough for gloss."""
        return float(input_of(node, identifier).default_value)

    def _refract(self, node, groups) -> None:
        index = self._values.value(node, "IOR", groups)
        self._refraction = max(self._refraction, 1.0 if varies(index) else float(index))

    def _unsupported(self, node, groups) -> _Shares:
        name = title_of(node)
        if node.type in _DIFFUSE_LIKE:
            self._values.notes.append(f"{name} {_DIFFUSE_LIKE[node.type]}; it counts as diffuse")
            return _Shares(self._values.colour(node, "Color", groups))
        if node.type in GLOSSY:
            self._values.notes.append(f"{name} {_MIRRORS}")
            return _Shares(mirrored=self._values.colour(node, GLOSSY[node.type], groups))
        if node.type in NOT_DIFFUSE:
            self._values.notes.append(f"{name} reflects no diffuse light; that part counts as black")
            return _Shares()
        self._values.leave(name, f"{name} is not supported; that part counts as grey")
        return _Shares(np.full(3, GREY))


def _mix(share: Value, first: Value, second: Value) -> Value:
    """Return a mix of two colours, which does not vary where both are the same."""
    return first if alike(first, second) else combined(mixed, share, first, second)


def _through_glass(through, opaque, metal, glass, colour):
    """Return what goes through one surface of a Principled BSDF; both of a pane multiply to its base colour."""
    return through + opaque * (1.0 - metal) * glass * np.sqrt(np.clip(colour, 0.0, 1.0))
