# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the page and the charts from what was measured.

`python -m bench.publish` writes the published page and its charts anew from their own numbers, after a change of words,
and from what has been measured since: single scenes, and the tables that have commands of their own.
"""

from __future__ import annotations

import json
from pathlib import Path

from tools.package import ROOT

from . import chart, page, results
from .machine import OUT

DOCS = ROOT / "docs"


def write_all(out: Path, docs: bool) -> list[Path]:
    """Write charts and page of what lies in `out` to `out`, and to docs too if asked; returns the files."""
    document = results.collect(out)
    written = chart.draw_all(document, out / "images")
    written += write_page(document, out)
    if docs:
        written += chart.draw_all(document, DOCS / "images", kinds=("png",))
        written += write_page(document, DOCS)
    return written


def write_page(document: results.Document, folder: Path) -> list[Path]:
    """Write `performance.json` and the page that is made of it."""
    data, text = folder / "performance.json", folder / "performance.md"
    data.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    text.write_text(page.page(document), encoding="utf-8")
    return [data, text]


def brought_up_to_date(published: results.Document, out: Path) -> results.Document:
    """Return the published document with those scenes and tables of `out` that were measured later."""
    measured = results.collect(out)
    scenes = {scene["scene"]: scene for scene in published["scenes"]}
    for scene in measured["scenes"]:
        if scene["run"] > scenes.get(scene["scene"], {"run": ""})["run"]:
            scenes[scene["scene"]] = scene
    newer = {
        name: measured[name]
        for name in ("paper_table", "scaling", "profile")
        if measured[name] and measured[name]["run"] > (published.get(name) or {"run": ""})["run"]
    }
    return {**published, **newer, "scenes": list(scenes.values())}


if __name__ == "__main__":
    known = results.read(DOCS / "performance.json") or results.collect(OUT)
    document = brought_up_to_date(known, OUT)
    for path in [*chart.draw_all(document, DOCS / "images", kinds=("png",)), *write_page(document, DOCS)]:
        print(path)
