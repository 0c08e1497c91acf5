# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the processor time of our bakes goes, and why to what takes much of it."""

from __future__ import annotations

from ..profile import RAY_LIBRARY
from ..results import Document, title
from .markdown import Lines, paragraph, table

SHOWN = 0.03
"""Share of the time from which on a module is listed."""

MUCH = 0.15
"""The same, from which on it is explained."""

REASONS = {
    "direct": "direct light of few emitters: their exact form factors, and the points that shadow rays end at",
    "many_lights": "direct light of many emitters, as the faces of a round lamp are: what each would send to each "
    "vertex, so that its shadow rays go where the light comes from",
    "gather": "the rays of the gather, made and summed",
}


def profile(measured: Document) -> Lines:
    """Show the shares of the modules."""
    rows = [
        (
            title(row["scene"]),
            f"{row['processor_seconds']:.2f}",
            f"{row['rays']:,}",
            ", ".join(f"{named(module)} {share:.0%}" for module, share in row["shares"].items() if share >= SHOWN),
        )
        for row in measured["scenes"]
    ]
    large = dict.fromkeys(
        module
        for row in measured["scenes"]
        for module, share in row["shares"].items()
        if share >= MUCH and module in REASONS
    )
    reasons = "; ".join(f"{named(module)}, {REASONS[module]}" for module in large)
    explained = f"What takes more than {MUCH:.0%} and is no ray: {reasons}." if reasons else ""
    return [
        "## Where the time goes",
        "",
        *paragraph(
            f"Processor time of one thread at {measured['quality']} by module of the core, measured "
            f"{measured['run'][:10]} by `python -m bench.profile`; what numpy does counts for the module that asked "
            f"for it, and so does what the profiler adds to each call. {explained}"
        ),
        "",
        *table(("scene", "processor seconds", "rays", "shares"), rows),
    ]


def named(module: str) -> str:
    """Return how a module is called on the page."""
    return module if module == RAY_LIBRARY else f"`{module}`"
