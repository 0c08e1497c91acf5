# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure what an artist lights in Cycles against our bake, and write `docs/parity.md`: `python -m bench.parity`.

Names of cases, or of topics, measure just these; all other rows of `docs/parity.json` stay as they are.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tools.package import ROOT

from ..machine import write_json
from . import real_files, rooms
from .cases import TOPICS, all_cases
from .page import FILES, ROOMS, met, page

DOCS = ROOT / "docs"
NUMBERS = DOCS / "parity.json"
PICTURES = DOCS / "images" / "parity"

MOST_SECONDS = 3600.0


@dataclass(frozen=True)
class Task:
    """A row that can be measured.

    Attributes
    ----------
    name : str
        By which it is asked for.
    topic : str
        A section of the page.
    title : str
    command : tuple of str
        The module that measures it, and what it is given before the paths of the answer and of the picture.
    """

    name: str
    topic: str
    title: str
    command: tuple[str, ...]


def tasks() -> dict[str, Task]:
    """Return every row by its name, in the order of the page."""
    found = [Task(case.name, case.topic, case.title, ("measure", case.name)) for case in all_cases().values()]
    found += [Task(name, ROOMS, rooms.title_of(name), ("real_files", "room", name)) for name in rooms.NAMES]
    for path in real_files.shipped_files():
        title = real_files.title_of(path)
        name = re.sub(r"\W+", "_", title.lower().removesuffix(".blend"))
        found.append(Task(name, FILES, title, ("real_files", "file", path)))
    return {task.name: task for task in found}


def measured(task: Task) -> dict[str, Any]:
    """Return a row, measured in a process of its own, or what went wrong there."""
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "row.json"
        module, *given = task.command
        command = [sys.executable, "-m", f"bench.parity.{module}", *given, answer, PICTURES / f"{task.name}.jpg"]
        ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=MOST_SECONDS, check=False)
        if answer.exists():
            row: dict[str, Any] = json.loads(answer.read_text(encoding="utf-8"))
            return row
    errors = [line for line in ended.stderr.splitlines() if re.match(r"[\w.]*(Error|Exception)\b", line)]
    why = errors[-1] if errors else f"its process ended with code {ended.returncode}"
    return {"topic": task.topic, "title": task.title, "failed": why}


def known_rows() -> dict[str, Any]:
    """Return the rows that were measured so far."""
    if not NUMBERS.exists():
        return {}
    rows: dict[str, Any] = json.loads(NUMBERS.read_text(encoding="utf-8"))["rows"]
    return rows


def publish(rows: dict[str, Any], order: dict[str, Task]) -> None:
    """Write numbers and page, in the order of the tasks; rows of tasks that are gone are left out."""
    ordered = {name: rows[name] for name in order if name in rows}
    write_json(NUMBERS, {"rows": ordered})
    (DOCS / "parity.md").write_text(page(ordered), encoding="utf-8")


def line_of(name: str, row: dict[str, Any]) -> str:
    """Return one row as a line of the printed table."""
    ends = f"{'met' if met(row) else 'NOT MET'}  {'; '.join(row.get('warnings', ()))}"
    if "failed" in row:
        return f"{name:<32}FAILED: {row['failed']}"
    if "difference" not in row:
        numbers = {key: row[key] for key in ("said", "processor_seconds", "picture_difference", "left") if key in row}
        return f"{name:<32}{numbers}  {ends}"
    numbers = f"{row['difference_of_mean']:>+9.2%}{row['difference']:>9.2%}{row['difference_with_rims']:>9.2%}"
    return f"{name:<32}{numbers}{row['noise']:>8.2%}  {ends}"


def main() -> None:
    """Measure what is asked for, and publish."""
    known = tasks()
    topics = (*TOPICS, ROOMS, FILES)
    parser = argparse.ArgumentParser(prog="python -m bench.parity", description=__doc__.splitlines()[0])
    parser.add_argument("rows", nargs="*", metavar="ROW", help=f"a row, or one of {', '.join(topics)}; default: all")
    parser.add_argument("--missing", action="store_true", help="measure only what was never measured, or failed")
    parser.add_argument("--page-only", action="store_true", help="measure nothing; write the page")
    asked = parser.parse_args()
    unknown = [name for name in asked.rows if name not in known and name not in topics]
    if unknown:
        parser.error(f"there is no row {', '.join(unknown)}; there are {', '.join(known)}")
    rows = known_rows()
    print(f"{'row':<32}{'mean':>9}{'at all':>9}{'w. rims':>9}{'noise':>8}", flush=True)
    for name, task in known.items():
        wanted = not asked.rows or name in asked.rows or task.topic in asked.rows
        there = name in rows and "failed" not in rows[name]
        if asked.page_only or not wanted or (asked.missing and there):
            continue
        row = measured(task)
        # Another run may have written other rows meanwhile.
        rows = {**known_rows(), name: row}
        print(line_of(name, row), flush=True)
        publish(rows, known)
    publish(rows, known)


if __name__ == "__main__":
    main()
