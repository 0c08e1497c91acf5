# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The number of its own that an Object Info node gives each object and each instance."""

from collections.abc import Iterable

import bpy

from .light_paths import set_output

LEVELS = 32
"""Looks that objects of one mesh may have by their numbers: each is evaluated once, in about a fifth of a second."""

_WORD = 0xFFFFFFFF


def object_random(instance: bpy.types.DepsgraphObjectInstance) -> float:
    """Return the number, 0 to 1, to the nearest of `LEVELS`."""
    if instance.is_instance:
        number = instance.random_id & _WORD
    else:
        number = _hashed(_hash_of_name(instance.object.original.name))
    return (min(int(number / _WORD * LEVELS), LEVELS - 1) + 0.5) / LEVELS


def asks_for_random(node: bpy.types.Node) -> bool:
    """Return whether a node gives the number to anything."""
    return node.type == "OBJECT_INFO" and any(out.is_linked and out.identifier == "Random" for out in node.outputs)


def with_random(trees: Iterable[bpy.types.NodeTree], number: float) -> None:
    """Have copied trees give this number, whatever the object is."""
    for tree in trees:
        for node in list(tree.nodes):
            if asks_for_random(node):
                set_output(tree, next(out for out in node.outputs if out.identifier == "Random"), number)


def _hash_of_name(name: str) -> int:
    value = 0
    for letter in name.encode():
        value = (value * 37 + letter) & _WORD
    return value


def _hashed(number: int) -> int:
    """Return what the final mix of Jenkins' lookup3 (2006) makes of two numbers, the second 0, as Cycles has it."""
    a = b = c = 0xDEADBEEF + (2 << 2) + 13
    a = (a + number) & _WORD
    c = ((c ^ b) - _turned(b, 14)) & _WORD
    a = ((a ^ c) - _turned(c, 11)) & _WORD
    b = ((b ^ a) - _turned(a, 25)) & _WORD
    c = ((c ^ b) - _turned(b, 16)) & _WORD
    a = ((a ^ c) - _turned(c, 4)) & _WORD
    b = ((b ^ a) - _turned(a, 14)) & _WORD
    return ((c ^ b) - _turned(b, 24)) & _WORD


def _turned(number: int, bits: int) -> int:
    return ((number << bits) | (number >> (32 - bits))) & _WORD
