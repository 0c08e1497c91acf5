# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake in a thread of its own, which never touches bpy: messages come out of a queue, one request goes in."""

import queue
import threading
from collections.abc import Callable
from dataclasses import dataclass

from ..core.errors import Cancelled
from ..core.progress import Progress, ProgressCallback
from ..core.result import BakeResult
from ..core.scene import Scene
from ..core.settings import BakeSettings

Bake = Callable[[Scene, BakeSettings, ProgressCallback], BakeResult]


@dataclass(frozen=True, eq=False)
class Finished:
    """The bake ended well."""

    result: BakeResult


@dataclass(frozen=True, eq=False)
class Failed:
    """The bake ended with an error, `Cancelled` among them; its traceback is that of the thread."""

    error: BaseException


Message = Progress | Finished | Failed


class BakeJob:
    """One bake in a daemon thread.

    The last message is `Finished` or `Failed`; after it the thread has nothing left to do.
    """

    def __init__(self, bake: Bake, scene: Scene, settings: BakeSettings) -> None:
        self.latest = Progress("Starting", 0.0)
        self._messages: queue.SimpleQueue[Message] = queue.SimpleQueue()
        self._stop = threading.Event()
        self._thread = threading.Thread(
            target=self._run, args=(bake, scene, settings), name="Radiosity bake", daemon=True
        )

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def cancel(self) -> None:
        """Ask the bake to stop; it does so at its next progress message."""
        self._stop.set()

    @property
    def cancelled(self) -> bool:
        """Whether the bake was asked to stop."""
        return self._stop.is_set()

    def wait(self, seconds: float) -> bool:
        """Wait for the thread, at most so long, and return whether it has ended."""
        self._thread.join(seconds)
        return not self._thread.is_alive()

    def messages(self) -> list[Message]:
        """Return what came since the last call, oldest first, and keep the newest progress in `latest`."""
        received = []
        while not self._messages.empty():
            message = self._messages.get()
            if isinstance(message, Progress):
                self.latest = message
            received.append(message)
        return received

    def _on_progress(self, message: Progress) -> None:
        if self._stop.is_set():
            raise Cancelled
        self._messages.put(message)

    def _run(self, bake: Bake, scene: Scene, settings: BakeSettings) -> None:
        try:
            result = bake(scene, settings, self._on_progress)
        except BaseException as error:  # handed over whole; the operator raises it again
            self._messages.put(Failed(error))
        else:
            self._messages.put(Finished(result))
