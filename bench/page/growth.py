# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How time grows with patches: the power of their number that it grows as."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from ..methods import RULE, UNIFORM
from ..results import Document, Entry, of_method, title
from .markdown import Lines, paragraph, seconds, table


def growth(document: Document) -> Lines:
    """Say how time grows with patches."""
    rows = ((name, *growth_cells(entries)) for name, entries in finer_and_finer(document))
    header = ("scene and method", "patches", "seconds", "exponent, whole range", "exponent, last step")
    return [
        "## Time against patches",
        "",
        *paragraph(
            "Time grows as patches to the power of the exponent; the goal is at most 1 over the whole range. Exponents "
            "are of processor time, as small bakes are too short for the wall clock. The third column of charts shows "
            "it."
        ),
        "",
        "![All charts](images/performance-all.png)",
        "",
        *table(header, rows),
    ]


def finer_and_finer(document: Document) -> Iterator[tuple[str, list[Entry]]]:
    """Return the bakes of each scene and method with growing numbers of patches, and what they are called."""
    for scene in document["scenes"]:
        for method in (UNIFORM, RULE):
            entries = sorted(of_method(scene, method), key=lambda e: e["patches"])
            if len(entries) > 1 and entries[0]["patches"] < entries[-1]["patches"]:
                yield f"{title(scene['scene'])}, {method.partition(', ')[2]}", entries


def exponent(fewer: Entry, more: Entry) -> float | None:
    """Return the power of the patches as which processor time grows between two bakes, None where they have as many."""
    if fewer["patches"] == more["patches"]:
        return None
    ratio = more["processor_seconds"] / fewer["processor_seconds"]
    return math.log(ratio) / math.log(more["patches"] / fewer["patches"])


def growth_cells(entries: Sequence[Entry]) -> tuple[str, str, str, str]:
    """Return ranges and exponents for bakes sorted by patches."""
    first, last = entries[0], entries[-1]
    whole, step = exponent(first, last), exponent(entries[-2], last)
    return (
        f"{first['patches']:,} to {last['patches']:,}",
        f"{seconds(first['seconds'])} to {seconds(last['seconds'])}",
        "-" if whole is None else f"{whole:.2f}",
        "-" if step is None else f"{step:.2f}",
    )
