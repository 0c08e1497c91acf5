# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside the folder of the real Blender: start a virtual screen, run Blender on it, and end both.

    python3 window_session.py SECONDS [Blender's arguments]      SECONDS 0: no limit

Blender finds the screen's frame buffer in $SCREEN_FILE. When the time is up, what the screen shows is saved as
$LAST_SCREEN, if that is set, and the exit code is 124.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tools.real_blender import SCREEN_SIZE, TIMED_OUT
from tools.screen import read_screen, save_png

WIDTH, HEIGHT = SCREEN_SIZE


def start_screen(folder: str) -> tuple[subprocess.Popen[bytes], str]:
    """Start Xvfb with its frame buffer in a file; it chooses a free display and tells which when it is ready."""
    reading, writing = os.pipe()
    command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-fbdir", folder]
    command += ["-nolisten", "tcp", "-noreset", "+extension", "GLX", "+render"]
    with open(os.path.join(folder, "log"), "wb") as log:  # noqa: PTH118, PTH123 - plain strings all along
        server = subprocess.Popen(command, pass_fds=[writing], stdout=log, stderr=log)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        number = pipe.readline().strip()
    if not number:
        raise RuntimeError("the virtual screen did not start:\n" + Path(folder, "log").read_text(errors="replace"))
    return server, f":{number}"


def main(limit: float, arguments: list[str]) -> int:
    with tempfile.TemporaryDirectory() as folder:
        server, display = start_screen(folder)
        screen_file = Path(folder, "Xvfb_screen0")
        environment = {**os.environ, "DISPLAY": display, "SCREEN_FILE": str(screen_file), "XDG_RUNTIME_DIR": folder}
        command = ["blender", "--window-geometry", "0", "0", str(WIDTH), str(HEIGHT), *arguments]
        blender = subprocess.Popen(command, env=environment)
        try:
            return blender.wait(timeout=limit or None)
        except subprocess.TimeoutExpired:
            if "LAST_SCREEN" in os.environ:
                save_png(read_screen(screen_file), Path(os.environ["LAST_SCREEN"]))
            print(f"ended after {limit:g} s", file=sys.stderr)
            return TIMED_OUT
        finally:
            for process in (blender, server):
                process.kill()
                process.wait()


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]), sys.argv[2:]))
