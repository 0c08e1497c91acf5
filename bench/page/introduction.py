# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What was measured, how, on what machine, and whether it was disturbed."""

from __future__ import annotations

from ..results import Document, title
from .markdown import Lines, paragraph, percent, table

# Share of the processors that others may take before a time is called disturbed.
DISTURBED = 0.05


def introduction(document: Document) -> Lines:
    """Say what was measured, how, and on what."""
    lines = [
        "# Performance",
        "",
        *paragraph(
            "How exact and how fast a bake is, beside other programs on the same scenes. `make bench` measures, and "
            "writes this page from what it measured; nothing here is written by hand."
        ),
        "",
    ]
    scenes = document["scenes"]
    if not scenes:
        return [*lines, "Nothing has been measured yet."]
    machines = dict.fromkeys(machine_line(scene) for scene in scenes)
    lines += [line for machine in machines for line in paragraph(f"Measured on: {machine}.")]
    lines += [
        "",
        "![Error against time](images/performance.png)",
        "",
        "*Relative RMS error over the surface against seconds, both logarithmic; lower and further left is better.*",
        "",
        *paragraph(
            "**Error.** Irradiance at area-uniform points of the surface, emitters left out, minus that of a converged "
            "path tracer (Mitsuba 3, many samples, computed once): root mean square over points and colour channels, "
            "relative to the mean. The reference's own noise, which is known, is subtracted in squares."
        ),
        "",
        *paragraph(
            "**Who computes what.** Our bakes, and the lines *to vertices*, compute vertices, and the points "
            "interpolate between them. *At the probes* means that a program computes the very points at which it is "
            "judged: it has no error of interpolation and often fewer points to compute, which favours it. The uniform "
            "meshes of the lines *to vertices* are ours, cut where objects stand on them, which favours them too. "
            "Mitsuba's kernels are compiled, and Blender is started, before the clock runs. Our time is that of the "
            "whole bake from arrays to arrays; where other programs' time is divided by ours, that of the whole "
            "operator."
        ),
        "",
        *table(
            ("scene", "triangles", "points", "paths a point of the reference", "its noise", "measured"),
            (
                (
                    title(scene["scene"]),
                    f"{scene['triangles']:,}",
                    f"{scene['probes']:,}",
                    f"{scene['reference_samples']:,}",
                    percent(scene["reference_noise"]),
                    measured_when(scene),
                )
                for scene in scenes
            ),
        ),
    ]
    disturbed = max(entry["others"] for scene in scenes for entry in scene["results"])
    if disturbed > DISTURBED:
        lines += [
            "",
            *paragraph(
                f"**The machine was busy with other things**: up to {disturbed:.0%} of its processors during a "
                "measurement. So seconds are longer than they would be, and not alike for all; processor time is the "
                "better measure, and stands beside them."
            ),
        ]
    return lines


def machine_line(scene: Document) -> str:
    """Return processor, cores and versions in one line."""
    machine = scene["machine"]
    versions = ", ".join(f"{name} {version}" for name, version in machine["versions"].items())
    return f"{machine['processor']}, {machine['cores']} cores, {machine['system']}; {versions}"


def measured_when(scene: Document) -> str:
    """Say when a scene was measured, and whether the peers were measured in the same run."""
    own = scene["run"]
    others = sorted({entry["run"] for entry in scene["results"]} - {own})
    day = own[:10]
    if not others:
        return f"{day}, all in one run"
    days = sorted({other[:10] for other in others})
    return f"{day}, other programs in another run ({', '.join(days)})"
