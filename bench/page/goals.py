# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The goals beside what was measured, whatever it is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from ..methods import (
    ESTIMATE_OVER_TRUTH,
    FASTER_ELSEWHERE,
    FASTER_ON_CORNELL_BOX,
    FEWER_VERTICES,
    GROWTH,
    LARGEST_ERROR,
    MOST_GIGABYTES,
    MOST_MINUTES,
    OURS,
    RAY_SHARE,
)
from ..results import Document, of_method, own_bake, ray_share, title
from .equal_error import COMPARED_QUALITIES, faster_by_both, fewer_vertices
from .growth import exponent, finer_and_finer
from .limits import limits
from .markdown import Lines, paragraph, percent, table, times


def goals(document: Document) -> Lines:
    """Put what we want beside what was measured, met or not."""
    rows: list[tuple[str, str, str]] = []
    scenes = document["scenes"]
    for quality, most in LARGEST_ERROR.items():
        found = {s["scene"]: own["rms"] for s in scenes if (own := own_bake(s, quality))}
        rows.append(goal_row(f"error at {quality} at most {most:.0%}", found, lambda x, m=most: x <= m, percent, max))
    rows += speed_rows(scenes)
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
    shares = {s["scene"]: ray_share(own, s["machine"]["cores"]) for s in scenes if (own := own_bake(s, "GOOD"))}
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
    rows += growth_rows(document)
    rows += size_rows(document.get("scaling") or {})
    return [
        "## Goals",
        "",
        *paragraph(
            "What we want, the worst that was measured, and on which scene. How many times faster we are is judged by "
            "wall clock or by processor time of all cores, whichever favours us less: on a machine that is busy with "
            "other things seconds are longer for those who were measured then. So is the gain in the paper's table."
        ),
        "",
        *table(("goal", "worst measured", "met"), rows),
        "",
        *limits(document),
    ]


def speed_rows(scenes: Sequence[Document]) -> list[tuple[str, str, str]]:
    """Return the goals of being faster than each peer: on the Cornell box, and elsewhere."""
    rows = []
    for quality in COMPARED_QUALITIES:
        for peer, goal in FASTER_ON_CORNELL_BOX.items():
            for where, chosen, least in (
                ("on the Cornell box", [s for s in scenes if s["scene"] == "cornell_box"], goal),
                ("elsewhere", [s for s in scenes if s["scene"] != "cornell_box"], FASTER_ELSEWHERE[peer]),
            ):
                ratios = ((s["scene"], faster_by_both(s, peer, quality)) for s in chosen)
                found = {scene: ratio for scene, ratio in ratios if ratio is not None}
                name = f"{least:g} times faster than {peer} {where}, at the error of {quality}"
                rows.append(goal_row(name, found, lambda x, g=least: x >= g, times, min))
    return rows


def growth_rows(document: Document) -> list[tuple[str, str, str]]:
    """Return the goal of how time grows with patches, over every range that was measured."""
    ranges = dict(finer_and_finer(document))
    patches = (document.get("scaling") or {}).get("patches") or []
    if len(patches) > 1:
        ranges[f"Corridor, to {patches[-1]['patches']:,} of them"] = patches
    if not ranges:
        return []
    powers = {name: power for name, rows in ranges.items() if (power := exponent(rows[0], rows[-1])) is not None}
    name = "time that grows no faster than patches"
    return [goal_row(name, powers, lambda x: x <= GROWTH, "to the power of {:.2f}".format, max)]


def size_rows(scaling: Document) -> list[tuple[str, str, str]]:
    """Return the goals for a dense mesh, as far as they were measured."""
    rows = []
    dense = scaling.get("dense")
    if dense:
        whole = dense["operator"]
        for name, value, most, unit in (
            ("below {:g} GB", whole["peak_bytes"] / 1e9, MOST_GIGABYTES, "GB"),
            ("in at most {:g} minutes", whole["seconds"] / 60.0, MOST_MINUTES, "minutes"),
        ):
            goal = f"{dense['triangles']:,} triangles {name.format(most)}"
            rows.append(goal_row(goal, {"statue": value}, lambda x, m=most: x <= m, f"{{:.1f}} {unit}".format, max))
    return rows


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
