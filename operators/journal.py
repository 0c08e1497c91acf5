# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes to the file that are taken back, newest first, when a later one fails."""

from collections.abc import Callable
from types import TracebackType
from typing import Any


class Journal:
    """All or nothing: a block of changes of which each knows how to be taken back.

    What cannot be taken back, such as removing a datablock, is put off with `later` until everything else went well.

    Examples
    --------
    >>> with Journal() as journal:
    ...     journal.set(obj, "hide_render", True)
    ...     journal.later(bpy.data.meshes.remove, old_mesh)
    """

    def __init__(self) -> None:
        self._inverses: list[tuple[Callable[..., Any], tuple[Any, ...]]] = []
        self._later: list[tuple[Callable[..., Any], tuple[Any, ...]]] = []

    def set(self, owner: object, name: str, value: object) -> None:
        """Set the property `name` of `owner`, and remember what it was."""
        self.on_failure(setattr, owner, name, getattr(owner, name))
        setattr(owner, name, value)

    def on_failure(self, inverse: Callable[..., Any], *arguments: object) -> None:
        """Remember the call that takes back the change which is made next."""
        self._inverses.append((inverse, arguments))

    def later(self, action: Callable[..., Any], *arguments: object) -> None:
        """Make this call once the whole block has succeeded."""
        self._later.append((action, arguments))

    def take_back_last(self) -> None:
        """Undo the newest change alone."""
        inverse, arguments = self._inverses.pop()
        inverse(*arguments)

    def take_back(self) -> None:
        """Undo every change, newest first."""
        while self._inverses:
            self.take_back_last()

    def __enter__(self) -> "Journal":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is not None:
            self.take_back()
            return
        for action, arguments in self._later:
            action(*arguments)
