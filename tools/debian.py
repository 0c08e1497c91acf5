# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Install what is missing from Debian's packages, as root or by sudo, and only when it is missing."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence


class DebianError(Exception):
    """Something is missing that cannot be installed here; the text says what and why."""


def root_prefix() -> list[str]:
    """Return what goes before a command that needs root: nothing for root itself, sudo where it asks no password."""
    if os.geteuid() == 0:
        return []
    if (
        shutil.which("sudo")
        and subprocess.run(["sudo", "-n", "true"], capture_output=True, check=False).returncode == 0
    ):
        return ["sudo", "-n"]
    raise DebianError("this needs root, or sudo without a password")


def install(packages: Sequence[str]) -> None:
    """Install Debian packages without their recommendations."""
    if not shutil.which("apt-get"):
        raise DebianError(f"please install {', '.join(packages)}: this machine has no apt-get to do it with")
    try:
        prefix = root_prefix()
    except DebianError as error:
        raise DebianError(f"please install {', '.join(packages)}: {error}") from error
    print(f"installing {' '.join(packages)}", flush=True)
    apt = [*prefix, "env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-qq"]
    subprocess.run([*apt, "update"], check=False, stdout=subprocess.DEVNULL)
    done = subprocess.run(
        [*apt, "install", "-y", "--no-install-recommends", *packages],
        check=False,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if done.returncode != 0:
        raise DebianError(f"apt-get could not install {', '.join(packages)}:\n{done.stdout}")


def ensure_command(command: str, package: str) -> None:
    """Install the package unless the command is there."""
    if not shutil.which(command, path=f"{os.environ.get('PATH', '')}:/usr/sbin:/sbin"):
        install([package])
