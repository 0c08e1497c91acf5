# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Our bakes with what they counted."""

from __future__ import annotations

from ..methods import OURS
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
