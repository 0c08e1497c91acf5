# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a number was measured on, and where results are written."""

from __future__ import annotations

import json
import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from tools.package import ROOT

OUT = ROOT / "out"
PACKAGES = ("numpy", "embreex", "mitsuba", "drjit", "bpy", "pyradiance")


def machine() -> dict[str, Any]:
    """Return processor, cores, system and the versions of what takes part, as JSON can hold it."""
    return {"processor": processor(), "cores": os.cpu_count(), "system": platform.system(), "versions": versions()}


def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that take part and are installed."""
    found = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def processor() -> str:
    """Return the processor's name, where the system tells it."""
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def write_json(path: Path, content: Any) -> None:
    """Write `content` with the machine's description."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"machine": machine(), **content}, indent=1) + "\n", encoding="utf-8")
