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
"""More than the pools of memory differ by from turn to turn."""


def test_twenty_bakes_leave_no_data_block_no_object_and_no_memory_behind():
    seen = long_run.turns(BAKES)
    assert seen[-1].bakes >= BAKES
    assert long_run.left_behind(seen) == {}
    assert long_run.objects_a_turn(seen) <= long_run.ALLOWED_OBJECTS
    assert seen[-1].resident - seen[-2].resident < ALLOWED_BYTES


def test_bakes_that_were_kept_would_be_found(monkeypatch):
    kept, remember = [], transports.remember

    def keep(scene, extraction, settings, result, shown):
        kept.append(result)
        remember(scene, extraction, settings, result, shown)

    monkeypatch.setattr("radiosity_bake.operators.bake.remember", keep)
    monkeypatch.setattr(long_run, "WAYS", (*long_run.WAYS[:2], *long_run.WAYS[-2:]))
    seen = long_run.turns(2 * 3)
    assert long_run.objects_a_turn(seen) > long_run.ALLOWED_OBJECTS
