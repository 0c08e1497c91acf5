# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The web page of a baked scene: what it is served from, how pictures are compared, and a browser's own picture."""

from __future__ import annotations

import json
import shutil
import struct
import urllib.error
import urllib.request

import numpy as np
import pytest
from PIL import Image

from tools import web

LINEAR = np.array([0.5, 0.25, 0.75])
SRGB = np.rint(255 * (1.055 * LINEAR ** (1 / 2.4) - 0.055))


def glb_of_a_square(path):
    """Write a square of edge 2 that shows the linear colour `LINEAR` unlit, from its vertices."""
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], dtype=np.float32)
    colours = np.tile(np.float32(LINEAR), (4, 1))
    triangles = np.array([0, 1, 2, 0, 2, 3], dtype=np.uint32)
    parts = [corners.tobytes(), colours.tobytes(), triangles.tobytes()]
    starts = np.cumsum([0, *map(len, parts)]).tolist()
    views = [
        {"buffer": 0, "byteOffset": start, "byteLength": len(part)}
        for start, part in zip(starts[:-1], parts, strict=True)
    ]
    vectors = {"componentType": 5126, "count": 4, "type": "VEC3"}
    content = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "materials": [{"extensions": {"KHR_materials_unlit": {}}}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2, "material": 0, "mode": 4}]}
        ],
        "accessors": [
            {**vectors, "bufferView": 0, "min": [-1, -1, 0], "max": [1, 1, 0]},
            {**vectors, "bufferView": 1},
            {"bufferView": 2, "componentType": 5125, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": starts[-1]}],
    }
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    binary = b"".join(parts)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


def picture(path, value, size=(4, 4)):
    Image.new("RGB", size, (value, value, value)).save(path)
    return path


def test_the_page_finds_its_viewer_where_its_files_are_put():
    page = web.PAGE.format(name="room")
    imports = json.loads(page.partition('importmap">')[2].partition("</script>")[0])["imports"]
    assert imports["three"].removeprefix("./three/") in web.VIEWER_FILES
    addons = imports["three/addons/"].removeprefix("./three/")
    loader = page.partition('from "three/addons/')[2].partition('"')[0]
    assert addons + loader in web.VIEWER_FILES
    assert "./room.glb" in page


def test_a_folder_is_served_for_as_long_as_it_is_lent(tmp_path):
    (tmp_path / "page.html").write_text("light", encoding="utf-8")
    with web.served(tmp_path) as address:
        assert urllib.request.urlopen(f"{address}/page.html").read() == b"light"
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(f"{address}/page.html", timeout=5)


def test_pictures_are_compared_in_steps_of_255(tmp_path):
    first, second = picture(tmp_path / "a.png", 10), picture(tmp_path / "b.png", 13)
    assert web.difference(first, second) == (3.0, 3.0)
    with pytest.raises(web.WebError, match="differ in size"):
        web.difference(first, picture(tmp_path / "c.png", 10, (5, 4)))


def test_the_picture_is_cut_to_the_size_that_was_asked_for(tmp_path, monkeypatch):
    """The browser itself takes no small window."""

    def browser(command, **_):
        target = next(word for word in command if word.startswith("--screenshot=")).partition("=")[2]
        picture(target, 7, (64 + web.SMALLEST_WINDOW, 48 + web.SMALLEST_WINDOW))
        return web.subprocess.CompletedProcess(command, 0, "", "")

    monkeypatch.setattr(web, "ensure_command", lambda *_: None)
    monkeypatch.setattr(web.subprocess, "run", browser)
    web.photograph("http://127.0.0.1:1/page.html", tmp_path / "page.png", 64, 48)
    assert Image.open(tmp_path / "page.png").size == (64, 48)


@pytest.mark.parametrize("scene", ["missing.glb", "missing.blend"])
def test_what_cannot_be_shown_ends_in_a_sentence(tmp_path, monkeypatch, capsys, scene):
    monkeypatch.setattr(web, "FOLDER", tmp_path / "web")
    monkeypatch.setattr(web, "fetch_viewer", lambda folder: None)
    assert web.main([str(tmp_path / scene)]) == 1
    assert capsys.readouterr().err.startswith("web: ")


@pytest.mark.skipif(
    not (shutil.which(web.BROWSER) and shutil.which("npm")), reason="there is no browser or npm on this machine"
)
def test_a_browser_shows_linear_vertex_colours_as_srgb(tmp_path, monkeypatch):
    monkeypatch.setattr(web, "FOLDER", tmp_path / "web")
    monkeypatch.setattr(web, "ROOT", tmp_path)
    glb_of_a_square(tmp_path / "square.glb")
    try:
        web.fetch_viewer(tmp_path / "web" / "three")
    except web.WebError as error:
        pytest.skip(f"no viewer to be had here: {error}")
    assert web.main([str(tmp_path / "square.glb"), "--size", "120x120"]) == 0
    shown = np.asarray(Image.open(tmp_path / "web" / "square.png"), dtype=float)
    # One step for the rounding of the browser's, one for ours.
    np.testing.assert_allclose(shown[60, 60], SRGB, atol=2)
