# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the checkout importable as `radiosity_bake`, whatever its folder is called, with or without Blender."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

# `tools` holds what the tests share with the demo and the benchmarks: `from tools.rooms import cornell_box`.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tools.package import load_package

if TYPE_CHECKING:
    from tools.real_blender import RealBlender

load_package()


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
