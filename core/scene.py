# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as plain arrays: all that `core` ever knows of Blender."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Rec. 709 luminance of linear RGB."""


@dataclass(frozen=True, eq=False)
class Texture:
    """Colours that vary over triangles, each of which is cut evenly into small cells of one colour.

    Attributes
    ----------
    triangle : (k,) int
        The triangles that vary, in ascending order.
    part : (k,) int
        Vertices between triangles of the same part show the mean of them; other colours meet at a sharp edge.
    along : (k,) int
        Cells along each edge: a triangle has the square of it. Powers of two fit the midpoint splits of patches.
    colours : (cells, 3) float32
        Linear RGB of the cells of one triangle after the other, each triangle's as `core.textures.cell_centres` has
        them.
    """

    triangle: Ints
    part: Ints
    along: Ints
    colours: NDArray[np.float32]


@dataclass(frozen=True)
class LightLinking:
    """Which meshes the light of a lamp or of an emitting mesh is for. What they reflect is for all.

    Attributes
    ----------
    receivers : frozenset of int or None
        Indices into `Scene.meshes`: what it lights; None for all.
    blockers : frozenset of int or None
        What hides it; None for all.
    """

    receivers: frozenset[int] | None = None
    blockers: frozenset[int] | None = None


UNLINKED = LightLinking()
"""Light for all meshes, which all of them hide."""

GRAZING = 0.1
"""Cycles' default."""


@dataclass(frozen=True, eq=False)
class SurfaceMesh:
    """One mesh as it renders: world coordinates, triangles wound so that the front is counterclockwise.

    Attributes
    ----------
    name : str
        The object's name, for warnings.
    vertices : (v, 3) float, scene units
        World coordinates, in float64 (cancel large translations in float64 before anything is rounded).
    triangles : (t, 3) int
        Vertex indices. A transform of negative determinant needs its triangles turned over by whoever makes this.
    corner_normals : (t, 3, 3) float, unit
        World shading normal at each triangle corner; equal to the triangle's own normal where shading is flat.
    reflectance : (t, 3) float, 0..1
        Share of the light on each triangle that it sends on to others, evenly to all sides, linear RGB.
    emission : (t, 3) float, W m^-2 sr^-1
        Emitted radiance of each triangle, linear RGB; of both sides, as in Cycles, without `front_only`.
    baked : bool
        Whether values are wanted on this mesh; it takes part in the light transport either way.
    seen : bool
        Whether reflected light meets it. If not, it sends no light on that it receives, and hides none behind it.
    shadow : bool
        Whether it hides lamps and emitters.
    reflectance_texture, emission_texture : Texture or None
        Of the triangles over which they vary, in place of what is above.
    clear : (t,) bool or None
        Triangles that light goes through as if they were not there.
    translucence : (t, 3) float, 0..1, or None
        Share of the light on one side of each triangle that leaves the other side evenly in all directions, linear RGB.
    translucence_texture : Texture or None
        Of the triangles over which it varies.
    transmittance : (t, 3) float, 0..1, or None
        Share of the light that goes straight through each triangle, linear RGB. Reflectance and emission are what it
        leaves, as means over holes and all.
    transmittance_texture : Texture or None
        Of the triangles over which it varies.
    refraction : (t,) float or None
        Index of refraction of those that are the surface of glass, which reflects a part of what would go through; 1 of
        others.
    front_only : (t,) bool or None
        Triangles whose back does not emit.
    linking : LightLinking
        Of the light that it emits.
    grazing : float, 0..1
        Cosine between a smooth face and light of lamps below which it is grazing, so that shadow rays start above the
        face (Cycles' geometry offset of the shadow terminator); 0: nowhere.
    own_reflectance : (t, 3) float, 0..1, or None
        Diffuse albedo, by which its own colours show the light. None where all that it sends on is diffuse; gloss is
        sent on as well, and not shown, as it looks different from everywhere.
    own_reflectance_texture : Texture or None
        Of the triangles over which it varies.
    """

    name: str
    vertices: Floats
    triangles: Ints
    corner_normals: Floats
    reflectance: Floats
    emission: Floats
    baked: bool = True
    seen: bool = True
    shadow: bool = True
    reflectance_texture: Texture | None = None
    emission_texture: Texture | None = None
    clear: NDArray[np.bool_] | None = None
    translucence: Floats | None = None
    translucence_texture: Texture | None = None
    transmittance: Floats | None = None
    transmittance_texture: Texture | None = None
    refraction: Floats | None = None
    front_only: NDArray[np.bool_] | None = None
    linking: LightLinking = UNLINKED
    grazing: float = GRAZING
    own_reflectance: Floats | None = None
    own_reflectance_texture: Texture | None = None

    def emits(self) -> bool:
        """Whether it gives light anywhere."""
        texture = self.emission_texture
        return bool(np.any(self.emission)) or (texture is not None and bool(np.any(texture.colours)))

    def without_emission(self) -> SurfaceMesh:
        """The same mesh, dark."""
        return replace(self, emission=np.zeros_like(self.emission), emission_texture=None)

    def without_reflectance(self) -> SurfaceMesh:
        """The same mesh, black."""
        return replace(
            self,
            reflectance=np.zeros_like(self.reflectance),
            reflectance_texture=None,
            own_reflectance=None,
            own_reflectance_texture=None,
            translucence=None,
            translucence_texture=None,
        )

    def translucent(self) -> NDArray[np.bool_]:
        """Triangles of which one side sends on light of the other, (t,)."""
        some = np.zeros(len(self.triangles), dtype=bool)
        if self.translucence is not None:
            some |= (self.translucence > 0.0).any(axis=1)
        if self.translucence_texture is not None:
            some[self.translucence_texture.triangle] = True
        return some


@dataclass(frozen=True, eq=False)
class Cone:
    """How a spot's light fades away from its axis, as Cycles has it.

    Attributes
    ----------
    inverse : (3, 3) float
        Takes directions of the world to the lamp's own space, in which it shines along -z.
    cosine : float
        Of half the angle of the cone, outside of which it is dark.
    blend : float, 0..1
        Share of the cone, by cosines, over which light fades in.
    """

    inverse: Floats
    cosine: float
    blend: float


@dataclass(frozen=True, eq=False)
class Profile:
    """How bright a lamp is to each side, as of a measured one or one with a slide.

    Attributes
    ----------
    inverse : (3, 3) float
        Takes directions of the world to the lamp's own space, in which its axis is -z.
    reach : float, radians
        Up to which angle from the axis it is told.
    shares : (rows, columns) float, 0..1
        Of the strength: rows in the middles of even steps from the axis to the reach, columns at even steps from +x
        to +y.
    """

    inverse: Floats
    reach: float
    shares: Floats


@dataclass(frozen=True)
class Falloff:
    """How a lamp's light falls off otherwise than with the square of the distance d: multiplied by d^n d^2 / (s + d^2).

    Attributes
    ----------
    power : int
        n: 1 to fall off with the distance, 2 not to fall off.
    smooth : float, scene units squared
        s: by how much it is less near the lamp.
    """

    power: int
    smooth: float


@dataclass(frozen=True, eq=False)
class PointLamp:
    """A lamp that shines to all sides, or as a spot. Rays do not meet it.

    Attributes
    ----------
    name : str
    centre : (3,) float, scene units
    radius : float, scene units
        0 casts hard shadows.
    strength : (3,) float, W sr^-1
        Radiant intensity in linear RGB, where cone and profile take nothing away.
    soft : bool
        Whether it is a disk that faces whoever looks at it, in place of a sphere.
    cone : Cone or None
    shadow : bool
        Whether surfaces hide it.
    linking : LightLinking
    profile : Profile or None
    falloff : Falloff or None
    """

    name: str
    centre: Floats
    radius: float
    strength: Floats
    soft: bool = False
    cone: Cone | None = None
    shadow: bool = True
    linking: LightLinking = UNLINKED
    profile: Profile | None = None
    falloff: Falloff | None = None

    @property
    def is_even(self) -> bool:
        """Whether it shines to all sides alike, and falls off with the square of the distance."""
        return self.cone is None and self.profile is None and self.falloff is None


@dataclass(frozen=True, eq=False)
class AreaLamp:
    """A rectangle or an ellipse whose front shines. Rays do not meet it.

    Attributes
    ----------
    name : str
    centre : (3,) float, scene units
    half_axes : (2, 3) float, scene units
        From the centre to the middles of two neighbouring edges.
    normal : (3,) float, unit
        Where it shines to.
    strength : (3,) float, W m^-2 sr^-1
        Radiance, in linear RGB, that gives the lamp's power were it even to all sides.
    elliptic : bool
    spread : float, radians
        Angle of the cone that its light stays in; pi for a lamp that looks equally bright from all sides.
    shadow : bool
    linking : LightLinking
    """

    name: str
    centre: Floats
    half_axes: Floats
    normal: Floats
    strength: Floats
    elliptic: bool = False
    spread: float = np.pi
    shadow: bool = True
    linking: LightLinking = UNLINKED


@dataclass(frozen=True, eq=False)
class SunLamp:
    """A disk so far away that it is seen in the same direction from everywhere.

    Attributes
    ----------
    name : str
    direction : (3,) float, unit
        In which its light travels.
    angle : float, radians
        That its diameter is seen at; 0 casts hard shadows.
    strength : (3,) float, W m^-2
        Irradiance of a surface that faces it, in linear RGB.
    shadow : bool
    of_world : bool
        Whether it stands for a bright part of the world.
    linking : LightLinking
    """

    name: str
    direction: Floats
    angle: float
    strength: Floats
    shadow: bool = True
    of_world: bool = False
    linking: LightLinking = UNLINKED


Lamp = PointLamp | AreaLamp | SunLamp


@dataclass(frozen=True)
class LightGroup:
    """What gives light under one name; light of what no group names belongs to none.

    Attributes
    ----------
    name : str
    meshes, lamps : frozenset of int
        Indices into `Scene.meshes` and `Scene.lamps`.
    world : bool
    """

    name: str
    meshes: frozenset[int] = frozenset()
    lamps: frozenset[int] = frozenset()
    world: bool = False


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything that takes part in the light transport.

    Attributes
    ----------
    meshes : tuple of SurfaceMesh
        In a fixed order; results refer to them by index.
    world : (3,) or (cells, 3) float, W m^-2 sr^-1
        Radiance that a ray meets when it leaves the scene: the same in all directions, or a map of `core.world`.
    lamps : tuple of Lamp
        In a fixed order.
    light_groups : tuple of LightGroup
        No two of which share anything.
    """

    meshes: tuple[SurfaceMesh, ...]
    world: Floats
    lamps: tuple[Lamp, ...] = ()
    light_groups: tuple[LightGroup, ...] = ()


def surface_mesh(
    name: str,
    vertices: object,
    triangles: object,
    *,
    reflectance: object = (0.0, 0.0, 0.0),
    emission: object = (0.0, 0.0, 0.0),
    corner_normals: object | None = None,
    baked: bool = True,
    seen: bool = True,
    shadow: bool = True,
) -> SurfaceMesh:
    """Make a `SurfaceMesh` from anything array-like, colours given once or for each triangle.

    Parameters
    ----------
    vertices : (v, 3) array_like, scene units
    triangles : (t, 3) array_like of int
    reflectance, emission : (3,) or (t, 3) array_like
    corner_normals : (t, 3, 3) array_like or None
        None shades flat: every corner takes its triangle's normal (zero for a triangle without area).
    """
    points = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    corners = np.array(triangles, dtype=np.int64).reshape(-1, 3)
    if corner_normals is None:
        a, b, c = (points[corners[:, k]] for k in range(3))
        with np.errstate(invalid="ignore", over="ignore"):
            normal = np.cross(b - a, c - a)
            length = np.linalg.norm(normal, axis=1, keepdims=True)
            normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
        normals = np.repeat(normal[:, None, :], 3, axis=1)
    else:
        normals = np.array(corner_normals, dtype=np.float64).reshape(-1, 3, 3)
    shape = (len(corners), 3)
    return SurfaceMesh(
        name,
        points,
        corners,
        normals,
        np.array(np.broadcast_to(np.asarray(reflectance, dtype=np.float64), shape)),
        np.array(np.broadcast_to(np.asarray(emission, dtype=np.float64), shape)),
        baked,
        seen,
        shadow,
    )
