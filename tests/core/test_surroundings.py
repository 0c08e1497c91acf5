# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A dim room is lit as exactly as a bright one, whatever is bright beside it."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
from radiosity_bake.core import bake as bake_module
from radiosity_bake.core.bake import bake
from radiosity_bake.core.result import BakeResult
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import BakeSettings

from bench.accuracy import irradiance_at_probes
from bench.probes import area_uniform_probes
from tests.core.building import moved, room_with_block
from tests.scenes import exact

GOOD = BakeSettings(quality="GOOD", keep_transport=False)
AWAY = (100.0, 0.0, 0.0)
DIMMER = 1.0 / 30.0


def two_rooms(dimmer: float) -> Scene:
    """Two closed rooms that do not see each other; the lamp of the second is so much dimmer."""
    first, second = room_with_block(), moved(room_with_block(), by=AWAY)
    others = tuple(replace(m, name=f"Other {m.name}", emission=dimmer * np.asarray(m.emission)) for m in second.meshes)
    return replace(first, meshes=first.meshes + others)


def vertices(result: BakeResult) -> tuple[int, int]:
    """Of the first room and of the other."""
    count, half = [len(mesh.vertices) for mesh in result.meshes], len(result.meshes) // 2
    return sum(count[:half]), sum(count[half:])


@pytest.fixture(scope="module")
def both() -> BakeResult:
    return bake(two_rooms(DIMMER), GOOD)


@pytest.fixture(scope="module")
def alone() -> int:
    return sum(len(mesh.vertices) for mesh in bake(room_with_block(), GOOD).meshes)


def test_a_dim_room_gets_about_as_many_vertices_as_alone(both: BakeResult, alone: int):
    _, dim = vertices(both)
    # Errors count from three quarters of the mean on: they may be a third larger, with as many fewer vertices.
    assert 0.6 * alone < dim < 1.2 * alone


def test_a_dim_room_is_as_exact_as_a_bright_one(both: BakeResult):
    room = room_with_block()
    there = area_uniform_probes(room, 2000)
    beside = replace(there, mesh=there.mesh + len(room.meshes), position=there.position + AWAY)
    bright, dim = irradiance_at_probes(both, there), irradiance_at_probes(both, beside) / DIMMER
    # Each of them is off by about one percent of the mean.
    assert np.sqrt(np.mean((dim - bright) ** 2)) / bright.mean() < 0.02


def test_rooms_that_are_equally_bright_are_treated_as_one_alone(alone: int):
    assert sum(vertices(bake(two_rooms(1.0), GOOD))) < 2.2 * alone


def noise(scene: Scene) -> float:
    """Of the hemisphere rays at the first vertices, as it is judged, relative to the mean."""
    with patch.object(bake_module, "enough_rays", wraps=bake_module.enough_rays) as judged:
        bake(scene, GOOD)
    return judged.call_args_list[0].args[2]


def test_noise_in_a_dim_room_is_judged_as_if_the_room_were_alone():
    room = room_with_block()
    yard = exact.rectangle("yard", (10.0, 0.0, 0.0), (10.0, 0.0, 0.0), (0.0, 10.0, 0.0), reflectance=0.5)
    under_a_sky = replace(room, meshes=(*room.meshes, yard), world=np.full(3, 2.0))
    # Errors count from three quarters of the mean on, and nothing but the room has noise. Over all area it would be two
    # fifths of that.
    assert noise(under_a_sky) > 0.6 * noise(room)
