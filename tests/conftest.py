# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the checkout importable as `radiosity_bake`, whatever its folder is called, with or without Blender."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = "radiosity_bake"


def load_package() -> None:
    """Load the repository's root, which is the extension's package, under its fixed name."""
    if PACKAGE in sys.modules:
        return
    spec = importlib.util.spec_from_file_location(PACKAGE, ROOT / "__init__.py", submodule_search_locations=[str(ROOT)])
    assert spec is not None and spec.loader is not None
    package = importlib.util.module_from_spec(spec)
    sys.modules[PACKAGE] = package
    spec.loader.exec_module(package)


load_package()
# `tools` holds what the tests share with the demo and the benchmarks: `from tools.rooms import cornell_box`.
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))
