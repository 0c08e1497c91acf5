# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The checkout as the package `radiosity_bake`, though its folder may be called anything, with or without Blender."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

PACKAGE = "radiosity_bake"
ROOT = Path(__file__).resolve().parents[1]


def load_package() -> ModuleType:
    """Return the repository's root, which is the extension's package, loaded once under the name of its id.

    An installed copy of the same name would otherwise answer to an import; here the checkout is what is meant.
    """
    if PACKAGE not in sys.modules:
        spec = importlib.util.spec_from_file_location(
            PACKAGE, ROOT / "__init__.py", submodule_search_locations=[str(ROOT)]
        )
        if spec is None or spec.loader is None:
            raise ImportError(f"{PACKAGE} cannot be loaded from the checkout")
        package = importlib.util.module_from_spec(spec)
        sys.modules[PACKAGE] = package
        spec.loader.exec_module(package)
    return sys.modules[PACKAGE]
