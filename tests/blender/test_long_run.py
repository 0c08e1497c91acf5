# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Twenty bakes of every kind in one process: nothing grows. `python -m tools.long_run` makes two hundred."""

import sys

import pytest
from radiosity_bake.operators import transports

from tools import long_run

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is read as Linux tells it")

BAKES = 20
ALLOWED_BYTES = 2 * 2**20
"""More than the pools of glibc differ by from turn to turn."""

MORE_TURNS = 6
"""Where memory comes from other pools, which a Blender may bring along, it goes up and down by more: then so many turns
may be made until it is down again. What a turn leaves behind adds up instead."""


def test_twenty_bakes_leave_no_data_block_no_object_and_no_memory_behind():
    seen = long_run.turns(BAKES)
    assert seen[-1].bakes >= BAKES
    assert long_run.left_behind(seen) == {}
    assert long_run.objects_a_turn(seen) <= long_run.ALLOWED_OBJECTS
    first, *later = (turn.resident for turn in seen[1:])
    for _ in range(MORE_TURNS):
        if min(later) - first < ALLOWED_BYTES:
            break
        later.append(long_run.turns(1)[-1].resident)
    assert min(later) - first < ALLOWED_BYTES


def test_bakes_that_were_kept_would_be_found(monkeypatch):
    kept, remember = [], transports.remember

    def keep(scene, extraction, settings, result, shown):
        kept.append(result)
        remember(scene, extraction, settings, result, shown)

    monkeypatch.setattr("radiosity_bake.operators.bake.remember", keep)
    monkeypatch.setattr(long_run, "WAYS", (*long_run.WAYS[:2], *long_run.WAYS[-2:]))
    seen = long_run.turns(2 * 3)
    assert long_run.objects_a_turn(seen) > long_run.ALLOWED_OBJECTS
