# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory limit, by the memory of a process that has nothing else to do than one bake."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.cells import MOST_CELLS
from radiosity_bake.core.memory import Memory
from radiosity_bake.core.scene import PointLamp, Scene
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import DARK, block, grid

ROOT = Path(__file__).resolve().parents[2]
ABOVE_THE_LIMIT = 1.1
"""What is promised. Batches of rays and pools of memory are in it, so that the least limits come closest."""

BAKE = """
import ctypes, sys, threading, time
sys.path.insert(0, sys.argv[1])
from tools.package import load_package
load_package()
from radiosity_bake.core.bake import bake
from radiosity_bake.core.cells import MOST_CELLS
from radiosity_bake.core.memory import Memory
from radiosity_bake.core.settings import BakeSettings
from bench.scenes import SCENES

def resident():
    return int(open("/proc/self/statm").read().split()[1]) * 4096

bake(SCENES["furnace"](), BakeSettings(quality="DRAFT", output="ORIGINAL"))
ctypes.CDLL(None).malloc_trim(0)
before, most = resident(), [0]

def watch():
    while True:
        most[0] = max(most[0], resident())
        time.sleep(0.002)

threading.Thread(target=watch, daemon=True).start()
name, quality, limit, size = sys.argv[2], sys.argv[3], int(sys.argv[4]), float(sys.argv[5])
settings = BakeSettings(quality=quality, memory_limit=limit, minimum_size=size, threads=2)
report = bake(SCENES[name](), settings).report
print((most[0] - before) / 2**20 / limit)
print(len([warning for warning in report["warnings"] if "memory limit" in warning]))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is read as Linux tells it")
@pytest.mark.parametrize(
    ("scene", "quality", "limit", "size"),
    [("cornell_box", "HIGH", 64, 0.0), ("furnished_room", "GOOD", 64, 0.03), ("furnished_room", "HIGH", 128, 0.0)],
)
def test_a_bake_that_wants_more_keeps_to_the_limit_and_says_what_it_left_out(scene, quality, limit, size):
    command = [sys.executable, "-c", BAKE, str(ROOT), scene, quality, str(limit), str(size)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    share, warnings = (float(word) for word in done.stdout.split())
    assert warnings >= 1
    # Less than half of it would be coarser than need be.
    assert 0.5 < share <= ABOVE_THE_LIMIT


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_less_memory_changes_nothing_or_a_warning_says_so(output):
    lamp = PointLamp("Lamp", np.array([0.7, 0.3, 0.6]), 0.02, np.ones(3))
    meshes = (grid("Floor", 1, reflectance=(0.5,) * 3), block("Box", (0.4, 0.4, 0.0), (0.6, 0.6, 0.2)))
    scene = Scene(meshes, DARK, (lamp,))
    told, values = [], []
    for limit in (64, 256, 2048):
        result = bake(scene, BakeSettings(quality="DRAFT", output=output, memory_limit=limit, keep_transport=False))
        told.append([warning for warning in result.report["warnings"] if "memory limit" in warning])
        values.append([mesh.irradiance for mesh in result.meshes])
    assert told[0] and not told[-1], "the least limit is too little for this scene, so that the test can fail"
    for warnings, found in zip(told, values, strict=True):
        same = all(np.array_equal(one, other) for one, other in zip(found, values[-1], strict=True))
        assert same or warnings


def test_the_default_limit_has_room_for_all_cells_there_may_be():
    assert Memory(BakeSettings().memory_limit * 2**20, 1, 1).most_cells() >= MOST_CELLS
