# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write down what bakes cost now, counts.json of test_counts.py: `python -m tests.core.data.make_counts`.

To be done when a change of the counts is meant; the commit says why they changed.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path


def main() -> None:
    """Bake, write, and print what changed."""
    sys.path.insert(0, str(Path(__file__).resolve().parents[3]))
    from tools.package import load_package

    load_package()
    from tests.core.test_counts import CASES, FILE, counts_of, expected_counts

    before = expected_counts() if FILE.exists() else {}
    after = {case: counts_of(case) for case in CASES}
    for case, counts in after.items():
        old = before.get(case, {})
        print(f"{case}: " + ", ".join(f"{name} {old.get(name, 0):,} -> {count:,}" for name, count in counts.items()))
    FILE.write_text(json.dumps(after, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
