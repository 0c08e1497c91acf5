# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The shell command: bake a .blend file without opening a window."""

import argparse
import json
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import bpy

from ..core.errors import BakeError, Cancelled
from ..core.progress import Progress
from ..core.settings import DATA_TYPES, DOMAINS, LIGHTS, MATERIALS, METHODS, OUTPUTS, QUALITIES, BakeSettings
from .animation import FRAME_OUTPUTS, bake_frames, files_of, summary_of
from .bake import bake_objects, counted, ray_library_problem
from .files import check_spared, check_writable, files_in_use, is_whole_blend, newer_blender, replaced
from .missing_links import missing_links
from .naming import named
from .participants import is_stamp, rendered_objects
from .record import source_of
from .settings import bake_settings, keep_settings
from .targets import shows_surfaces

NAME = "radiosity_bake"

_DESCRIPTION = """\
Bake the light of a .blend file into vertex colours.

Blender reads the file first, then this command bakes it and writes the result to another file:

  blender --background room.blend --command radiosity_bake --quality GOOD --output room_baked.blend

Settings that are not given are those saved in the file (panel "Radiosity" in the 3D viewport's sidebar).
"""
_EPILOG = """\
Exit code 0: all files were written. Exit code 1: none was, except those of frames before the one that failed, if each
has a file of its own; a sentence on stderr says what happened.
"""
_LINE_EVERY_SECONDS = 1.0

_handles = []
"""The command's handle between registering and unregistering, which Blender wants back."""


def register() -> None:
    """Make `blender --command radiosity_bake` known."""
    _handles.append(bpy.utils.register_cli_command(NAME, main))


def unregister() -> None:
    """Withdraw the command."""
    while _handles:
        bpy.utils.unregister_cli_command(_handles.pop())


class CommandError(BakeError):
    """The command line asks for something that cannot be done."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str):
        raise CommandError(f"{message} (--help explains the options)")


def main(argv: list[str], blend_path: str | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    argv : list of str
        The options, without the command's name.
    blend_path : str or None
        The .blend file to open first; None takes the one that is open.

    Returns
    -------
    int
        0 when the files were written (or help was asked for), 1 with a sentence on stderr otherwise.
    """
    try:
        options = _parser().parse_args(_joined(argv))
        if options.frames_to is not None and options.frames is None:
            raise CommandError("--frames-to says where frames are kept; say which to bake with --frames A:B")
        if blend_path is not None:
            _open(Path(blend_path))
        _run(options)
    except SystemExit:
        return 0
    except (BakeError, Cancelled) as error:
        print(f"{NAME}: {error or 'cancelled; nothing was written'}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"{NAME}: cancelled; nothing was written", file=sys.stderr)
        return 1
    return 0


def _joined(argv: list[str]) -> list[str]:
    """Return the options with `--frames -2:1` as one, which argparse would take for two: it knows `-2`, not `-2:1`."""
    joined: list[str] = []
    for argument in argv:
        if joined and joined[-1] == "--frames" and argument[1:2].isdigit():
            joined[-1] += f"={argument}"
        else:
            joined.append(argument)
    return joined


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog=NAME,
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    files = parser.add_argument_group("files")
    files.add_argument("--output", metavar="FILE", help="the .blend to write; relative to the current folder")
    files.add_argument("--report", metavar="FILE", help="a JSON file for counts, times, errors and warnings")
    files.add_argument("--overwrite", action="store_true", help="allow --output to be the file that was read")
    what = parser.add_argument_group("what is baked")
    what.add_argument("--scene", metavar="NAME", help="this scene; else the one that was shown when the file was saved")
    what.add_argument("--object", metavar="NAME", action="append", help="bake this mesh only; may be given repeatedly")
    what.add_argument(
        "--frames", metavar="A:B", help="bake every frame from A to B; all in one file, or a file each (--frames-to)"
    )
    what.add_argument(
        "--frames-to",
        choices=FRAME_OUTPUTS,
        help="attributes Radiosity.0001, ... in one file (the default), or files named like --output with _0001, ...",
    )
    what.add_argument("--bake-to", choices=OUTPUTS, help="new refined meshes, or the meshes as they are")
    what.add_argument("--light", choices=LIGHTS, help="everything, lighting without colours, or a part of the light")
    what.add_argument(
        "--light-groups", action=argparse.BooleanOptionalAction, help="one more attribute for each light group"
    )
    what.add_argument("--domain", choices=DOMAINS, help="colours of face corners, or of vertices")
    what.add_argument("--data-type", choices=DATA_TYPES, help="32 or 8 bits a channel")
    what.add_argument(
        "--byte-maximum", type=float, metavar="BRIGHTNESS", help="what 8 bits reach up to; 0: the brightest there is"
    )
    what.add_argument("--prefix", metavar="TEXT", help="what the attributes' names begin with")
    what.add_argument(
        "--material",
        choices=MATERIALS,
        help="the light as it is, or on your materials' textures; automatic: where there are some",
    )
    how = parser.add_argument_group("how it is baked")
    how.add_argument("--threshold", type=float, help="share of another surface's light above which one is split")
    how.add_argument(
        "--minimum-size", type=float, metavar="LENGTH", help="no piece is split to less than this; 0: automatic"
    )
    how.add_argument("--method", choices=METHODS, help="split what receives much of another's light, or everything")
    how.add_argument("--quality", choices=QUALITIES, help="how many rays are traced")
    how.add_argument("--seed", type=int, help="pattern of the remaining noise")
    how.add_argument("--threads", type=int, help="cores that trace rays; 0: all")
    how.add_argument("--memory-limit", type=int, metavar="MIB", help="memory that the bake may take")
    how.add_argument("--patch-limit", type=int, metavar="N", help="patches that exchange light, at most; 0: no limit")
    return parser


def _open(path: Path) -> None:
    try:
        path.stat()
    except FileNotFoundError:
        raise CommandError(f"There is no file {path}") from None
    except OSError as error:
        raise CommandError(f"{path} could not be read: {error.strerror}") from error
    if not path.is_file():
        raise CommandError(f"{path} is not a file")
    try:
        bpy.ops.wm.open_mainfile(filepath=str(path.resolve()))
    except RuntimeError as error:
        newer = newer_blender(path)
        if newer is not None:
            here = f"this is {bpy.app.version[0]}.{bpy.app.version[1]}"
            raise CommandError(f"{path} could not be read: it was saved by {newer}; {here}") from error
        raise CommandError(f"{path} could not be read: {_sentence(error)}") from error


def _run(options: argparse.Namespace) -> None:
    """Check everything that can be checked, bake, then write the files."""
    problem = ray_library_problem()
    if problem is not None:
        raise CommandError(problem)
    context = bpy.context
    with ExitStack() as shown:
        _show_scene(options.scene, shown)
        _bake(options, context)


def _show_scene(name: str | None, shown: ExitStack) -> None:
    """Have the context be that of a scene, which the output shows then; of the one that it is, for None."""
    if name is None:
        return
    scene = bpy.data.scenes.get((name, None))
    if scene is None:
        raise CommandError(f'There is no scene "{name}" that could be baked; the file has {named(_local_scenes())}')
    if bpy.context.window is not None:
        bpy.context.window.scene = scene
    else:
        shown.enter_context(bpy.context.temp_override(scene=scene, view_layer=scene.view_layers[0]))


def _local_scenes() -> list[str]:
    return [scene.name for scene in bpy.data.scenes if scene.library is None]


def _bake(options: argparse.Namespace, context: bpy.types.Context) -> None:
    if context.mode != "OBJECT":
        # A file remembers the mode that it was saved in, and there is nobody here to leave it.
        bpy.ops.object.mode_set(mode="OBJECT")
    settings = _settings(options, context.scene)
    objects = _objects(options.object, context)
    if options.frames is not None:
        _run_frames(options, objects, settings)
        return
    (output,), report_path = _paths(options, None)
    report = bake_objects(context, objects, settings, _ProgressLines())
    # Who opens the output finds in its panel what it was baked with.
    keep_settings(context.scene.radiosity, settings)
    _write(report, output, report_path)
    _summarise(report, output)


def _run_frames(options: argparse.Namespace, objects: list[bpy.types.Object], settings: BakeSettings) -> None:
    context = bpy.context
    to_files = options.frames_to == "FILES"
    frames = _frames(options.frames)
    outputs, report_path = _paths(options, frames if to_files else None)
    # Who opens one of the files finds in its panel what it was baked with.
    keep_settings(context.scene.radiosity, settings)
    report = bake_frames(context, objects, settings, frames, outputs if to_files else None, _ProgressLines())
    _write(report, None if to_files else outputs[0], report_path)
    _warn(report)
    others = f" and {len(outputs) - 1:,} more" if len(outputs) > 1 else ""
    print(f"{summary_of(report)}. Wrote {outputs[0]}{others}", flush=True)


def _frames(text: str) -> range:
    first, colon, last = text.partition(":")
    try:
        return range(int(first), int(last if colon else first) + 1)
    except ValueError:
        raise CommandError(f"--frames {text} is not a range of frames such as 1:24") from None


def _write(report: dict, output: Path | None, report_path: Path | None) -> None:
    """Write the files; both are complete before either takes its name."""
    with ExitStack() as files:
        if output is not None:
            _save(files.enter_context(replaced(output)), output)
        if report_path is not None:
            text = json.dumps(report, indent=2, ensure_ascii=False) + "\n"
            files.enter_context(replaced(report_path)).write_text(text, encoding="utf-8")


def _settings(options: argparse.Namespace, scene: bpy.types.Scene) -> BakeSettings:
    saved = bake_settings(scene.radiosity)
    given = {
        "threshold": options.threshold,
        "minimum_size": options.minimum_size,
        "method": options.method,
        "quality": options.quality,
        "output": options.bake_to,
        "seed": options.seed,
        "threads": options.threads,
        "memory_limit": options.memory_limit,
        "patch_limit": options.patch_limit,
        "keep_transport": None,
        "light": options.light,
        "light_groups": options.light_groups,
        "domain": options.domain,
        "data_type": options.data_type,
        "byte_maximum": options.byte_maximum,
        "prefix": options.prefix,
        "material": options.material,
    }
    return BakeSettings(**{name: getattr(saved, name) if value is None else value for name, value in given.items()})


def _objects(names: list[str] | None, context: bpy.types.Context) -> list[bpy.types.Object]:
    if names is None:
        meshes = [obj for obj in rendered_objects(context.view_layer) if shows_surfaces(obj) and not is_stamp(obj)]
        if not meshes:
            raise CommandError(". ".join(["The scene has nothing with faces that renders", *missing_links()]))
        return sorted(meshes, key=lambda obj: obj.name_full)
    objects = []
    for name in names:
        obj = context.scene.objects.get(name)
        if obj is None:
            raise CommandError(f'There is no object "{name}" in the scene "{context.scene.name}"')
        if not shows_surfaces(source_of(obj)):
            raise CommandError(f'"{name}" is not a mesh and cannot be baked')
        objects.append(obj)
    return objects


def _paths(options: argparse.Namespace, frames: range | None) -> tuple[list[Path], Path | None]:
    """Return the .blend files that are to be written, one for all frames or one for each, and the report."""
    source = Path(bpy.data.filepath).resolve() if bpy.data.filepath else None
    if options.output is None and not options.overwrite:
        raise CommandError("Say where to write the result with --output FILE, or --overwrite the file that was read")
    if options.output is None and source is None:
        raise CommandError("No .blend file was read that could be overwritten; give --output FILE")
    output = source if options.output is None else Path(options.output).resolve()
    if output.suffix != ".blend":
        raise CommandError(f"{output} does not end in .blend")
    read = [] if source is None else [source]
    outputs = [output] if frames is None else files_of(output, frames)
    for path in outputs:
        if path == source and not options.overwrite:
            raise CommandError(f"{path} is the file that was read; give another --output, or --overwrite it")
        check_spared(path, "The output", [*([] if options.overwrite else read), *files_in_use()])
        check_writable(path, "The output")
    if options.report is None:
        return outputs, None
    report = Path(options.report).resolve()
    if report in outputs:
        raise CommandError(f"The report {report} would replace a .blend file; give another name")
    check_spared(report, "The report", [*read, *files_in_use()])
    check_writable(report, "The report")
    return outputs, report


def _save(temporary: Path, output: Path) -> None:
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(temporary), copy=True, check_existing=False)
    except RuntimeError as error:
        # Of a disk that is full, Blender tells that the file which it then removed is not there.
        raise CommandError(
            f"{output} could not be written ({_sentence(error)}); look whether the disk is full"
        ) from error
    if not is_whole_blend(temporary):
        raise CommandError(f"{output} could not be written to its end; look whether the disk is full")


def _sentence(error: RuntimeError) -> str:
    """Return what an operator reported, without Blender's prefix."""
    return str(error).strip().removeprefix("Error: ")


class _ProgressLines:
    """Prints a line when a stage begins, and once a second while it lasts."""

    def __init__(self) -> None:
        self._stage = ""
        self._last = 0.0

    def __call__(self, message: Progress) -> None:
        now = time.monotonic()
        if message.stage == self._stage and now - self._last < _LINE_EVERY_SECONDS:
            return
        self._stage, self._last = message.stage, now
        detail = f": {message.detail}" if message.detail else ""
        print(f"{message.share:4.0%}  {message.stage}{detail}", flush=True)


def _warn(report: dict) -> None:
    for warning in report["warnings"]:
        print(f"Warning: {warning}")
    others = [scene.name for scene in bpy.data.scenes if scene != bpy.context.scene and _could_be_baked(scene)]
    if others:
        print(
            f'Only the scene "{bpy.context.scene.name}" was baked; the file also has {named(others)}: '
            "--scene NAME bakes another"
        )


def _could_be_baked(scene: bpy.types.Scene) -> bool:
    layers = scene.view_layers if scene.library is None else ()
    return any(shows_surfaces(obj) for layer in layers for obj in rendered_objects(layer))


def _summarise(report: dict, output: Path) -> None:
    _warn(report)
    print(
        f"Baked {counted(len(report['objects']), 'object')} in {report['seconds']['total']:.1f} s: "
        f"{report.get('patches', 0):,} patches, {report.get('vertices', 0):,} vertices, "
        f"{report.get('rays', 0):,} rays. Wrote {output}",
        flush=True,
    )
