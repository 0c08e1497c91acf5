# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that nobody would build and everybody imports: a generator of them for hypothesis.

A scene is made of a few meshes, each a shape with ailments: vertices that are no numbers, faces that are there twice,
edges with five faces, colours of -3. Its lamps and its world are as odd. Some scenes have a sound room around them,
which has to come out lit whatever else is in it.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray
from radiosity_bake.core.scene import (
    AreaLamp,
    Cone,
    Lamp,
    PointLamp,
    Scene,
    SunLamp,
    SurfaceMesh,
    Texture,
    surface_mesh,
)
from radiosity_bake.core.settings import METHODS, BakeSettings
from radiosity_bake.core.world import MAP_CELLS

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Shape = tuple[Floats, Ints]

NO_NUMBERS = (np.nan, np.inf, -np.inf)
HUGE = (1e19, -3e38, 1e200)
"""Beyond what single precision can square, beyond almost all of it, and beyond it."""

FAR = 100.0
"""Scene sizes that something which is merely far away lies off."""


@dataclass(frozen=True, eq=False)
class UglyScene:
    """A scene, how to bake it, and what is known of it.

    Attributes
    ----------
    scene : Scene
    settings : BakeSettings
    in_company : bool
        Whether the last meshes are a sound room with a lamp: then there is light, and something to bake.
    """

    scene: Scene
    settings: BakeSettings
    in_company: bool

    def __repr__(self) -> str:
        """Tell what matters, for a failure's report."""
        meshes = ", ".join(f"{mesh.name} ({len(mesh.triangles)})" for mesh in self.scene.meshes)
        return f"UglyScene({meshes}; lamps {self.scene.lamps}; world {self.scene.world.shape}; {self.settings})"


# ------------------------------------------------------------------------------------------------------------- shapes


def _square(rng: np.random.Generator) -> Shape:
    return np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float), np.array([(0, 1, 2), (0, 2, 3)])


def _box(rng: np.random.Generator) -> Shape:
    vertices = np.array(list(itertools.product((0.0, 1.0), repeat=3)))
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    return vertices, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def _triangle(rng: np.random.Generator) -> Shape:
    return rng.random((3, 3)), np.array([(0, 1, 2)])


def _soup(rng: np.random.Generator) -> Shape:
    """Triangles that run through each other, some of them with corners that are the same vertex."""
    count = int(rng.integers(2, 24))
    return rng.random((count, 3)), rng.integers(0, count, (count, 3))


def _dust(rng: np.random.Generator) -> Shape:
    """Tiny triangles all over the place."""
    count = int(rng.integers(5, 40))
    middle = rng.random((count, 1, 3))
    corners = middle + 10.0 ** rng.uniform(-7.0, -2.0, (count, 1, 1)) * rng.normal(size=(count, 3, 3))
    return corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def _slivers(rng: np.random.Generator) -> Shape:
    """A fan of triangles ten thousand times as long as wide, and of collinear ones."""
    count = int(rng.integers(2, 12))
    along = np.linspace(0.0, 10.0 ** rng.uniform(-6.0, -2.0), count + 1)
    rim = np.stack([np.ones(count + 1), along, np.zeros(count + 1)], axis=1)
    vertices = np.concatenate([np.zeros((1, 3)), rim, [(0.5, 0.0, 0.0)]])
    fan = [(0, k + 1, k + 2) for k in range(count)]
    return vertices, np.array([*fan, (0, 1, count + 2)])


def _book(rng: np.random.Generator) -> Shape:
    """Many pages on one spine: an edge with as many faces, some pages at the same place."""
    count = int(rng.integers(3, 8))
    angle = np.repeat(rng.uniform(0.0, np.pi, (count + 1) // 2), 2)[:count]
    out = np.stack([np.cos(angle), np.sin(angle), np.zeros(count)], axis=1)
    vertices = np.concatenate([[(0, 0, 0), (0, 0, 1)], out, out + (0, 0, 1)])
    pages = [((0, 2 + k, 2 + count + k), (0, 2 + count + k, 1)) for k in range(count)]
    return vertices, np.array(pages).reshape(-1, 3)


def _strip(rng: np.random.Generator) -> Shape:
    """A band that was turned over once and closed (Moebius): no side of it is the front."""
    count = int(rng.integers(3, 14))
    turn = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    width = 0.2 * np.array([-1.0, 1.0])[:, None]
    radius = 0.5 + width * np.cos(turn / 2.0)
    points = np.stack([radius * np.cos(turn), radius * np.sin(turn), width * np.sin(turn / 2.0)], axis=-1)
    triangles = []
    for k in range(count):
        a, b = k, count + k
        c, d = (k + 1, count + k + 1) if k + 1 < count else (count, 0)
        triangles += [(a, c, b), (b, c, d)]
    return points.reshape(-1, 3), np.array(triangles)


def _ball(rng: np.random.Generator) -> Shape:
    """A globe with poles where a dozen triangles meet, and no weld at its seam."""
    rings, around = 5, int(rng.integers(4, 13))
    up, turn = np.meshgrid(np.linspace(0, np.pi, rings), np.linspace(0, 2 * np.pi, around + 1), indexing="ij")
    points = np.stack([np.sin(up) * np.cos(turn), np.sin(up) * np.sin(turn), np.cos(up)], axis=-1) / 2.0
    corner = np.arange(rings * (around + 1)).reshape(rings, around + 1)
    a, b, c, d = (corner[i : rings - 1 + i, j : around + j].ravel() for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)))
    return points.reshape(-1, 3), np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def _nothing(rng: np.random.Generator) -> Shape:
    """Loose vertices at most."""
    return rng.random((int(rng.integers(0, 4)), 3)), np.zeros((0, 3), dtype=np.int64)


SHAPES: dict[str, Callable[[np.random.Generator], Shape]] = {
    "square": _square,
    "box": _box,
    "triangle": _triangle,
    "soup": _soup,
    "dust": _dust,
    "slivers": _slivers,
    "book": _book,
    "strip": _strip,
    "ball": _ball,
    "nothing": _nothing,
}


# ----------------------------------------------------------------------------------------------------------- ailments


def _some(rng: np.random.Generator, count: int) -> Ints:
    """Choose one to all of so many things."""
    return rng.choice(count, size=int(rng.integers(1, count + 1)), replace=False) if count else np.zeros(0, np.int64)


def _with_no_numbers(rng: np.random.Generator, vertices: Floats, triangles: Ints) -> Shape:
    vertices[_some(rng, len(vertices))[:2], rng.integers(3)] = rng.choice(NO_NUMBERS)
    return vertices, triangles


def _with_huge_numbers(rng: np.random.Generator, vertices: Floats, triangles: Ints) -> Shape:
    vertices[_some(rng, len(vertices))[:2], rng.integers(3)] = rng.choice(HUGE)
    return vertices, triangles


def _with_far_vertices(rng: np.random.Generator, vertices: Floats, triangles: Ints) -> Shape:
    vertices[_some(rng, len(vertices))[:1], rng.integers(3)] += FAR * rng.random()
    return vertices, triangles


def _flattened(rng: np.random.Generator, vertices: Floats, triangles: Ints) -> Shape:
    vertices[:, rng.integers(3)] *= rng.choice([0.0, 1e-12, 1e-6])
    return vertices, triangles


def _shrunk(rng: np.random.Generator, vertices: Floats, triangles: Ints) -> Shape:
    return vertices * rng.choice([0.0, 1e-30, 1e-5]), triangles


def _doubled(rng: np.random.Generator, vertices: Floats, triangles: Ints) -> Shape:
    """The same faces again, of the same vertices."""
    return vertices, np.concatenate([triangles, triangles[_some(rng, len(triangles))]])


def _lined(rng: np.random.Generator, vertices: Floats, triangles: Ints) -> Shape:
    """The same faces again, from behind, of vertices of their own, at the same place or almost."""
    moved = vertices + rng.choice([0.0, 1e-9, 1e-6, 1e-4])
    return np.concatenate([vertices, moved]), np.concatenate([triangles, triangles[:, ::-1] + len(vertices)])


def _turned_in_part(rng: np.random.Generator, vertices: Floats, triangles: Ints) -> Shape:
    chosen = _some(rng, len(triangles))
    triangles[chosen] = triangles[chosen, ::-1]
    return vertices, triangles


def _with_repeated_corners(rng: np.random.Generator, vertices: Floats, triangles: Ints) -> Shape:
    chosen = _some(rng, len(triangles))[:3]
    triangles[chosen, 0] = triangles[chosen, 1]
    return vertices, triangles


def _torn(rng: np.random.Generator, vertices: Floats, triangles: Ints) -> Shape:
    """Every face by itself, and a face or more missing."""
    kept = triangles[_some(rng, len(triangles))]
    return vertices[kept.ravel()], np.arange(kept.size).reshape(-1, 3)


Ailment = Callable[[np.random.Generator, Floats, Ints], Shape]
AILMENTS: tuple[Ailment, ...] = (
    _with_no_numbers,
    _with_huge_numbers,
    _with_far_vertices,
    _flattened,
    _shrunk,
    _doubled,
    _lined,
    _turned_in_part,
    _with_repeated_corners,
    _torn,
)

seeds = st.integers(0, 2**16)
odd_colours = st.sampled_from(
    [0.0, 0.5, 1.0, 0.999, 1.5, -3.0, 1e-30, 1e30, np.nan, np.inf, -np.inf, (0.9, np.nan, -1.0), (0.0, 0.0, 2.0)]
)
odd_light = st.sampled_from(
    [0.0, 1.0, 100.0, -2.0, 1e-30, 1e-6, 1e6, 1e30, np.nan, np.inf, -np.inf, (1.0, np.nan, -1.0), (0.0, 5.0, 0.0)]
)
odd_sizes = st.sampled_from([0.0, 1e-30, 1e-6, 0.1, 1.0, 1e6, 1e30, -1.0, np.nan, np.inf])
odd_places = st.sampled_from(
    [(0.5, 0.5, 0.7), (0.0, 0.0, 0.0), (1.0, 0.5, 0.5), (1e6, 0.0, 0.0), (np.nan, 0.0, 0.0), (0.0, np.inf, 0.0)]
)
odd_directions = st.sampled_from(
    [(0.0, 0.0, -1.0), (0.6, 0.0, -0.8), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (np.nan, 0.0, 1.0)]
)


def _rgb(value: object) -> Floats:
    return np.array(np.broadcast_to(np.asarray(value, dtype=np.float64), 3))


@st.composite
def meshes(draw: st.DrawFn, number: int) -> SurfaceMesh:
    """A mesh in the unit cube, more or less."""
    rng = np.random.default_rng(draw(seeds))
    name = draw(st.sampled_from(sorted(SHAPES)))
    vertices, triangles = SHAPES[name](rng)
    ailments = draw(st.lists(st.sampled_from(AILMENTS), max_size=3))
    # Several ailments may leave no face, or none that is finite.
    with np.errstate(all="ignore"):
        vertices = vertices * rng.uniform(0.1, 1.0) + rng.uniform(0.0, 0.5, 3)
        for ailment in ailments:
            vertices, triangles = ailment(rng, vertices.copy(), triangles.copy())
    mesh = surface_mesh(
        " ".join([name, str(number), *(ailment.__name__.strip("_") for ailment in ailments)]),
        vertices,
        triangles,
        reflectance=_rgb(draw(odd_colours)),
        emission=_rgb(draw(st.one_of(st.just(0.0), odd_light))),
        baked=draw(st.booleans()) or draw(st.booleans()),
        seen=draw(st.integers(0, 5)) > 0,
        shadow=draw(st.integers(0, 5)) > 0,
    )
    if draw(st.integers(0, 3)) == 0:
        wild = rng.normal(size=mesh.corner_normals.shape)
        wild[rng.random(len(wild)) < 0.3] = rng.choice([0.0, np.nan, np.inf, 1e300])
        mesh = replace(mesh, corner_normals=wild)
    if draw(st.integers(0, 3)) == 0:
        mesh = replace(mesh, clear=rng.random(len(triangles)) < 0.4)
    if draw(st.integers(0, 3)) == 0:
        mesh = replace(mesh, front_only=rng.random(len(triangles)) < 0.5)
    for kind in ("reflectance_texture", "emission_texture"):
        if len(triangles) and draw(st.integers(0, 3)) == 0:
            mesh = replace(mesh, **{kind: _texture(rng, len(triangles), draw(odd_colours))})
    return mesh


def _texture(rng: np.random.Generator, triangles: int, odd: object) -> Texture:
    chosen = np.sort(_some(rng, triangles))
    along = 2 ** rng.integers(0, 3, len(chosen))
    colours = rng.random((int((along**2).sum()), 3))
    colours[rng.random(len(colours)) < 0.3] = _rgb(odd)
    with np.errstate(over="ignore"):
        return Texture(chosen, np.zeros(len(chosen), dtype=np.int64), along, colours.astype(np.float32))


@st.composite
def lamps(draw: st.DrawFn) -> Lamp:
    """A lamp of which anything may be odd."""
    kind, strength, shadow = draw(st.sampled_from(["point", "spot", "area", "sun"])), _rgb(draw(odd_light)), True
    place, size = np.array(draw(odd_places)), draw(odd_sizes)
    if draw(st.integers(0, 5)) == 0:
        shadow = False
    if kind == "sun":
        angle = draw(st.sampled_from([0.0, 1e-30, 0.01, 2.0]))
        return SunLamp("sun", np.array(draw(odd_directions)), angle, strength, shadow)
    if kind == "area":
        axes = np.array([(size, 0.0, 0.0), (0.0, draw(odd_sizes), 0.0)])
        spread = draw(st.sampled_from([np.pi, 0.02, 1.0]))
        normal, elliptic = np.array(draw(odd_directions)), draw(st.booleans())
        return AreaLamp("area", place, axes, normal, strength, elliptic, spread, shadow)
    cone = None
    if kind == "spot":
        inverse = np.diag(draw(st.sampled_from([(1.0, 1.0, 1.0), (1e-6, 1.0, 1e6), (-1.0, 1.0, 1.0)])))
        cone = Cone(inverse, draw(st.sampled_from([1.0, 0.0, 0.8])), draw(st.sampled_from([0.0, 0.15, 1.0])))
    return PointLamp(kind, place, size, strength, draw(st.booleans()), cone, shadow)


@st.composite
def worlds(draw: st.DrawFn) -> Floats:
    """A world of one colour, or a map with a spot of another."""
    colour = _rgb(draw(st.one_of(st.just(0.0), odd_light)))
    if draw(st.integers(0, 3)):
        return colour
    sky = np.full((MAP_CELLS, 3), 0.3)
    sky[: MAP_CELLS // 8] = colour
    return sky


def _room() -> tuple[SurfaceMesh, ...]:
    """A closed room around the unit cube, with a lamp in its ceiling."""
    vertices, triangles = _box(np.random.default_rng(0))
    walls = surface_mesh("room", vertices * 3.0 - 1.0, triangles[:, ::-1], reflectance=0.5)
    vertices, triangles = _square(np.random.default_rng(0))
    lamp = surface_mesh("lamp", vertices + (0.0, 0.0, 1.9), triangles[:, ::-1], emission=10.0)
    return walls, lamp


def _placed(mesh: SurfaceMesh, scale: float, offset: float) -> SurfaceMesh:
    with np.errstate(all="ignore"):
        return replace(mesh, vertices=mesh.vertices * scale + offset * scale)


@st.composite
def ugly_scenes(draw: st.DrawFn, largest: int = 3) -> UglyScene:
    """A scene of up to `largest` ugly meshes and three odd lamps, of any size and place, with or without company."""
    made = [draw(meshes(number)) for number in range(draw(st.integers(0, largest)))]
    in_company = draw(st.booleans())
    scale = draw(st.sampled_from([1.0, 1.0, 1e-4, 1e3, 1e5]))
    offset = draw(st.sampled_from([0.0, 0.0, -3.0, 1e3]))
    placed = [_placed(mesh, scale, offset) for mesh in [*made, *(_room() if in_company else ())]]
    settings = BakeSettings(
        quality="DRAFT",
        method=draw(st.sampled_from(METHODS)),
        output=draw(st.sampled_from(["REFINED", "ORIGINAL"])),
        minimum_size=draw(st.sampled_from([0.0, 0.5, 0.5, 10.0])) * scale,
        threads=1,
        seed=draw(st.integers(0, 3)),
        memory_limit=draw(st.sampled_from([64, 2048])),
        patch_limit=draw(st.sampled_from([0, 0, 1, 30])),
    )
    scene = Scene(tuple(placed), draw(worlds()), tuple(draw(st.lists(lamps(), max_size=3))))
    return UglyScene(scene, settings, in_company)
