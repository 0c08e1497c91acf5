# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What bakes cost, in counts: they are the same on every machine, so they show a change that seconds would hide.

`python -m tests.core.data.make_counts` writes the counts that are expected.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import cornell_box, room_with_block
from tests.scenes import exact

FILE = Path(__file__).parent / "data" / "counts.json"

COUNTED = ("patches", "vertices", "rays")

TOLERANCE = 0.03
"""How far a count may move unnoticed: another numpy or another processor rounds a few rays and splits differently."""


def room_with_ball() -> Scene:
    """The room with a block, and a ball of 1,280 triangles over it: what a curved mesh costs."""
    room = room_with_block()
    vertices, triangles = exact.icosphere(3)
    ball = surface_mesh("ball", 0.25 * vertices + (0.8, 0.9, 1.2), triangles, reflectance=exact.rgb(0.5))
    return Scene((*room.meshes, ball), room.world)


def block_under_the_sky() -> Scene:
    """A floor and a block under a white sky: rays leave, and no emitter is sampled."""
    _, *_, block = room_with_block().meshes
    floor = exact.rectangle("floor", (0, 0, 0), (2, 0, 0), (0, 2, 0), reflectance=0.5)
    return Scene((floor, block), np.ones(3))


def room_lit_from_many_faces() -> Scene:
    """The room with a glowing ball of 320 faces in place of its lamp: what many emitters cost."""
    room = room_with_block()
    vertices, triangles = exact.icosphere(2)
    ball = surface_mesh("lamp", 0.15 * vertices + (1.3, 0.7, 1.5), triangles, emission=exact.rgb(20.0))
    return Scene((*(mesh for mesh in room.meshes if mesh.name != "lamp"), ball), room.world)


def room_lit_from_below_its_ceiling() -> Scene:
    """The room with a lamp that shines up, close under the ceiling: a small bright spot lights all else."""
    room = room_with_block()
    up = exact.rectangle("lamp", (0.9, 0.9, 1.9), (0.2, 0, 0), (0, 0.2, 0), emission=20.0)
    return Scene((*(mesh for mesh in room.meshes if mesh.name != "lamp"), up), room.world)


CASES: dict[str, tuple[Callable[[], Scene], BakeSettings]] = {
    "Cornell box, draft": (cornell_box, BakeSettings(quality="DRAFT")),
    "Cornell box, good": (cornell_box, BakeSettings(quality="GOOD")),
    "Cornell box, draft on its own mesh": (cornell_box, BakeSettings(quality="DRAFT", output="ORIGINAL")),
    "Cornell box, draft by the paper's rule": (cornell_box, BakeSettings(quality="DRAFT", minimum_size=0.05)),
    "Cornell box, draft, uniform": (cornell_box, BakeSettings(quality="DRAFT", minimum_size=0.05, method="UNIFORM")),
    "room with a ball, draft": (room_with_ball, BakeSettings(quality="DRAFT")),
    "room lit from many faces, draft": (room_lit_from_many_faces, BakeSettings(quality="DRAFT")),
    "room lit from below its ceiling, draft": (room_lit_from_below_its_ceiling, BakeSettings(quality="DRAFT")),
    "block under the sky, draft": (block_under_the_sky, BakeSettings(quality="DRAFT")),
}


def counts_of(case: str) -> dict[str, int]:
    """Return what the bake of a case counts."""
    scene, settings = CASES[case]
    report = bake(scene(), settings).report
    return {name: report[name] for name in COUNTED}


def expected_counts() -> dict[str, dict[str, int]]:
    """Return what was written down last."""
    counts: dict[str, dict[str, int]] = json.loads(FILE.read_text(encoding="utf-8"))
    return counts


def test_every_case_has_expected_counts_and_no_other_has():
    assert sorted(expected_counts()) == sorted(CASES)


@pytest.mark.parametrize("case", CASES)
def test_a_bake_costs_the_patches_vertices_and_rays_that_it_did(case):
    expected, found = expected_counts()[case], counts_of(case)
    moved = [
        f"{name}: {expected[name]:,} expected, {found[name]:,} found ({found[name] / expected[name] - 1:+.1%})"
        for name in COUNTED
        if abs(found[name] - expected[name]) > TOLERANCE * expected[name]
    ]
    assert not moved, (
        f"The cost of '{case}' has changed. {'; '.join(moved)}. If that is meant, and the errors are as they should "
        "be, write the new counts down: python -m tests.core.data.make_counts"
    )
