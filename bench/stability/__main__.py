# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure the sweeps and write `docs/stability.md`: `python -m bench.stability`.

Names of sweeps measure just these; all others stay as they are in `docs/stability.json`.
"""

from __future__ import annotations

import argparse
import json
from typing import Any

from tools.package import ROOT

from ..machine import write_json
from .cases import ALL, SWEEPS, Sweep
from .page import cell, draw, page
from .programs import answers

DOCS = ROOT / "docs"
NUMBERS = DOCS / "stability.json"
PICTURES = DOCS / "images" / "stability"

Entry = dict[str, Any]


def measured(sweep: Sweep, programs: tuple[str, ...], known: Entry | None) -> Entry:
    """Return the answers of some programs to a sweep, beside those that were there."""
    cases = [sweep.case_of(value) for value in sweep.values]
    found = answers(sweep, cases, tuple(name for name in sweep.programs if name in programs))
    before = {row["value"]: row["found"] for row in known["rows"]} if known else {}
    rows = []
    for k, case in enumerate(cases):
        every = {**before.get(case.value, {}), **{name: each[k] for name, each in found.items()}}
        kept = {name: every[name] for name in sweep.programs if name in every}
        rows.append({"value": case.value, "truth": case.truth, "found": kept})
    return {"rows": rows}


def known_sweeps() -> dict[str, Entry]:
    """Return what was measured so far."""
    if not NUMBERS.exists():
        return {}
    found: dict[str, Entry] = json.loads(NUMBERS.read_text(encoding="utf-8"))["sweeps"]
    return found


def publish(found: dict[str, Entry]) -> None:
    """Write numbers, charts and page, in the order of the sweeps."""
    ordered = {name: found[name] for name in SWEEPS if name in found}
    write_json(NUMBERS, {"sweeps": ordered})
    for name, entry in ordered.items():
        draw(SWEEPS[name], entry["rows"], PICTURES / f"{name}.svg")
    (DOCS / "stability.md").write_text(page(ordered), encoding="utf-8")


def main() -> None:
    """Measure what is asked for, and publish."""
    parser = argparse.ArgumentParser(prog="python -m bench.stability", description=__doc__.splitlines()[0])
    parser.add_argument("sweeps", nargs="*", metavar="SWEEP", help=f"default: all of {', '.join(SWEEPS)}")
    parser.add_argument("--program", action="append", choices=ALL, help="measure these alone; default: all")
    parser.add_argument("--page-only", action="store_true", help="measure nothing; write the page")
    asked = parser.parse_args()
    unknown = [name for name in asked.sweeps if name not in SWEEPS]
    if unknown:
        parser.error(f"there is no sweep {', '.join(unknown)}; there are {', '.join(SWEEPS)}")
    found = known_sweeps()
    for name in () if asked.page_only else asked.sweeps or SWEEPS:
        sweep = SWEEPS[name]
        entry = measured(sweep, tuple(asked.program or ALL), found.get(name))
        # Another run may have written other sweeps meanwhile.
        found = {**known_sweeps(), name: entry}
        for row in entry["rows"]:
            errors = "  ".join(f"{program} {cell(sweep, row, each)}" for program, each in row["found"].items())
            print(f"{name:<12}{row['value']:>10g}  {errors}", flush=True)
        publish(found)
    publish(found)


if __name__ == "__main__":
    main()
