# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The charts: error against time, error against vertices and time against patches for each scene; and one for all."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .methods import COLOURS, OURS, RULE, UNIFORM
from .results import Document, Entry, of_method, title

BAKES = (OURS, UNIFORM, RULE)

FORM_FACTOR_COLOURS = (COLOURS[OURS], "#2563eb", "#15803d")

# Errors below are those of rounding.
LEAST_DRAWN = 1e-8

# Small enough for the repository, large enough to read.
DOTS_PER_INCH = 80


def draw_all(document: Document, folder: Path, kinds: Sequence[str] = ("svg", "png")) -> list[Path]:
    """Draw the charts of what was measured, `performance-all` and others, into a folder; returns the files.

    Parameters
    ----------
    document : dict
        What `results.collect` returns.
    """
    pyplot = new_pyplot()
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for name, make, measured in (
        ("performance-all", every_chart, document["scenes"]),
        ("performance", one_chart, document["scenes"]),
        ("performance-form-factors", form_factor_chart, (document["form_factors"] or {}).get("results")),
    ):
        if not measured:
            continue
        figure = make(pyplot, measured)
        for kind in kinds:
            path = folder / f"{name}.{kind}"
            figure.savefig(path, dpi=DOTS_PER_INCH, metadata={"Date": None} if kind == "svg" else None)
            paths.append(path)
        pyplot.close(figure)
    return paths


def new_pyplot() -> Any:
    """Return matplotlib's plotting module, which draws into files and needs no window."""
    import matplotlib

    matplotlib.use("Agg")
    # The same numbers give the same file.
    matplotlib.rcParams["svg.hashsalt"] = "bench"
    from matplotlib import pyplot

    return pyplot


def every_chart(pyplot: Any, scenes: Sequence[Document]) -> Any:
    """Return a figure with a row for each scene and a column for each question."""
    figure, rows = pyplot.subplots(len(scenes), 3, figsize=(15.0, 3.9 * len(scenes)), squeeze=False)
    for row, scene in zip(rows, scenes, strict=True):
        error_against(row[0], scene, "seconds", "seconds", tuple(COLOURS))
        error_against(row[1], scene, "points", "vertices, or points computed", tuple(COLOURS))
        time_against_patches(row[2], scene)
        row[0].set_title(title(scene["scene"]), loc="left", fontweight="bold")
    legend(figure, rows[0][0])
    figure.tight_layout(rect=(0.0, 0.0, 1.0, 1.0 - 0.55 / figure.get_figheight()))
    return figure


def one_chart(pyplot: Any, scenes: Sequence[Document]) -> Any:
    """Return the figure of error against time, a panel for each scene."""
    columns = min(len(scenes), 3)
    rows = -(-len(scenes) // columns)
    figure, panels = pyplot.subplots(rows, columns, figsize=(4.3 * columns, 3.5 * rows + 0.8), squeeze=False)
    flat = panels.ravel()
    for axes, scene in zip(flat, scenes, strict=False):
        error_against(axes, scene, "seconds", "seconds", tuple(COLOURS))
        axes.set_title(title(scene["scene"]), loc="left", fontweight="bold")
    for axes in flat[len(scenes) :]:
        axes.axis("off")
    beside = len(flat) > len(scenes)
    if beside:
        flat[-1].legend(*flat[0].get_legend_handles_labels(), loc="center left", frameon=False)
    else:
        legend(figure, flat[0])
    figure.tight_layout(rect=(0.0, 0.0, 1.0, 1.0 if beside else 1.0 - 0.6 / figure.get_figheight()))
    return figure


def form_factor_chart(pyplot: Any, results: Sequence[Entry]) -> Any:
    """Return the figure of error against time, a panel for each case of `form_factors`."""
    names = list(dict.fromkeys(entry["case"] for entry in results))
    figure, panels = pyplot.subplots(1, len(names), figsize=(3.6 * len(names), 3.9), squeeze=False)
    methods = list(dict.fromkeys(entry["method"] for entry in results))
    for axes, name in zip(panels[0], names, strict=True):
        for method, colour in zip(methods, FORM_FACTOR_COLOURS, strict=False):
            found = (entry for entry in results if (entry["case"], entry["method"]) == (name, method))
            points = sorted((e["seconds"], max(e["error"], LEAST_DRAWN)) for e in found)
            if points:
                axes.plot(*zip(*points, strict=True), "o-", label=method, color=colour, markersize=4)
        axes.set_title(name, loc="left", fontsize=9)
        axes.set_xlabel("seconds")
        finish(axes)
    panels[0][0].set_ylabel("relative error")
    legend(figure, panels[0][0])
    figure.tight_layout(rect=(0.0, 0.0, 1.0, 0.92))
    return figure


def legend(figure: Any, axes: Any) -> None:
    """Put the lines' names above all panels."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", ncols=4, frameon=False)


def error_against(axes: Any, scene: Document, key: str, label: str, methods: Sequence[str]) -> None:
    """Draw the error of each method against a cost."""
    for method in methods:
        points = sorted((e[key], 100.0 * e["rms"]) for e in of_method(scene, method))
        # Other programs change their samples more than their points: a line through those would mean nothing.
        draw_line(axes, method, points, joined=key == "seconds" or method in BAKES)
    axes.set_xlabel(label)
    axes.set_ylabel("relative RMS error, %")
    finish(axes)


def time_against_patches(axes: Any, scene: Document) -> None:
    """Draw the time of our bakes against their patches, and a line along which time grows as patches do."""
    entries = [entry for method in BAKES for entry in of_method(scene, method)]
    for method in BAKES:
        draw_line(axes, method, sorted((e["patches"], e["seconds"]) for e in of_method(scene, method)))
    if entries:
        few, many = (pick(e["patches"] for e in entries) for pick in (min, max))
        start = min(entries, key=lambda e: e["patches"])["seconds"]
        axes.plot((few, many), (start, start * many / few), ":", color="#9ca3af", zorder=0)
    axes.set_xlabel("patches (dotted: in proportion)")
    axes.set_ylabel("seconds")
    finish(axes)


def draw_line(axes: Any, method: str, points: list[tuple[float, float]], joined: bool = True) -> None:
    """Draw one method, ours on top and thicker."""
    if points:
        own = method == OURS
        options: Entry = {"markersize": 6 if own else 4, "linewidth": 2.5 if own else 1.3, "zorder": 3 if own else 2}
        kind = "o-" if joined else "o"
        axes.plot(*zip(*points, strict=True), kind, label=method, color=COLOURS[method], **options)


def finish(axes: Any) -> None:
    """Make both axes logarithmic, with plain numbers."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        axis.set_major_formatter(lambda value, _: f"{value:g}")
        # Only where few decades are shown there is room for numbers between them.
        between = high / low < 30.0
        axis.set_minor_formatter(lambda value, _, between=between: f"{value:g}" if between else "")
    axes.tick_params(which="minor", labelsize=7)
    axes.grid(visible=True, which="both", alpha=0.25)
