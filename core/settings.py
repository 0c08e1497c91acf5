# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a bake; the defaults live here and nowhere else."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .errors import SettingsError

METHODS = ("ADAPTIVE", "UNIFORM")
QUALITIES = ("DRAFT", "GOOD", "HIGH")
LARGEST = 2**31 - 1
"""Largest whole number that Blender's settings hold."""

OUTPUTS = ("REFINED", "ORIGINAL")
MATERIALS = ("AUTOMATIC", "PLAIN", "TEXTURED")
DOMAINS = ("CORNER", "POINT")
DATA_TYPES = ("FLOAT", "BYTE")
LONGEST_PREFIX = 32
"""Characters before the name of an attribute, which Blender cuts at 63 in some versions."""
LIGHTS = ("ALL", "IRRADIANCE", "DIRECT", "INDIRECT")


@dataclass(frozen=True)
class BakeSettings:
    """What a user may ask of a bake.

    Attributes
    ----------
    threshold : float
        A fragment is split while it receives more than this share of the energy that leaves some other fragment
        (Kulyasov & Nikulin 2010, step 4); 0 < threshold <= 1.
    minimum_size : float
        Length n in scene units: only what has a longest edge of m = 2n or more is split, so that no split makes a
        longest edge shorter than n. Faces are cut further only to fit together, and where another object hides part of
        them. Where the light decides which faces are split (adaptive, refined meshes), the patches that exchange it are
        no smaller than the automatic ones. 0 chooses it from the scene's size and the quality, and lets faces (not
        patches) become finer where light changes fast.
    method : str
        `'ADAPTIVE'` splits by form factors; `'UNIFORM'` splits everything down to the minimum size.
    quality : str
        `'DRAFT'`, `'GOOD'` or `'HIGH'`: rays for each fragment and vertex, and the automatic minimum size.
    output : str
        `'REFINED'` returns the subdivided meshes; `'ORIGINAL'` values at the corners of the input triangles.
    seed : int
        Seed of the sampling patterns; the same seed gives the same bytes.
    threads : int
        Threads that trace rays; 0 takes every core. The result does not depend on it.
    memory_limit : int
        What a bake may take beside the scene itself, in MiB; a small one gives fewer patches, vertices and rays, and
        a warning.
    patch_limit : int
        Patches that may exchange light, at most; 0 is no limit. Those that receive least of the others' light stay
        coarse, and triangles are clustered more coarsely where there are too many to begin with. Vertices are added
        where the light on the faces asks for it, whatever the patches.
    keep_transport : bool
        Whether the result holds what the rays met, so that it can be lit again; that, too, stays below the limit.
    light : str
        Which light the values hold: `'ALL'`, only what comes straight from what emits and from the world
        (`'DIRECT'`), or only what was reflected before (`'INDIRECT'`). Of whoever stores it: `'IRRADIANCE'` is all,
        but stored without the radiosity.
    light_groups : bool
        Whether the values are also given for each light group of the scene.
    domain, data_type : str
        Of whoever stores the result: at face corners or vertices, and in single precision or as 8-bit sRGB.
    byte_maximum : float
        W m^-2 sr^-1 that 8 bits reach up to; 0 takes the brightest value that there is.
    prefix : str
        What the names of the attributes begin with.
    material : str
        Of whoever stores the result: `'PLAIN'` shows the radiosity as it is, `'TEXTURED'` the irradiance on the
        colours and textures of the original materials, `'AUTOMATIC'` the latter where these vary over a surface.
    """

    threshold: float = 0.02
    minimum_size: float = 0.0
    method: str = "ADAPTIVE"
    quality: str = "GOOD"
    output: str = "REFINED"
    seed: int = 0
    threads: int = 0
    memory_limit: int = 2048
    patch_limit: int = 0
    keep_transport: bool = True
    light: str = "ALL"
    light_groups: bool = False
    domain: str = "CORNER"
    data_type: str = "FLOAT"
    byte_maximum: float = 0.0
    prefix: str = ""
    material: str = "AUTOMATIC"

    def __post_init__(self) -> None:
        if not (0.0 < self.threshold <= 1.0):
            raise SettingsError(f"Threshold is {self.threshold:g}; choose a value above 0 and up to 1")
        if not (math.isfinite(self.minimum_size) and self.minimum_size >= 0.0):
            raise SettingsError(
                f"Minimum size is {self.minimum_size:g}; choose a positive length, or 0 to have it chosen"
            )
        for name, value, allowed in (
            ("Method", self.method, METHODS),
            ("Quality", self.quality, QUALITIES),
            ("Output", self.output, OUTPUTS),
            ("Light", self.light, LIGHTS),
            ("Domain", self.domain, DOMAINS),
            ("Data type", self.data_type, DATA_TYPES),
            ("Material", self.material, MATERIALS),
        ):
            if value not in allowed:
                raise SettingsError(f"{name} is {value!r}; choose one of {', '.join(allowed)}")
        if not (math.isfinite(self.byte_maximum) and self.byte_maximum >= 0.0):
            raise SettingsError(
                f"The byte maximum is {self.byte_maximum:g}; choose a positive brightness, or 0 to have it chosen"
            )
        if len(self.prefix) > LONGEST_PREFIX or self.prefix.startswith("."):
            raise SettingsError(
                f"The prefix is {self.prefix!r}; choose up to {LONGEST_PREFIX} characters that begin with no dot"
            )
        if not 0 <= self.seed <= LARGEST:
            raise SettingsError(f"Seed is {self.seed}; choose 0 to {LARGEST}")
        if not 0 <= self.threads <= LARGEST:
            raise SettingsError(f"Threads is {self.threads}; choose 0 for all cores, or more")
        if not 64 <= self.memory_limit <= LARGEST:
            raise SettingsError(f"Memory limit is {self.memory_limit} MiB; choose 64 MiB or more")
        if not 0 <= self.patch_limit <= LARGEST:
            raise SettingsError(f"Patch limit is {self.patch_limit}; choose 0 for none, or more")
