#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run Debian's Blender, headless or in a window, without installing it: it lives in a folder of its own.

    tools/real_blender.py prepare                               make the folder (once; about a minute, 1.2 GB)
    tools/real_blender.py --background --python script.py       run Blender with these arguments
    tools/real_blender.py --window room.blend                   the same on a virtual screen

Options, before Blender's own arguments:
    --suite NAME      Debian suite: trixie (Blender 4.3, default) or sid (the newest)
    --profile FOLDER  Blender's user folder; without it every run gets a fresh one
    --bind FOLDER     show this folder inside as well (repeatable); the checkout and the current folder are shown
    --env NAME=VALUE  set a variable inside (repeatable); the environment is empty otherwise
    --timeout SECONDS end Blender after so long, with exit code 124
    --window          run on a virtual screen with software OpenGL

The folder is made by mmdebstrap, which only unpacks packages (no package script runs), under $RADIOSITY_BAKE_CACHE or
~/.cache/radiosity-bake. Blender runs in it by chroot, in mount, process and network namespaces of its own: nothing
outlives the command, and there is no network inside. It needs root or sudo.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
if __package__ in (None, ""):  # run as a script, as a Blender executable would be
    sys.path.insert(0, str(ROOT))

from tools.debian import DebianError, ensure_command, root_prefix  # noqa: E402

TIMED_OUT = 124
SCREEN_SIZE = (1600, 1000)

# Debian's blender depends on its libraries, but not on the Python modules that official builds bring along (numpy,
# requests, zstandard, attrs). The rest is a shell to run in, a virtual screen, software OpenGL and a mouse for it.
PACKAGES = (
    *("base-files", "base-passwd", "bash", "coreutils", "dash", "libc-bin"),
    *("blender", "python3", "python3-attr", "python3-numpy", "python3-requests", "python3-zstandard"),
    *("xvfb", "xkb-data", "x11-xkb-utils", "xdotool"),
    *("libegl-mesa0", "libegl1", "libgl1", "libgl1-mesa-dri", "libglx-mesa0"),
)
# Blender 5's extension system imports cattrs, which Debian lacks.
PYTHON_PACKAGES = {"sid": ("cattrs==26.2.1", "typing_extensions==4.16.0")}

# $1 is the folder, then folders to show inside, "--", and the command. Mounts end with the mount namespace.
ENTER = """
set -e
root=$1
shift
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
mount -t tmpfs tmpfs "$root/tmp"
while [ "$1" != -- ]; do
  mkdir -p "$root$1"
  mount --rbind "$1" "$root$1"
  shift
done
shift
exec chroot "$root" "$@"
"""


class RealBlenderError(Exception):
    """The folder cannot be made or entered on this machine; the text says why."""


def default_cache() -> Path:
    """Return the folder, outside the checkout, that keeps what takes long to make."""
    configured = os.environ.get("RADIOSITY_BAKE_CACHE")
    return Path(configured) if configured else Path.home() / ".cache" / "radiosity-bake"


@dataclass(frozen=True)
class RealBlender:
    """Debian's Blender of one suite, in a folder of its own."""

    suite: str = "trixie"
    cache: Path = field(default_factory=default_cache)

    @property
    def base(self) -> Path:
        return self.cache.resolve() / f"blender-{self.suite}"

    @property
    def root(self) -> Path:
        return self.base / "root"

    @property
    def _recipe(self) -> str:
        return " ".join((*PACKAGES, *PYTHON_PACKAGES.get(self.suite, ())))

    def is_ready(self) -> bool:
        """Tell whether the folder was made to its end, and by the present recipe."""
        ready = self.base / "ready"
        return ready.is_file() and ready.read_text(encoding="utf-8") == self._recipe

    def prepare(self) -> None:
        """Make the folder unless it is there.

        Raises
        ------
        RealBlenderError
            When this machine cannot make or enter it.
        """
        try:
            root_prefix()
        except DebianError as error:
            raise RealBlenderError(str(error)) from error
        if self.is_ready():
            return
        self.base.mkdir(parents=True, exist_ok=True)
        with (self.base / "lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not self.is_ready():
                print(f"making a folder with Debian {self.suite}'s Blender: {self.base}", file=sys.stderr, flush=True)
                try:
                    self._make()
                except DebianError as error:
                    raise RealBlenderError(str(error)) from error
                (self.base / "ready").write_text(self._recipe, encoding="utf-8")

    def _make(self) -> None:
        prefix = root_prefix()
        ensure_command("mmdebstrap", "mmdebstrap")
        ensure_command("unshare", "util-linux")
        log = self.base / "log"
        subprocess.run([*prefix, "rm", "-rf", "--one-file-system", str(self.root)], check=True)
        command = [*prefix, "mmdebstrap", "--variant=extract", f"--include={','.join(PACKAGES)}"]
        # A mirror may be frozen at some day, older than its lists are valid for; signatures are checked all the same.
        command += ['--aptopt=Acquire::Check-Valid-Until "false"']
        with log.open("w") as output:
            done = subprocess.run([*command, self.suite, str(self.root)], stdout=output, stderr=output, check=False)
        if done.returncode != 0:
            tail = "\n".join(log.read_text(encoding="utf-8", errors="replace").splitlines()[-15:])
            raise RealBlenderError(f"mmdebstrap could not unpack Debian {self.suite}'s Blender:\n{tail}")
        self._add_python_packages()
        self._finish()
        self._must_run("blender", "--background", "--version")

    def _must_run(self, *arguments: str) -> None:
        """Run a command inside that cannot fail unless this machine forbids namespaces, or the folder is broken."""
        done = subprocess.run(self.command(arguments), capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RealBlenderError(f"`{' '.join(arguments)}` does not run in {self.root}: {done.stderr.strip()}")

    def _add_python_packages(self) -> None:
        """Unpack wheels beside Debian's Python modules."""
        for requirement in PYTHON_PACKAGES.get(self.suite, ()):
            with tempfile.TemporaryDirectory() as scratch:
                pip = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary=:all:"]
                if subprocess.run([*pip, "--dest", scratch, requirement], check=False).returncode != 0:
                    raise RealBlenderError(f"pip could not download {requirement}")
                for wheel in Path(scratch).glob("*.whl"):
                    zipfile.ZipFile(wheel).extractall(self.root / "usr/lib/python3/dist-packages")

    def _finish(self) -> None:
        """Do the little that the package scripts would have done, were they run."""
        (library_folder,) = (self.root / "usr/lib").glob("*-linux-gnu")
        inside = "/" + str(library_folder.relative_to(self.root))
        configuration = self.root / "etc/ld.so.conf.d/alternatives.conf"  # Debian links these by update-alternatives
        configuration.write_text(f"{inside}/blas\n{inside}/lapack\n", encoding="utf-8")
        for name in ("passwd", "group"):
            shutil.copyfile(self.root / f"usr/share/base-passwd/{name}.master", self.root / "etc" / name)
        (self.root / "etc/mtab").symlink_to("/proc/self/mounts")  # Blender's file browser reads it
        certificates = sorted((self.root / "usr/share/ca-certificates/mozilla").glob("*.crt"))
        bundle = self.root / "etc/ssl/certs/ca-certificates.crt"  # requests cannot be imported without it
        bundle.write_text("".join(path.read_text(encoding="utf-8") for path in certificates), encoding="utf-8")
        self._must_run("ldconfig")

    def command(
        self,
        arguments: Sequence[str],
        *,
        binds: Sequence[Path] = (),
        environment: Mapping[str, str] | None = None,
    ) -> list[str]:
        """Return the command line that runs `arguments` inside, in the current folder, in a clean environment."""
        shown = _without_nested([ROOT, Path.cwd(), *binds])
        variables = {
            "PATH": "/usr/bin:/usr/sbin",
            "HOME": "/tmp",
            "LANG": "C.UTF-8",
            "PYTHONDONTWRITEBYTECODE": "1",
            "LIBGL_ALWAYS_SOFTWARE": "1",
            "GALLIUM_DRIVER": "llvmpipe",
            "SDL_AUDIODRIVER": "dummy",
            "ALSOFT_DRIVERS": "null",
            **(environment or {}),
        }
        namespaces = ["unshare", "--mount", "--propagation", "private", "--net", "--pid", "--fork", "--kill-child"]
        enter = ["sh", "-c", ENTER, "enter", str(self.root), *map(str, shown), "--"]
        inside = ["env", "-i", f"--chdir={Path.cwd()}", *(f"{name}={value}" for name, value in variables.items())]
        return [*root_prefix(), *namespaces, *enter, *inside, *arguments]

    def run(
        self,
        arguments: Sequence[str],
        *,
        profile: Path | None = None,
        binds: Sequence[Path] = (),
        environment: Mapping[str, str] | None = None,
        window: bool = False,
        timeout: float | None = None,
        capture: bool = False,
    ) -> subprocess.CompletedProcess[str]:
        """Run Blender with these arguments and return how it ended; exit code 124 means that the time was up."""
        self.prepare()
        with _profile(profile) as user_folder:
            variables = {"BLENDER_USER_RESOURCES": str(user_folder), **(environment or {})}
            blender = ["blender", *arguments]
            if window:
                blender = ["python3", str(ROOT / "tools/window_session.py"), str(timeout or 0), *arguments]
            command = self.command(blender, binds=[user_folder, *binds], environment=variables)
            # On a screen the session inside watches the time, for it can still save what the screen shows.
            limit = None if timeout is None else timeout + (15 if window else 0)
            try:
                return subprocess.run(command, capture_output=capture, text=True, timeout=limit, check=False)
            except subprocess.TimeoutExpired as expired:
                output = expired.stdout.decode(errors="replace") if isinstance(expired.stdout, bytes) else ""
                return subprocess.CompletedProcess(command, TIMED_OUT, output, f"ended after {timeout:g} s")


@contextmanager
def _profile(given: Path | None) -> Iterator[Path]:
    """Give Blender's user folder: the one asked for, or a fresh one that goes away afterwards."""
    if given is not None:
        given.mkdir(parents=True, exist_ok=True)
        yield given.resolve()
        return
    with tempfile.TemporaryDirectory(prefix="blender-profile-", ignore_cleanup_errors=True) as fresh:
        yield Path(fresh)


def _without_nested(folders: Sequence[Path]) -> list[Path]:
    """Return the folders, outer ones first, without those that lie in another one: each is mounted once."""
    kept: list[Path] = []
    for folder in sorted({folder.resolve() for folder in folders}):
        if not any(folder.is_relative_to(outer) for outer in kept):
            kept.append(folder)
    return kept


def split_options(arguments: Sequence[str]) -> tuple[dict[str, list[str]], list[str]]:
    """Split a command line into this tool's own options, which come first, and Blender's arguments."""
    options: dict[str, list[str]] = {}
    rest = list(arguments)
    while rest:
        name, _, value = rest[0].partition("=")
        if name == "--window":
            options.setdefault(name, []).append("")
            rest = rest[1:]
        elif name in {"--suite", "--profile", "--bind", "--env", "--timeout"}:
            if not value and len(rest) < 2:
                raise RealBlenderError(f"{name} needs a value")
            options.setdefault(name, []).append(value or rest[1])
            rest = rest[1:] if value else rest[2:]
        else:
            break
    return options, rest


def main(arguments: Sequence[str]) -> int:
    if not arguments or arguments[0] in {"help", "--tool-help"}:
        print(__doc__)
        return 0
    try:
        options, rest = split_options(arguments)
        blender = RealBlender(options.get("--suite", ["trixie"])[-1])
        blender.prepare()
        if rest == ["prepare"]:
            return 0
        return blender.run(
            rest,
            profile=Path(options["--profile"][-1]) if "--profile" in options else None,
            binds=[Path(folder) for folder in options.get("--bind", [])],
            environment=dict(pair.split("=", 1) for pair in options.get("--env", [])),
            window="--window" in options,
            timeout=float(options["--timeout"][-1]) if "--timeout" in options else None,
        ).returncode
    except (RealBlenderError, DebianError) as error:
        print(f"real_blender: {error}", file=sys.stderr)
        return 70


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
