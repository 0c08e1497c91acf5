# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Our bakes with what they counted, and how their time grows with patches."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..methods import OURS, RULE, UNIFORM
from ..results import Document, Entry, of_method, own_cost, ray_share, title
from .markdown import Lines, paragraph, percent, seconds, table


def own_bakes(document: Document) -> Lines:
    """List our bakes with what they counted."""
    rows = (
        (
            f"{title(scene['scene'])}, {entry['setting']}",
            seconds(entry["seconds"]),
            seconds(own_cost(entry, "seconds")),
            seconds(entry["processor_seconds"]),
            f"{ray_share(entry, scene['machine']['cores']):.0%}",
            percent(entry["rms"]),
            percent(entry["estimated_error"]),
            f"{entry['patches']:,}",
            f"{entry['points']:,}",
            f"{entry['rays']:,}",
            longest_stages(entry),
        )
        for scene in document["scenes"]
        for entry in of_method(scene, OURS)
    )
    header = ("scene", "seconds", "whole operator", "processor seconds", "of it rays", "error", "estimated")
    return [
        "## Our bakes",
        "",
        *paragraph(
            "*Whole operator*: seconds from Blender's meshes to Blender's meshes. *Of it rays*: the share of the "
            "time of all cores inside the ray library. *Estimated*: the error that the bake itself reports, without "
            "knowing the reference."
        ),
        "",
        *table((*header, "patches", "vertices", "rays", "longest stages"), rows),
    ]


def longest_stages(entry: Entry, most: int = 2) -> str:
    """Return the stages that took longest, with their share of the time."""
    stages = {stage: spent for stage, spent in entry["stages"].items() if stage != "total"}
    total = sum(stages.values())
    first = sorted(stages, key=stages.__getitem__, reverse=True)[:most]
    return ", ".join(f"{stage.replace('_', ' ')} {stages[stage] / total:.0%}" for stage in first)


def growth(document: Document) -> Lines:
    """Say how time grows with patches."""
    rows = []
    for scene in document["scenes"]:
        for method in (UNIFORM, RULE):
            entries = sorted(of_method(scene, method), key=lambda e: e["patches"])
            if len(entries) > 1 and entries[0]["patches"] < entries[-1]["patches"]:
                rows.append((f"{title(scene['scene'])}, {method.partition(', ')[2]}", *growth_cells(entries)))
    header = ("scene and method", "patches", "seconds", "exponent, whole range", "exponent, last step")
    return [
        "## Time against patches",
        "",
        *paragraph(
            "Time grows as patches to the power of the exponent; the goal is at most 1. Exponents are of processor "
            "time, as small bakes are too short for the wall clock. The third column of charts shows it."
        ),
        "",
        "![All charts](images/performance-all.png)",
        "",
        *table(header, rows),
    ]


def growth_cells(entries: Sequence[Entry]) -> tuple[str, str, str, str]:
    """Return ranges and exponents for bakes sorted by patches."""

    def exponent(a: Entry, b: Entry) -> str:
        if a["patches"] == b["patches"]:
            return "-"
        ratio = b["processor_seconds"] / a["processor_seconds"]
        return f"{math.log(ratio) / math.log(b['patches'] / a['patches']):.2f}"

    first, last = entries[0], entries[-1]
    return (
        f"{first['patches']:,} to {last['patches']:,}",
        f"{seconds(first['seconds'])} to {seconds(last['seconds'])}",
        exponent(first, last),
        exponent(entries[-2], last),
    )
