# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the references of test_accuracy.py: `python -m tests.core.data.make_references [SCENE ...]`.

Needs what `tools/requirements/bench.txt` names; Mitsuba 3 takes minutes for the thousands of paths of each probe.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parent

PROBES = 4000
SAMPLES = 16384
"""Of the Cornell box, whose reference has been there from the start; the others are parts of the benchmark's own."""

EVERY = 4
"""Of the benchmark's probes, one in so many is kept: enough to know an error to a fifth of itself."""

SCENES = ("cornell_box", "corridor", "furnished_room", "paper_scene_1", "pillar_hall", "statue")


def main(names: list[str]) -> None:
    """Compute and write."""
    sys.path.insert(0, str(FOLDER.parents[2]))
    from tools.package import load_package

    load_package()
    from bench.measure import judged
    from bench.probes import area_uniform_probes
    from bench.reference import irradiance
    from tests.core.building import cornell_box

    for name in names or SCENES:
        if name == "cornell_box":
            scene = cornell_box()
            probes = area_uniform_probes(scene, PROBES)
            truth = irradiance(scene, probes.position, probes.normal, probes.shading_normal, samples=SAMPLES)
            rows = slice(None)
        else:
            case = judged(name, PROBES, 1)
            probes, truth = case.probes, case.reference
            rows = slice(0, None, EVERY)
        np.savez_compressed(
            FOLDER / f"reference_{name}.npz",
            mesh=probes.mesh[rows].astype(np.uint8),
            triangle=probes.triangle[rows].astype(np.uint32),
            position=probes.position[rows].astype(np.float32),
            irradiance=truth.irradiance[rows].astype(np.float32),
            variance=np.float32((truth.standard_error[rows] ** 2).mean()),
        )


if __name__ == "__main__":
    main(sys.argv[1:])
