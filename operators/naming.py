# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of things for sentences."""

from collections.abc import Iterable


def named(names: Iterable[str], most: int | None = 3) -> str:
    """Return quoted names for a sentence, the first few of many."""
    names = list(names)
    shown = ", ".join(f'"{name}"' for name in names[:most])
    return shown if most is None or len(names) <= most else f"{shown} and {len(names) - most} more"
