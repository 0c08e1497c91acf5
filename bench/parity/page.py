# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""`docs/parity.md`, from the numbers of `docs/parity.json`."""

from __future__ import annotations

from collections import Counter
from typing import Any

from ..page.markdown import Lines, paragraph, percent, seconds, table
from .cases import TOPICS

# What the difference may be beyond the noise of the reference.
ALLOWED = 0.02

# Sections beside the topics of the cases, and the seconds in which a room has to be baked, on two cores.
ROOMS = "rooms"
FILES = "files"
MOST_SECONDS = 60.0
CORES = 2

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

MEASURED = (
    "Measured in Blender {}. Seconds are those of the processor, summed over its cores, which do not depend on what "
    "else the machine did: for Cycles, of the two bakes that a row is compared with, of 1,024 samples each, or of more "
    "where the light is noisy; for ours, of one bake."
)

WHOLE_FILES = (
    "Everything that renders is baked at GOOD to refined meshes, shown with the textures of its materials, and "
    "restored. Seconds are half of the processor time of the bake; a room has to take less than 60. The difference "
    "is that of the pictures, as a share of what can be shown. What Restore leaves is compared with what was there "
    "before: objects, meshes with all attributes, materials, collections; the file itself is not written."
)


def met(row: Row) -> bool:
    """Return whether a row is within what is allowed.

    A whole file has to be baked in time without coming out black, and to be left as it was.
    """
    if "failed" in row:
        return False
    if "difference" in row:
        return bool(row["difference"] <= ALLOWED + row["noise"])
    kept = not row.get("left") and not row.get("file_changed", False)
    if row["topic"] == FILES and "said" in row:
        return kept
    return kept and "said" not in row and row.get("brightest", 0.0) > 0.0 and seconds_on_two_cores(row) < MOST_SECONDS


def versions(rows: dict[str, Row]) -> str:
    """Return the versions of Blender that rows were measured in, newest last, with how many when there are several."""
    found = Counter(row["blender"] for row in rows.values() if "blender" in row)
    if len(found) == 1:
        return next(iter(found))
    return ", ".join(f"{version} ({found[version]} rows)" for version in sorted(found))


def seconds_on_two_cores(row: Row) -> float:
    """Return half of the processor time of a bake, which does not depend on what else the machine did."""
    return float(row.get("processor_seconds", 0.0)) / CORES


def page(rows: dict[str, Row]) -> str:
    """Return the page."""
    kept = sum(met(row) for row in rows.values())
    lines: Lines = ["# Parity with Cycles", "", "<!-- Written by `python -m bench.parity`. -->", ""]
    lines += [*paragraph(INTRODUCTION), "", *paragraph(COLUMNS), "", *paragraph(PICTURES), ""]
    lines += [f"**{kept} of {len(rows)} rows are met.**", "", *paragraph(MEASURED.format(versions(rows))), ""]
    for topic, title in {**TOPICS, ROOMS: "Rooms like an artist's", FILES: "Files that ship with Blender"}.items():
        found = {name: row for name, row in rows.items() if row["topic"] == topic}
        if found:
            lines += section(title, found) if topic in TOPICS else files(title, found)
    return "\n".join(lines).rstrip("\n") + "\n"


def files(title: str, rows: dict[str, Row]) -> Lines:
    """Return the section of whole files: a table, what was said about each, and the pictures."""
    header = (
        "file",
        "objects",
        "vertices",
        "seconds",
        "brightest",
        "difference",
        "of the mean",
        "left as it was",
        "met",
    )
    lines = [f"## {title}", "", *paragraph(WHOLE_FILES), ""]
    lines += [*table(header, [cells_of_file(name, row) for name, row in rows.items()]), ""]
    for row in rows.values():
        told = [
            part
            for part in (row.get("failed"), row.get("said"), *row.get("warnings", ()), *row.get("left", ()))
            if part
        ]
        if told:
            lines += [f"- {row['title']}: {'; '.join(told)}.".replace("..", "."), ""]
    return lines + pictures_of(rows)


def cells_of_file(name: str, row: Row) -> list[str]:
    """Return the cells of a whole file's row."""
    title, ends = f"{row['title']} (`{name}`)", "yes" if met(row) else "**no**"
    if "failed" in row or "said" in row:
        return [title, str(row.get("objects", "")), "", "", "", "", "", "no" if row.get("left") else "yes", ends]
    shown = "picture_difference" in row
    return [
        title,
        f"{row['objects']:,}",
        f"{row['vertices']:,}",
        seconds(seconds_on_two_cores(row)),
        f"{row['brightest']:.3g}",
        percent(row["picture_difference"]) if shown else "",
        f"{row['picture_difference_of_mean']:+.2%}" if shown else "",
        "no" if row.get("left") or row.get("file_changed") else "yes",
        ends,
    ]


def section(title: str, rows: dict[str, Row]) -> Lines:
    """Return the table of one topic, what was said about rows that are not met, and the pictures."""
    header = (
        "feature",
        "Cycles",
        "ours",
        "of the mean",
        "difference",
        "with rims",
        "noise",
        "seconds, Cycles",
        "ours",
        "met",
    )
    lines = [f"## {title}", "", *table(header, [cells(name, row) for name, row in rows.items()]), ""]
    for row in rows.values():
        if not met(row):
            told = [row["failed"]] if "failed" in row else row["warnings"]
            lines += [f"- **{row['title']}** is not met" + (f": {'; '.join(told)}." if told else "."), ""]
        if "note" in row:
            lines += [*paragraph(f"- {row['title']}: {row['note']}"), ""]
    return lines + pictures_of(rows)


def pictures_of(rows: dict[str, Row]) -> Lines:
    """Return the pictures of those rows that have any."""
    lines: Lines = []
    for row in rows.values():
        if row.get("picture"):
            lines += [f"**{row['title']}**", "", f"![Cycles, ours, difference](images/parity/{row['picture']})", ""]
    return lines


def cells(name: str, row: Row) -> list[str]:
    """Return the cells of a row."""
    title = f"{row['title']} (`{name}`)"
    if "failed" in row:
        return [title, *[""] * 8, "no"]
    used = row.get("processor_seconds", {})
    return [
        title,
        f"{sum(row['cycles']) / 3:.4g}",
        f"{sum(row['ours']) / 3:.4g}",
        f"{row['difference_of_mean']:+.2%}",
        percent(row["difference"]),
        percent(row["difference_with_rims"]),
        percent(row["noise"]),
        *(seconds(used[name]) if name in used else "" for name in ("cycles", "ours")),
        "yes" if met(row) else "**no**",
    ]
