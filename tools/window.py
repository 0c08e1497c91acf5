# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Play a script in the window of Debian's Blender, on a virtual screen, and keep its screenshots.

    .venv/main/bin/python -m tools.window SCRIPT [--zip FILE] [--blend FILE] [--pictures FOLDER] [-- ARGUMENTS]

`tools/window_player.py` says what a script looks like; tests/window has some.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from .real_blender import ROOT, RealBlender, RealBlenderError

PLAYER = ROOT / "tools" / "window_player.py"


def install(blender: RealBlender, path: Path, profile: Path) -> subprocess.CompletedProcess[str]:
    """Install and enable an extension's zip in a Blender user folder, by Blender's own command."""
    arguments = ["--command", "extension", "install-file", "--repo", "user_default", "--enable", str(path)]
    return blender.run(arguments, profile=profile, binds=[path.parent], timeout=120, capture=True)


def play(
    script: Path,
    pictures: Path,
    *,
    blender: RealBlender | None = None,
    extension: Path | None = None,
    blend: Path | None = None,
    arguments: Sequence[str] = (),
    timeout: float = 240.0,
    capture: bool = False,
) -> subprocess.CompletedProcess[str]:
    """Play a script in a fresh Blender, with an extension and a file if given; screenshots go into `pictures`."""
    blender = blender or RealBlender()
    pictures.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="blender-window-", ignore_cleanup_errors=True) as profile:
        if extension is not None:
            installed = install(blender, extension, Path(profile))
            if installed.returncode != 0:
                return installed
        command = [str(blend)] if blend else []
        command += [] if extension else ["--factory-startup"]  # it would disable the extension
        command += ["--python-exit-code", "1", "--python", str(PLAYER)]
        command += ["--", str(script.resolve()), str(pictures.resolve()), *arguments]
        return blender.run(
            command,
            profile=Path(profile),
            binds=[script.resolve().parent, pictures, *([blend.parent] if blend else [])],
            environment={"LAST_SCREEN": str(pictures.resolve() / "timed_out.png")},
            window=True,
            timeout=timeout,
            capture=capture,
        )


def main(arguments: Sequence[str]) -> int:
    own, rest = list(arguments), []
    if "--" in own:
        own, rest = own[: own.index("--")], own[own.index("--") + 1 :]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("script", type=Path)
    parser.add_argument("--zip", type=Path, help="install and enable this extension first")
    parser.add_argument("--blend", type=Path, help="open this file")
    parser.add_argument("--pictures", type=Path, default=ROOT / "out" / "window", help="default: out/window")
    parser.add_argument("--suite", default="trixie")
    options = parser.parse_args(own)
    try:
        blender = RealBlender(options.suite)
        done = play(
            options.script,
            options.pictures,
            blender=blender,
            extension=options.zip.resolve() if options.zip else None,
            blend=options.blend.resolve() if options.blend else None,
            arguments=rest,
        )
    except RealBlenderError as error:
        print(f"window: {error}", file=sys.stderr)
        return 70
    return done.returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
