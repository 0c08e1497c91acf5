# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's package under its own name, though the repository's folder may be called anything."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

NAME = "radiosity_bake"
ROOT = Path(__file__).resolve().parent.parent


def load_package() -> ModuleType:
    """Return the repository root as the package `radiosity_bake`, loaded once; `tools` and `tests` become importable.

    An installed copy of the same name would answer first otherwise, and we want to measure this one.
    """
    if NAME not in sys.modules:
        path = ROOT / "__init__.py"
        spec = importlib.util.spec_from_file_location(NAME, path, submodule_search_locations=[str(ROOT)])
        if spec is None or spec.loader is None:
            raise ImportError(f"{NAME} cannot be loaded from {path.name}")
        module = importlib.util.module_from_spec(spec)
        sys.modules[NAME] = module
        spec.loader.exec_module(module)
    if str(ROOT) not in sys.path:
        sys.path.insert(0, str(ROOT))
    return sys.modules[NAME]
