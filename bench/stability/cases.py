# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The sweeps: scenes of two surfaces or two rooms, one length or number of which goes to where methods fail.

In most, black receivers see an emitter of radiance 1 and nothing else. What is asked is the mean irradiance over pi of
the receiver, which is the form factor from it to the emitter: every program can say it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from radiosity_bake.core.scene import Floats, Scene, SurfaceMesh

from tests.core.building import block, flipped, grid
from tests.scenes import exact, oracle

OURS = "Radiosity Bake"
ROWS = "Radiosity Bake, traced rows"
CYCLES = "Cycles, vertex bake"
RAYSTRACK = "raystrack"
PYVIEWFACTOR = "pyViewFactor"
ALL = (OURS, ROWS, RAYSTRACK, PYVIEWFACTOR, CYCLES)
BAKES = (OURS, CYCLES)

DARK = np.zeros(3)

# Size of a room, and how far the walls of two are apart.
ROOM = (2.0, 2.0, 2.0)
WALL = 0.1


@dataclass(frozen=True)
class Rectangle:
    """A parallelogram whose front looks along u x v; each (3,) float, scene units."""

    corner: Floats
    u: Floats
    v: Floats

    @staticmethod
    def of(corner: ArrayLike, u: ArrayLike, v: ArrayLike) -> Rectangle:
        """Return the rectangle of three array-likes."""
        return Rectangle(*(np.asarray(x, dtype=np.float64) for x in (corner, u, v)))

    def corners(self) -> Floats:
        """Return its corners, counterclockwise, (4, 3)."""
        return self.corner + np.array([0.0 * self.u, self.u, self.u + self.v, self.v])

    def area(self) -> float:
        """Return its area."""
        return float(np.linalg.norm(np.cross(self.u, self.v)))

    def moved(self, scale: float, by: ArrayLike) -> Rectangle:
        """Return it scaled about the origin, then moved."""
        return Rectangle(self.corner * scale + np.asarray(by), self.u * scale, self.v * scale)


@dataclass(frozen=True, eq=False)
class Case:
    """One scene of a sweep and its answer.

    Attributes
    ----------
    value : float
        Of the sweep's magnitude.
    scene : Scene
    truth : float, W m^-2 sr^-1
        The mean irradiance over pi of the receiver; of a leak, 0.
    receiver, emitter : int
        Meshes of the scene.
    place : Rectangle or None
        That the receiver is, where a mean over it is asked for.
    """

    value: float
    scene: Scene
    truth: float
    receiver: int = 0
    emitter: int = 1
    place: Rectangle | None = None


@dataclass(frozen=True)
class Sweep:
    """A magnitude, the values it takes, and what is asked of each.

    Attributes
    ----------
    name, title, magnitude : str
        `magnitude` names the axis.
    why : str
        What fails there, and how the answer is known.
    values : tuple of float
    case_of : callable
    limit : float
        Our error is to stay below it.
    kind : str
        `'mean'`: relative error of the mean light; `'leak'`: the mean light where there is none, relative to that on
        the bright side.
    programs : tuple of str
    linear : bool
        Whether the axis of the magnitude is linear.
    """

    name: str
    title: str
    magnitude: str
    why: str
    values: tuple[float, ...]
    case_of: Callable[[float], Case]
    limit: float
    kind: str = "mean"
    programs: tuple[str, ...] = ALL
    linear: bool = False


def pair(value: float, receiver: Rectangle, emitter: Rectangle, truth: float | None = None) -> Case:
    """Return a black receiver before an emitter of radiance 1; its answer is that of the oracle if none is given."""
    meshes = (
        exact.rectangle("receiver", receiver.corner, receiver.u, receiver.v),
        exact.rectangle("emitter", emitter.corner, emitter.u, emitter.v, emission=1.0),
    )
    known = oracle.form_factor(receiver.corners(), emitter.corners()) if truth is None else truth
    return Case(value, Scene(meshes, DARK), known, place=receiver)


def facing(width: float, height: float, distance: float) -> tuple[Rectangle, Rectangle]:
    """Return a rectangle and the one above it that looks down at it."""
    low = Rectangle.of((0, 0, 0), (width, 0, 0), (0, height, 0))
    return low, Rectangle.of((0, 0, distance), (0, height, 0), (width, 0, 0))


def standing(width: float, height: float) -> tuple[Rectangle, Rectangle]:
    """Return a wall that stands on the middle of the edge of a unit floor, and that floor."""
    wall = Rectangle.of((0.0, 0.5 - width / 2, 0.0), (0, width, 0), (0, 0, height))
    return wall, Rectangle.of((0, 0, 0), (1, 0, 0), (0, 1, 0))


def gap(value: float) -> Case:
    """Two unit squares face to face, ever closer."""
    return pair(value, *facing(1.0, 1.0, value), exact.parallel_factor(1.0, 1.0, value))


def angle(value: float) -> Case:
    """Two unit squares that share an edge and open by so many degrees."""
    leaning = np.radians(value)
    floor = Rectangle.of((0, 0, 0), (1, 0, 0), (0, 1, 0))
    return pair(value, floor, Rectangle.of((0, 0, 0), (0, 1, 0), (math.cos(leaning), 0, math.sin(leaning))))


def aspect(value: float) -> Case:
    """Two strips of length 1 face to face, as far apart as they are wide."""
    width = 1.0 / value
    return pair(value, *facing(1.0, width, width), exact.parallel_factor(1.0, width, width))


def scale(value: float) -> Case:
    """The floor and the wall at a right angle, of this size."""
    wall, floor = (r.moved(value, (0, 0, 0)) for r in standing(1.0, 1.0))
    return pair(value, wall, floor, exact.perpendicular_factor(1.0, 1.0, 1.0))


def offset(value: float) -> Case:
    """The same so far from the origin."""
    wall, floor = (r.moved(1.0, np.array((1.0, -1.0, 0.5)) * value) for r in standing(1.0, 1.0))
    return pair(value, wall, floor, exact.perpendicular_factor(1.0, 1.0, 1.0))


def neighbour(value: float) -> Case:
    """A tiny wall that stands at the edge of a floor so many times as wide."""
    return pair(value, *standing(1.0 / value, 1.0 / value))


def point(value: float) -> Case:
    """A square lamp of this size above the middle of a unit floor, a quarter of its width away."""
    floor = Rectangle.of((0, 0, 0), (1, 0, 0), (0, 1, 0))
    low = 0.5 - value / 2
    lamp = Rectangle.of((low, low, 0.25), (0, value, 0), (value, 0, 0))
    # The oracle's rule wants a polygon that is not tiny first; reciprocity gives the other way.
    return pair(value, floor, lamp, oracle.form_factor(lamp.corners(), floor.corners()) * value**2)


def emitters(value: float) -> Case:
    """A ceiling of so many glowing triangles above a floor of its size."""
    cells = round(math.sqrt(value / 2.0))
    ceiling = flipped(grid("emitter", cells, emission=(1.0, 1.0, 1.0)))
    ceiling = replace(ceiling, vertices=ceiling.vertices + (0.0, 0.0, 1.0))
    floor, _ = facing(1.0, 1.0, 1.0)
    receiver = exact.rectangle("receiver", floor.corner, floor.u, floor.v)
    return Case(value, Scene((receiver, ceiling), DARK), exact.parallel_factor(1.0, 1.0, 1.0), place=floor)


def horizon(value: float) -> Case:
    """A square lamp that stands beside a floor, its lower edge at this height: the floor sees what is above it."""
    floor = Rectangle.of((0, 0, 0), (1, 0, 0), (0, 1, 0))
    return pair(value, floor, Rectangle.of((-0.25, 0.0, value), (0, 1, 0), (0, 0, 1)))


def furnace(value: float) -> Case:
    """A box that glows and reflects this share: its radiance is 1 / (1 - value), whatever its shape."""
    room = exact.closed_room((1.0, 1.5, 0.8), reflectance=value, emission=1.0)
    return Case(value, Scene((room,), DARK), 1.0 / (1.0 - value), emitter=0)


def rooms(apart: float) -> tuple[SurfaceMesh, ...]:
    """Return a dark room, a bright one beside it and its lamp; their walls are single sheets, so far apart."""
    dark = exact.closed_room(ROOM, reflectance=0.5, name="dark room")
    dark = replace(dark, vertices=dark.vertices + (ROOM[0] + apart, 0.0, 0.0))
    bright = exact.closed_room(ROOM, reflectance=0.5, name="bright room")
    return dark, bright, exact.rectangle("lamp", (0.7, 0.7, 1.9), (0, 0.6, 0), (0.6, 0, 0), emission=5.0)


def wall(value: float) -> Case:
    """Two rooms side by side, so far apart."""
    return Case(value, Scene(rooms(value), DARK), 0.0)


def through(value: float) -> Case:
    """A beam that stands in the bright room and sticks so far into the dark one."""
    beam = block("beam", (0.9, 0.8, 0.7), (ROOM[0] + WALL + value, 1.2, 1.3))
    return Case(value, Scene((*rooms(WALL), beam), DARK), 0.0)


def powers(first: int, last: int, step: int = 1) -> tuple[float, ...]:
    """Return powers of ten."""
    return tuple(float(f"1e{k}") for k in range(first, last + (1 if step > 0 else -1), step))


# What the direct light of a GOOD bake may differ by: what is asked of it over a surface.
GOOD = 0.02

SWEEPS = {
    sweep.name: sweep
    for sweep in (
        Sweep(
            "gap",
            "Parallel faces ever closer",
            "gap, in widths of the faces",
            "Two unit squares face to face. Integrals over both run into the pole of 1/r², and rays begin off their "
            "surface by some length, perhaps beyond the other one: ours 2e-6 of the scene's extent, below which faces "
            "count as touching. The answer is the closed form (C-11).",
            powers(0, -6, -1),
            gap,
            GOOD,
        ),
        Sweep(
            "angle",
            "Faces that share an edge",
            "angle between the faces, degrees",
            "Two unit squares with a common edge, from almost flat to almost closed. Near the edge the light changes "
            "over any length. The answer is the contour integral by the double-exponential rule.",
            (179.0, 175.0, 165.0, 150.0, 120.0, 90.0, 60.0, 30.0, 15.0, 5.0, 2.0, 1.0),
            angle,
            GOOD,
            linear=True,
        ),
        Sweep(
            "aspect",
            "Slivers",
            "length over width",
            "Two strips face to face, as far apart as they are wide; halving them evenly never makes them compact. "
            "The answer is the closed form.",
            powers(0, 5),
            aspect,
            GOOD,
        ),
        Sweep(
            "scale",
            "Size of the scene",
            "size, scene units",
            "A floor and a wall at a right angle; nothing changes but the unit. Fixed lengths in a program show here.",
            powers(-4, 5),
            scale,
            GOOD,
        ),
        Sweep(
            "offset",
            "Distance from the origin",
            "offset, in sizes of the scene",
            "The same floor and wall far from the origin, where single precision runs out of digits: at 1e6 it "
            "knows a place to a sixteenth of the scene. raystrack and Blender's meshes hold single precision.",
            (0.0, *powers(1, 6)),
            offset,
            GOOD,
        ),
        Sweep(
            "neighbour",
            "A tiny face beside a huge one",
            "width of the floor over that of the wall",
            "A small wall that stands on the edge of a glowing floor. A floor cut without regard to the wall sees it "
            "from far away, and the wall sees the floor from nearby. The answer is that of the contour integral.",
            powers(0, 4),
            neighbour,
            GOOD,
        ),
        Sweep(
            "point",
            "A lamp that shrinks to a point",
            "width of the lamp, in widths of the floor",
            "A lamp a quarter of the floor's width above its middle. Rays from the floor do not meet it any more. "
            "The answer is the contour integral, by reciprocity.",
            powers(0, -6, -1),
            point,
            GOOD,
        ),
        Sweep(
            "emitters",
            "Many emitters",
            "emitting triangles",
            "A ceiling of glowing triangles above a floor. Together they are one square, whose factor is known.",
            (2.0, 32.0, 512.0, 8192.0, 100352.0),
            emitters,
            GOOD,
        ),
        Sweep(
            "horizon",
            "A lamp that sets",
            "height of the lamp's lower edge, in its own",
            "A square lamp beside a floor; what of it is below the floor's plane must count for nothing, and hide "
            "nothing. The answer is the contour integral of the part above.",
            (0.5, 0.1, 0.0, -0.1, -0.5, -0.9, -0.99),
            horizon,
            GOOD,
            linear=True,
        ),
        Sweep(
            "reflectance",
            "Reflectance close to one",
            "reflectance",
            "A closed box that glows and reflects: its light is the emission over one less the reflectance. What is "
            "missing of an exchange is lost once a bounce. Cycles bounces 1,024 times, the most it can.",
            (0.5, 0.9, 0.99, 0.999),
            furnace,
            1e-3,
            programs=BAKES,
            linear=True,
        ),
        Sweep(
            "wall",
            "A bright room beside a dark one",
            "distance between the walls, in half widths of a room",
            "The walls between the rooms are single sheets. No light may pass; a ray that begins beyond the other "
            "sheet would bring it. At 0 both lie in one plane, and it would be chance which of them a ray meets: ours "
            "holds such walls apart for rays, by less than these begin off them.",
            (*powers(-1, -6, -1), 0.0),
            wall,
            1e-3,
            kind="leak",
            programs=BAKES,
        ),
        Sweep(
            "through",
            "A beam through the wall",
            "length of the beam in the dark room",
            "A beam stands in the bright room and sticks through both walls into the dark one. Patches that it cuts "
            "have light on one side of the cut only.",
            (1.0, *powers(-1, -5, -1)),
            through,
            1e-3,
            kind="leak",
            programs=BAKES,
        ),
    )
}
