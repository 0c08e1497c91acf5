# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the page and the charts from what was measured.

`python -m bench.publish` writes the published page anew from its own numbers, after a change of its words, and from the
tables that commands of their own have measured since.
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
    """Return the published document with those tables of `out` that were measured later."""
    measured = results.collect(out)
    newer = {
        name: measured[name]
        for name in ("paper_table", "scaling", "profile")
        if measured[name] and measured[name]["run"] > (published.get(name) or {"run": ""})["run"]
    }
    return {**published, **newer}


if __name__ == "__main__":
    for path in write_page(brought_up_to_date(results.read(DOCS / "performance.json") or {}, OUT), DOCS):
        print(path)
