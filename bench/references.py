# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The references of all scenes, computed where they are missing: `python -m bench.references [SCENE ...]`.

Prints the noise of each. That takes hours on two cores; what is stopped goes on where it was.
"""

from __future__ import annotations

import sys

from .measure import judged
from .scenes import SCENES


def main(names: list[str]) -> None:
    """Compute and print."""
    print(f"{'scene':<18}{'samples':>9}{'seconds':>9}{'noise':>8}")
    # The furnace has no probes: every part of it emits, and its answer is known.
    for name in names or [name for name in SCENES if name != "furnace"]:
        reference = judged(name).reference
        print(f"{name:<18}{reference.samples:>9,}{reference.seconds:>9.0f}{reference.noise:>8.2%}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
