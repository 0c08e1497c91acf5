# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Show a baked scene in a web page, in a real browser, and keep a picture of it: `make web [WEB=out/demo/room.blend]`.

    .venv/main/bin/python -m tools.web SCENE [--beside PICTURE] [--size 720x720]

SCENE is a .glb, or a baked .blend that Blender's exporter writes one of. The page, its viewer (three.js, from npm) and
the picture land in out/web. `--beside` prints by how much the browser's picture differs from one that Blender rendered
with the view transform Standard: the page shows linear colours as sRGB, without tone mapping, through the scene's
camera.
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import http.server
import shutil
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from .debian import DebianError, ensure_command
from .environments import ROOT

FOLDER = ROOT / "out" / "web"
VIEWER = "three@0.187.0"
VIEWER_FILES = (
    "build/three.core.js",
    "build/three.module.js",
    "examples/jsm/loaders/GLTFLoader.js",
    "examples/jsm/utils/BufferGeometryUtils.js",
    "examples/jsm/utils/SkeletonUtils.js",
)
BROWSER = "chromium"
PATIENCE_SECONDS = 120
SMALLEST_WINDOW = 500
"""Pixels below which the browser takes another size than it is told; the picture is cut out of a larger one."""

PAGE = """\
<!doctype html>
<meta charset="utf-8">
<title>{name}</title>
<style>body {{ margin: 0; background: black; overflow: hidden }} canvas {{ display: block }}</style>
<script type="importmap">
{{"imports": {{"three": "./three/build/three.module.js", "three/addons/": "./three/examples/jsm/"}}}}
</script>
<script type="module">
import * as THREE from "three";
import {{ GLTFLoader }} from "three/addons/loaders/GLTFLoader.js";

const renderer = new THREE.WebGLRenderer({{ antialias: true, preserveDrawingBuffer: true }});
renderer.toneMapping = THREE.NoToneMapping;
const asked = new URLSearchParams(location.search);
const width = Number(asked.get("width") ?? innerWidth), height = Number(asked.get("height") ?? innerHeight);
renderer.setSize(width, height);
document.body.append(renderer.domElement);
const {{ scene, cameras }} = await new GLTFLoader().loadAsync("./{name}.glb");
// A material that is not unlit shows what it emits, and needs no lamp for it.
const camera = cameras[0] ?? new THREE.PerspectiveCamera(50, 1, 0.01, 1000);
if (!cameras.length) {{
  const sphere = new THREE.Box3().setFromObject(scene).getBoundingSphere(new THREE.Sphere());
  camera.position.copy(sphere.center).add(new THREE.Vector3(0.4, 0.3, 1).setLength(2.5 * sphere.radius));
  camera.lookAt(sphere.center);
}}
camera.aspect = width / height;
camera.updateProjectionMatrix();
renderer.render(scene, camera);
</script>
"""


class WebError(Exception):
    """The page cannot be made or shown; the text says why."""


def fetch_viewer(folder: Path) -> None:
    """Put the viewer's files into `folder`, unless they are there."""
    if all((folder / file).is_file() for file in VIEWER_FILES):
        return
    ensure_command("npm", "npm")
    with tempfile.TemporaryDirectory() as temporary:
        command = ["npm", "install", "--prefix", temporary, "--no-audit", "--no-fund", "--ignore-scripts", VIEWER]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise WebError(f"npm could not install {VIEWER}: {done.stderr.strip()}")
        for file in VIEWER_FILES:
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(Path(temporary) / "node_modules" / "three" / file, folder / file)


def export(blend: Path, path: Path) -> None:
    """Write what is visible in a .blend as a .glb."""
    if not blend.is_file():
        raise WebError(f"there is no file {blend}")
    import bpy

    bpy.ops.wm.open_mainfile(filepath=str(blend))
    bpy.ops.export_scene.gltf(filepath=str(path), use_visible=True, export_cameras=True)


@contextlib.contextmanager
def served(folder: Path) -> Iterator[str]:
    """Lend an address at which a browser finds `folder`: pages from files may not load modules."""

    class Handler(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=str(folder)))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()


def photograph(address: str, picture: Path, width: int, height: int) -> None:
    """Have a browser without a window show a page, and keep what it shows."""
    ensure_command(BROWSER, BROWSER)
    picture.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory() as profile:
        command = [
            BROWSER,
            "--headless",
            "--no-sandbox",  # which a container does not allow
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--force-device-scale-factor=1",
            "--force-color-profile=srgb",
            f"--user-data-dir={profile}",
            f"--window-size={width + SMALLEST_WINDOW},{height + SMALLEST_WINDOW}",
            "--virtual-time-budget=20000",
            f"--screenshot={picture}",
            f"{address}?width={width}&height={height}",
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=PATIENCE_SECONDS)
    if not picture.is_file():
        raise WebError(f"{BROWSER} took no picture: {done.stderr.strip()[-500:]}")
    Image.open(picture).convert("RGB").crop((0, 0, width, height)).save(picture)


def difference(first: Path, second: Path) -> tuple[float, float]:
    """Return the mean and the 99th percentile of how much two pictures differ, in steps of 255."""
    pictures = [np.asarray(Image.open(path).convert("RGB"), dtype=np.float64) for path in (first, second)]
    if pictures[0].shape != pictures[1].shape:
        raise WebError(f"{first} and {second} differ in size; give --size")
    apart = np.abs(pictures[0] - pictures[1]).max(axis=2)
    return float(apart.mean()), float(np.quantile(apart, 0.99))


def main(arguments: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(prog="tools.web", description=__doc__.partition("\n")[0])
    parser.add_argument("scene", type=Path, metavar="SCENE")
    parser.add_argument("--beside", type=Path, metavar="PICTURE")
    parser.add_argument("--size", default="", metavar="WIDTHxHEIGHT")
    options = parser.parse_args(arguments)
    name = options.scene.stem
    try:
        if options.size:
            width, height = (int(part) for part in options.size.split("x"))
        else:
            width, height = Image.open(options.beside).size if options.beside else (720, 720)
        FOLDER.mkdir(parents=True, exist_ok=True)
        fetch_viewer(FOLDER / "three")
        if options.scene.suffix == ".blend":
            export(options.scene.resolve(), FOLDER / f"{name}.glb")
        else:
            shutil.copy(options.scene, FOLDER / f"{name}.glb")
        (FOLDER / f"{name}.html").write_text(PAGE.format(name=name), encoding="utf-8")
        with served(FOLDER) as address:
            photograph(f"{address}/{name}.html", FOLDER / f"{name}.png", width, height)
        print(f"page and picture: {FOLDER.relative_to(ROOT) / name}.html, .png")
        if options.beside:
            mean, most = difference(FOLDER / f"{name}.png", options.beside)
            print(f"beside {options.beside.name}: {mean:.2f} of 255 apart in the mean, 99% of pixels within {most:.0f}")
    except (WebError, DebianError, OSError, subprocess.TimeoutExpired) as error:
        print(f"web: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
