# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender's window: play a script step by step while Blender's event loop runs, then end Blender.

A script has a generator function `play(window)`. Whatever it yields is a condition, a function without arguments; the
script goes on when it gives something true:

    def play(window):
        yield from window.open_sidebar("Radiosity")
        yield from window.click_operator("radiosity.bake")
        yield from window.until(lambda: "Radiosity" in bpy.data.objects["Floor"].data.color_attributes, 60)
        yield from window.screenshot("baked")

An exception in it ends Blender with exit code 1 and its traceback, and saves the screen as `failed.png`.
"""

from __future__ import annotations

import os
import runpy
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tools.screen import read_screen, save_png

Steps = Iterator[Callable[[], object]]
TURN = 0.05  # seconds between looks; Blender draws and handles events in between
TURNS_TO_SETTLE = 5  # how many turns it takes until a change is drawn and its events are handled


class Window:
    """What a script sees and does: Blender's first window, with a real mouse and keyboard."""

    def __init__(self, pictures: Path, arguments: list[str]) -> None:
        self.pictures = pictures
        self.arguments = arguments

    # ------------------------------------------------------------------------------------ what is there

    @property
    def window(self) -> bpy.types.Window:
        return bpy.context.window_manager.windows[0]

    def area(self, kind: str = "VIEW_3D") -> bpy.types.Area:
        """Return the largest editor of a kind."""
        return max((a for a in self.window.screen.areas if a.type == kind), key=lambda a: a.width * a.height)

    def region(self, kind: str) -> bpy.types.Region:
        """Return a region of the 3D viewport: WINDOW, UI (the sidebar), HEADER..."""
        return next(region for region in self.area().regions if region.type == kind)

    def context(self, region: str = "WINDOW") -> object:
        """Return a context manager in which operators run as from this region of the viewport."""
        return bpy.context.temp_override(window=self.window, area=self.area(), region=self.region(region))

    def is_running(self, operator: str) -> bool:
        """Tell whether a modal operator, by its Python name, is running in the window."""
        group, name = operator.split(".")
        return any(each.bl_idname == f"{group.upper()}_OT_{name}" for each in self.window.modal_operators)

    # ------------------------------------------------------------------------------------ waiting

    def until(self, condition: Callable[[], object], seconds: float = 30.0) -> Steps:
        """Wait for a condition, but not for ever."""
        deadline = time.monotonic() + seconds

        def holds() -> bool:
            if condition():
                return True
            if time.monotonic() > deadline:
                raise TimeoutError(f"waited {seconds:g} s in vain")
            return False

        yield holds

    def settle(self, turns: int = TURNS_TO_SETTLE) -> Steps:
        """Let the event loop turn a few times, with everything drawn anew."""
        for area in self.window.screen.areas:
            area.tag_redraw()
        for _ in range(turns):
            yield lambda: True

    # ------------------------------------------------------------------------------------ doing

    def open_sidebar(self, tab: str) -> Steps:
        """Show the viewport's sidebar with a tab; the tabs are there only after it was drawn once."""
        self.area().spaces.active.show_region_ui = True
        yield from self.settle()
        self.region("UI").active_panel_category = tab
        yield from self.settle()

    def _xdotool(self, *words: object) -> None:
        subprocess.run(["xdotool", *map(str, words)], check=True)

    def move_mouse(self, x: int, y: int) -> None:
        """Move the mouse; Blender counts from the lower left corner, the screen from the upper left one."""
        self._xdotool("mousemove", x, self.window.height - 1 - y)

    def click(self) -> None:
        """Press and release the left button where the mouse is."""
        self._xdotool("click", 1)

    def key(self, name: str) -> None:
        """Press and release a key, by its X name: Escape, n, ctrl+z."""
        self._xdotool("key", name)

    def click_operator(self, operator: str) -> Steps:
        """Find an operator's button in the sidebar and click it.

        The mouse goes down the sidebar; over each button Blender itself is asked what it would run.
        """
        region = self.region("UI")
        x = region.x + region.width // 2 - 10
        for y in range(region.y + region.height - 10, region.y, -10):
            self.move_mouse(x, y)
            yield from self.settle(2)
            if self._operator_under_mouse().startswith(f"bpy.ops.{operator}("):
                self.click()
                yield from self.settle(2)
                return
        raise LookupError(f"no button in the sidebar runs {operator}")

    def _operator_under_mouse(self) -> str:
        manager = bpy.context.window_manager
        manager.clipboard = ""
        with self.context("UI"):
            if bpy.ops.ui.copy_python_command_button.poll():
                bpy.ops.ui.copy_python_command_button()
        return manager.clipboard

    def screenshot(self, name: str) -> Steps:
        """Save what the screen shows, once it is drawn."""
        yield from self.settle()
        self.save_screen(name)

    def save_screen(self, name: str) -> None:
        save_png(read_screen(Path(os.environ["SCREEN_FILE"])), self.pictures / f"{name}.png")


def play(script: Path, window: Window) -> Steps:
    """Run the script once the window is drawn."""
    yield from window.settle()
    yield from runpy.run_path(str(script))["play"](window)


def end(code: int) -> None:
    """End Blender at once: the operator for it gives no exit code and may ask about unsaved changes."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def start(script: Path, pictures: Path, arguments: list[str]) -> None:
    """Begin to play; Blender's event loop calls back every turn."""
    preferences = bpy.context.preferences
    preferences.view.show_splash = False
    preferences.use_preferences_save = False
    window = Window(pictures, arguments)
    steps = play(script, window)
    waiting_for: list[Callable[[], object]] = []

    def turn() -> float:
        try:
            if not waiting_for:
                waiting_for.append(next(steps))
            if waiting_for[0]():
                waiting_for.clear()
        except StopIteration:
            end(0)
        except BaseException:
            traceback.print_exc()
            window.save_screen("failed")
            end(1)
        return TURN

    bpy.app.timers.register(turn, first_interval=0.0, persistent=True)


if __name__ == "__main__":
    first, second, *rest = sys.argv[sys.argv.index("--") + 1 :]
    start(Path(first), Path(second), rest)
