# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the extension's zips, one a platform, by the builder that Blender itself has, and validate them by it.

The builder is a plain Python script inside the bpy wheel: this needs no Blender program, but an environment with bpy.

    .venv/main/bin/python -m tools.build [--output dist]
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tomllib
from pathlib import Path

from .fetch_wheels import FOLDER, ROOT, WheelError, fetch

DIST = ROOT / "dist"
THIS_PYTHON = Path(sys.executable)
BUILDER = "lib/python3.*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py"


class BuildError(Exception):
    """The zips cannot be built, or Blender's validator refuses one."""


def blender_builder(python: Path) -> Path:
    """Return the path of Blender's extension builder in a Python's bpy, without importing bpy."""
    found = list(python.parents[1].glob(BUILDER))
    if len(found) != 1:
        raise BuildError(f"{python} has no bpy, which brings Blender's builder; run `make venv` first")
    return found[0]


def run_builder(*arguments: str, python: Path = THIS_PYTHON) -> None:
    """Run one command of Blender's builder; what it prints is shown only when it fails."""
    command = [str(python), str(blender_builder(python)), *arguments]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise BuildError(f"`blender_ext.py {' '.join(arguments)}` failed:\n{done.stdout}{done.stderr}")


def expected_zips(output: Path) -> list[Path]:
    """Return the names that the builder gives to the zips, in the manifest's order of platforms."""
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    stem = f"{manifest['id']}-{manifest['version']}"
    return [output / f"{stem}-{platform.replace('-', '_')}.zip" for platform in manifest["platforms"]]


def validate(path: Path, python: Path = THIS_PYTHON) -> None:
    """Let the validator of a Python's Blender read a zip."""
    run_builder("validate", str(path), python=python)


def build(output: Path = DIST) -> list[Path]:
    """Build and validate every zip and return their paths; older zips in the folder go away."""
    fetch(FOLDER)
    output.mkdir(parents=True, exist_ok=True)
    for old in output.glob("*.zip"):
        old.unlink()
    run_builder("build", "--split-platforms", f"--source-dir={ROOT}", f"--output-dir={output}")
    zips = expected_zips(output)
    for path in zips:
        if not path.exists():
            raise BuildError(f"the builder ended well but did not write {path.name}")
        validate(path)
    return zips


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=DIST, help="where the zips go (default: dist/)")
    try:
        for path in build(parser.parse_args().output.resolve()):
            print(f"{path.stat().st_size / 1e6:6.1f} MB  {path}")
    except (BuildError, WheelError) as error:
        print(f"build: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
