# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The page `docs/performance.md`, made of what was measured: the goals beside it, whatever it is."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence

from .convergence import BY_VERTICES, AtError, cost_at
from .methods import (
    ESTIMATE_OVER_TRUTH,
    FASTER_ELSEWHERE,
    FASTER_ON_CORNELL_BOX,
    FEWER_VERTICES,
    LARGEST_ERROR,
    OURS,
    PAPER_GAINS,
    PEERS,
    RAY_SHARE,
    RULE,
    UNIFORM,
    faster_goal,
)
from .paper_table import costliest_stage, gain
from .results import Document, Entry, of_method, pairs, title

# Share of the processors that others may take before a time is called disturbed.
DISTURBED = 0.05

# Relative error of form factors to which times are compared.
FORM_FACTOR_ERROR = 0.01

COMPARED_QUALITIES = ("GOOD", "HIGH")

Lines = list[str]


def page(document: Document) -> str:
    """Return the page's text for what `results.collect` returns."""
    parts = [introduction(document)]
    if document["scenes"]:
        parts += [goals(document), equal_error(document), vertices(document), own_bakes(document)]
        parts += [growth(document)]
    if document["form_factors"]:
        parts += [form_factors(document["form_factors"]["results"])]
    if document["paper_table"]:
        parts += [paper_table(document["paper_table"])]
    if document["scenes"]:
        parts += [everything(document)]
    return "\n".join(line for part in parts for line in (*part, "")).rstrip() + "\n"


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> Lines:
    """Return a table; the first column is text, the others are numbers."""
    return [
        "| " + " | ".join(header) + " |",
        "|" + "|".join(["---"] + ["---:"] * (len(header) - 1)) + "|",
        *("| " + " | ".join(row) + " |" for row in rows),
    ]


def paragraph(text: str) -> Lines:
    """Return a text in lines of the documents' length."""
    return textwrap.wrap(text, 120, break_long_words=False, break_on_hyphens=False)


def percent(share: float) -> str:
    """Return a share with two or three digits that mean something."""
    return f"{share:.2%}" if share < 0.1 else f"{share:.1%}"


def seconds(value: float) -> str:
    """Return seconds with two or three digits."""
    return f"{value:.2f}" if value < 10.0 else f"{value:.1f}" if value < 100.0 else f"{value:,.0f}"


def times(value: float) -> str:
    """Return a factor with two or three digits."""
    return f"{value:.2g}" if value < 10.0 else f"{value:,.0f}"


# -------------------------------------------------------------------------------------------------------- the sections


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
            "whole bake from arrays to arrays."
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


def goals(document: Document) -> Lines:
    """Put what we want beside what was measured, met or not."""
    rows: list[tuple[str, str, str]] = []
    scenes = document["scenes"]
    for quality, most in LARGEST_ERROR.items():
        found = {s["scene"]: e["rms"] for s in scenes for e in of_method(s, OURS) if e["setting"] == quality}
        rows.append(goal_row(f"error at {quality} at most {most:.0%}", found, lambda x, m=most: x <= m, percent, max))
    for quality in COMPARED_QUALITIES:
        for peer, goal in FASTER_ON_CORNELL_BOX.items():
            for where, chosen, least in (
                ("on the Cornell box", [s for s in scenes if s["scene"] == "cornell_box"], goal),
                ("elsewhere", [s for s in scenes if s["scene"] != "cornell_box"], FASTER_ELSEWHERE[peer]),
            ):
                found = {}
                for scene in chosen:
                    ratio = faster(scene, peer, quality, "seconds")
                    if ratio is not None:
                        found[scene["scene"]] = ratio.cost
                name = f"{least:g} times faster than {peer} {where}, at the error of {quality}"
                rows.append(goal_row(name, found, lambda x, g=least: x >= g, times, min))
    fewer = {s["scene"]: f.cost for s in scenes if (f := fewer_vertices(s, "GOOD")) is not None}
    rows.append(
        goal_row(
            f"{FEWER_VERTICES:g} times fewer vertices than uniform subdivision, at the error of GOOD",
            fewer,
            lambda x: x >= FEWER_VERTICES,
            times,
            min,
        )
    )
    shares = {
        s["scene"]: ray_share(e, s["machine"]["cores"])
        for s in scenes
        for e in of_method(s, OURS)
        if e["setting"] == "GOOD"
    }
    name = f"{RAY_SHARE:.0%} of the time of GOOD, of all cores, inside the ray library"
    rows.append(goal_row(name, shares, lambda x: x >= RAY_SHARE, "{:.0%}".format, min))
    low, high = ESTIMATE_OVER_TRUTH
    estimates = {
        f"{s['scene']} {e['setting']}": e["estimated_error"] / e["rms"]
        for s in scenes
        for e in of_method(s, OURS)
        if e["rms"] > 0.0
    }
    rows.append(
        goal_row("estimated error no less than the true one", estimates, lambda x: x >= low, "{:.2f} of it".format, min)
    )
    rows.append(
        goal_row(f"and no more than {high:g} times", estimates, lambda x: x <= high, "{:.2f} times".format, max)
    )
    return [
        "## Goals",
        "",
        "What we want, the worst that was measured, and on which scene.",
        "",
        *table(("goal", "worst measured", "met"), rows),
    ]


def goal_row(
    goal: str,
    found: Mapping[str, float],
    met: Callable[[float], bool],
    write: Callable[[float], str],
    worst: Callable[..., str],
) -> tuple[str, str, str]:
    """Return a goal beside the worst of what was found, by scene; `worst` is `min` or `max`."""
    if not found:
        return goal, "not measured", ""
    scene = worst(found, key=found.__getitem__)
    good = sum(bool(met(value)) for value in found.values())
    verdict = "yes" if good == len(found) else "**no**" if good == 0 else f"**on {good} of {len(found)}**"
    return goal, f"{write(found[scene])} ({title(scene)})", verdict


def faster(scene: Document, peer: str, quality: str, clock: str) -> AtError | None:
    """Return the peer's time over ours at the error of one of our qualities."""
    own = [entry for entry in of_method(scene, OURS) if entry["setting"] == quality]
    if not own or own[0]["rms"] <= 0.0:
        return None
    theirs = cost_at(pairs(of_method(scene, peer), clock), own[0]["rms"])
    return AtError(theirs.cost / own_cost(own[0], clock), theirs.kind) if theirs else None


def own_cost(entry: Entry, clock: str) -> float:
    """Return what the whole operator took, or the core where that was not measured."""
    return float(entry.get(f"operator_{clock}", entry[clock]))


def fewer_vertices(scene: Document, quality: str) -> AtError | None:
    """Return the vertices of uniform subdivision over ours at the error of one of our qualities."""
    own = [entry for entry in of_method(scene, OURS) if entry["setting"] == quality]
    if not own or own[0]["rms"] <= 0.0:
        return None
    theirs = cost_at(pairs(of_method(scene, UNIFORM), "points"), own[0]["rms"], BY_VERTICES)
    return AtError(theirs.cost / own[0]["points"], theirs.kind) if theirs else None


def ray_share(entry: Entry, cores: int) -> float:
    """Return the share of a bake's time, of all cores, inside the ray library."""
    return float(entry["seconds_in_ray_library"] / (entry["seconds"] * cores))


SIGNS = {"between": "", "beyond": "≥ ", "below": "≤ "}


def ratio_cell(scene: Document, peer: str, quality: str) -> str:
    """Return how many times faster we are, by wall clock and, in brackets, by processor time."""
    wall, processor = (faster(scene, peer, quality, clock) for clock in ("seconds", "processor_seconds"))
    if wall is None or processor is None:
        return "-"
    cell = f"{SIGNS[wall.kind]}{times(wall.cost)} ({times(processor.cost)})"
    goal = faster_goal(scene["scene"], peer)
    return cell if goal is None or wall.cost >= goal else f"{cell} of {goal:g}"


def equal_error(document: Document) -> Lines:
    """Say how many times longer each peer takes for the error that our bake has."""
    rows = []
    for scene in document["scenes"]:
        for quality in COMPARED_QUALITIES:
            own = [entry for entry in of_method(scene, OURS) if entry["setting"] == quality]
            if own:
                cells = [ratio_cell(scene, peer, quality) for peer in PEERS]
                name = f"{title(scene['scene'])}, {quality}"
                rows.append((name, percent(own[0]["rms"]), seconds(own_cost(own[0], "seconds")), *cells))
    return [
        "## Time at equal error",
        "",
        *paragraph(
            "Each program's time for the error that our bake has, divided by the time of our whole operator, from "
            "Blender's meshes to Blender's meshes: by wall clock and, in brackets, by processor time of all cores. "
            "Between two settings the time is interpolated, both scales logarithmic. ≥: the error lies beyond the "
            "program's best setting, and it is granted that its error falls from there as one over the square root of "
            "time, which interpolation on its mesh would slow down. ≤: its cheapest setting is better already. *of 20* "
            "stands where the goal, which is that factor, is missed by wall clock."
        ),
        "",
        *table(("scene", "our error", "our seconds", *PEERS), rows),
    ]


def vertices(document: Document) -> Lines:
    """Say how many more vertices uniform subdivision takes for the same error."""
    rows = []
    for scene in document["scenes"]:
        for entry in of_method(scene, OURS):
            fewer = fewer_vertices(scene, entry["setting"])
            if fewer is not None:
                name = f"{title(scene['scene'])}, {entry['setting']}"
                factor = f"{SIGNS[fewer.kind]}{times(fewer.cost)}"
                rows.append((name, percent(entry["rms"]), f"{entry['points']:,}", factor))
    return [
        "## Vertices at equal error",
        "",
        *paragraph(
            "The vertices of uniform subdivision for the error that our bake has, divided by ours. ≥: beyond the "
            f"finest one, the error is granted to fall as one over the vertices. The goal is {FEWER_VERTICES:g}."
        ),
        "",
        *table(("scene", "error", "our vertices", "uniform over ours"), rows),
    ]


def own_bakes(document: Document) -> Lines:
    """List our bakes with what they counted."""
    rows = (
        (
            f"{title(scene['scene'])}, {entry['setting']}",
            seconds(entry["seconds"]),
            seconds(own_cost(entry, "seconds")),
            seconds(entry["processor_seconds"]),
            f"{ray_share(entry, scene['machine']['cores']):.0%}",
            percent(entry["rms"]),
            percent(entry["estimated_error"]),
            f"{entry['patches']:,}",
            f"{entry['points']:,}",
            f"{entry['rays']:,}",
            longest_stages(entry),
        )
        for scene in document["scenes"]
        for entry in of_method(scene, OURS)
    )
    header = ("scene", "seconds", "whole operator", "processor seconds", "of it rays", "error", "estimated")
    return [
        "## Our bakes",
        "",
        *paragraph(
            "*Whole operator*: seconds from Blender's meshes to Blender's meshes. *Of it rays*: the share of the "
            "time of all cores inside the ray library. *Estimated*: the error that the bake itself reports, without "
            "knowing the reference."
        ),
        "",
        *table((*header, "patches", "vertices", "rays", "longest stages"), rows),
    ]


def longest_stages(entry: Entry, most: int = 2) -> str:
    """Return the stages that took longest, with their share of the time."""
    stages = {stage: spent for stage, spent in entry["stages"].items() if stage != "total"}
    total = sum(stages.values())
    first = sorted(stages, key=stages.__getitem__, reverse=True)[:most]
    return ", ".join(f"{stage.replace('_', ' ')} {stages[stage] / total:.0%}" for stage in first)


def growth(document: Document) -> Lines:
    """Say how time grows with patches."""
    rows = []
    for scene in document["scenes"]:
        for method in (UNIFORM, RULE):
            entries = sorted(of_method(scene, method), key=lambda e: e["patches"])
            if len(entries) > 1 and entries[0]["patches"] < entries[-1]["patches"]:
                rows.append((f"{title(scene['scene'])}, {method.partition(', ')[2]}", *growth_cells(entries)))
    header = ("scene and method", "patches", "seconds", "exponent, whole range", "exponent, last step")
    return [
        "## Time against patches",
        "",
        *paragraph(
            "Time grows as patches to the power of the exponent; the goal is at most 1. Exponents are of processor "
            "time, as small bakes are too short for the wall clock. The third column of charts shows it."
        ),
        "",
        "![All charts](images/performance-all.png)",
        "",
        *table(header, rows),
    ]


def growth_cells(entries: Sequence[Entry]) -> tuple[str, str, str, str]:
    """Return ranges and exponents for bakes sorted by patches."""

    def exponent(a: Entry, b: Entry) -> str:
        if a["patches"] == b["patches"]:
            return "-"
        ratio = b["processor_seconds"] / a["processor_seconds"]
        return f"{math.log(ratio) / math.log(b['patches'] / a['patches']):.2f}"

    first, last = entries[0], entries[-1]
    return (
        f"{first['patches']:,} to {last['patches']:,}",
        f"{seconds(first['seconds'])} to {seconds(last['seconds'])}",
        exponent(first, last),
        exponent(entries[-2], last),
    )


def form_factors(results: Sequence[Entry]) -> Lines:
    """Put our form factors beside those of programs that compute nothing else."""
    rows = []
    for case, method in dict.fromkeys((entry["case"], entry["method"]) for entry in results):
        found = [entry for entry in results if (entry["case"], entry["method"]) == (case, method)]
        best = min(found, key=lambda e: e["error"])
        within = cost_at(((e["seconds"], e["error"]) for e in found if e["seconds"] > 0.0), FORM_FACTOR_ERROR)
        enough = seconds_of(within) if within and min(e["error"] for e in found) <= FORM_FACTOR_ERROR else "not reached"
        cells = (f"{best['factor']:.6f}", f"{best['error']:.1e}", seconds(best["seconds"]), best["setting"], enough)
        rows.append((f"{case}: {best['truth']:.6f} ({best['source']})", method, *cells))
    header = ("case and truth", "program", "its best factor", "error", "seconds", "setting")
    return [
        "## Form factors",
        "",
        *paragraph(
            "Beside programs that compute nothing else. Ours are the shares of traced rays that a bake works with, 64 "
            "a triangle, the triangles split for more of them; building the ray library's scene is inside the clock. "
            "Pairs of pyViewFactor are exact, but one ray between their middles tells whether they see each other."
        ),
        "",
        "![Form factors](images/performance-form-factors.png)",
        "",
        *table((*header, f"seconds to {FORM_FACTOR_ERROR:.0%}"), rows),
    ]


def seconds_of(cost: AtError) -> str:
    """Return a cost in seconds with its sign."""
    return f"{SIGNS[cost.kind]}{cost.cost:.2g}"


def paper_table(measured: Document) -> Lines:
    """Show the paper's table, ours, with what both methods gain and lose."""
    rows = []
    for row in measured["rows"]:
        u, a = row["uniform"], row["adaptive"]
        stage, loss = costliest_stage(row)
        goal = PAPER_GAINS.get(row["scene"]) if is_finest(row, measured["rows"]) else None
        met = gain(row, "seconds") > (goal or 0.0)
        rows.append(
            (
                f"{title(row['scene'])}, n = {row['minimum_size']:g} m",
                *(f"{u[key]:,} / {a[key]:,}" for key in ("fragments", "vertices")),
                *(f"{seconds(u[key])} / {seconds(a[key])}" for key in ("seconds", "processor_seconds")),
                f"{percent(u['rms'])} / {percent(a['rms'])}",
                f"{gain(row, 'fragments'):.1%}",
                f"{gain(row, 'seconds'):.1%} ({gain(row, 'processor_seconds'):.1%})",
                "yes" if met else "**no**",
                f"{stage.replace('_', ' ')} {loss:+.0%}" if loss > 0.0 else "-",
            )
        )
    finest = ", ".join(f"{goal:.0%}" for goal in PAPER_GAINS.values())
    header = ("scene and minimum size", "fragments", "vertices", "seconds", "processor seconds", "error")
    return [
        "## The paper's table",
        "",
        *paragraph(
            "Kulyasov & Nikulin's Table 1 on our scenes after its own: uniform / adaptive subdivision at the same "
            f"minimum size, threshold {measured['threshold']:g}, quality {measured['quality']}; measured "
            f"{measured['run'][:10]} by `make compare`. Both light the fragments that they end with in the same way, "
            f"and neither makes a face finer than the minimum size. *Gain*: of the time of the whole picture, by wall "
            f"clock and, in brackets, by processor time; every row should be positive, and the finest of each scene "
            f"above {finest}. *Stage*: where adaptive loses most, as a share of uniform's time."
        ),
        "",
        *table((*header, "fewer fragments", "gain", "met", "stage"), rows),
        "",
        *(
            line
            for scene in dict.fromkeys(row["scene"] for row in measured["rows"] if row["scene"] in PAPER_GAINS)
            for line in (f"![{title(scene)}, subdivided](images/subdivision-{scene.replace('_', '-')}.png)", "")
        ),
        "*The finest subdivision of each scene, adaptive and uniform, and below the three as they are baked at GOOD.*",
        "",
        "![The three scenes, baked](images/paper-scenes.png)",
    ]


def is_finest(row: Entry, rows: Sequence[Entry]) -> bool:
    """Say whether a row has the least minimum size of its scene."""
    return bool(row["minimum_size"] == min(r["minimum_size"] for r in rows if r["scene"] == row["scene"]))


def everything(document: Document) -> Lines:
    """List every measurement."""
    lines = ["## Everything that was measured"]
    for scene in document["scenes"]:
        rows = (
            (
                f"{entry['method']}, {entry['setting']}",
                f"{entry['points']:,}",
                seconds(entry["seconds"]),
                seconds(entry["processor_seconds"]),
                f"{entry['others']:.0%}",
                percent(entry["rms"]),
                percent(entry["lit_rms"]),
                f"{entry['bias']:+.2%}",
                percent(entry["p95"]),
            )
            for entry in scene["results"]
        )
        header = (
            "method and setting",
            "points",
            "seconds",
            "processor seconds",
            "others",
            "error",
            "where lit",
            "mean",
        )
        lines += ["", f"### {title(scene['scene'])}", "", *table((*header, "95% below"), rows)]
    return [
        *lines,
        "",
        *paragraph(
            "*Others*: share of the processors that other programs kept busy meanwhile. *Where lit*: the error over "
            "the points that any light reaches. *Mean*: how far the mean over everything is off. *95% below*: 95% of "
            "the points have a smaller error."
        ),
    ]
