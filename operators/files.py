# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that appear whole or not at all: written under a temporary name in their folder, then renamed."""

import os
import re
import secrets
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import bpy

from ..core.errors import BakeError

_ZSTANDARD, _END_OF_SEEKABLE = b"\x28\xb5\x2f\xfd", b"\xb1\xea\x92\x8f"
"""How a compressed .blend file begins and ends: frames of Zstandard and a table of them."""
_END_OF_BLEND = b"ENDB"
"""Name of the last block of one that is not compressed, which has but a header."""
_TAIL = 64
_HEADER_SIZE = 32
"""Bytes, more than the header of a .blend file has."""
_BLEND = ".blend"
_LONGEST_PATH = 1022
"""Bytes: Blender cuts a path off after 1023, without a word, and saves to one that is a character longer."""
_HEADER = re.compile(rb"BLENDER(?:[-_][vV](\d)(\d\d)|\d\d[-_]\d\d[vV](\d\d)(\d\d))")
"""How a .blend file that is not compressed begins, to 4.5 and since 5.0: with the version of Blender that saved it."""
_ANYONE_WRITES = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH
"""Marks of a folder; on Windows they tell nothing of who may write."""


class FileError(BakeError):
    """A file cannot be written where it was asked for."""


def check_writable(path: Path, what: str) -> None:
    """Try whether a file could be written at `path`, before hours are spent on its contents.

    Parameters
    ----------
    path : Path
    what : str
        What the file is, to begin the sentence with.

    Raises
    ------
    FileError
    """
    try:
        _try(path, what)
    except OSError as error:
        raise FileError(f"{what} {path} cannot be written ({error.strerror})") from error


def _try(path: Path, what: str) -> None:
    if path.is_dir():
        raise FileError(f"{what} {path} is a folder; give the name of a file")
    if not path.parent.is_dir():
        raise FileError(f"{what} {path}: there is no folder {path.parent}")
    if path.exists() and not path.stat().st_mode & stat.S_IWUSR:
        raise FileError(f"{what} {path} is read-only; give another name or make it writable")
    # Root may write to it all the same, but whoever made it so did not mean root to.
    if os.name == "posix" and not path.parent.stat().st_mode & _ANYONE_WRITES:
        raise FileError(f"{what} {path}: the folder {path.parent} cannot be written to (it is read-only)")
    probe = _temporary(path)
    if path.suffix == _BLEND and max(len(os.fsencode(name)) for name in (path, probe)) > _LONGEST_PATH:
        raise FileError(f"{what} {path} has a longer path than Blender can save to; choose a folder of a shorter one")
    try:
        probe.touch(exist_ok=False)
    except OSError as error:
        raise FileError(f"{what} {path}: the folder {path.parent} cannot be written to ({error.strerror})") from error
    finally:
        with suppress(OSError):
            probe.unlink()


def files_in_use() -> list[Path]:
    """Return the libraries that the open file links, and the images and other files that it reads."""
    return [Path(path) for path in bpy.utils.blend_paths(absolute=True)]


def check_spared(path: Path, what: str, in_use: Iterable[Path]) -> None:
    """Refuse to write over one of the files that are read.

    Parameters
    ----------
    path : Path
    what : str
        What would be written, to begin the sentence with.
    in_use : iterable of Path

    Raises
    ------
    FileError
    """
    if any(_is_same(path, other) for other in in_use):
        raise FileError(f"{what} {path} would replace a file that the scene is read from; give another name")


def _is_same(path: Path, other: Path) -> bool:
    """Return whether two names are of one file, also through links and where capitals do not count."""
    try:
        return path == other or path.samefile(other)
    except OSError:
        return False


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Lend a temporary path beside `path` that takes its name when the block ends well, and is removed otherwise."""
    temporary = _temporary(path)
    try:
        yield temporary
        temporary.replace(path)
    except OSError as error:
        raise FileError(f"{path} could not be written: {error.strerror or error}") from error
    finally:
        with suppress(OSError):
            temporary.unlink()


def is_whole_blend(path: Path) -> bool:
    """Return whether Blender wrote a .blend file to its end.

    Blender 5.2 says that it saved a file of which the last part did not fit on the disk.
    """
    with path.open("rb") as file:
        start = file.read(4)
        file.seek(-min(_TAIL, path.stat().st_size), os.SEEK_END)
        end = file.read()
    return end.endswith(_END_OF_SEEKABLE) if start == _ZSTANDARD else _END_OF_BLEND in end


def newer_blender(path: Path) -> str | None:
    """Return which newer Blender than this seems to have saved a file that cannot be read, or None.

    What is compressed tells its version only where Python can take Zstandard apart, as that of Blender can.
    """
    with path.open("rb") as file:
        start = file.read(_HEADER_SIZE)
    if start.startswith(_ZSTANDARD):
        unpacked = _unpacked(path)
        if unpacked is None:
            return "a newer Blender" if is_whole_blend(path) else None
        start = unpacked
    found = _HEADER.match(start)
    if found is None:
        return None
    major, minor = (int(number) for number in found.groups() if number is not None)
    return f"Blender {major}.{minor}" if (major, minor) > bpy.app.version[:2] else None


def _unpacked(path: Path) -> bytes | None:
    """Return how a compressed file begins, None where that cannot be told."""
    try:
        import zstandard
    except ImportError:
        return None
    with path.open("rb") as file, suppress(zstandard.ZstdError):
        return zstandard.ZstdDecompressor().stream_reader(file).read(_HEADER_SIZE)
    return None


def _temporary(path: Path) -> Path:
    """Return a name beside `path` that is short, as that of `path` may be as long as names can be."""
    return path.with_name(f".{secrets.token_hex(8)}.tmp{_BLEND if path.suffix == _BLEND else ''}")
