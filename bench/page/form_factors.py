# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Our form factors beside those of programs that compute nothing else."""

from __future__ import annotations

from collections.abc import Sequence

from ..convergence import AtError, cost_at
from ..results import Entry
from .markdown import SIGNS, Lines, paragraph, seconds, table

# Relative error of form factors to which times are compared.
FORM_FACTOR_ERROR = 0.01


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
