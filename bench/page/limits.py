# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Why goals are missed: for each, what was measured, the limit, and what was tried."""

from __future__ import annotations

from collections.abc import Iterator

from ..methods import (
    CYCLES,
    FEWER_VERTICES,
    LARGEST_ERROR,
    MITSUBA_VERTICES,
    PAPER_GAINS,
    RADIANCE,
    RAY_SHARE,
    UNIFORM,
    faster_goal,
)
from ..paper_table import gain, is_finest
from ..profile import RAY_LIBRARY
from ..results import CLOCKS, Document, Entry, of_method, own_bake, title
from .equal_error import COMPARED_QUALITIES, faster_by_both, fewer_vertices
from .markdown import Lines, paragraph, percent, times


def limits(document: Document) -> Lines:
    """Say why goals are missed, a paragraph for each that is."""
    found = [*errors(document), *peers(document), *vertices(document), *rays(document), *gains(document)]
    return ["### Where they are missed, and why", "", *(line for text in found for line in (*paragraph(text), ""))][:-1]


def errors(document: Document) -> Iterator[str]:
    """Explain errors above those wanted."""
    for quality, most in LARGEST_ERROR.items():
        for scene in document["scenes"]:
            own = own_bake(scene, quality)
            if own is not None and own["rms"] > most:
                yield (
                    f"**Error at {quality}, {title(scene['scene'])}.** {percent(own['rms'])} with "
                    f"{own['points']:,} vertices; the mean of all light is off by {own['bias']:+.2%} of it. The bake "
                    f"says so itself: it estimates {percent(own['estimated_error'])}{told(own)}."
                )


def told(own: Entry) -> str:
    """Return what the bake warned of, as the end of a sentence."""
    return "".join(f', and warns: "{sentence}"' for sentence in own.get("warnings") or ())


def peers(document: Document) -> Iterator[str]:
    """Explain where another program is not outrun by as much as wanted."""
    for scene in document["scenes"]:
        for peer in (name for name in document_peers(scene) if name != MITSUBA_VERTICES):
            goal = faster_goal(scene["scene"], peer)
            for quality in COMPARED_QUALITIES:
                ratio, own = faster_by_both(scene, peer, quality), own_bake(scene, quality)
                if goal is None or ratio is None or own is None or ratio >= goal:
                    continue
                head = f"**{peer}, {title(scene['scene'])} at {quality}.** {times(ratio)} times faster, not {goal:g}."
                if peer == CYCLES:
                    best = min(of_method(scene, peer), key=lambda e: e["rms"])
                    yield (
                        f"{head} It was measured down to {percent(best['rms'])} with {best['points']:,} vertices; from "
                        f"there to our {percent(own['rms'])} it is granted that its error falls with more samples "
                        f"alone, which its interpolation would not let it, while our time includes {own['points']:,} "
                        "vertices."
                    )
                    continue
                same = faster_by_both(scene, MITSUBA_VERTICES, quality)
                beside = f" Mitsuba to vertices takes {times(same)} times as long as we." if same else ""
                yield (
                    f"{head} It computes the {scene['probes']:,} points at which it is judged, and interpolates "
                    f"nothing; our bake computes {own['points']:,} vertices for them, which makes us "
                    f"{times(ratio * own['points'] / scene['probes'])} times faster for each point computed."
                    f"{beside if peer != RADIANCE else ''}"
                )


def document_peers(scene: Document) -> list[str]:
    """Return the other programs measured on a scene for which there is a goal."""
    names = dict.fromkeys(entry["method"] for entry in scene["results"])
    return [name for name in names if faster_goal(scene["scene"], name) is not None]


def vertices(document: Document) -> Iterator[str]:
    """Explain where uniform subdivision takes too few vertices for our error."""
    missed = []
    for scene in document["scenes"]:
        own, fewer = own_bake(scene, "GOOD"), fewer_vertices(scene, "GOOD")
        if own is None or fewer is None or fewer.cost >= FEWER_VERTICES:
            continue
        fewest = min(entry["points"] for entry in of_method(scene, UNIFORM))
        missed.append(
            f"{title(scene['scene'])} {times(fewer.cost)} ({own['points']:,} of ours, {fewest:,} of the coarsest "
            "uniform mesh)"
        )
    if missed:
        yield (
            f"**Vertices of uniform subdivision over ours.** {'; '.join(missed)}. What a mesh is given with stays "
            "in both: on dense meshes hardly a vertex is ours to leave out. Where given meshes are coarse, uniform "
            "subdivision is cut at the feet of objects by our own cuts, which removes the errors that fall slowest "
            "with finer meshes; beyond its finest mesh its error is granted to go on falling as one over the vertices."
        )


def rays(document: Document) -> Iterator[str]:
    """Explain the share of the ray library."""
    profile = document.get("profile")
    if not profile or min(row["shares"].get(RAY_LIBRARY, 0.0) for row in profile["scenes"]) >= RAY_SHARE:
        return
    told = []
    for row in profile["scenes"]:
        each, share = 1e9 * row["processor_seconds"] / row["rays"], row["shares"].get(RAY_LIBRARY, 0.0)
        told.append(f"{title(row['scene'])} {share:.0%}, {share * each:,.0f} of {each:,.0f} nanoseconds a ray")
    yield (
        f"**Half of the time in the ray library.** By processor time: {'; '.join(told)}. The library is too fast for "
        "half: around it a ray is made, the patch under its hit found, and what it sees summed, each in a few passes "
        "over arrays. Patterns that all vertices share, tables in place of walks down the patch tree, single "
        "precision, and looking rays up again in place of tracing more made these passes as few as they are; fewer "
        "need compiled code, which the extension does not bring along."
    )


def gains(document: Document) -> Iterator[str]:
    """Explain rows of the paper's table in which adaptive subdivision loses."""
    rows = (document.get("paper_table") or {"rows": []})["rows"]
    lost = [row for row in rows if min(gain(row, clock) for clock in CLOCKS) <= 0.0]
    if lost:
        worst = min(lost, key=lambda row: gain(row, "processor_seconds"))
        yield (
            f"**Rows of the paper's table that are not positive.** {len(lost)} of {len(rows)}. At coarse "
            f"sizes the rule splits nearly everything: in the worst row, {title(worst['scene'])} at n = "
            f"{worst['minimum_size']:g} m, {worst['adaptive']['fragments']:,} of "
            f"{worst['uniform']['fragments']:,} fragments are left, so that all there is to gain is "
            f"{gain(worst, 'fragments'):.1%}, and judging the pairs takes more: {worst['adaptive']['rays']:,} rays "
            f"against {worst['uniform']['rays']:,}, and in each round some milliseconds of array operations, of a "
            f"bake of {worst['uniform']['processor_seconds']:.2f} seconds. Parts are judged by the rays of the whole "
            "before they are traced themselves."
        )
    for row in rows:
        least, goal = min(gain(row, clock) for clock in CLOCKS), PAPER_GAINS.get(row["scene"], 0.0)
        if is_finest(row, rows) and 0.0 < least <= goal:
            u, a = row["uniform"], row["adaptive"]
            yield (
                f"**The finest row of {title(row['scene'])}.** It gains {least:.1%}, not {goal:.0%}. Of "
                f"{u['fragments']:,} fragments {a['fragments']:,} are left, but the light, which is to be as exact as "
                f"the quality says, splits the faces on them: it is gathered at {a['vertices']:,} vertices in place of "
                f"{u['vertices']:,}, which takes {a['stages']['gathering']:.2f} of {a['stages']['total']:.2f} seconds."
            )
