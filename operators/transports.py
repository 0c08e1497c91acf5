# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The transport of the last bake, which stays in memory for relighting: one scene's at most, and never in the file.

Blender's properties cannot hold it, so it lives here. The scene remembers the bake that it shows by a token, which an
undo takes back with everything else; what does not belong to that bake is of no use and let go.
"""

import secrets
from dataclasses import dataclass

import bpy
from bpy.app.handlers import persistent

from ..core.relight import KeptTransport, NotKept
from ..core.result import BakeResult
from ..core.settings import BakeSettings
from .extraction import Extraction
from .local_mesh import fingerprint


@dataclass(frozen=True, eq=False)
class BakedObject:
    """An object that carries a bake.

    Attributes
    ----------
    uid : int
        `session_uid` of the original.
    name : str
    fingerprint : bytes
        Of the mesh that carries the colours, which is its own or the refined object's.
    """

    uid: int
    name: str
    fingerprint: bytes


@dataclass(frozen=True, eq=False)
class RememberedBake:
    """The last bake.

    Attributes
    ----------
    scene_uid : int
        `session_uid` of the Blender scene.
    token : str
        That the scene has while it shows this bake.
    settings : BakeSettings
    objects : tuple of BakedObject
        In the order of the targets.
    transport : KeptTransport or NotKept
    """

    scene_uid: int
    token: str
    settings: BakeSettings
    objects: tuple[BakedObject, ...]
    transport: KeptTransport | NotKept


_last: dict[str, RememberedBake] = {}
"""The last bake under the key "bake", or nothing."""


def remember(
    scene: bpy.types.Scene,
    extraction: Extraction,
    settings: BakeSettings,
    result: BakeResult,
    shown: list[bpy.types.Object],
) -> None:
    """Keep the transport of `result` in place of any other; `shown` are the objects that carry its colours."""
    release()
    scene.radiosity.token = secrets.token_hex(8)
    if result.kept is None:
        return
    objects = tuple(
        BakedObject(target.uid, target.name, fingerprint(obj.data))
        for target, obj in zip(extraction.targets, shown, strict=True)
    )
    _last["bake"] = RememberedBake(scene.session_uid, scene.radiosity.token, settings, objects, result.kept)


def remembered_bake(scene: bpy.types.Scene) -> RememberedBake | None:
    """Return the bake that `scene` shows, if it is in memory."""
    bake = _last.get("bake")
    if bake is None or bake.scene_uid != scene.session_uid or bake.token != scene.radiosity.token:
        return None
    return bake


def release() -> None:
    """Let go of whatever is in memory."""
    _last.clear()


@persistent
def _release_on_load(*_: object) -> None:
    release()


@persistent
def _release_after_undo(*_: object) -> None:
    if all(remembered_bake(scene) is None for scene in bpy.data.scenes):
        release()


_HANDLERS = (
    (bpy.app.handlers.load_pre, _release_on_load),
    (bpy.app.handlers.undo_post, _release_after_undo),
)


def register() -> None:
    """Have it let go of when a file is opened, and when the bake is undone."""
    for handlers, handler in _HANDLERS:
        handlers.append(handler)


def unregister() -> None:
    """Let go of everything."""
    for handlers, handler in _HANDLERS:
        handlers.remove(handler)
    release()
