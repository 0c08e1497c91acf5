# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What other programs and uniform subdivision take for the error that our bake has."""

from __future__ import annotations

from ..convergence import BY_VERTICES, AtError, cost_at
from ..methods import FEWER_VERTICES, OURS, PEERS, UNIFORM, faster_goal
from ..results import CLOCKS, Document, of_method, own_bake, own_cost, pairs, title
from .markdown import SIGNS, Lines, paragraph, percent, seconds, table, times

COMPARED_QUALITIES = ("GOOD", "HIGH")


def faster(scene: Document, peer: str, quality: str, clock: str) -> AtError | None:
    """Return the peer's time over ours at the error of one of our qualities."""
    own = own_bake(scene, quality)
    if own is None or own["rms"] <= 0.0:
        return None
    theirs = cost_at(pairs(of_method(scene, peer), clock), own["rms"])
    return AtError(theirs.cost / own_cost(own, clock), theirs.kind) if theirs else None


def faster_by_both(scene: Document, peer: str, quality: str) -> float | None:
    """Return the peer's time over ours by the clock that favours us less: what a goal is judged by.

    Wall clock favours whoever was measured on a quiet machine, processor time whoever leaves processors idle.
    """
    ratios = [faster(scene, peer, quality, clock) for clock in CLOCKS]
    return min((ratio.cost for ratio in ratios if ratio is not None), default=None)


def fewer_vertices(scene: Document, quality: str) -> AtError | None:
    """Return the vertices of uniform subdivision over ours at the error of one of our qualities."""
    own = own_bake(scene, quality)
    if own is None or own["rms"] <= 0.0:
        return None
    theirs = cost_at(pairs(of_method(scene, UNIFORM), "points"), own["rms"], BY_VERTICES)
    return AtError(theirs.cost / own["points"], theirs.kind) if theirs else None


def ratio_cell(scene: Document, peer: str, quality: str) -> str:
    """Return how many times faster we are, by wall clock and, in brackets, by processor time."""
    wall, processor = (faster(scene, peer, quality, clock) for clock in CLOCKS)
    if wall is None or processor is None:
        return "-"
    cell = f"{SIGNS[wall.kind]}{times(wall.cost)} ({times(processor.cost)})"
    goal = faster_goal(scene["scene"], peer)
    return cell if goal is None or min(wall.cost, processor.cost) >= goal else f"{cell} of {goal:g}"


def equal_error(document: Document) -> Lines:
    """Say how many times longer each peer takes for the error that our bake has."""
    rows = []
    for scene in document["scenes"]:
        for quality in COMPARED_QUALITIES:
            own = own_bake(scene, quality)
            if own is not None:
                cells = [ratio_cell(scene, peer, quality) for peer in PEERS]
                name = f"{title(scene['scene'])}, {quality}"
                rows.append((name, percent(own["rms"]), seconds(own_cost(own, "seconds")), *cells))
    return [
        "## Time at equal error",
        "",
        *paragraph(
            "Each program's time for the error that our bake has, divided by the time of our whole operator, from "
            "Blender's meshes to Blender's meshes: by wall clock and, in brackets, by processor time of all cores. "
            "Between two settings the time is interpolated, both scales logarithmic. ≥: the error lies beyond the "
            "program's best setting, and it is granted that its error falls from there as one over the square root of "
            "time, which interpolation on its mesh would slow down. ≤: its cheapest setting is better already. *of 20* "
            "stands where the goal, which is that factor, is missed by either clock."
        ),
        "",
        *table(("scene", "our error", "our seconds", *PEERS), rows),
    ]


def vertices(document: Document) -> Lines:
    """Say how many more vertices uniform subdivision takes for the same error."""
    rows = []
    for scene in document["scenes"]:
        for entry in of_method(scene, OURS):
            fewer = fewer_vertices(scene, entry["setting"])
            if fewer is not None:
                name = f"{title(scene['scene'])}, {entry['setting']}"
                factor = f"{SIGNS[fewer.kind]}{times(fewer.cost)}"
                rows.append((name, percent(entry["rms"]), f"{entry['points']:,}", factor))
    return [
        "## Vertices at equal error",
        "",
        *paragraph(
            "The vertices of uniform subdivision for the error that our bake has, divided by ours. ≥: beyond the "
            f"finest one, the error is granted to fall as one over the vertices. The goal is {FEWER_VERTICES:g}."
        ),
        "",
        *table(("scene", "error", "our vertices", "uniform over ours"), rows),
    ]
