# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The writing of the page: tables, paragraphs, and numbers in the digits that mean something."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence

Lines = list[str]

# Before a cost at equal error, by its kind.
SIGNS = {"between": "", "beyond": "≥ ", "below": "≤ "}


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> Lines:
    """Return a table; the first column is text, the others are numbers."""
    return [
        "| " + " | ".join(header) + " |",
        "|" + "|".join(["---"] + ["---:"] * (len(header) - 1)) + "|",
        *("| " + " | ".join(row) + " |" for row in rows),
    ]


def paragraph(text: str) -> Lines:
    """Return a text in lines of the documents' length."""
    return textwrap.wrap(text, 120, break_long_words=False, break_on_hyphens=False)


def percent(share: float) -> str:
    """Return a share with two or three digits that mean something."""
    return f"{share:.2%}" if share < 0.1 else f"{share:.1%}"


def seconds(value: float) -> str:
    """Return seconds with two or three digits."""
    return f"{value:.2f}" if value < 10.0 else f"{value:.1f}" if value < 100.0 else f"{value:,.0f}"


def times(value: float) -> str:
    """Return a factor with two or three digits."""
    return f"{value:.2g}" if value < 10.0 else f"{value:,.0f}"
