# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the page and the charts from what was measured.

`python -m bench.publish` writes the published page anew from its own numbers, after a change of its words.
"""

from __future__ import annotations

import json
from pathlib import Path

from tools.package import ROOT

from . import chart, page, results

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


if __name__ == "__main__":
    for path in write_page(results.read(DOCS / "performance.json"), DOCS):
        print(path)
