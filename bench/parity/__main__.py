# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure what an artist lights in Cycles against our bake, and write `docs/parity.md`: `python -m bench.parity`.

Names of cases, or of topics, measure just these; all other rows of `docs/parity.json` stay as they are.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from tools.package import ROOT

from ..machine import write_json
from .cases import TOPICS, Case, all_cases
from .page import met, page

DOCS = ROOT / "docs"
NUMBERS = DOCS / "parity.json"
PICTURES = DOCS / "images" / "parity"

MOST_SECONDS = 1800.0


def measured(case: Case) -> dict[str, Any]:
    """Return the row of a case, measured in a process of its own, or what went wrong there."""
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "row.json"
        command = [sys.executable, "-m", "bench.parity.measure", case.name, answer, PICTURES / f"{case.name}.jpg"]
        ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=MOST_SECONDS, check=False)
        if answer.exists():
            row: dict[str, Any] = json.loads(answer.read_text(encoding="utf-8"))
            return row
    said = [line for line in ended.stderr.strip().splitlines() if line.strip()]
    why = said[-1] if said else f"it ended with code {ended.returncode}"
    return {"topic": case.topic, "title": case.title, "failed": why}


def known_rows() -> dict[str, Any]:
    """Return the rows that were measured so far."""
    if not NUMBERS.exists():
        return {}
    rows: dict[str, Any] = json.loads(NUMBERS.read_text(encoding="utf-8"))["rows"]
    return rows


def publish(rows: dict[str, Any], cases: dict[str, Case]) -> None:
    """Write numbers and page, in the order of the cases; rows whose case is gone are left out."""
    ordered = {name: rows[name] for name in cases if name in rows}
    write_json(NUMBERS, {"rows": ordered})
    (DOCS / "parity.md").write_text(page(ordered), encoding="utf-8")


def line_of(name: str, row: dict[str, Any]) -> str:
    """Return one row as a line of the printed table."""
    if "failed" in row:
        return f"{name:<32}FAILED: {row['failed']}"
    ends = "met" if met(row) else "NOT MET"
    numbers = f"{row['difference_of_mean']:>+9.2%}{row['difference']:>9.2%}{row['difference_with_rims']:>9.2%}"
    return f"{name:<32}{numbers}{row['noise']:>8.2%}  {ends}  {'; '.join(row['warnings'])}"


def main() -> None:
    """Measure what is asked for, and publish."""
    cases = all_cases()
    parser = argparse.ArgumentParser(prog="python -m bench.parity", description=__doc__.splitlines()[0])
    parser.add_argument("rows", nargs="*", metavar="ROW", help=f"a case, or one of {', '.join(TOPICS)}; default: all")
    parser.add_argument("--missing", action="store_true", help="measure only what was never measured")
    parser.add_argument("--page-only", action="store_true", help="measure nothing; write the page")
    asked = parser.parse_args()
    unknown = [name for name in asked.rows if name not in cases and name not in TOPICS]
    if unknown:
        parser.error(f"there is no case {', '.join(unknown)}; there are {', '.join(cases)}")
    rows = known_rows()
    print(f"{'case':<32}{'mean':>9}{'at all':>9}{'w. rims':>9}{'noise':>8}", flush=True)
    for name, case in cases.items():
        wanted = not asked.rows or name in asked.rows or case.topic in asked.rows
        if asked.page_only or not wanted or (asked.missing and name in rows):
            continue
        # Another run may have written other rows meanwhile.
        row = measured(case)
        rows = {**known_rows(), name: row}
        print(line_of(name, row), flush=True)
        publish(rows, cases)
    publish(rows, cases)


if __name__ == "__main__":
    main()
