# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What was measured, collected from `out/` into the one document that the page and the charts are made of."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from .methods import BENCH_SCENES, OURS

Document = dict[str, Any]
Entry = dict[str, Any]

CLOCKS = ("seconds", "processor_seconds")
"""Wall clock, and the time of all processors."""

KEPT = ("method", "setting", "seconds", "processor_seconds", "operator_seconds", "operator_processor_seconds", "others")
KEPT += ("points", "patches", "rays", "run")


def collect(out: Path) -> Document:
    """Return everything that lies in `out`, each if it was measured: scenes and the tables of other commands."""
    scenes = [read(out / "bench" / f"{name}.json") for name in BENCH_SCENES]
    return {
        "scenes": [{**scene, "results": [kept(e) for e in scene["results"]]} for scene in scenes if scene],
        "form_factors": read(out / "form_factors.json"),
        "scaling": read(out / "scaling.json"),
        "profile": read(out / "profile.json"),
        "paper_table": read(out / "compare.json"),
    }


def read(path: Path) -> Document | None:
    """Return a file of JSON, or None where it is missing."""
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None


def kept(entry: Entry) -> Entry:
    """Return what the page needs of a measurement, in as many digits as mean something."""
    found = {key: entry[key] for key in KEPT if key in entry}
    found |= {key: round(entry[key], 4) for key in ("seconds", "processor_seconds", "others")}
    accuracy = entry["accuracy"]
    found |= {key: round(accuracy[key], 6) for key in ("rms", "lit_rms", "bias", "p95")}
    if "report" in entry:
        report = entry["report"]
        found["estimated_error"] = round(report["estimated_error"], 6)
        found["seconds_in_ray_library"] = round(report["seconds_in_ray_library"], 4)
        found["warnings"] = report["warnings"]
        found["stages"] = {stage: round(seconds, 4) for stage, seconds in report["seconds"].items()}
    return found


def of_method(scene: Document, method: str) -> list[Entry]:
    """Return the measurements of one method on a scene."""
    return [entry for entry in scene["results"] if entry["method"] == method]


def own_bake(scene: Document, quality: str) -> Entry | None:
    """Return the measurement of our bake of a scene at one quality, or None."""
    return next((entry for entry in of_method(scene, OURS) if entry["setting"] == quality), None)


def pairs(entries: Iterable[Entry], cost: str) -> list[tuple[float, float]]:
    """Return (cost, error) of each measurement."""
    return [(entry[cost], entry["rms"]) for entry in entries]


def own_cost(entry: Entry, clock: str) -> float:
    """Return what the whole operator took, or the core where that was not measured."""
    return float(entry.get(f"operator_{clock}", entry[clock]))


def ray_share(entry: Entry, cores: int) -> float:
    """Return the share of a bake's time, of all cores, inside the ray library."""
    return float(entry["seconds_in_ray_library"] / (entry["seconds"] * cores))


def title(scene: str) -> str:
    """Return a scene's name as it is written: Cornell box."""
    words = scene.replace("_", " ")
    return words[0].upper() + words[1:]
