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

# Sections beside the topics of the cases, and the processor seconds in which each of two cores has to bake a room.
ROOMS = "rooms"
FILES = "files"
MOST_SECONDS = 60.0
CORES = 2

# Of what a screen can show, which is about the lightness L*/100 of CIE 1976. The difference that is just noticeable is
# 2.3 units there (Mahy, Van Eycken, Oosterlinck 1994); pictures may differ by it, beyond the noise of Cycles' own.
NOTICEABLE = 0.023
# A room that is lighter or darker as a whole is seen at once beside the other picture: 1 unit is where one begins to.
NOTICEABLE_MEAN = 0.01

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
    "restored. The processor seconds are all that the bake used on all cores; half of them, which is the least that it "
    "takes two cores, has to be less than 60. It is not what a clock shows, which depends on what else the machine "
    "does. The difference is that of the pictures, root mean square and mean, as a share of what can be shown, which "
    "is about a hundredth of the lightness L* of CIE 1976; noise is that of Cycles' picture, from two with different "
    "seeds, and empty where it was not measured. A row is met if the difference is at most 2.3%, the one that is just "
    "noticeable, plus that noise, and that of the mean at most 1%. What Restore leaves is compared with what was there "
    "before: objects, meshes with all attributes, materials, collections; the file itself is not written."
)


def met(row: Row) -> bool:
    """Return whether a row is within what is allowed.

    A whole file has to be baked in time without coming out black, to look as in Cycles, and to be left as it was.
    """
    if "failed" in row:
        return False
    if "difference" in row:
        return bool(row["difference"] <= ALLOWED + row["noise"] and row.get("picture_difference", 0.0) <= ALLOWED)
    kept = not row.get("left") and not row.get("file_changed", False)
    if row["topic"] == FILES and "said" in row:
        return kept
    if not kept or "said" in row:
        return False
    return row["brightest"] > 0.0 and row["processor_seconds"] < CORES * MOST_SECONDS and looks_alike(row)


def looks_alike(row: Row) -> bool:
    """Return whether the pictures of a whole file differ by less than one sees; where there is no camera, they do."""
    if "picture_difference" not in row:
        return True
    return bool(
        row["picture_difference"] <= NOTICEABLE + row.get("picture_noise", 0.0)
        and abs(row["picture_difference_of_mean"]) <= NOTICEABLE_MEAN
    )


def versions(rows: dict[str, Row]) -> str:
    """Return the versions of Blender that rows were measured in, newest last, with how many when there are several."""
    found = Counter(row["blender"] for row in rows.values() if "blender" in row)
    if len(found) == 1:
        return next(iter(found))
    return ", ".join(f"{version} ({found[version]} rows)" for version in sorted(found))


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
        "processor seconds",
        "brightest",
        "difference",
        "of the mean",
        "noise",
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
        if "picture_difference" in row and not looks_alike(row):
            told.insert(0, "its picture differs by more than is allowed, so that it is not met")
        if told:
            lines += [f"- {row['title']}: {'; '.join(told)}.".replace("..", "."), ""]
    return lines + pictures_of(rows)


def cells_of_file(name: str, row: Row) -> list[str]:
    """Return the cells of a whole file's row."""
    title, ends = f"{row['title']} (`{name}`)", "yes" if met(row) else "**no**"
    if "failed" in row or "said" in row:
        return [title, str(row.get("objects", "")), *[""] * 6, "no" if row.get("left") else "yes", ends]
    shown = "picture_difference" in row
    return [
        title,
        f"{row['objects']:,}",
        f"{row['vertices']:,}",
        seconds(row["processor_seconds"]),
        f"{row['brightest']:.3g}",
        percent(row["picture_difference"]) if shown else "",
        f"{row['picture_difference_of_mean']:+.2%}" if shown else "",
        percent(row["picture_noise"]) if "picture_noise" in row else "",
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
        if "picture_difference" in row:
            told = (
                f"what counts lies between the vertices; the pictures differ by {percent(row['picture_difference'])} of"
            )
            lines += [*paragraph(f"- {row['title']}: {told} what can be shown, at most {ALLOWED:.0%} is met."), ""]
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
