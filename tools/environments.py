# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the Python environments that the tests, the demo and the benchmarks run in.

    python3 -m tools.environments           .venv/py311 (Blender 4.2), .venv/py313 (Blender 5.2), .venv/main (the newer)
    python3 -m tools.environments bench     also what the benchmarks compare with, part of it in .venv/form-factors

Each has Blender as a Python module (bpy). Beside each lies a twin without embreex, `.venv/py311-user`: there the ray
library can only come from the extension's own zip, as on a user's computer. What is there and up to date stays.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from .debian import DebianError, install

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / ".venv"
REQUIREMENTS = ROOT / "tools" / "requirements"

# What bpy's library needs from the system, and the Debian package that has it. Xi, SM and their like are there on a
# desktop; a server or a container lacks them.
DEBIAN_PACKAGE_OF_LIBRARY = {
    "libEGL.so.1": "libegl1",
    "libGL.so.1": "libgl1",
    "libICE.so.6": "libice6",
    "libSM.so.6": "libsm6",
    "libX11.so.6": "libx11-6",
    "libXext.so.6": "libxext6",
    "libXfixes.so.3": "libxfixes3",
    "libXi.so.6": "libxi6",
    "libXrender.so.1": "libxrender1",
    "libXt.so.6": "libxt6",
    "libXxf86vm.so.1": "libxxf86vm1",
    "libdecor-0.so.0": "libdecor-0-0",
    "libgomp.so.1": "libgomp1",
    "libstdc++.so.6": "libstdc++6",
    "libwayland-client.so.0": "libwayland-client0",
    "libxkbcommon.so.0": "libxkbcommon0",
}

LLVM_VERSIONS = (19, 18, 17, 16, 15, 14)


class MissingEnvironmentError(Exception):
    """An environment cannot be made; the text says what is missing."""


@dataclass(frozen=True)
class Environment:
    """A virtual environment with one Blender in it."""

    name: str
    python_version: str
    blender: str

    @property
    def folder(self) -> Path:
        return FOLDER / self.name

    @property
    def python(self) -> Path:
        return self.folder / "bin" / "python"

    @property
    def user_folder(self) -> Path:
        """The twin without embreex."""
        return FOLDER / f"{self.name}-user"

    @property
    def user_python(self) -> Path:
        return self.user_folder / "bin" / "python"

    @property
    def site_packages(self) -> Path:
        return self.folder / "lib" / f"python{self.python_version}" / "site-packages"

    @property
    def requirements(self) -> list[Path]:
        return [REQUIREMENTS / f"blender-{self.blender}.txt", REQUIREMENTS / "development.txt"]


ENVIRONMENTS = (Environment("py311", "3.11", "4.2"), Environment("py313", "3.13", "5.2"))


def present_environments() -> list[Environment]:
    """Return the environments that were made, oldest Blender first."""
    return [environment for environment in ENVIRONMENTS if environment.python.exists()]


# ---------------------------------------------------------------------------------------------- interpreters


def _candidates(version: str) -> Iterable[Path]:
    """Give the places where a Python of this version may be: this one, the search path, pyenv."""
    yield Path(sys.executable)
    found = shutil.which(f"python{version}")
    if found:
        yield Path(found)
    pyenv = Path(os.environ.get("PYENV_ROOT") or Path.home() / ".pyenv")
    yield from sorted(pyenv.glob(f"versions/{version}.*/bin/python{version}"))


def find_interpreter(version: str) -> Path | None:
    """Return a Python of this version that starts, or None; a pyenv shim may be there and not start."""
    ask = "import sys; print('%d.%d' % sys.version_info[:2])"
    for candidate in _candidates(version):
        done = subprocess.run([str(candidate), "-c", ask], capture_output=True, text=True, check=False)
        if done.returncode == 0 and done.stdout.strip() == version:
            return candidate
    return None


# ---------------------------------------------------------------------------------------------- making


def _fingerprint(files: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _create(interpreter: Path, environment: Environment) -> None:
    """Create the empty environment; Debian keeps the module for it in a package of its own."""
    if subprocess.run([str(interpreter), "-c", "import ensurepip"], capture_output=True, check=False).returncode != 0:
        install([f"python{environment.python_version}-venv"])
    subprocess.run([str(interpreter), "-m", "venv", "--clear", str(environment.folder)], check=True)


def _pip_install(environment: Environment, requirements: Iterable[Path]) -> None:
    command = [str(environment.python), "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
    for path in requirements:
        command += ["--requirement", str(path)]
    if subprocess.run(command, check=False).returncode != 0:
        raise MissingEnvironmentError(f"pip could not install what {environment.folder} needs; its own words are above")


def make(environment: Environment, interpreter: Path, extra: tuple[Path, ...] = ()) -> None:
    """Make one environment and its twin, unless they are there as the requirement files say."""
    stamp = environment.folder / "made-from"
    requirements = [*environment.requirements, *extra]
    fingerprints = {_fingerprint(requirements), _fingerprint([*requirements, REQUIREMENTS / "bench.txt"])}
    if stamp.exists() and stamp.read_text(encoding="utf-8") in fingerprints:
        return
    print(f"making {environment.folder} with Blender {environment.blender}", flush=True)
    if not stamp.exists():
        _create(interpreter, environment)
    _pip_install(environment, requirements)
    install_missing_libraries(environment)
    make_user_twin(environment, interpreter)
    stamp.write_text(_fingerprint(requirements), encoding="utf-8")


def make_form_factors(interpreter: Path) -> None:
    """Make `.venv/form-factors`, unless it is there as its requirement file says; its numpy is not ours."""
    folder, requirements = FOLDER / "form-factors", REQUIREMENTS / "form-factors.txt"
    stamp = folder / "made-from"
    if stamp.exists() and stamp.read_text(encoding="utf-8") == _fingerprint([requirements]):
        return
    print(f"making {folder}", flush=True)
    subprocess.run([str(interpreter), "-m", "venv", "--clear", str(folder)], check=True)
    command = [str(folder / "bin" / "python"), "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
    if subprocess.run([*command, "--requirement", str(requirements)], check=False).returncode != 0:
        raise MissingEnvironmentError(f"pip could not install what {folder} needs; its own words are above")
    stamp.write_text(_fingerprint([requirements]), encoding="utf-8")


def make_user_twin(environment: Environment, interpreter: Path) -> None:
    """Make the twin: an environment whose packages are links to those of the first, all but embreex."""
    command = [str(interpreter), "-m", "venv", "--clear", "--without-pip", str(environment.user_folder)]
    subprocess.run(command, check=True)
    twin_packages = environment.user_folder / environment.site_packages.relative_to(environment.folder)
    for entry in environment.site_packages.iterdir():
        if not entry.name.startswith("embreex"):
            (twin_packages / entry.name).symlink_to(entry)


def missing_libraries(environment: Environment) -> list[str]:
    """Return the system libraries that bpy would not find."""
    (library,) = (environment.site_packages / "bpy").glob("__init__*.so")
    done = subprocess.run(["ldd", str(library)], capture_output=True, text=True, check=True)
    return re.findall(r"(\S+) => not found", done.stdout)


def install_missing_libraries(environment: Environment) -> None:
    """Install the system libraries that bpy needs and that are not there."""
    missing = missing_libraries(environment)
    unknown = [library for library in missing if library not in DEBIAN_PACKAGE_OF_LIBRARY]
    if unknown:
        raise MissingEnvironmentError(f"bpy needs {', '.join(unknown)}, and it is not known which package has it")
    if missing:
        install(sorted({DEBIAN_PACKAGE_OF_LIBRARY[library] for library in missing}))


def install_llvm() -> None:
    """Install LLVM's library, which Mitsuba compiles with, unless some version of it is there."""
    if any(Path("/usr/lib").glob("*/libLLVM*.so*")):
        return
    for version in LLVM_VERSIONS:
        try:
            install([f"libllvm{version}"])
        except DebianError as error:
            last_error = error
        else:
            return
    raise last_error


def make_all(extra: tuple[Path, ...] = ()) -> list[Environment]:
    """Make every environment whose Python this machine has, and let `.venv/main` be the newest; the extra
    requirements go into that one."""
    found = [(environment, find_interpreter(environment.python_version)) for environment in ENVIRONMENTS]
    usable = [(environment, interpreter) for environment, interpreter in found if interpreter is not None]
    for environment, interpreter in found:
        if interpreter is None:
            print(
                f"There is no Python {environment.python_version} on this machine, so nothing runs in Blender "
                f"{environment.blender}; install it (python{environment.python_version} on the search path, or "
                f"`pyenv install {environment.python_version}`) to have that too.",
                file=sys.stderr,
            )
    if not usable:
        raise MissingEnvironmentError("Blender's Python module needs Python 3.11 or 3.13, and this machine has neither")
    newest = usable[-1][0]
    for environment, interpreter in usable:
        make(environment, interpreter, extra if environment is newest else ())
    main_link = FOLDER / "main"
    if not main_link.is_symlink() or main_link.readlink() != Path(newest.name):
        main_link.unlink(missing_ok=True)
        main_link.symlink_to(newest.name)
    return [environment for environment, _ in usable]


def main(arguments: list[str]) -> int:
    for_benchmarks = arguments == ["bench"]
    try:
        made = make_all((REQUIREMENTS / "bench.txt",) if for_benchmarks else ())
        if for_benchmarks:
            install_llvm()
            make_form_factors(made[-1].python)
    except (MissingEnvironmentError, DebianError) as error:
        print(f"environments: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
