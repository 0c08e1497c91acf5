# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The example rooms as plain numbers: no Blender, no numpy, so that tests, benchmarks and the demo share them.

Every room is a list of `Surface`: world coordinates in metres, z up, front of the room towards -y (what Blender's
front view sees). Faces are wound counterclockwise seen from the side that the light is on: walls face into the room,
blocks and cubes outwards. `CAMERAS` says where the pictures are taken from.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

Colour = tuple[float, float, float]
Point = tuple[float, float, float]
Face = tuple[int, ...]

BLACK: Colour = (0.0, 0.0, 0.0)

# The measured spectra of the Cornell box as linear RGB, as the Mitsuba 3 renderer ships them in its own Cornell box.
CORNELL_WHITE: Colour = (0.885809, 0.698859, 0.666422)
CORNELL_GREEN: Colour = (0.105421, 0.37798, 0.076425)
CORNELL_RED: Colour = (0.570068, 0.0430135, 0.0443706)
CORNELL_RADIANCE: Colour = (18.387, 13.9873, 6.75357)


@dataclass(frozen=True)
class Surface:
    """One object of a room: what an artist would name, model and give one material.

    Attributes
    ----------
    name, material : str
    vertices : tuple of points, m
    faces : tuple of tuples of vertex indices
    reflectance : diffuse albedo, linear RGB, 0..1
    emission : emitted radiance, linear RGB, W m^-2 sr^-1
    smooth : whether it is shaded smoothly, its faces being those of something round
    """

    name: str
    material: str
    vertices: tuple[Point, ...]
    faces: tuple[Face, ...]
    reflectance: Colour
    emission: Colour = BLACK
    smooth: bool = False


@dataclass(frozen=True)
class Camera:
    """Where a picture is taken from: positions in m, lens and sensor width in mm, height over width of it."""

    location: Point
    target: Point
    lens: float
    sensor_width: float
    aspect: float = 1.0


# ---------------------------------------------------------------------------------------------- the Cornell box


def _from_cornell(x: float, y: float, z: float) -> Point:
    """Turn published millimetres (x to the left, y up, z into the box) into metres, z up; a rotation, no mirror."""
    return (-x / 1000.0, z / 1000.0, y / 1000.0)


def _cornell_surface(name: str, material: str, quads: str, reflectance: Colour, emission: Colour = BLACK) -> Surface:
    """Read quads as they are published, one corner "x y z" a line; equal corners become one vertex."""
    corners = [_from_cornell(*map(float, line.split())) for line in quads.strip().splitlines()]
    index_of: dict[Point, int] = {}
    corner_indices = [index_of.setdefault(corner, len(index_of)) for corner in corners]
    faces = tuple(tuple(corner_indices[i : i + 4]) for i in range(0, len(corner_indices), 4))
    return Surface(name, material, tuple(index_of), faces, reflectance, emission)


def cornell_box_hung() -> list[Surface]:
    """Return the Cornell box with its lamp hung 0.1 mm below an unbroken ceiling: a hard test, and a bad picture.

    Many renderers ship it so, with a lamp that glows on one side only. Blender's glow on both: here the strip of
    ceiling behind the lamp is by far the brightest thing in the room.
    """
    return [
        _cornell_surface("Floor", "White", "552.8 0 0 \n 0 0 0 \n 0 0 559.2 \n 549.6 0 559.2", CORNELL_WHITE),
        _cornell_surface(
            "Ceiling", "White", "556 548.8 0 \n 556 548.8 559.2 \n 0 548.8 559.2 \n 0 548.8 0", CORNELL_WHITE
        ),
        _cornell_surface(
            "Back Wall", "White", "549.6 0 559.2 \n 0 0 559.2 \n 0 548.8 559.2 \n 556 548.8 559.2", CORNELL_WHITE
        ),
        _cornell_surface("Right Wall", "Green", "0 0 559.2 \n 0 0 0 \n 0 548.8 0 \n 0 548.8 559.2", CORNELL_GREEN),
        _cornell_surface(
            "Left Wall", "Red", "552.8 0 0 \n 549.6 0 559.2 \n 556 548.8 559.2 \n 556 548.8 0", CORNELL_RED
        ),
        _cornell_surface(
            "Short Block",
            "White",
            """130 165 65
            82 165 225
            240 165 272
            290 165 114
            290 0 114
            290 165 114
            240 165 272
            240 0 272
            130 0 65
            130 165 65
            290 165 114
            290 0 114
            82 0 225
            82 165 225
            130 165 65
            130 0 65
            240 0 272
            240 165 272
            82 165 225
            82 0 225""",
            CORNELL_WHITE,
        ),
        _cornell_surface(
            "Tall Block",
            "White",
            """423 330 247
            265 330 296
            314 330 456
            472 330 406
            423 0 247
            423 330 247
            472 330 406
            472 0 406
            472 0 406
            472 330 406
            314 330 456
            314 0 456
            314 0 456
            314 330 456
            265 330 296
            265 0 296
            265 0 296
            265 330 296
            423 330 247
            423 0 247""",
            CORNELL_WHITE,
        ),
        _cornell_surface(
            "Lamp",
            "Lamp",
            "343 548.7 227 \n 343 548.7 332 \n 213 548.7 332 \n 213 548.7 227",
            CORNELL_WHITE,
            CORNELL_RADIANCE,
        ),
    ]


def cornell_box() -> list[Surface]:
    """Return the Cornell box with its measured coordinates: its lamp is in the plane of the ceiling, in a hole of it.

    The numbers are those that the Cornell University Program of Computer Graphics publishes as "Cornell Box Data". The
    walls are as slightly askew as the real ones, and the blocks have no bottom.
    """
    surfaces = {surface.name: surface for surface in cornell_box_hung()}
    ceiling, lamp = surfaces["Ceiling"], surfaces["Lamp"]
    height = ceiling.vertices[0][2]
    rim = tuple((x, y, height) for x, y, _ in lamp.vertices)
    nearest = [min(range(4), key=lambda k: math.dist(rim[k], corner)) + 4 for corner in ceiling.vertices]
    ring = tuple((k, (k + 1) % 4, nearest[(k + 1) % 4], nearest[k]) for k in range(4))
    surfaces["Ceiling"] = replace(ceiling, vertices=ceiling.vertices + rim, faces=ring)
    surfaces["Lamp"] = replace(lamp, vertices=rim)
    return list(surfaces.values())


# ---------------------------------------------------------------------------------------------- the paper's scene 1

PAPER_WHITE: Colour = (0.75, 0.75, 0.75)
PAPER_WARM: Colour = (0.7, 0.42, 0.22)
PAPER_COOL: Colour = (0.2, 0.4, 0.65)

CUBE_FACES: tuple[Face, ...] = (
    (0, 3, 2, 1),  # bottom
    (4, 5, 6, 7),  # top
    (0, 1, 5, 4),
    (1, 2, 6, 5),
    (2, 3, 7, 6),
    (3, 0, 4, 7),
)


def cube(
    name: str,
    material: str,
    base: Point,
    edge: float,
    degrees: float,
    reflectance: Colour,
    emission: Colour = BLACK,
) -> Surface:
    """Return a cube that stands with the centre of its bottom on `base`, turned about the vertical."""
    x, y, z = base
    radius = edge * math.sqrt(0.5)
    angles = [math.radians(degrees + 225.0 + 90.0 * k) for k in range(4)]
    ring = [(x + radius * math.cos(angle), y + radius * math.sin(angle)) for angle in angles]
    vertices = tuple((px, py, height) for height in (z, z + edge) for px, py in ring)
    return Surface(name, material, vertices, CUBE_FACES, reflectance, emission)


def paper_scene_1() -> list[Surface]:
    """Return scene 1 of Kulyasov & Nikulin (2010): five cubes and one cube-shaped lamp.

    The paper gives the objects but no coordinates. Here the cubes stand in a room of 4 x 4 x 3 m, open to the front,
    and the lamp hangs in its middle; one cube stands on another.
    """
    left, right, back, top = -2.0, 2.0, 4.0, 3.0
    floor = ((left, 0.0, 0.0), (right, 0.0, 0.0), (right, back, 0.0), (left, back, 0.0))
    upper = tuple((x, y, top) for x, y, _ in floor)

    def wall(name: str, corners: tuple[Point, ...], material: str, reflectance: Colour) -> Surface:
        return Surface(name, material, corners, ((0, 1, 2, 3),), reflectance)

    return [
        wall("Floor", floor, "Plaster", PAPER_WHITE),
        wall("Ceiling", (upper[0], upper[3], upper[2], upper[1]), "Plaster", PAPER_WHITE),
        wall("Back Wall", (floor[3], floor[2], upper[2], upper[3]), "Plaster", PAPER_WHITE),
        wall("Left Wall", (floor[0], floor[3], upper[3], upper[0]), "Warm Paint", PAPER_WARM),
        wall("Right Wall", (floor[2], floor[1], upper[1], upper[2]), "Cool Paint", PAPER_COOL),
        cube("Cube 1", "Chalk", (-1.0, 2.9, 0.0), 1.1, 18.0, PAPER_WHITE),
        cube("Cube 2", "Chalk", (-1.0, 2.9, 1.1), 0.6, 48.0, PAPER_WHITE),
        cube("Cube 3", "Chalk", (1.0, 2.6, 0.0), 0.9, -24.0, PAPER_WHITE),
        cube("Cube 4", "Warm Paint", (-0.7, 1.3, 0.0), 0.5, 30.0, PAPER_WARM),
        cube("Cube 5", "Cool Paint", (0.6, 1.2, 0.0), 0.6, -12.0, PAPER_COOL),
        cube("Lamp", "Lamp", (0.0, 1.9, 2.2), 0.3, 0.0, BLACK, (16.0, 14.0, 11.0)),
    ]


# ---------------------------------------------------------------------------------------------- a studio

STUDIO_PLASTER: Colour = (0.78, 0.76, 0.72)
STUDIO_CEILING: Colour = (0.82, 0.82, 0.8)
STUDIO_SAGE: Colour = (0.36, 0.46, 0.36)
STUDIO_FLOOR: Colour = (0.4, 0.26, 0.15)
STUDIO_OAK: Colour = (0.55, 0.36, 0.2)
STUDIO_PAINT: Colour = (0.8, 0.8, 0.8)
STUDIO_RUG: Colour = (0.5, 0.12, 0.1)
STUDIO_CLAY: Colour = (0.6, 0.28, 0.16)
STUDIO_DAYLIGHT: Colour = (7.0, 8.5, 10.5)
STUDIO_BULB: Colour = (40.0, 26.0, 13.0)
STUDIO_BOOKS: tuple[Colour, ...] = ((0.55, 0.1, 0.08), (0.1, 0.2, 0.42), (0.7, 0.55, 0.2), (0.12, 0.3, 0.2))


def box(name: str, material: str, low: Point, high: Point, reflectance: Colour) -> Surface:
    """Return a closed box between two corners."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    ring = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    vertices = tuple((x, y, z) for z in (z0, z1) for x, y in ring)
    return Surface(name, material, vertices, CUBE_FACES, reflectance)


def sphere(
    name: str, material: str, centre: Point, radius: float, reflectance: Colour, emission: Colour = BLACK
) -> Surface:
    """Return a smooth sphere of 32 segments and 16 rings, closed by triangles at its poles."""
    segments, rings = 32, 16
    (cx, cy, cz), vertices = centre, []
    for ring in range(1, rings):
        polar = math.pi * ring / rings
        for segment in range(segments):
            angle = 2.0 * math.pi * segment / segments
            level, out = math.cos(polar), math.sin(polar)
            point = (out * math.cos(angle), out * math.sin(angle), level)
            vertices.append((cx + radius * point[0], cy + radius * point[1], cz + radius * point[2]))
    top, bottom = len(vertices), len(vertices) + 1
    vertices += [(cx, cy, cz + radius), (cx, cy, cz - radius)]
    faces: list[Face] = []
    last = (rings - 2) * segments
    for k in range(segments):
        j = (k + 1) % segments
        faces.append((top, k, j))
        faces += [(r + k, r + segments + k, r + segments + j, r + j) for r in range(0, last, segments)]
        faces.append((bottom, last + j, last + k))
    return Surface(name, material, tuple(vertices), tuple(faces), reflectance, emission, smooth=True)


def studio() -> list[Surface]:
    """Return a furnished room of 4 x 4.4 x 2.6 m as an artist would have it: thin legs, a shelf, a window, a bulb.

    Daylight comes through the panes of a window in the left wall; the room is open to the front.
    """
    left, right, front, back, top = -2.0, 2.0, 0.0, 4.4, 2.6
    floor = ((left, front, 0.0), (right, front, 0.0), (right, back, 0.0), (left, back, 0.0))
    upper = tuple((x, y, top) for x, y, _ in floor)
    sill, lintel, near, far = 0.9, 2.1, 1.4, 3.2
    window = tuple((left, y, z) for y, z in ((near, sill), (far, sill), (far, lintel), (near, lintel)))
    left_wall = (floor[0], floor[3], upper[3], upper[0], *window)

    def wall(name: str, material: str, corners: tuple[Point, ...], reflectance: Colour) -> Surface:
        return Surface(name, material, corners, ((0, 1, 2, 3),), reflectance)

    room = [
        wall("Floor", "Floorboards", floor, STUDIO_FLOOR),
        wall("Ceiling", "Ceiling Paint", (upper[0], upper[3], upper[2], upper[1]), STUDIO_CEILING),
        wall("Back Wall", "Sage Paint", (floor[3], floor[2], upper[2], upper[3]), STUDIO_SAGE),
        wall("Right Wall", "Plaster", (floor[2], floor[1], upper[1], upper[2]), STUDIO_PLASTER),
        Surface(
            "Left Wall",
            "Plaster",
            left_wall,
            tuple((k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4) for k in range(4)),
            STUDIO_PLASTER,
        ),
    ]
    pane = [(x - 0.12, y, z) for x, y, z in window]
    light = [
        Surface("Window", "Daylight", tuple(pane), ((0, 1, 2, 3),), BLACK, STUDIO_DAYLIGHT),
        sphere("Bulb", "Bulb", (0.75, 2.5, 1.95), 0.07, BLACK, STUDIO_BULB),
    ]
    outer, inner = left - 0.12, left
    frame = {
        "Bottom": ((outer, near - 0.04, sill - 0.04), (inner + 0.1, far + 0.04, sill)),
        "Top": ((outer, near - 0.04, lintel), (inner + 0.02, far + 0.04, lintel + 0.04)),
        "Front": ((outer, near - 0.04, sill), (inner + 0.02, near, lintel)),
        "Back": ((outer, far, sill), (inner + 0.02, far + 0.04, lintel)),
        "Middle": ((outer + 0.05, 2.28, sill), (outer + 0.09, 2.32, lintel)),
        "Bar": ((outer + 0.05, near, 1.63), (outer + 0.09, far, 1.66)),
    }
    fittings = [box(f"Window Frame {k}", "White Paint", low, high, STUDIO_PAINT) for k, (low, high) in frame.items()]
    fittings.append(box("Bulb Cord", "White Paint", (0.745, 2.495, 2.03), (0.755, 2.505, top), STUDIO_PAINT))
    fittings.append(box("Rug", "Rug", (-1.1, 1.2, 0.0), (1.5, 3.3, 0.012), STUDIO_RUG))
    return [*room, *light, *fittings, *_studio_furniture()]


def _studio_furniture() -> list[Surface]:
    """Return a table with a ball, a bowl's worth of cubes and a stool, and a shelf of books on the back wall."""
    surfaces = [box("Table Top", "Oak", (-0.5, 2.0, 0.71), (0.9, 2.8, 0.74), STUDIO_OAK)]
    for k, (x, y) in enumerate(((-0.46, 2.04), (0.83, 2.04), (0.83, 2.73), (-0.46, 2.73))):
        surfaces.append(box(f"Table Leg {k + 1}", "Oak", (x, y, 0.0), (x + 0.03, y + 0.03, 0.71), STUDIO_OAK))
    surfaces.append(sphere("Ball", "Clay", (-0.05, 2.35, 0.90), 0.16, STUDIO_CLAY))
    surfaces.append(cube("Box on the Table", "White Paint", (0.55, 2.45, 0.74), 0.18, 25.0, STUDIO_PAINT))
    surfaces.append(box("Stool Seat", "White Paint", (-0.95, 1.5, 0.43), (-0.6, 1.85, 0.46), STUDIO_PAINT))
    for k, (x, y) in enumerate(((-0.93, 1.52), (-0.645, 1.52), (-0.645, 1.805), (-0.93, 1.805))):
        surfaces.append(
            box(f"Stool Leg {k + 1}", "White Paint", (x, y, 0.0), (x + 0.025, y + 0.025, 0.43), STUDIO_PAINT)
        )
    surfaces.append(sphere("Floor Ball", "Ball Paint", (1.3, 1.6, 0.222), 0.21, STUDIO_BOOKS[1]))
    for k, height in enumerate((1.25, 1.65)):
        surfaces.append(box(f"Shelf {k + 1}", "Oak", (0.3, 4.15, height), (1.7, 4.4, height + 0.025), STUDIO_OAK))
    x = 0.4
    for k, (thick, tall) in enumerate(((0.04, 0.24), (0.06, 0.28), (0.03, 0.22), (0.05, 0.26), (0.045, 0.23))):
        low, high = (x, 4.2, 1.275), (x + thick, 4.38, 1.275 + tall)
        surfaces.append(box(f"Book {k + 1}", f"Cover {k % 4 + 1}", low, high, STUDIO_BOOKS[k % 4]))
        x += thick + 0.004
    surfaces.append(sphere("Shelf Ball", "Clay", (1.2, 4.27, 1.775), 0.1, STUDIO_CLAY))
    return surfaces


ROOMS: dict[str, Callable[[], list[Surface]]] = {
    "cornell_box": cornell_box,
    "paper_scene_1": paper_scene_1,
    "studio": studio,
}

CAMERAS: dict[str, Camera] = {
    # Published: at (278, 273, -800) mm, looking along z, focal length 35 mm, film 25 mm.
    "cornell_box": Camera(_from_cornell(278, 273, -800), _from_cornell(278, 273, 0), 35.0, 25.0),
    "paper_scene_1": Camera((0.0, -5.2, 1.5), (0.0, 2.0, 1.5), 45.0, 36.0, 0.75),
    "studio": Camera((0.1, -4.6, 1.45), (0.0, 2.0, 1.25), 40.0, 36.0, 0.68),
}
