# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake the example rooms with the built zip and put the pictures beside path-traced ones: `make demo [ROOMS=studio]`.

Everything lands in out/demo: for each room the .blend file, the baked .blend file, the bake's report, the two pictures,
and both side by side.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from PIL import Image, ImageDraw, ImageFont

from .build import DIST
from .environments import ROOT, present_environments
from .installed import linux_zip, run_with_installed
from .rooms import ROOMS

FOLDER = ROOT / "out" / "demo"
DEMO_ROOMS = ("cornell_box", "paper_scene_1")
"""What is made unless others are named; `studio` is larger and takes minutes."""

CAPTION_HEIGHT = 28
GAP = 8


def side_by_side(room: str, report: dict[str, Any]) -> Path:
    """Put the picture of the baked room beside the path-traced one, each with a caption."""
    pictures = report["pictures"]
    traced = "Path traced and denoised" if pictures["denoised"] else "Path traced"
    captions = {
        f"{room}_baked.png": f"Baked in {report['seconds']['total']:.1f} s, {report['vertices']:,} vertices",
        f"{room}_path_traced.png": f"{traced} by Cycles in {pictures['path_traced']:.0f} s",
    }
    images = [Image.open(FOLDER / name).convert("RGB") for name in captions]
    width, height = images[0].size
    sheet = Image.new("RGB", (2 * width + GAP, height + CAPTION_HEIGHT), (24, 24, 24))
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=15)
    for column, (picture, caption) in enumerate(zip(images, captions.values(), strict=True)):
        left = column * (width + GAP)
        sheet.paste(picture, (left, 0))
        draw.text((left + width / 2, height + CAPTION_HEIGHT / 2), caption, font=font, fill="white", anchor="mm")
    path = FOLDER / f"{room}.png"
    sheet.save(path)
    return path


def print_report(room: str, report: dict[str, Any]) -> None:
    """Print what came of a bake, in a few lines."""
    print(f"\n{room}")
    for key in (
        "patches",
        "vertices",
        "triangles",
        "rays",
        "iterations",
        "residual",
        "estimated_error",
        "minimum_size",
    ):
        if report.get(key) is not None:
            print(f"  {key.replace('_', ' '):16} {report[key]:,.6g}")
    print(f"  {'energy imbalance':16} {report['energy']['imbalance']:.2g}")
    for stage, seconds in report["seconds"].items():
        print(f"  {'seconds, ' + stage:28} {seconds:.2f}")
    for picture in ("path_traced", "rendered_from_baked"):
        print(f"  {'seconds, ' + picture:28} {report['pictures'][picture]:.1f}")
    for warning in report["warnings"]:
        print(f"  warning: {warning}")


def main(rooms: Sequence[str]) -> int:
    unknown = [room for room in rooms if room not in ROOMS]
    if unknown:
        print(f"demo: there is no room {unknown[0]}; choose from {', '.join(ROOMS)}", file=sys.stderr)
        return 2
    FOLDER.mkdir(parents=True, exist_ok=True)
    environment = present_environments()[-1]
    made = []
    for room in rooms:
        print(f"{room}: path tracing, then baking ...", flush=True)
        arguments = [room, str(linux_zip(DIST)), str(FOLDER)]
        done = run_with_installed(environment, "tools.demo_room", arguments, capture=True)
        if done.returncode != 0:
            print(f"demo: {room} failed\n{done.stdout}{done.stderr}", file=sys.stderr)
            return 1
        report = json.loads((FOLDER / f"{room}.json").read_text(encoding="utf-8"))
        print_report(room, report)
        made.append(side_by_side(room, report))
    print("\npictures and .blend files are in", FOLDER.relative_to(ROOT))
    for path in made:
        print(f"  {path.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:] or DEMO_ROOMS))
