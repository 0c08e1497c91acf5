# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every measurement."""

from __future__ import annotations

from ..results import Document, title
from .markdown import Lines, paragraph, percent, seconds, table


def everything(document: Document) -> Lines:
    """List every measurement."""
    lines = ["## Everything that was measured"]
    for scene in document["scenes"]:
        rows = (
            (
                f"{entry['method']}, {entry['setting']}",
                f"{entry['points']:,}",
                seconds(entry["seconds"]),
                seconds(entry["processor_seconds"]),
                f"{entry['others']:.0%}",
                percent(entry["rms"]),
                percent(entry["lit_rms"]),
                f"{entry['bias']:+.2%}",
                percent(entry["p95"]),
            )
            for entry in scene["results"]
        )
        header = (
            "method and setting",
            "points",
            "seconds",
            "processor seconds",
            "others",
            "error",
            "where lit",
            "mean",
        )
        lines += ["", f"### {title(scene['scene'])}", "", *table((*header, "95% below"), rows)]
    return [
        *lines,
        "",
        *paragraph(
            "*Others*: share of the processors that other programs kept busy meanwhile. *Where lit*: the error over "
            "the points that any light reaches. *Mean*: how far the mean over everything is off. *95% below*: 95% of "
            "the points have a smaller error."
        ),
    ]
