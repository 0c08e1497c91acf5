# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How time and memory grow, to 300,000 patches and to a million triangles: `python -m bench.scaling`.

Each bake runs in a process of its own, whose peak of memory is its own too. Uniform subdivision of the corridor at GOOD
makes the patches; the million triangles are the statue's, baked at GOOD by the core alone and by the whole operator.
Writes `out/scaling.json`, which the page shows; `--only` measures a part of it and keeps the rest.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from radiosity_bake.core.bake import bake
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import BakeSettings

from .machine import OUT, write_json
from .measure import run_operator
from .results import read
from .scenes import corridor, even_size, statue
from .stopwatch import Cost, timed_once

PATCHES = (1_000, 4_000, 16_000, 64_000, 256_000)
"""Asked for; the corridor's walls are split together, which makes 1,172 to 299,760 of them."""

MEMORY_LIMIT = 4096
"""MiB for the rays: at the default of 2048 so many patches would be given half of the rays of GOOD each."""

DENSE = (1100, 456)
"""Quadrangles around the statue and rings along it: a million triangles."""

QUALITY = "GOOD"

Row = dict[str, Any]


def dense_statue() -> Scene:
    """Return the statue of a million triangles in its room."""
    return statue(*DENSE)


def uniform_bake(patches: int) -> Row:
    """Bake the corridor, uniformly cut into about so many patches, in this process."""
    scene = corridor()
    size = even_size(scene, patches)
    asked = BakeSettings(
        method="UNIFORM", minimum_size=size, quality=QUALITY, memory_limit=MEMORY_LIMIT, keep_transport=False
    )
    return row_of(*timed_once(lambda: bake(scene, asked).report))


def dense_bake() -> Row:
    """Bake the dense statue with the settings that a user begins with, by the core alone, in this process."""
    scene = dense_statue()
    return row_of(*timed_once(lambda: bake(scene, BakeSettings(quality=QUALITY)).report))


def row_of(report: dict[str, Any], cost: Cost) -> Row:
    """Return what the page shows of one bake of this process."""
    return {
        **{key: report[key] for key in ("patches", "vertices", "rays")},
        **{key: round(value, 3) for key, value in cost.as_json().items()},
        "warnings": report["warnings"],
        "peak_bytes": peak_bytes(),
    }


def peak_bytes() -> int:
    """Return the most memory that this process has had."""
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


def in_a_process(which: str) -> Row:
    """Return what `python -m bench.scaling --here WHICH` prints."""
    done = subprocess.run(
        [sys.executable, "-m", "bench.scaling", "--here", which], check=True, stdout=subprocess.PIPE, text=True
    )
    row: Row = json.loads(done.stdout.splitlines()[-1])
    return row


def dense_operator() -> Row:
    """Bake the dense statue by Blender's operator, in a process of its own that bakes nothing else."""
    with tempfile.TemporaryDirectory() as folder:
        return run_operator(dense_statue(), (QUALITY,), Path(folder), warm=False)[QUALITY]


def line_of(what: str, row: Row) -> str:
    """Return one bake as a line of the printed table."""
    memory = row["peak_bytes"] / 1e9
    return (
        f"{what:<22}{row['patches']:>9,}{row['vertices']:>11,}{row['rays']:>14,}{row['seconds']:>9.1f}"
        f"{row['processor_seconds']:>9.1f}{memory:>8.2f}"
    )


def measured(which: str) -> dict[str, Any]:
    """Measure the patches or the triangles, each bake printed as it comes."""
    if which == "patches":
        rows = []
        for patches in PATCHES:
            rows.append(in_a_process(str(patches)))
            print(line_of("uniform corridor", rows[-1]), flush=True)
        return {"patches": rows}
    core = in_a_process("dense")
    print(line_of("dense statue, core", core), flush=True)
    operator = dense_operator()
    print(line_of("dense statue, operator", operator), flush=True)
    triangles = sum(len(mesh.triangles) for mesh in dense_statue().meshes)
    return {"dense": {"triangles": triangles, "core": core, "operator": operator}}


def write(parts: tuple[str, ...] = ("patches", "dense")) -> None:
    """Measure and write, and keep what else was measured before."""
    print(f"{'':<22}{'patches':>9}{'vertices':>11}{'rays':>14}{'seconds':>9}{'cpu':>9}{'GB':>8}", flush=True)
    found = {key: value for key, value in (read(OUT / "scaling.json") or {}).items() if key in ("patches", "dense")}
    for part in parts:
        found |= measured(part)
        run = datetime.now(UTC).isoformat(timespec="seconds")
        write_json(OUT / "scaling.json", {"run": run, "quality": QUALITY, "memory_limit": MEMORY_LIMIT, **found})


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(prog="python -m bench.scaling", description=__doc__.splitlines()[0])
    parser.add_argument("--only", choices=("patches", "dense"))
    parser.add_argument("--here", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.here:
        print(json.dumps(dense_bake() if asked.here == "dense" else uniform_bake(int(asked.here))))
    else:
        write((asked.only,) if asked.only else ("patches", "dense"))


if __name__ == "__main__":
    main()
