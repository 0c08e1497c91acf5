# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the checkout importable as `radiosity_bake`, whatever its folder is called, with or without Blender."""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from tools.real_blender import RealBlender

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


@pytest.fixture(scope="session")
def zips(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """The zips, built from the checkout as it is."""
    from tools.build import build

    return build(tmp_path_factory.mktemp("dist"))


@pytest.fixture(scope="session")
def linux_zip(zips: list[Path]) -> Path:
    """The zip for this platform."""
    return next(path for path in zips if path.name.endswith("-linux_x64.zip"))


# The newest, from sid, is tested only where it is asked for, for it changes from day to day.
SUITES = ["trixie", "sid"] if os.environ.get("RADIOSITY_BAKE_SID") else ["trixie"]


@pytest.fixture(scope="session", params=SUITES)
def real_blender(request: pytest.FixtureRequest) -> RealBlender:
    """Debian's Blender."""
    from tools.debian import DebianError
    from tools.real_blender import RealBlender, RealBlenderError

    blender = RealBlender(request.param)
    try:
        blender.prepare()
    except (RealBlenderError, DebianError) as error:
        if os.environ.get("CI") == "true":
            raise
        pytest.skip(f"NO REAL BLENDER ON THIS MACHINE: {error}")
    return blender
