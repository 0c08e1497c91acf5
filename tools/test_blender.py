# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run tests/blender inside any Blender (4.2 or later), as its own Python runs add-ons.

    .venv/main/bin/python -m tools.test_blender /path/to/blender [pytest's arguments]

Blender gets the tests and pytest, and the ray library from the wheel that the extension bundles for its Python; nothing
is written into its folders, and the user's preferences are left alone (`--factory-startup`).
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from .environments import REQUIREMENTS, ROOT
from .fetch_wheels import WheelError, fetch

PYTEST = ROOT / ".cache" / "blender-tests"


def have_pytest() -> None:
    """Unpack pytest and what it needs, all plain Python, into a folder that any Blender's Python can import from."""
    requirements = REQUIREMENTS / "blender-tests.txt"
    stamp = PYTEST / requirements.name
    if stamp.exists() and stamp.read_bytes() == requirements.read_bytes():
        return
    shutil.rmtree(PYTEST, ignore_errors=True)
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--quiet", "--no-deps"]
    subprocess.run([*command, "--target", str(PYTEST), "--requirement", str(requirements)], check=True)
    shutil.copyfile(requirements, stamp)


def main(arguments: Sequence[str]) -> int:
    if not arguments:
        print(__doc__)
        return 2
    blender, *rest = arguments
    executable = shutil.which(blender) or str(Path(blender).resolve())
    if not Path(executable).exists():
        print(f"test_blender: there is no Blender at {blender}", file=sys.stderr)
        return 2
    try:
        fetch()
    except WheelError as error:
        print(f"test_blender: {error}", file=sys.stderr)
        return 1
    have_pytest()
    script = ROOT / "tools" / "run_tests_in_blender.py"
    command = [executable, "--background", "--factory-startup", "--python-exit-code", "1", "--python", str(script)]
    return subprocess.run([*command, "--", "tests/blender", *rest], cwd=ROOT, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
