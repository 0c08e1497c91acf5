# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The chart: error against time and against vertices, a row for each scene."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .machine import OUT

COLOURS = {
    "Radiosity Bake adaptive": "#c2410c",
    "Radiosity Bake uniform": "#f59e0b",
    "Mitsuba 3": "#2563eb",
    "Radiance rtrace -I": "#15803d",
    "Cycles bake to vertices": "#6b7280",
}

AXES = (("seconds", "seconds"), ("points", "vertices, or points computed"))


def draw(entries: list[dict[str, Any]], name: str = "bench") -> list[Path]:
    """Draw what was measured to `out/<name>.svg` and `.png`, and return where.

    Parameters
    ----------
    entries : list of dict
        With `scene`, `method`, `seconds`, `points` and `accuracy` (`rms`).
    """
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = name
    from matplotlib import pyplot

    scenes = list(dict.fromkeys(e["scene"] for e in entries))
    figure, rows = pyplot.subplots(len(scenes), 2, figsize=(10.0, 3.4 * len(scenes)), squeeze=False, sharey="row")
    for row, scene in zip(rows, scenes, strict=True):
        for axes, (key, label) in zip(row, AXES, strict=True):
            _panel(axes, [e for e in entries if e["scene"] == scene], key)
            axes.set_xlabel(label)
        row[0].set_ylabel("relative RMS error, %")
        row[0].set_title(scene.replace("_", " "), loc="left")
    rows[0][0].legend(fontsize=8)
    figure.tight_layout()
    paths = [OUT / f"{name}.{kind}" for kind in ("svg", "png")]
    for path in paths:
        figure.savefig(path, dpi=110, metadata={"Date": None} if path.suffix == ".svg" else None)
    pyplot.close(figure)
    return paths


def _panel(axes: Any, entries: list[dict[str, Any]], key: str) -> None:
    """Draw a line for each method."""
    for method in dict.fromkeys(e["method"] for e in entries):
        points = sorted((e[key], 100.0 * e["accuracy"]["rms"]) for e in entries if e["method"] == method)
        axes.plot(*zip(*points, strict=True), "o-", markersize=4, label=method, color=COLOURS.get(method))
    axes.set_xscale("log")
    axes.set_yscale("log")
    for kind in (axes.yaxis.set_major_formatter, axes.yaxis.set_minor_formatter):
        kind(lambda value, _: f"{value:g}")
    axes.tick_params(axis="y", which="minor", labelsize=7)
    axes.grid(visible=True, which="both", alpha=0.25)
