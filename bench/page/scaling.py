# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How time and memory grow to 300,000 patches, and what a million triangles take."""

from __future__ import annotations

from ..results import Document, Entry
from .growth import exponent
from .markdown import Lines, paragraph, seconds, table


def scaling(measured: Document) -> Lines:
    """Show the growth with patches, and the dense scene."""
    rows = measured.get("patches") or []
    lines: Lines = []
    if len(rows) > 1:
        whole, last = exponent(rows[0], rows[-1]), exponent(rows[-2], rows[-1])
        busy = max(row["others"] for row in rows)
        lines += [
            "### To 300,000 patches",
            "",
            *paragraph(
                f"The corridor at {measured['quality']}, uniformly cut, each bake in a process of its own, measured "
                f"{measured['run'][:10]} by `python -m bench.scaling`. The memory limit is "
                f"{measured['memory_limit']:,} MiB, so that all patches get the same number of rays. Time "
                f"grows as patches to the power of {whole:.2f} over the whole range, of {last:.2f} in the last step. "
                f"Others kept up to {busy:.0%} of the processors busy meanwhile."
            ),
            "",
            *table(
                ("patches", "vertices", "rays", "seconds", "processor seconds", "microseconds a patch", "most memory"),
                [cells(row) for row in rows],
            ),
            "",
        ]
    dense = measured.get("dense")
    if dense:
        lines += [
            "### A million triangles",
            "",
            *paragraph(
                f"The statue made of {dense['triangles']:,} triangles at {measured['quality']}, with the settings that "
                "a user begins with, in a process that does nothing else; most memory is that of the whole process, "
                "scene and Blender included."
            ),
            "",
            *table(
                ("", "patches", "vertices", "rays", "seconds", "processor seconds", "most memory"),
                [
                    (name, *cells(dense[key])[:5], cells(dense[key])[6])
                    for key, name in (("core", "core alone"), ("operator", "whole operator"))
                ],
            ),
            "",
        ]
    return lines[:-1]


def cells(row: Entry) -> tuple[str, ...]:
    """Return the texts of a bake: its counts, its times, time over patches, memory."""
    return (
        f"{row['patches']:,}",
        f"{row['vertices']:,}",
        f"{row['rays']:,}",
        seconds(row["seconds"]),
        seconds(row["processor_seconds"]),
        f"{1e6 * row['processor_seconds'] / row['patches']:,.0f}",
        f"{row['peak_bytes'] / 1e9:.2f} GB",
    )
