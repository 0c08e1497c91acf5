# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the reference of test_accuracy.py, cornell_box.npz: `python -m tests.core.data.make_cornell_box`.

Needs what `tools/requirements/bench.txt` names; Mitsuba 3 takes minutes for the 16,384 paths of each probe.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

PROBES = 4000
SAMPLES = 16384


def main() -> None:
    """Compute and write."""
    sys.path.insert(0, str(Path(__file__).resolve().parents[3]))
    from tools.package import load_package

    load_package()
    from bench.probes import area_uniform_probes
    from bench.reference import irradiance
    from tests.core.building import cornell_box

    scene = cornell_box()
    probes = area_uniform_probes(scene, PROBES)
    truth = irradiance(scene, probes.position, probes.normal, probes.shading_normal, samples=SAMPLES)
    np.savez_compressed(
        Path(__file__).with_name("cornell_box.npz"),
        mesh=probes.mesh.astype(np.uint8),
        triangle=probes.triangle.astype(np.uint8),
        position=probes.position.astype(np.float32),
        normal=probes.normal.astype(np.float16),
        irradiance=truth.irradiance.astype(np.float32),
        variance=np.float32((truth.standard_error**2).mean()),
    )


if __name__ == "__main__":
    main()
