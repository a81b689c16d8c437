"""The graph of bodies and contacts: which bodies contacts touch, and which are connected by contacts."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray


def restrict(row_a: IntArray, row_b: IntArray, count: int) -> tuple[IntArray, IntArray, IntArray]:
    """The rows, out of `count`, that occur in both arrays, in increasing order, and both arrays renumbered to them."""
    occurs = np.zeros(count, bool)
    occurs[row_a] = occurs[row_b] = True
    rows = np.flatnonzero(occurs)
    number = np.empty(count, np.intp)
    number[rows] = np.arange(len(rows))
    return rows, number[row_a], number[row_b]


def islands(row_a: IntArray, row_b: IntArray, inverse_mass: FloatArray) -> IntArray:
    """(m,) label of the island of every contact; bodies of infinite mass do not connect."""
    moves = inverse_mass > 0
    label = np.arange(len(moves))  # (R,) of the bodies
    both = moves[row_a] & moves[row_b]
    a, b = row_a[both], row_b[both]
    while True:
        before = label.copy()
        lowest = np.minimum(before[a], before[b])
        # Hook the roots, not only the ends, so that labels travel along whole trees at once.
        np.minimum.at(label, before[a], lowest)
        np.minimum.at(label, before[b], lowest)
        label = label[label]
        if np.array_equal(label, before):
            return np.where(moves[row_a], label[row_a], label[row_b])
