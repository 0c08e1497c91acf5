# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The methods that are compared, by the names that charts and tables show, and what we want to reach."""

from __future__ import annotations

OURS = "Radiosity Bake"
UNIFORM = "Radiosity Bake, uniform"
RULE = "Radiosity Bake, the paper's rule alone"
MITSUBA = "Mitsuba 3 at the probes"
MITSUBA_VERTICES = "Mitsuba 3 to vertices"
RADIANCE = "Radiance rtrace -I at the probes"
CYCLES = "Cycles bake to vertices"

PEERS = (MITSUBA, MITSUBA_VERTICES, RADIANCE, CYCLES)

COLOURS = {
    OURS: "#c2410c",
    UNIFORM: "#f59e0b",
    RULE: "#a855f7",
    MITSUBA: "#2563eb",
    MITSUBA_VERTICES: "#7dd3fc",
    RADIANCE: "#15803d",
    CYCLES: "#6b7280",
}

BENCH_SCENES = ("cornell_box", "corridor", "furnished_room", "pillar_hall", "statue")

# Times faster at equal error than each peer: on the Cornell box, and elsewhere.
FASTER_ON_CORNELL_BOX = {MITSUBA: 20.0, RADIANCE: 50.0, CYCLES: 500.0}
FASTER_ELSEWHERE = {MITSUBA: 10.0, RADIANCE: 20.0, CYCLES: 100.0}

# Relative RMS error over the surface.
LARGEST_ERROR = {"GOOD": 0.02, "HIGH": 0.01}

# Times fewer vertices than uniform subdivision at equal error.
FEWER_VERTICES = 4.0

# Share of a bake's time, of all cores, inside the ray library.
RAY_SHARE = 0.5

# Time grows no faster than patches; a million triangles fit into so much memory, and take minutes.
GROWTH = 1.0
MOST_GIGABYTES = 4.0
MOST_MINUTES = 10.0

# The estimated error over the true one: a bound, and not too pessimistic a one.
ESTIMATE_OVER_TRUTH = (1.0, 3.0)

# Gain in time of adaptive over uniform subdivision at the finest size of each of the paper's scenes.
PAPER_GAINS = {"paper_scene_1": 0.60, "paper_scene_2": 0.50, "paper_scene_3": 0.45}


def faster_goal(scene: str, peer: str) -> float | None:
    """Return how many times faster than a peer we want to be on a scene; None where no goal was set."""
    goals = FASTER_ON_CORNELL_BOX if scene == "cornell_box" else FASTER_ELSEWHERE
    return goals.get(peer)
