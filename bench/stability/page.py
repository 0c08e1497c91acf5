# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""`docs/stability.md` and its charts, from the numbers of `docs/stability.json`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..chart import new_pyplot
from ..page.markdown import Lines, paragraph, table
from .cases import CYCLES, OURS, PYVIEWFACTOR, RAYSTRACK, ROWS, SWEEPS, Sweep
from .programs import NODES, RAYS, SAMPLES

Row = dict[str, Any]

COLOURS = {OURS: "#dc2626", ROWS: "#f59e0b", CYCLES: "#7c3aed", RAYSTRACK: "#2563eb", PYVIEWFACTOR: "#15803d"}

# Errors below are those of rounding, and are drawn there.
LEAST_DRAWN = 1e-9
MOST_DRAWN = 1e3

INTRODUCTION = (
    "Each scene has an answer that is known, and is made worse step by step. `make stability` measures everything and "
    'writes this page; `make stability STABILITY="gap wall"` measures some of it again and keeps the rest.'
)
HOW = (
    "Where nothing else is said, a black receiver sees an emitter of radiance 1, so that its mean irradiance over π is "
    "the form factor from it to the emitter. **Radiosity Bake** is the whole bake at GOOD, its mean taken over the "
    f"refined mesh; **traced rows** are {RAYS:,} of the rays by which patches exchange light, counted; direct light "
    f"does not depend on them. **Cycles** bakes {SAMPLES:,} samples to each of {NODES} × {NODES} vertices at the nodes "
    f"of a Gauss rule. **raystrack** traces {RAYS:,} rays from the smaller of the two surfaces; **pyViewFactor** "
    "integrates each pair of eight triangles a square. Errors are relative to the truth, so that 1 means that nothing "
    "was found; between rooms, what is shown is the mean light in the dark one over that in the bright one. Programs "
    "that cannot say it, or were not measured yet, have no column."
)


def error_of(sweep: Sweep, row: Row, found: Row) -> float | None:
    """Return the error of an answer, relative to the truth; None where there is no answer."""
    if "failed" in found:
        return None
    return float(abs(found["said"]) if sweep.kind == "leak" else abs(found["said"] / row["truth"] - 1.0))


def met(sweep: Sweep, rows: list[Row]) -> bool:
    """Return whether our bake stays below its limit everywhere."""
    errors = [error_of(sweep, row, row["found"][OURS]) for row in rows]
    return all(error is not None and error < sweep.limit for error in errors)


def page(measured: dict[str, Row]) -> str:
    """Return the page."""
    kept = sum(met(SWEEPS[name], entry["rows"]) for name, entry in measured.items())
    lines: Lines = ["# Stability where methods fail", "", "<!-- Written by `python -m bench.stability`. -->", ""]
    lines += [*paragraph(INTRODUCTION), "", *paragraph(HOW), ""]
    lines += [f"**Ours stays within its limit in {kept} of {len(measured)} sweeps.**", ""]
    missing = [sweep.title for name, sweep in SWEEPS.items() if name not in measured]
    if missing:
        lines += [*paragraph(f"Not measured yet: {'; '.join(missing)}."), ""]
    for name, entry in measured.items():
        lines += section(SWEEPS[name], entry["rows"])
    return "\n".join(lines).rstrip("\n") + "\n"


def section(sweep: Sweep, rows: list[Row]) -> Lines:
    """Return one sweep: what it is, a table of errors, the chart, and what was said beside numbers."""
    names = [name for name in COLOURS if any(name in row["found"] for row in rows)]
    ends = "kept" if met(sweep, rows) else "**not kept**"
    lines = [f"## {sweep.title}", "", *paragraph(f"{sweep.why} Limit for ours: {sweep.limit:g}, {ends}."), ""]
    body = []
    for row in rows:
        cells = [cell(sweep, row, row["found"][name]) if name in row["found"] else "" for name in names]
        body.append([f"{row['value']:g}", *cells])
    lines += [*table((sweep.magnitude, *names), body), ""]
    lines += [f"![{sweep.title}](images/stability/{sweep.name}.svg)", ""]
    for told, values in remarks(rows).items():
        lines += [*paragraph(f"- At {values}: {told}"), ""]
    return lines


def cell(sweep: Sweep, row: Row, found: Row) -> str:
    """Return an error as the table shows it."""
    error = error_of(sweep, row, found)
    return "none" if error is None else "0" if error == 0.0 else f"{error:.1e}"


def remarks(rows: list[Row]) -> dict[str, str]:
    """Return why answers are missing and what our bake warned of, and at which values."""
    found: dict[str, list[str]] = {}
    for row in rows:
        for name, each in row["found"].items():
            told = [each["failed"]] if "failed" in each else each.get("warnings", ())
            for sentence in told:
                found.setdefault(f"{name}: {sentence}", []).append(f"{row['value']:g}")
    return {told: ", ".join(values) for told, values in found.items()}


def draw(sweep: Sweep, rows: list[Row], path: Path) -> None:
    """Draw the errors of all programs against the magnitude."""
    pyplot = new_pyplot()
    figure, axes = pyplot.subplots(figsize=(7.0, 3.6))
    values = [row["value"] for row in rows]
    places, labels = axis_places(sweep, values)
    for name, colour in COLOURS.items():
        points = []
        for place, row in zip(places, rows, strict=True):
            error = error_of(sweep, row, row["found"][name]) if name in row["found"] else None
            if error is not None:
                points.append((place, min(max(error, LEAST_DRAWN), MOST_DRAWN)))
        if points:
            axes.plot(*zip(*points, strict=True), "o-", label=name, color=colour, lw=2.5 if name == OURS else 1.3)
    axes.axhline(sweep.limit, color="#9ca3af", ls=":", label="limit for ours")
    axes.set_yscale("log")
    axes.set_xticks(places, labels)
    axes.set_xlabel(sweep.magnitude)
    axes.set_ylabel("leak" if sweep.kind == "leak" else "relative error")
    axes.grid(visible=True, alpha=0.25)
    figure.legend(loc="outside upper center", ncols=3, frameon=False, fontsize=8)
    figure.tight_layout(rect=(0.0, 0.0, 1.0, 0.88))
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)
    pyplot.close(figure)


def axis_places(sweep: Sweep, values: list[float]) -> tuple[list[float], list[str]]:
    """Return where along the axis the values stand, at even steps, and what is written there."""
    return list(range(len(values))), [f"{value:g}" for value in values]
