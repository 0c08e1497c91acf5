# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake a .blend file with the bpy module, without a Blender program.

python tools/bake.py room.blend --quality GOOD --output room_baked.blend

takes the options of `blender --command radiosity_bake`; `--help` lists them.
"""

import sys
from pathlib import Path

# A script finds what lies beside it, not the checkout that it belongs to.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tools.package import PACKAGE, load_package


def run(arguments: list[str]) -> int:
    """Return the command's exit code; the first argument is the file to open, unless it is an option."""
    package = load_package()
    package.register()
    from radiosity_bake.operators.command import main

    try:
        if arguments and not arguments[0].startswith("-"):
            return main(arguments[1:], arguments[0])
        if "--help" in arguments or "-h" in arguments:
            return main(["--help"])
        print(f"{PACKAGE}: Give the .blend file to bake first, then the options", file=sys.stderr)
        return 1
    finally:
        package.unregister()


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
