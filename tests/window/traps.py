# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Played in Blender's window: everything that may happen to the file, the window or the extension while a bake runs.

The light is held back until a trap was sprung, so that nothing depends on how fast the machine is. Then the bake must
end in the sentence that is expected, with no data block left behind where nothing was stored, and the next bake must
work. What is printed as a traceback fails the test.
"""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import addon_utils
import bpy

MODULE = next(name for name in sys.modules if name.endswith(".radiosity_bake.operators.bake")).removesuffix(
    ".operators.bake"
)
BAKED, FRAMES_BAKED = r"Baked 1 object in", "Baked 2 frames in"
SECONDS = 120.0
"""What a step may take; a machine that is busy with other things takes long to draw a window."""


def part(name):
    return sys.modules[f"{MODULE}.{name}"]


class HeldLight:
    """A bake that waits for `let_go` before it begins, and listens to being cancelled meanwhile."""

    def __init__(self):
        self.gate = threading.Event()
        self.bakes = 0

    def __call__(self, scene, settings, progress, **options):
        from importlib import import_module

        core = import_module(f"{MODULE}.core.bake")
        messages = import_module(f"{MODULE}.core.progress")
        self.bakes += 1
        while not self.gate.wait(0.02):
            progress(messages.Progress("Held", 0.0))
        return core.bake(scene, settings, progress, **options)

    def let_go(self):
        self.gate.set()


class Bake:
    """One bake from the window, and the sentences that it ended in."""

    def __init__(self, window, frames):
        self.window, self.frames = window, frames
        self.light, self.sentences = HeldLight(), []

    @property
    def baked(self):
        return FRAMES_BAKED if self.frames else BAKED

    def begin(self, override=None):
        part("operators.bake")._core_bake = lambda: self.light
        doors = part("operators.doors")
        original = doors.Watch.__init__

        def overhear(watch, task, report):
            def told(kind, sentence):
                self.sentences.append(sentence)
                report(kind, sentence)

            original(watch, task, told)

        doors.Watch.__init__ = overhear
        try:
            with override or self.window.context():
                operator = bpy.ops.radiosity.bake_frames if self.frames else bpy.ops.radiosity.bake
                assert operator("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
        finally:
            doors.Watch.__init__ = original
        yield from self.window.until(lambda: self.light.bakes, SECONDS)

    def ends(self):
        self.light.let_go()
        yield from self.window.until(lambda: part("operators.doors").Watch.running is None, SECONDS)

    def waits(self, sentence):
        """Hold until the bake says that it waits for something."""
        self.light.let_go()
        watch = part("operators.doors").Watch
        yield from self.window.until(lambda: sentence in watch.running.latest.stage, SECONDS)
        yield from turns(4)
        assert watch.running is not None and not self.sentences


def turns(count):
    """Let the event loop turn, without drawing more than it asks for."""
    for _ in range(count):
        yield lambda: True


def datablocks():
    """How many of each kind there are."""
    kinds = ("objects", "meshes", "materials", "images", "node_groups", "collections", "scenes", "worlds", "lights")
    return {kind: len(getattr(bpy.data, kind)) for kind in kinds}


def fresh(window, output):
    """An empty file with a floor, a box and a lamp, no camera, and the box selected."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, load_ui=False)
    space = window.area().spaces.active
    # Most of the time goes into drawing, in software.
    space.shading.type, space.overlay.show_overlays = "WIREFRAME", False
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 2
    scene.radiosity.quality, scene.radiosity.output, scene.radiosity.minimum_size = "DRAFT", output, 1.0
    with window.context():
        bpy.ops.mesh.primitive_plane_add(size=6.0)
        bpy.ops.object.light_add(type="POINT", location=(1.0, -1.0, 4.0))
        bpy.ops.ed.undo_push(message="Room")
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 0.5))
        bpy.context.object.name = "Box"
        bpy.ops.ed.undo_push(message="Box")


# ---------------------------------------------------------------------------------------------------------------------
# Each springs a trap and yields until the bake has ended; returns what its sentence must hold, "" for none


def edit_mode_entered(bake):
    with bake.window.context():
        bpy.ops.object.mode_set(mode="EDIT")
    yield from bake.waits("Leave edit mode")
    with bake.window.context():
        bpy.ops.object.mode_set(mode="OBJECT")
    yield from bake.ends()
    return bake.baked


def edit_mode_entered_and_the_mesh_edited(bake):
    with bake.window.context():
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.subdivide()
    yield from bake.waits("Leave edit mode")
    with bake.window.context():
        bpy.ops.object.mode_set(mode="OBJECT")
    yield from bake.ends()
    return 'The mesh of "Box" was edited'


def object_deleted(bake):
    with bake.window.context():
        bpy.ops.object.delete()
    yield from bake.ends()
    return '"Box" was deleted'


def object_renamed(bake):
    bpy.data.objects["Box"].name = "Chest"
    yield from bake.ends()
    return bake.baked


def object_grabbed(bake):
    with bake.window.context():
        bpy.ops.transform.translate("INVOKE_DEFAULT")
    yield from bake.waits("Confirm or cancel what you are doing")
    bake.window.key("Escape")
    yield from bake.ends()
    return bake.baked


def undo_pressed(bake):
    with bake.window.context():
        bpy.ops.ed.undo()
    yield from bake.ends()
    # What was undone is that the box was added.
    return "was deleted"


def undo_and_redo_pressed(bake):
    with bake.window.context():
        bpy.ops.ed.undo()
        bpy.ops.ed.redo()
    yield from bake.ends()
    return bake.baked


def another_bake_started(bake):
    for operator in (bpy.ops.radiosity.bake, bpy.ops.radiosity.bake_frames, bpy.ops.radiosity.relight):
        with bake.window.context():
            assert not operator.poll()
    yield from bake.ends()
    return bake.baked


def another_scene_shown(bake):
    scene = bpy.context.scene
    bake.window.window.scene = bpy.data.scenes.new("Other")
    yield from bake.ends()
    bake.window.window.scene = scene
    assert scene.radiosity.report and not bpy.data.scenes["Other"].radiosity.report
    return bake.baked


def scene_deleted(bake):
    scene = bpy.context.scene
    bake.window.window.scene = bpy.data.scenes.new("Other")
    bpy.data.scenes.remove(scene)
    yield from bake.ends()
    return "The scene was deleted"


def workspace_switched(bake):
    before = bake.window.window.workspace
    bake.window.window.workspace = next(each for each in bpy.data.workspaces if each != before)
    yield from turns(5)
    yield from bake.ends()
    bake.window.window.workspace = before
    yield from bake.window.settle()
    return bake.baked


def window_opened_and_closed(bake):
    """Another window is closed: the bake of this one goes on."""
    with bake.window.context():
        bpy.ops.wm.window_new()
    yield from bake.window.settle()
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[-1]):
        bpy.ops.wm.window_close()
    yield from bake.ends()
    return bake.baked


def handlers_that_fail(bake):
    def broken(*_):
        raise RuntimeError("meant to fail")

    lists = (bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.frame_change_post)
    for handlers in lists:
        handlers.append(broken)
    try:
        yield from bake.ends()
    finally:
        for handlers in lists:
            handlers.remove(broken)
    return bake.baked


def saved_meanwhile(bake):
    with TemporaryDirectory() as folder:
        path = Path(folder, "room.blend")
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        yield from bake.ends()
        bpy.ops.wm.save_mainfile()
        bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)
        assert json_report()["objects"]
    return bake.baked


def json_report():
    import json

    return json.loads(bpy.context.scene.radiosity.report)


def file_opened(bake):
    with TemporaryDirectory() as folder:
        path = Path(folder, "other.blend")
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
        yield from bake.window.settle(2)
        with bake.window.context():
            bpy.ops.wm.open_mainfile(filepath=str(path))
    yield from bake.ends()
    return ""


def new_file_made(bake):
    with bake.window.context():
        bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield from bake.ends()
    return ""


def extension_disabled(bake):
    addon_utils.disable(MODULE)
    assert part("operators.doors").Watch.running is None
    bake.light.let_go()
    yield from bake.window.settle()
    addon_utils.enable(MODULE)
    # Blender forgets the operator with the next event; another modal one that begins before that would crash it.
    for x in (700, 720):
        bake.window.move_mouse(x, 500)
        yield from bake.window.settle()
    return ""


IN_A_WINDOW_ALONE = (object_grabbed, undo_pressed, workspace_switched, window_opened_and_closed, file_opened)
"""What only a window can tell; the rest is in tests/blender/test_traps.py too, where it takes no time."""

TRAPS = (
    edit_mode_entered,
    edit_mode_entered_and_the_mesh_edited,
    object_deleted,
    object_renamed,
    object_grabbed,
    undo_pressed,
    undo_and_redo_pressed,
    another_bake_started,
    another_scene_shown,
    scene_deleted,
    workspace_switched,
    window_opened_and_closed,
    handlers_that_fail,
    saved_meanwhile,
    file_opened,
    new_file_made,
)


def play(window):
    """Arguments are names of traps, or `all`, under both operators and outputs; else those of `IN_A_WINDOW_ALONE`."""
    yield from window.open_sidebar("Radiosity")
    everything = "all" in window.arguments
    asked = set(window.arguments) or {spring.__name__ for spring in IN_A_WINDOW_ALONE}
    ways = [(True, "ORIGINAL"), (False, "REFINED"), (False, "ORIGINAL"), (True, "REFINED")]
    for frames, output in ways if everything else ways[:1]:
        for spring in TRAPS:
            if everything or spring.__name__ in asked:
                yield from trap(window, spring, frames, output)
        yield from close_the_window_of_a_bake(window, frames)
    # Last, as Blender forgets an operator whose add-on is disabled only with the next event.
    yield from trap(window, extension_disabled, True, "REFINED")
    yield from window.screenshot("traps")


def trap(window, spring, frames, output):
    """Spring one trap; frames are kept as attributes on the meshes as they are, where the output is that."""
    name = f"{spring.__name__}, {'frames' if frames else 'single'}, {output}"
    print(f"trap: {name}", flush=True)
    fresh(window, output)
    yield from turns(2)
    began = time.monotonic()
    before = datablocks()
    bake = Bake(window, frames)
    yield from bake.begin()
    expected = yield from spring(bake)
    told = " ".join(bake.sentences)
    assert expected in told if expected else not bake.sentences, f"{name}: {told!r} instead of {expected!r}"
    if expected != bake.baked and spring not in {file_opened, new_file_made}:
        after = datablocks()
        grown = {kind: count - before[kind] for kind, count in after.items() if count > before[kind]}
        # A scene was deleted for another one.
        assert not grown, f"{name}: {grown} were left behind"
    yield from bake_again(window, name)
    print(f"trap: {name}: {time.monotonic() - began:.1f} s, {told!r}", flush=True)


def bake_again(window, name):
    """The file can be saved, and the next bake works."""
    with TemporaryDirectory() as folder:
        path = str(Path(folder, "after.blend"))
        bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
        assert Path(path).stat().st_size > 0
    if not any(obj.type == "MESH" for obj in bpy.context.scene.objects):
        return
    if not any(obj.type == "LIGHT" for obj in bpy.context.scene.objects):
        bpy.context.scene.collection.objects.link(bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT")))
        bpy.data.lights["Lamp"].energy = 100.0
    mesh = next(obj for obj in bpy.context.scene.objects if obj.type == "MESH" and obj.visible_get())
    mesh.select_set(True)
    bpy.context.view_layer.objects.active = mesh
    bpy.context.scene.radiosity.quality = "DRAFT"
    bpy.context.scene.radiosity.minimum_size = 1.0
    bake = Bake(window, False)
    yield from bake.begin()
    yield from bake.ends()
    assert any("Baked" in sentence for sentence in bake.sentences), f"{name}: then {bake.sentences}"


def close_the_window_of_a_bake(window, frames):
    print(f"trap: window of the bake closed, {'frames' if frames else 'single'}", flush=True)
    fresh(window, "REFINED")
    with window.context():
        bpy.ops.wm.window_new()
    yield from window.settle()
    other = bpy.context.window_manager.windows[-1]
    area = next(each for each in other.screen.areas if each.type == "VIEW_3D")
    region = next(each for each in area.regions if each.type == "WINDOW")
    bake = Bake(window, frames)
    yield from bake.begin(bpy.context.temp_override(window=other, area=area, region=region))
    with bpy.context.temp_override(window=other):
        bpy.ops.wm.window_close()
    yield from bake.ends()
    assert not bake.sentences
    yield from bake_again(window, "window closed")
