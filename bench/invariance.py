# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Hunt for scenes whose light changes with what must not matter: `python -m bench.invariance`.

Random rooms, and scenes of the benchmark by name, are baked as they are and changed: moved, turned, scaled with their
lamps, with other orders of objects and faces, other diagonals, objects split and joined, more threads, other batches.
The mean light of every object is to stay within the error that both bakes state; with other threads all bytes are to
stay. What does not is told, and the exit code is 1.

    python -m bench.invariance                                  ten random rooms
    python -m bench.invariance --rooms 50 --seed 7              others
    python -m bench.invariance --scene cornell_box --rooms 0    a scene of the benchmark
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from unittest import mock

import numpy as np
from radiosity_bake.core import workers
from radiosity_bake.core.bake import bake
from radiosity_bake.core.result import BakeResult
from radiosity_bake.core.scene import AreaLamp, Floats, Lamp, PointLamp, Scene, SunLamp, SurfaceMesh
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import block, mesh_area
from tests.scenes import exact

from .scenes import SCENES

SETTINGS = BakeSettings(quality="DRAFT", keep_transport=False, threads=2)

# Of rays per batch, in place of what is usual.
OTHER_BATCH = 5000

OF_TRIANGLES = ("triangles", "corner_normals", "reflectance", "emission")


@dataclass(frozen=True, eq=False)
class Changed:
    """A scene that is to be lit as another one.

    Attributes
    ----------
    scene : Scene
    object_of_mesh : tuple of int
        The object, by its number in the scene as it was, that each mesh is or is part of; joined ones have one number.
    """

    scene: Scene
    object_of_mesh: tuple[int, ...]


Change = Callable[[Scene, np.random.Generator], Changed]


def mapped(
    scene: Scene, change: Callable[[SurfaceMesh], SurfaceMesh], lamps: tuple[Lamp, ...] | None = None
) -> Changed:
    """Return the scene with every mesh changed."""
    meshes = tuple(change(mesh) for mesh in scene.meshes)
    return Changed(
        replace(scene, meshes=meshes, lamps=scene.lamps if lamps is None else lamps), tuple(range(len(meshes)))
    )


def taken(mesh: SurfaceMesh, triangles: np.ndarray) -> SurfaceMesh:
    """Return a mesh of some triangles of another, in an order."""
    return replace(mesh, **{name: getattr(mesh, name)[triangles] for name in OF_TRIANGLES})


def moved(scene: Scene, rng: np.random.Generator) -> Changed:
    """Move everything by a thousand sizes of the scene."""
    by = rng.normal(size=3) * 1e3

    def lamp_moved(lamp: Lamp) -> Lamp:
        return lamp if isinstance(lamp, SunLamp) else replace(lamp, centre=lamp.centre + by)

    return mapped(scene, lambda m: replace(m, vertices=m.vertices + by), tuple(map(lamp_moved, scene.lamps)))


def turned(scene: Scene, rng: np.random.Generator) -> Changed:
    """Turn everything about a random axis."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))

    def lamp_turned(lamp: Lamp) -> Lamp:
        if isinstance(lamp, SunLamp):
            return replace(lamp, direction=lamp.direction @ turn)
        if isinstance(lamp, AreaLamp):
            lamp = replace(lamp, half_axes=lamp.half_axes @ turn, normal=lamp.normal @ turn)
        return replace(lamp, centre=lamp.centre @ turn)

    return mapped(
        scene,
        lambda m: replace(m, vertices=m.vertices @ turn, corner_normals=m.corner_normals @ turn),
        tuple(map(lamp_turned, scene.lamps)),
    )


def scaled(scene: Scene, rng: np.random.Generator) -> Changed:
    """Scale everything, and the power of lamps by the square."""
    by = 10.0 ** rng.uniform(-3.0, 3.0)

    def lamp_scaled(lamp: Lamp) -> Lamp:
        if isinstance(lamp, PointLamp):
            return replace(lamp, centre=lamp.centre * by, radius=lamp.radius * by, strength=lamp.strength * by**2)
        if isinstance(lamp, AreaLamp):
            return replace(lamp, centre=lamp.centre * by, half_axes=lamp.half_axes * by)
        return lamp

    return mapped(scene, lambda m: replace(m, vertices=m.vertices * by), tuple(map(lamp_scaled, scene.lamps)))


def objects_shuffled(scene: Scene, rng: np.random.Generator) -> Changed:
    """Number the objects otherwise."""
    order = rng.permutation(len(scene.meshes))
    return Changed(replace(scene, meshes=tuple(scene.meshes[k] for k in order)), tuple(order.tolist()))


def faces_shuffled(scene: Scene, rng: np.random.Generator) -> Changed:
    """Number the faces of each object otherwise."""
    return mapped(scene, lambda m: taken(m, rng.permutation(len(m.triangles))))


def corners_rolled(scene: Scene, rng: np.random.Generator) -> Changed:
    """Begin each triangle with another corner."""
    return mapped(
        scene,
        lambda m: replace(
            m, triangles=np.roll(m.triangles, 1, axis=1), corner_normals=np.roll(m.corner_normals, 1, axis=1)
        ),
    )


def other_diagonals(scene: Scene, rng: np.random.Generator) -> Changed:
    """Cut flat quads, triangles (a, b, c) and (a, c, d), along their other diagonal."""

    def change(mesh: SurfaceMesh) -> SurfaceMesh:
        t = mesh.triangles
        if len(t) % 2 or not (np.array_equal(t[::2, 0], t[1::2, 0]) and np.array_equal(t[::2, 2], t[1::2, 1])):
            return mesh
        if any(not np.array_equal(getattr(mesh, name)[::2], getattr(mesh, name)[1::2]) for name in OF_TRIANGLES[1:]):
            return mesh
        a, b, c, d = *t[::2].T, t[1::2, 2]
        return replace(mesh, triangles=np.stack([b, c, d, b, d, a], axis=1).reshape(-1, 3))

    return mapped(scene, change)


def objects_split(scene: Scene, rng: np.random.Generator) -> Changed:
    """Make two objects of each that is no single quad, each with half of its faces, at random."""
    meshes, of = [], []
    for number, mesh in enumerate(scene.meshes):
        order = rng.permutation(len(mesh.triangles))
        halves = np.array_split(order, 2) if len(order) > 2 else [order]
        meshes += [taken(mesh, np.sort(half)) for half in halves]
        of += [number] * len(halves)
    return Changed(replace(scene, meshes=tuple(meshes)), tuple(of))


def objects_joined(scene: Scene, rng: np.random.Generator) -> Changed:
    """Make one object of all."""
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in scene.meshes])
    joined = replace(
        scene.meshes[0],
        vertices=np.concatenate([mesh.vertices for mesh in scene.meshes]),
        triangles=np.concatenate([m.triangles + k for m, k in zip(scene.meshes, first, strict=False)]),
        **{name: np.concatenate([getattr(m, name) for m in scene.meshes]) for name in OF_TRIANGLES[1:]},
    )
    return Changed(replace(scene, meshes=(joined,)), (0,))


CHANGES: dict[str, Change] = {
    "moved": moved,
    "turned": turned,
    "scaled": scaled,
    "objects in another order": objects_shuffled,
    "faces in another order": faces_shuffled,
    "other first corners": corners_rolled,
    "other diagonals": other_diagonals,
    "objects split": objects_split,
    "objects joined": objects_joined,
}


def random_room(seed: int) -> Scene:
    """Return a closed room with blocks, a lamp of each of two kinds, and at random a sheet that stands on the floor."""
    rng = np.random.default_rng(seed)
    size = rng.uniform(1.5, 5.0, 3)
    meshes = [exact.closed_room(tuple(size), reflectance=tuple(rng.uniform(0.2, 0.85, 3)))]
    for number in range(int(rng.integers(1, 5))):
        low = size * np.append(rng.uniform(0.05, 0.6, 2), 0.0)
        high = low + size * rng.uniform(0.05, 0.3, 3)
        solid = block(f"block {number}", tuple(low), tuple(high), turned=rng.uniform(0.0, 90.0))
        meshes.append(replace(solid, reflectance=np.full_like(solid.reflectance, rng.uniform(0.1, 0.8))))
    if rng.random() < 0.5:
        across = size * rng.uniform(0.1, 0.4, 3)
        meshes.append(
            exact.rectangle("sheet", (*across[:2], 0.0), (0.0, across[1], 0.0), (0.0, 0.0, across[2]), reflectance=0.5)
        )
    wide = size[:2] * rng.uniform(0.1, 0.4, 2)
    corner = (*(size[:2] * rng.uniform(0.1, 0.5, 2)), size[2] * rng.uniform(0.9, 0.99))
    meshes.append(exact.rectangle("lamp", corner, (0.0, wide[1], 0.0), (wide[0], 0.0, 0.0), emission=5.0))
    bulb = PointLamp("bulb", size * rng.uniform(0.7, 0.9, 3), 0.05, rng.uniform(0.1, 1.0, 3))
    return Scene(tuple(meshes), np.zeros(3), (bulb,))


def light_of_objects(result: BakeResult, object_of_mesh: tuple[int, ...], objects: int) -> tuple[Floats, Floats]:
    """Return the mean irradiance over pi of the fronts of each object, and their areas; none of objects not baked."""
    area, light = np.zeros(objects), np.zeros(objects)
    for mesh in result.meshes:
        number, own = object_of_mesh[mesh.mesh], mesh_area(mesh)
        area[number] += own.sum()
        light[number] += own @ mesh.irradiance.mean(axis=(1, 2))
    return np.divide(light, area, out=np.full(objects, np.nan), where=area > 0.0), area


def difference(plain: BakeResult, other: BakeResult, changed: Changed, objects: int) -> float:
    """Return the largest change of an object's mean light, in errors that the two bakes state."""
    before, area = light_of_objects(plain, tuple(range(objects)), objects)
    after, _ = light_of_objects(other, changed.object_of_mesh, objects)
    if len(changed.scene.meshes) == 1 < objects:
        known = area > 0.0
        before, after = before[known] @ area[known] / area[known].sum(), after[:1]
    error = np.hypot(plain.report["estimated_error"], other.report["estimated_error"])
    return float(np.nanmax(np.abs(after - before)) / (error * np.nanmax(before)))


def same_bytes(one: BakeResult, other: BakeResult) -> bool:
    """Return whether all values of two bakes are the same."""
    return all(
        a.vertices.tobytes() == b.vertices.tobytes() and a.irradiance.tobytes() == b.irradiance.tobytes()
        for a, b in zip(one.meshes, other.meshes, strict=True)
    )


def hunt(name: str, scene: Scene, seed: int) -> list[str]:
    """Return what changed the light of a scene that must not, and print how much each change did."""
    plain = bake(scene, SETTINGS)
    found, told = [], []
    for what, change in CHANGES.items():
        changed = change(scene, np.random.default_rng(seed))
        ratio = difference(plain, bake(changed.scene, SETTINGS), changed, len(scene.meshes))
        told.append(f"{ratio:.2f}")
        if not ratio <= 1.0:
            found.append(f"{name}: {what}: {ratio:.2f} of the stated error")
    if not same_bytes(plain, bake(scene, replace(SETTINGS, threads=1))):
        found.append(f"{name}: one thread gives other bytes than two")
    with mock.patch.object(workers, "RAYS_PER_BATCH", OTHER_BATCH):
        other = Changed(scene, tuple(range(len(scene.meshes))))
        ratio = difference(plain, bake(scene, SETTINGS), other, len(scene.meshes))
    told.append(f"{ratio:.2f}")
    if ratio > 0.1:
        found.append(f"{name}: smaller batches: {ratio:.2f} of the stated error")
    print(f"{name:<22}{'  '.join(told)}", flush=True)
    return found


def main() -> int:
    """Hunt, and tell what was found."""
    parser = argparse.ArgumentParser(prog="python -m bench.invariance", description=__doc__.splitlines()[0])
    parser.add_argument("--rooms", type=int, default=10, help="how many random rooms")
    parser.add_argument("--seed", type=int, default=0, help="of the first of them")
    parser.add_argument("--scene", action="append", default=[], choices=SCENES, help="of the benchmark, too")
    asked = parser.parse_args()
    print("largest change of an object's mean light, in stated errors:", ", ".join([*CHANGES, "smaller batches"]))
    found = []
    for name in asked.scene:
        found += hunt(name, SCENES[name](), asked.seed)
    for seed in range(asked.seed, asked.seed + asked.rooms):
        found += hunt(f"room {seed}", random_room(seed), seed)
    print("\n".join(found) or "nothing changed what it must not")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
