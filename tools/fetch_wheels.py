# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Download the wheels that the extension bundles, exactly those whose hashes are pinned in `wheels.sha256`.

They are bundled as the package index serves them, under their own names. A file that is there and has its hash is kept.

    python3 -m tools.fetch_wheels [--folder wheels]
"""

from __future__ import annotations

import argparse
import hashlib
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PINS = ROOT / "tools" / "wheels.sha256"
FOLDER = ROOT / "wheels"


class WheelError(Exception):
    """A wheel cannot be had, or is not the one that was pinned."""


@dataclass(frozen=True)
class Wheel:
    """A pinned wheel, its parts read off its file name (PEP 427)."""

    file_name: str
    sha256: str

    @property
    def requirement(self) -> str:
        distribution, version, *_ = self.file_name.split("-")
        return f"{distribution}=={version} --hash=sha256:{self.sha256}"

    @property
    def python_version(self) -> str:
        tag = self.file_name.split("-")[2]  # cp311
        return f"{tag[2]}.{tag[3:]}"

    @property
    def platforms(self) -> list[str]:
        return self.file_name.removesuffix(".whl").split("-")[4].split(".")


def pinned_wheels(pins: Path = PINS) -> list[Wheel]:
    """Return the pinned wheels; the file has the format of `sha256sum`."""
    lines = (line.split() for line in pins.read_text(encoding="utf-8").splitlines() if line.strip())
    return [Wheel(file_name, sha256) for sha256, file_name in lines]


def is_intact(wheel: Wheel, folder: Path) -> bool:
    """Tell whether the wheel lies in the folder with the pinned hash."""
    path = folder / wheel.file_name
    return path.is_file() and hashlib.sha256(path.read_bytes()).hexdigest() == wheel.sha256


def download(wheel: Wheel, folder: Path) -> None:
    """Download one wheel by pip, which refuses any other hash; it appears in the folder when it is whole."""
    with tempfile.TemporaryDirectory(dir=folder, prefix=".download-") as scratch:
        requirements = Path(scratch) / "requirements.txt"
        requirements.write_text(wheel.requirement + "\n", encoding="utf-8")
        command = [sys.executable, "-m", "pip", "--disable-pip-version-check", "download", "--quiet"]
        command += ["--no-deps", "--only-binary=:all:", "--require-hashes", "--requirement", str(requirements)]
        command += ["--python-version", wheel.python_version, "--dest", scratch]
        for platform in wheel.platforms:
            command += ["--platform", platform]
        if subprocess.run(command, check=False).returncode != 0:
            raise WheelError(f"pip could not download {wheel.file_name}; its own words are above")
        if not is_intact(wheel, Path(scratch)):
            raise WheelError(f"pip downloaded another file than {wheel.file_name}; compare it with {PINS.name}")
        (Path(scratch) / wheel.file_name).replace(folder / wheel.file_name)


def fetch(folder: Path = FOLDER) -> list[Path]:
    """Have all pinned wheels in the folder and return their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    wheels = pinned_wheels()
    for wheel in wheels:
        if not is_intact(wheel, folder):
            print(f"downloading {wheel.file_name}", flush=True)
            download(wheel, folder)
    return [folder / wheel.file_name for wheel in wheels]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=FOLDER, help="where the wheels go (default: wheels/)")
    try:
        print(f"{len(fetch(parser.parse_args().folder))} wheels present, hashes as pinned")
    except WheelError as error:
        print(f"fetch_wheels: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
