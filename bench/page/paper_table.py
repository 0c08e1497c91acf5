# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's table, ours, with what both methods gain and lose."""

from __future__ import annotations

from ..methods import PAPER_GAINS
from ..paper_table import costliest_stage, gain, is_finest
from ..results import CLOCKS, Document, title
from .markdown import Lines, paragraph, percent, seconds, table


def paper_table(measured: Document) -> Lines:
    """Show the paper's table, ours, with what both methods gain and lose."""
    rows = []
    for row in measured["rows"]:
        u, a = row["uniform"], row["adaptive"]
        stage, loss = costliest_stage(row)
        goal = PAPER_GAINS.get(row["scene"]) if is_finest(row, measured["rows"]) else None
        met = min(gain(row, clock) for clock in CLOCKS) > (goal or 0.0)
        rows.append(
            (
                f"{title(row['scene'])}, n = {row['minimum_size']:g} m",
                *(f"{u[key]:,} / {a[key]:,}" for key in ("fragments", "vertices")),
                *(f"{seconds(u[clock])} / {seconds(a[clock])}" for clock in CLOCKS),
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
            f"clock and, in brackets, by processor time; every row should be positive by both, and the finest of each "
            f"scene above {finest}. *Stage*: where adaptive loses most, as a share of uniform's time."
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
