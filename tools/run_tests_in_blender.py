# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The half of `tools/test_blender.py` that Blender runs: import pytest and the bundled ray library, run the tests."""

from __future__ import annotations

import os
import platform
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CACHE = ROOT / ".cache"
PLATFORM_TAGS = {"Linux": "manylinux", "Darwin": "macosx", "Windows": "win"}
MACHINE_TAGS = {"x86_64": "x86_64", "AMD64": "amd64", "arm64": "arm64"}


def bundled_ray_library() -> Path:
    """Return a folder with the ray library's wheel for this Python and system, unpacked."""
    python = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    pattern = f"embreex-*-{python}-{python}-{PLATFORM_TAGS[platform.system()]}*{MACHINE_TAGS[platform.machine()]}.whl"
    wheels = list((ROOT / "wheels").glob(pattern))
    if len(wheels) != 1:
        raise FileNotFoundError(f"the extension bundles no ray library for this Blender: no wheel is like {pattern}")
    folder = CACHE / wheels[0].stem
    if not folder.exists():
        zipfile.ZipFile(wheels[0]).extractall(folder)
    return folder


def main() -> int:
    sys.path[:0] = [str(CACHE / "blender-tests"), str(bundled_ray_library())]
    sys.dont_write_bytecode = True
    import pytest

    os.chdir(ROOT)
    arguments = sys.argv[sys.argv.index("--") + 1 :]
    return int(pytest.main(["-p", "no:cacheprovider", *arguments]))


sys.exit(main())
