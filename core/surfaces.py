# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""All meshes of a scene joined into one set of sound triangles, with what is wrong with them said."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import NothingToBakeError
from .geometry import (
    corner_angles,
    cross,
    frame,
    lengths,
    normalized,
    triangle_areas,
    triangle_cross,
    triangle_shells,
    welded,
)
from .limits import LARGEST_COORDINATE, lamp_warnings, light_warnings, sound_lamp, sound_light
from .planes import share_planes
from .scene import Floats, Ints, Lamp, LightLinking, Scene, SurfaceMesh, Texture
from .textures import joined, mean_colours, with_means
from .transmittance import Transmittance, of_opaque, transmittance_of

SMALLEST_AREA = 1e-14
"""Triangles with less than this share of the squared extent of the frame have no area that float32 rays could meet."""

LARGEST_SLANTED = 16.0
"""Extents of the frame above which triangles are left out, unless they are square to an axis, which rays meet exactly:
float32 has the plane of larger ones off by as much as rays start off it, so that they would shade themselves."""

LARGEST_SQUARE = 4096.0
"""The same for all triangles: float32 tells places on larger ones apart no better than what stands there is large."""

TURNS = 1e-5
"""Difference between the normals of a triangle's corners from which on it is shaded as a curved surface."""

HAIR = 8e-7
"""How much solids are made smaller for rays, in units of the extent that the scene would have if it ended with them: 13
steps between neighbouring float32, and less than rays start off their surface."""

HAIR_STEPS = 4
"""Steps for each doubling of that extent in which it grows with them: up to a fifth more than it need be."""


@dataclass(frozen=True, eq=False)
class Surfaces:
    """Every triangle with an area, of every mesh, in world coordinates.

    Attributes
    ----------
    points : (v, 3) float, scene units
        The vertices of all meshes, one mesh after the other.
    place_of_point : (v,) int
        The lowest vertex of the same mesh at the same place: edges are compared by places.
    triangles : (t, 3) int
    normals : (t, 3) float, unit
    areas : (t,) float
    corner_normals : (t, 3, 3) float, unit
    reflectance, emission : (t, 3) float
        Means, where they vary.
    reflectance_texture, emission_texture : Texture or None
        How they vary over some of the triangles.
    own_reflectance : (t, 3) float or None
        Mean share of the light on them by which they show it; None where that is all that they send on, and
    own_reflectance_texture : Texture or None
        how it varies.
    translucence : (t, 3) float or None
        Mean share of the light on one side that leaves the other; None where there is none, and
    translucence_texture : Texture or None
        how it varies.
    mesh_of_triangle, input_triangle : (t,) int
        The mesh, and the triangle's number in it.
    first_point_of_mesh : (meshes + 1,) int
    shell_of_triangle : (t,) int
        Connected pieces, over all meshes.
    closed : (shells,) bool
        Whether the shell has an inside.
    baked : (t,) bool
    seen, shadow : (t,) bool
        Whether reflected light meets it, and whether it hides lamps and emitters.
    transmittance : Transmittance or None
        What goes straight through triangles; None where nothing does.
    front_only : (t,) bool
        Whether only the front emits.
    linking : tuple of LightLinking
        Of the emission of each mesh.
    grazing : (meshes,) float
        Cosine below which light is grazing on each.
    extent : float
        Largest edge of the bounding box.
    world : (3,) or (cells, 3) float
    lamps : tuple of Lamp
        As `core.limits` takes them.
    warnings : tuple of str
        What is wrong with the triangles, and
    colour_warnings : tuple of str
        with their colours.
    """

    points: Floats
    place_of_point: Ints
    triangles: Ints
    normals: Floats
    areas: Floats
    corner_normals: Floats
    reflectance: Floats
    emission: Floats
    reflectance_texture: Texture | None
    emission_texture: Texture | None
    own_reflectance: Floats | None
    own_reflectance_texture: Texture | None
    translucence: Floats | None
    translucence_texture: Texture | None
    mesh_of_triangle: Ints
    input_triangle: Ints
    first_point_of_mesh: Ints
    shell_of_triangle: Ints
    closed: NDArray[np.bool_]
    baked: NDArray[np.bool_]
    seen: NDArray[np.bool_]
    shadow: NDArray[np.bool_]
    transmittance: Transmittance | None
    front_only: NDArray[np.bool_]
    linking: tuple[LightLinking, ...]
    grazing: Floats
    extent: float
    world: Floats
    lamps: tuple[Lamp, ...]
    warnings: tuple[str, ...]
    colour_warnings: tuple[str, ...]

    def traced_points(self) -> Floats:
        """The points as rays are to meet them, (v, 3): solids are smaller by a hair, sheets back to back are apart.

        Where a cupboard stands against a wall, two faces lie in one plane, and a ray from inside the cupboard met by
        chance its back or the wall, as if the cupboard were open to the room. Where rooms of sheets lie beside each
        other, it met the wall of the one or of the other.
        """
        solid = self._solid[self.shell_of_triangle]
        apart = self._back_to_back()
        moved = self.points - self.hair * self._way(np.flatnonzero(solid))
        result: Floats = moved + self._hair_of(self.triangles[apart]) * self._way(np.flatnonzero(apart))
        return result

    def _way(self, chosen: Ints) -> Floats:
        """Mean normals of some triangles at their points, (v, 3), of length 1, zero elsewhere.

        By their angles: of a face that is cut into a fan at a corner all parts together count as the face.
        """
        corners = self.triangles[chosen]
        weighted = np.repeat(self.normals[chosen], 3, axis=0) * corner_angles(self.points[corners]).reshape(-1, 1)
        place = self.place_of_point[corners].ravel()
        sums = [np.bincount(place, weights=column, minlength=len(self.points)) for column in weighted.T]
        way: Floats = normalized(np.stack(sums, axis=1))[self.place_of_point]
        return way

    @cached_property
    def hair(self) -> float:
        """How much solids are smaller for rays, scene units."""
        return self._hair_of(self._of_solids)

    def _hair_of(self, triangles: Ints) -> float:
        """How much some triangles (k, 3) are moved for rays, scene units."""
        middle, extent = frame(self.points[self.triangles.ravel()])
        # On a wide ground, rays are as fine near its middle as the coordinates there, which are small. In steps, as the
        # points of all solids would move when one of them does.
        reach = 2.0 * float(np.abs(self.points[triangles] - middle).max(initial=0.0))
        if reach == 0.0:
            return 0.0
        steps = np.ceil(HAIR_STEPS * np.log2(reach / extent))
        return HAIR * extent * float(min(np.exp2(steps / HAIR_STEPS), 1.0))

    @cached_property
    def _of_solids(self) -> Ints:
        """Triangles of what has an inside, (k, 3)."""
        return self.triangles[self._solid[self.shell_of_triangle]]

    @cached_property
    def _solid(self) -> NDArray[np.bool_]:
        """Whether each shell has an inside, which its normals look away from, (shells,)."""
        return self.closed & (signed_volumes(self) > 0.0)

    @cached_property
    def stands_for_curved(self) -> NDArray[np.bool_]:
        """Triangles that are shaded smooth and turn, in place of a curved surface, (t,)."""
        turns = (np.abs(self.corner_normals - self.corner_normals[:, :1]) > TURNS).any(axis=(1, 2))
        found: NDArray[np.bool_] = turns & (self.grazing[self.mesh_of_triangle] > 0.0)
        return found

    def _back_to_back(self) -> NDArray[np.bool_]:
        """Triangles of sheets in one plane with others, of another sheet, that look the other way, (t,).

        Rooms that are closed are sheets as others are, around the space that their normals look into.
        """
        sheets = np.flatnonzero(~self._solid[self.shell_of_triangle])
        corners, shell = self.points[self.triangles[sheets]], self.shell_of_triangle[sheets]
        result = np.zeros(len(self.triangles), dtype=bool)
        result[sheets] = share_planes(self.normals[sheets], corners, shell, self.extent)[1]
        return result

    def doubled(self) -> NDArray[np.bool_]:
        """Triangles on a side of which others may lie, (t,): solids bury what they stand on."""
        corners = self.points[self.triangles]
        alike, opposed = share_planes(self.normals, corners, self.shell_of_triangle, self.extent)
        result: NDArray[np.bool_] = alike | self._back_to_back() | _repeated(self.place_of_point[self.triangles])
        # A solid that is there again, turned inside out, is no sheet, and nothing stands on it.
        facing = np.flatnonzero(opposed)
        _, place = np.unique(corners[facing].reshape(-1, 3), axis=0, return_inverse=True)
        result[facing] |= _repeated(place.reshape(-1, 3))
        return result

    def blockers(self) -> dict[frozenset[int], NDArray[np.bool_]]:
        """The triangles that hide light of some blockers only, (t,), by these."""
        sets = {linking.blockers for linking in (*self.linking, *(lamp.linking for lamp in self.lamps))} - {None}
        return {
            chosen: self.shadow & np.isin(self.mesh_of_triangle, list(chosen)) for chosen in sets if chosen is not None
        }

    def own_colours(self) -> tuple[Floats, Texture | None]:
        """The reflectance by which triangles show the light on them, (t, 3), and how it varies."""
        if self.own_reflectance is None:
            return self.reflectance, self.reflectance_texture
        return self.own_reflectance, self.own_reflectance_texture

    def reflectance_over(self, triangle: Ints, corners: Floats) -> Floats:
        """Mean reflectance over parts of triangles, (n, 3), whose corners have barycentric coordinates (n, 3, 3)."""
        return mean_colours(self.reflectance, self.reflectance_texture, triangle, corners)

    def emission_over(self, triangle: Ints, corners: Floats) -> Floats:
        """Mean emission over parts of triangles, (n, 3), as `reflectance_over`."""
        return mean_colours(self.emission, self.emission_texture, triangle, corners)

    def translucence_over(self, triangle: Ints, corners: Floats) -> Floats:
        """Mean translucence over parts of triangles, (n, 3), as `reflectance_over`."""
        if self.translucence is None:
            return np.zeros((len(triangle), 3))
        return mean_colours(self.translucence, self.translucence_texture, triangle, corners)

    def of_opaque_parts(self, colours: Floats, triangle: Ints, corners: Floats) -> Floats:
        """Means over parts of triangles, 0 to 1, as those of what is opaque of them, which rays meet, (n, 3)."""
        if self.transmittance is None:
            return colours
        return np.minimum(of_opaque(colours, self.transmittance.opacity_over(triangle, corners)), 1.0)

    def vary(self, triangle: Ints) -> NDArray[np.bool_]:
        """Whether the reflectance that rays meet on triangles (n,) is not that of the whole triangle, (n,)."""
        some = self.let_pass()
        if self.reflectance_texture is not None:
            some[self.reflectance_texture.triangle] = True
        return some[triangle]

    def let_pass(self) -> NDArray[np.bool_]:
        """Triangles that let a part of the light through, straight or not, (t,)."""
        clear = self.transmittance is not None and self.transmittance.some
        return clear | self.translucent()

    def translucent(self) -> NDArray[np.bool_]:
        """Triangles of which one side sends on light of the other, (t,)."""
        if self.translucence is None:
            return np.zeros(len(self.triangles), dtype=bool)
        return self.translucence.any(axis=1)

    def recoloured(self, scene: Scene) -> Surfaces:
        """The same triangles, with the colours that they have in `scene`, whose meshes have the same shapes."""
        kept = np.split(self.input_triangle, np.searchsorted(self.mesh_of_triangle, np.arange(1, len(scene.meshes))))
        colours = _colours(scene, kept)
        if self.world.ndim > colours["world"].ndim:
            colours["world"] = np.tile(colours["world"], (len(self.world), 1))
        return replace(self, **colours)


def signed_volumes(surfaces: Surfaces) -> Floats:
    """Volume within each shell where it is closed, (shells,), negative where its normals look inward."""
    corners = surfaces.points[surfaces.triangles] - surfaces.points[surfaces.triangles[0, 0]]
    volume = np.einsum("tx,tx->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    return np.bincount(surfaces.shell_of_triangle, weights=volume, minlength=len(surfaces.closed))


def join(scene: Scene) -> Surfaces:
    """Join the meshes of a scene, leaving out triangles that lie nowhere or have no area.

    Raises
    ------
    NothingToBakeError
        When no triangle of a mesh that is to be baked is left.
    """
    warnings: list[str] = []
    extent = _extent(scene.meshes)
    kept = [_sound(mesh, extent, warnings) for mesh in scene.meshes]
    if not any(mesh.baked and len(keep) for mesh, keep in zip(scene.meshes, kept, strict=True)):
        raise NothingToBakeError(_no_face(scene))
    first_point = np.concatenate([[0], np.cumsum([len(mesh.vertices) for mesh in scene.meshes])]).astype(np.int64)
    points = np.concatenate([_finite(mesh.vertices) for mesh in scene.meshes])
    places = np.concatenate([welded(_finite(m.vertices)) + o for m, o in zip(scene.meshes, first_point, strict=False)])

    triangles = np.concatenate([m.triangles[k] + o for m, k, o in zip(scene.meshes, kept, first_point, strict=False)])
    cross = triangle_cross(points, triangles)
    shell, closed = triangle_shells(places[triangles], len(points))
    counts = [len(keep) for keep in kept]
    mesh_of_triangle = np.repeat(np.arange(len(counts)), counts)
    flags = np.array([(mesh.baked, mesh.seen, mesh.shadow) for mesh in scene.meshes])[mesh_of_triangle]
    opaque = ~_marked([mesh.clear for mesh in scene.meshes], kept)
    normals = normalized(cross)
    corner_normals = np.concatenate([m.corner_normals[k] for m, k in zip(scene.meshes, kept, strict=True)]).astype(
        float
    )
    return Surfaces(
        points=points,
        place_of_point=places,
        triangles=triangles,
        normals=normals,
        areas=lengths(cross) / 2.0,
        corner_normals=_shading_normals(corner_normals, normals),
        mesh_of_triangle=mesh_of_triangle,
        input_triangle=np.concatenate(kept),
        first_point_of_mesh=first_point,
        shell_of_triangle=shell,
        closed=closed,
        baked=flags[:, 0],
        seen=flags[:, 1] & opaque,
        shadow=flags[:, 2] & opaque,
        transmittance=transmittance_of(scene.meshes, kept),
        front_only=_marked([mesh.front_only for mesh in scene.meshes], kept),
        linking=tuple(mesh.linking for mesh in scene.meshes),
        grazing=np.array([mesh.grazing for mesh in scene.meshes], dtype=np.float64),
        extent=extent,
        warnings=tuple(warnings),
        **_colours(scene, kept),
    )


def _colours(scene: Scene, kept: list[Ints]) -> dict[str, Any]:
    """The fields of `Surfaces` that depend on colours; `kept` are the sound triangles of each mesh."""

    def of_triangles(values: list[Floats]) -> Floats:
        return np.concatenate([v[k] for v, k in zip(values, kept, strict=True)]).astype(np.float64)

    reflectance = np.nan_to_num(of_triangles([mesh.reflectance for mesh in scene.meshes]), posinf=1.0)
    outside = ((reflectance < 0.0) | (reflectance > 1.0)).any(axis=1)
    mesh_of_triangle = np.repeat(np.arange(len(kept)), [len(keep) for keep in kept])
    names = [scene.meshes[mesh].name for mesh in np.unique(mesh_of_triangle[outside])]
    emission = of_triangles([mesh.emission for mesh in scene.meshes])
    pale = joined([(mesh.reflectance_texture, k) for mesh, k in zip(scene.meshes, kept, strict=True)])
    bright = joined([(mesh.emission_texture, k) for mesh, k in zip(scene.meshes, kept, strict=True)])
    translucence, silky = _translucence(scene, kept)
    own, own_pale = _own_reflectance(scene, kept)
    if pale is not None:
        pale = replace(pale, colours=np.clip(np.nan_to_num(pale.colours, posinf=1.0), 0.0, 1.0))
    if bright is not None:
        bright = replace(bright, colours=sound_light(bright.colours).astype(np.float32))
    return {
        "reflectance": with_means(np.clip(reflectance, 0.0, 1.0), pale),
        "emission": with_means(sound_light(emission), bright),
        "reflectance_texture": pale,
        "emission_texture": bright,
        "own_reflectance": own,
        "own_reflectance_texture": own_pale,
        "translucence": translucence,
        "translucence_texture": silky,
        "world": sound_light(scene.world),
        "lamps": tuple(sound_lamp(lamp) for lamp in scene.lamps),
        "colour_warnings": (
            *(f"{name}: a base colour outside 0 to 1 was limited to it" for name in names),
            *_light_warnings(scene),
        ),
    }


def _own_reflectance(scene: Scene, kept: list[Ints]) -> tuple[Floats | None, Texture | None]:
    """What meshes show of the light on all triangles, None where that is all that they send on, and how it varies."""
    pairs = list(zip(scene.meshes, kept, strict=True))
    if all(mesh.own_reflectance is None for mesh, _ in pairs):
        return None, None
    found = [
        (mesh.reflectance, mesh.reflectance_texture)
        if mesh.own_reflectance is None
        else (mesh.own_reflectance, mesh.own_reflectance_texture)
        for mesh, _ in pairs
    ]
    texture = joined([(varied, k) for (_, varied), k in zip(found, kept, strict=True)])
    if texture is not None:
        texture = replace(texture, colours=np.clip(np.nan_to_num(texture.colours, posinf=1.0), 0.0, 1.0))
    shares = np.concatenate([share[k] for (share, _), k in zip(found, kept, strict=True)])
    return with_means(np.clip(np.nan_to_num(shares, posinf=1.0), 0.0, 1.0), texture), texture


def _translucence(scene: Scene, kept: list[Ints]) -> tuple[Floats | None, Texture | None]:
    """Of all triangles, None where none is translucent, and how it varies."""
    pairs = list(zip(scene.meshes, kept, strict=True))
    texture = joined([(mesh.translucence_texture, k) for mesh, k in pairs])
    if texture is None and all(mesh.translucence is None for mesh, _ in pairs):
        return None, None
    if texture is not None:
        texture = replace(texture, colours=np.clip(np.nan_to_num(texture.colours, posinf=1.0), 0.0, 1.0))
    shares = [np.zeros((len(k), 3)) if m.translucence is None else m.translucence[k] for m, k in pairs]
    means = with_means(np.clip(np.nan_to_num(np.concatenate(shares), posinf=1.0), 0.0, 1.0), texture)
    return (means, texture) if means.any() else (None, None)


def _light_warnings(scene: Scene) -> list[str]:
    """Sentences on emission, world and lamps that are not taken as they are."""
    told = [light_warnings(mesh.name, "emission", mesh.emission) for mesh in scene.meshes]
    textures = [(mesh.name, mesh.emission_texture) for mesh in scene.meshes]
    told += [light_warnings(name, "emission", t.colours) for name, t in textures if t is not None]
    told += [light_warnings("World", "light", scene.world), *(lamp_warnings(lamp) for lamp in scene.lamps)]
    return list(dict.fromkeys(sentence for sentences in told for sentence in sentences))


def _marked(marks: list[NDArray[np.bool_] | None], kept: list[Ints]) -> NDArray[np.bool_]:
    """Marks of the sound triangles of all meshes, of which some have none."""
    return np.concatenate(
        [np.zeros(len(k), dtype=bool) if mark is None else mark[k] for mark, k in zip(marks, kept, strict=True)]
    )


def _finite(vertices: Floats) -> Floats:
    """The vertices, those that lie nowhere moved to the origin: no triangle that is left has them."""
    return np.where(_somewhere(vertices)[:, None], vertices, 0.0)


def _somewhere(points: Floats) -> NDArray[np.bool_]:
    """Whether points (..., 3) lie within the limits."""
    return np.asarray((np.abs(points) <= LARGEST_COORDINATE).all(axis=-1))


def _extent(meshes: tuple[SurfaceMesh, ...]) -> float:
    corners = [m.vertices[m.triangles] for m in meshes]
    used = np.concatenate([c[_somewhere(c).all(axis=1)].reshape(-1, 3) for c in corners] or [np.zeros((0, 3))])
    return frame(used)[1]


def _sound(mesh: SurfaceMesh, extent: float, warnings: list[str]) -> Ints:
    """Triangles of a mesh that lie somewhere and have an area; the others are named in a warning."""
    corners = mesh.vertices[mesh.triangles]
    somewhere = _somewhere(corners).all(axis=1)
    finite = np.isfinite(corners).all(axis=(1, 2))
    area = np.zeros(len(corners))
    area[somewhere] = triangle_areas(corners[somewhere])
    small = somewhere & (area <= SMALLEST_AREA * extent * extent)
    size, slanted = _sizes(corners)
    vast = (slanted > LARGEST_SLANTED * extent) | (size > LARGEST_SQUARE * extent)
    for left_out, why in (
        (~finite, "with coordinates that are not numbers"),
        (finite & ~somewhere, f"with coordinates beyond {LARGEST_COORDINATE:.0e}"),
        (small & (area == 0.0), "without area"),
        (small & (area > 0.0), f"without area to speak of in a scene of {extent:.1e}"),
        (vast & ~small, f"too large beside the rest of the scene, for which rays are fine in {extent:.1e},"),
    ):
        if left_out.any():
            warnings.append(f"{mesh.name}: {int(left_out.sum())} triangles {why} left out")
    return np.flatnonzero(somewhere & ~small & ~vast)


def _sizes(corners: Floats) -> tuple[Floats, Floats]:
    """Sizes of triangles (t, 3, 3), and the same times the sines of their normals' angles to the nearest axis, (t,)."""
    somewhere = _somewhere(corners).all(axis=1)
    size = np.zeros(len(corners))
    size[somewhere] = np.ptp(corners[somewhere], axis=1).max(axis=1)
    some = np.flatnonzero(size > 0.0)
    unit = corners[some] / size[some, None, None]
    normal = np.abs(normalized(cross(unit[:, 1] - unit[:, 0], unit[:, 2] - unit[:, 0])))
    slanted = np.zeros(len(corners))
    slanted[some] = size[some] * lengths(np.sort(normal, axis=1)[:, :2])
    return size, slanted


def _no_face(scene: Scene) -> str:
    """Why there is nothing to bake, and what to do."""
    corners = np.concatenate([m.vertices[m.triangles] for m in scene.meshes if m.baked] or [np.zeros((0, 3, 3))])
    if not (triangle_areas(corners[_somewhere(corners).all(axis=1)]) > 0.0).any():
        return "None of the meshes to bake has a face with an area; select a mesh that has faces"
    # What reaches far may be thin, and left out itself.
    corners_of_mesh = [m.vertices[m.triangles] for m in scene.meshes]
    reach = [float(np.abs(c[_somewhere(c).all(axis=1)]).max(initial=0.0)) for c in corners_of_mesh]
    farthest = int(np.argmax(reach))
    return (
        f'The meshes to bake are too small beside "{scene.meshes[farthest].name}", which reaches {reach[farthest]:.1e} '
        "far; hide that one, or scale it down"
    )


def _shading_normals(corner_normals: Floats, normals: Floats) -> Floats:
    """Unit corner normals on the triangle's front; the triangle's own where they are missing or point away."""
    unit = normalized(np.nan_to_num(corner_normals))
    wrong = np.einsum("tkx,tx->tk", unit, normals) <= 0.0
    return np.where(wrong[..., None], normals[:, None, :], unit)


def _repeated(places: Ints) -> NDArray[np.bool_]:
    """Whether triangles of the places (t, 3) have the same three as another, (t,)."""
    _, number, count = np.unique(np.sort(places, axis=1), axis=0, return_inverse=True, return_counts=True)
    repeated: NDArray[np.bool_] = count[number.ravel()] > 1
    return repeated
