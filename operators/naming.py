# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of things for sentences."""

import re
from collections.abc import Collection, Iterable

_COUNTED = re.compile(r"(\d+) (.+)", re.DOTALL)


def named(names: Iterable[str], most: int | None = 3) -> str:
    """Return quoted names for a sentence, the first few of many."""
    names = list(names)
    shown = ", ".join(f'"{name}"' for name in names[:most])
    return shown if most is None or len(names) <= most else f"{shown} and {len(names) - most} more"


def joined(sentences: Iterable[str], names: Collection[str]) -> list[str]:
    """Return sentences of which those that say the same of several objects are one, with the sum of what they count.

    Parameters
    ----------
    sentences : iterable of str
        Some begin with the name of an object and a colon, and a number may follow.
    names : collection of str
        Those of all objects.
    """
    told: dict[str, list[tuple[str, str, int]]] = {}
    for sentence in sentences:
        name, said = _of_object(sentence, names)
        counted = _COUNTED.fullmatch(said) if name else None
        cause, number = (counted[2], int(counted[1])) if counted else (said, 0)
        told.setdefault(cause if name else sentence, []).append((sentence, name, number))
    return [_one_sentence(cause, alike) for cause, alike in told.items()]


def _of_object(sentence: str, names: Collection[str]) -> tuple[str, str]:
    """Return the name that a sentence begins with, empty for none, and what it says."""
    for colon in re.finditer(": ", sentence):
        if sentence[: colon.start()] in names:
            return sentence[: colon.start()], sentence[colon.end() :]
    return "", sentence


def _one_sentence(cause: str, alike: list[tuple[str, str, int]]) -> str:
    if len(alike) == 1:
        return alike[0][0]
    total = sum(number for _, _, number in alike)
    return f"{named(dict.fromkeys(name for _, name, _ in alike))}: {f'{total:,} ' if total else ''}{cause}"
