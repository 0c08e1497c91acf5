# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read the virtual screen's frame buffer file and save it as PNG.

Blender's own screenshot operator gives a black picture under software OpenGL; Xvfb keeps the screen in a file in the
format of X window dumps (X11/XWDFile.h): a header of 25 big-endian words and the window's name, a colour table of 12
bytes an entry, then the rows.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

HEADER_SIZE, WIDTH, HEIGHT, BITS_PER_PIXEL, BYTES_PER_LINE, COLOURS = 0, 4, 5, 11, 12, 19
COLOUR_ENTRY_BYTES = 12


def read_screen(path: Path) -> NDArray[np.uint8]:
    """Return the picture on the virtual screen, (height, width, 3) RGB."""
    data = path.read_bytes()
    header = struct.unpack(">25I", data[:100])
    if header[BITS_PER_PIXEL] != 32:
        raise ValueError(f"the screen has {header[BITS_PER_PIXEL]} bits a pixel; 32 were expected")
    start = header[HEADER_SIZE] + COLOUR_ENTRY_BYTES * header[COLOURS]
    height, width, stride = header[HEIGHT], header[WIDTH], header[BYTES_PER_LINE]
    rows = np.frombuffer(data, np.uint8, height * stride, start).reshape(height, stride)
    return rows[:, : 4 * width].reshape(height, width, 4)[:, :, 2::-1]


def save_png(picture: NDArray[np.uint8], path: Path) -> None:
    """Write an (height, width, 3) RGB picture as PNG, by the standard library alone."""
    height, width, _ = picture.shape
    lines = np.zeros((height, 1 + 3 * width), np.uint8)  # each line begins with its filter, 0 for none
    lines[:, 1:] = picture.reshape(height, 3 * width)
    chunks = (
        (b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(lines.tobytes(), 6)),
        (b"IEND", b""),
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for kind, content in chunks:
            file.write(struct.pack(">I", len(content)) + kind + content)
            file.write(struct.pack(">I", zlib.crc32(kind + content)))
