# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""`docs/parity.md`, from the numbers of `docs/parity.json`."""

from __future__ import annotations

from typing import Any

from ..page.markdown import Lines, paragraph, percent, table
from .cases import TOPICS

# What the difference may be beyond the noise of the reference.
ALLOWED = 0.02

Row = dict[str, Any]

INTRODUCTION = (
    "A scene for every feature, built by script in Blender and baked twice at the same vertices: by our operator at "
    "GOOD, and by Cycles' own bake of diffuse light to vertex colours without Color, at 64 bounces, without clamping "
    "and without adaptive sampling. `make parity` measures all rows and writes this page; "
    '`make parity PARITY="sun_wide spot"` measures some of them again and keeps the others.'
)
COLUMNS = (
    "Cycles and ours are the means over the vertices and the three colours. The difference is the root mean square "
    "over them, relative to that of Cycles' light; noise is that of the reference itself, from two bakes with "
    "different seeds. A row is met if the difference is at most 2% plus that noise. Vertices on the rim and on the "
    "creases of a mesh are in the column with rims only: there our light is gathered a little inside the face, "
    "while Cycles' rays start on the edge."
)
PICTURES = (
    "Pictures: Cycles, path traced and denoised; the scene baked to refined meshes, as its display material shows it; "
    "the second less the first, four times enlarged, grey where they agree."
)


def met(row: Row) -> bool:
    """Return whether a row is within what is allowed."""
    return "failed" not in row and bool(row["difference"] <= ALLOWED + row["noise"])


def page(rows: dict[str, Row]) -> str:
    """Return the page."""
    kept = sum(met(row) for row in rows.values())
    lines: Lines = ["# Parity with Cycles", "", "<!-- Written by `python -m bench.parity`. -->", ""]
    lines += [*paragraph(INTRODUCTION), "", *paragraph(COLUMNS), "", *paragraph(PICTURES), ""]
    lines += [f"**{kept} of {len(rows)} rows are met.**", ""]
    for topic, title in TOPICS.items():
        found = {name: row for name, row in rows.items() if row["topic"] == topic}
        if found:
            lines += section(title, found)
    return "\n".join(lines).rstrip("\n") + "\n"


def section(title: str, rows: dict[str, Row]) -> Lines:
    """Return the table of one topic, what was said about rows that are not met, and the pictures."""
    header = ("feature", "Cycles", "ours", "of the mean", "difference", "with rims", "noise", "met")
    lines = [f"## {title}", "", *table(header, [cells(name, row) for name, row in rows.items()]), ""]
    for row in rows.values():
        if not met(row):
            told = [row["failed"]] if "failed" in row else row["warnings"]
            lines += [f"- **{row['title']}** is not met" + (f": {'; '.join(told)}." if told else "."), ""]
    for row in rows.values():
        if row.get("picture"):
            lines += [f"**{row['title']}**", "", f"![Cycles, ours, difference](images/parity/{row['picture']})", ""]
    return lines


def cells(name: str, row: Row) -> list[str]:
    """Return the cells of a row."""
    title = f"{row['title']} (`{name}`)"
    if "failed" in row:
        return [title, "", "", "", "", "", "", "no"]
    return [
        title,
        f"{sum(row['cycles']) / 3:.4g}",
        f"{sum(row['ours']) / 3:.4g}",
        f"{row['difference_of_mean']:+.2%}",
        percent(row["difference"]),
        percent(row["difference_with_rims"]),
        percent(row["noise"]),
        "yes" if met(row) else "**no**",
    ]
