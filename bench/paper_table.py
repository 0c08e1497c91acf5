# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's table as text: uniform against adaptive, and where the time of each went."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

Row = dict[str, Any]

COLUMNS = ("scene", "n", "fragments", "vertices", "rays", "seconds", "cpu", "error", "fewer", "gain", "cpu gain")
WIDTHS = (14, 7, 15, 15, 23, 13, 13, 14, 7, 8, 9)


def gain(row: Row, key: str) -> float:
    """Return the share that adaptive saves on uniform, negative where it takes more."""
    return float(1.0 - row["adaptive"][key] / row["uniform"][key])


def is_finest(row: Row, rows: Sequence[Row]) -> bool:
    """Say whether a row has the least minimum size of its scene."""
    return bool(row["minimum_size"] == min(r["minimum_size"] for r in rows if r["scene"] == row["scene"]))


def cells(row: Row) -> tuple[str, ...]:
    """Return the texts of a row's columns, uniform / adaptive in each."""
    u, a = row["uniform"], row["adaptive"]
    return (
        row["scene"],
        f"{row['minimum_size']:g}",
        *(f"{u[key]:,} / {a[key]:,}" for key in ("fragments", "vertices", "rays")),
        *(f"{u[key]:.2f} / {a[key]:.2f}" for key in ("seconds", "processor_seconds")),
        f"{u['rms']:.2%} / {a['rms']:.2%}",
        *(f"{gain(row, key):.1%}" for key in ("fragments", "seconds", "processor_seconds")),
    )


def lines_of(rows: Sequence[Row]) -> list[str]:
    """Return the table: a line that explains, the header, a line for each row."""
    explained = "Uniform / adaptive. Fewer, gain: fragments, time and processor time that adaptive saves on uniform."
    return [explained, aligned(COLUMNS), *(aligned(cells(row)) for row in rows)]


def aligned(texts: Sequence[str]) -> str:
    """Return texts in columns, the first to the left, the others to the right."""
    return "".join(
        f"{text:<{width}}" if k == 0 else f"{text:>{width + 2}}"
        for k, (text, width) in enumerate(zip(texts, WIDTHS, strict=True))
    )


def costliest_stage(row: Row) -> tuple[str, float]:
    """Return the stage in which adaptive loses most against uniform, and its share of uniform's whole time."""
    u, a = row["uniform"]["stages"], row["adaptive"]["stages"]
    stage = max((s for s in a if s != "total"), key=lambda s: a[s] - u[s])
    return stage, (a[stage] - u[stage]) / u["total"]


def stage_lines(rows: Sequence[Row]) -> list[str]:
    """Return the seconds of each stage for both methods, and the stage that keeps adaptive from being faster."""
    if not rows:
        return []
    stages = [stage for stage in rows[0]["adaptive"]["stages"] if stage != "total"]
    header = f"{'scene':<14}{'n':>7}" + "".join(f"{stage.replace('_', ' '):>18}" for stage in stages)
    lines = ["Seconds by stage, uniform / adaptive, and the stage in which adaptive loses most:", header]
    for row in rows:
        u, a = row["uniform"]["stages"], row["adaptive"]["stages"]
        line = f"{row['scene']:<14}{row['minimum_size']:>7g}"
        line += "".join(f"{f'{u[stage]:.2f} / {a[stage]:.2f}':>18}" for stage in stages)
        stage, loss = costliest_stage(row)
        lost = f"{stage.replace('_', ' ')}: {loss:.0%} of uniform's time" if loss > 0.0 else "none"
        lines.append(f"{line}   {lost}")
    return lines
