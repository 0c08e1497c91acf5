# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Try random ugly scenes that the tests have not tried, for as long as it is told.

    .venv/main/bin/python -m tools.nightly               twenty minutes
    .venv/main/bin/python -m tools.nightly --minutes 3   as long as that

Each round has a seed of its own, which is printed: `--seed` begins with it again. A failure is shrunk to a small scene,
told with its traceback, and ends the run with exit code 1.
"""

from __future__ import annotations

import argparse
import os
import secrets
import subprocess
import sys
import time
from collections.abc import Sequence

from .environments import ROOT

SCENES_A_ROUND = 250


def command(seed: int) -> list[str]:
    """Return the command of one round."""
    test = "tests/core/test_ugly.py"
    return [sys.executable, "-m", "pytest", "-q", "-x", test, f"--hypothesis-seed={seed}", "-p", "no:cacheprovider"]


def main(arguments: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=20.0)
    parser.add_argument("--seed", type=int, help="of the first round")
    options = parser.parse_args(arguments)
    seed = secrets.randbelow(2**31) if options.seed is None else options.seed
    end, rounds = time.monotonic() + 60.0 * options.minutes, 0
    environment = {**os.environ, "UGLY_SCENES": str(SCENES_A_ROUND)}
    while time.monotonic() < end:
        print(f"round {rounds + 1}: {SCENES_A_ROUND} scenes of seed {seed}", flush=True)
        if subprocess.run(command(seed), cwd=ROOT, env=environment, check=False).returncode != 0:
            print(f"nightly: failed; `--seed {seed}` tries these scenes again", file=sys.stderr)
            return 1
        seed, rounds = (seed + 1) % 2**31, rounds + 1
    print(f"nightly: {rounds * SCENES_A_ROUND:,} scenes in {rounds} rounds, none of which failed")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
