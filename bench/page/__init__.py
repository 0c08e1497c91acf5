# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The page `docs/performance.md`, made of what was measured; each section is a file."""

from __future__ import annotations

from ..results import Document
from .equal_error import equal_error, vertices
from .everything import everything
from .form_factors import form_factors
from .goals import goals
from .growth import growth
from .introduction import introduction
from .own_bakes import own_bakes
from .paper_table import paper_table
from .profile import profile
from .scaling import scaling


def page(document: Document) -> str:
    """Return the page's text for what `results.collect` returns."""
    parts = [introduction(document)]
    if document["scenes"]:
        parts += [goals(document), equal_error(document), vertices(document), own_bakes(document)]
    if document.get("profile"):
        parts += [profile(document["profile"])]
    if document["scenes"]:
        parts += [growth(document)]
    if document.get("scaling"):
        parts += [scaling(document["scaling"])]
    if document["form_factors"]:
        parts += [form_factors(document["form_factors"]["results"])]
    if document["paper_table"]:
        parts += [paper_table(document["paper_table"])]
    if document["scenes"]:
        parts += [everything(document)]
    return "\n".join(line for part in parts for line in (*part, "")).rstrip() + "\n"
