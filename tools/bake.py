# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake a .blend file with the bpy module, without a Blender program.

python tools/bake.py room.blend --quality GOOD --output room_baked.blend

takes the options of `blender --command radiosity_bake`; `--help` lists them.
"""

import importlib.util
import sys
from pathlib import Path

PACKAGE = "radiosity_bake"


def load_package():
    """Return the extension of this checkout, imported under the name of its id."""
    if PACKAGE in sys.modules:
        return sys.modules[PACKAGE]
    root = Path(__file__).resolve().parent.parent
    spec = importlib.util.spec_from_file_location(PACKAGE, root / "__init__.py", submodule_search_locations=[str(root)])
    package = importlib.util.module_from_spec(spec)
    sys.modules[PACKAGE] = package
    spec.loader.exec_module(package)
    return package


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
