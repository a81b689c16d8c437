"""States of contacts and bounded rows on a homotopy of solved problems (`homotopy.py`); each change is a pivot.

In the functions c numbers a contact, c < m, or the row c - m; s is its sign, `which` one of the two changes of its
state (`margin`)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import inlined, nonallocating
from .coulomb import OPEN, SLIP, STICK

ABSENT, INSIDE, BOUND = 0, 4, 5  # states beside OPEN, STICK, SLIP: none; of bounded rows inside of their bounds, at one


class Tableau(NamedTuple):
    """A place on the homotopy, of m contacts and n bounded rows: contact i has the unknowns 2 i (normal) and 2 i + 1
    (tangential), row i the unknown 2 m + i; size = 2 m + n.

    MODE, SIGN (m + n,): states; sign of the friction that slips, or of the bound; else 0.  MU (m,): friction, as long
    as the homotopy lasts.  LOW, HIGH (n,): bounds.  REST (m,): tangential velocity of contacts that stick, not 0 where
    energy limits friction (`coulomb.mode_of`). T (size, size + 2): an unknown is an impulse or a velocity less its
    target; its state leaves one of both free, and fixes the other at 0. Row k has the free one of unknown k by changes
    of all fixed ones, then at theta = 0, and per theta. Where a contact slips, beta stands for beta - s mu lam.
    R (size + 2,): room for a row.
    """

    MODE: IntArray
    SIGN: FloatArray
    MU: FloatArray
    LOW: FloatArray
    HIGH: FloatArray
    REST: FloatArray
    T: FloatArray
    R: FloatArray


@inlined
def unknown_of(m: int, c: int) -> int:
    """The normal unknown of contact c < m, or the unknown of the row c - m."""
    return 2 * c if c < m else m + c


@nonallocating
def pivot(tableau: Tableau, k: int) -> None:
    """Exchange the free and the fixed quantity of unknown k."""
    T, R = tableau.T, tableau.R
    size, width = T.shape
    by = -1.0 / T[k, k]
    T[k, k] = -1.0
    for j in range(width):
        # A copy of the row cannot overlap the others, which are then vectorised.
        R[j] = T[k, j] * by
        T[k, j] = R[j]
    for i in range(size):
        factor = T[i, k]
        if i != k and factor != 0.0:
            T[i, k] = 0.0
            for j in range(width):
                T[i, j] += factor * R[j]


@nonallocating
def slope_of(tableau: Tableau, c: int) -> float:
    """beta / lam of a contact that slips."""
    return float(tableau.SIGN[c] * tableau.MU[c])


@nonallocating
def slip(tableau: Tableau, c: int, sign: float) -> None:
    """Let contact c, which is open, slip with friction of that sign: lam becomes free, and beta follows it."""
    T, n = tableau.T, 2 * c
    tableau.MODE[c], tableau.SIGN[c] = SLIP, sign
    for i in range(len(T)):
        T[i, n] += slope_of(tableau, c) * T[i, n + 1]
    pivot(tableau, n)


@nonallocating
def stick(tableau: Tableau, c: int) -> None:
    """Let contact c, which slips, stick: beta becomes free."""
    T, n = tableau.T, 2 * c
    pivot(tableau, n + 1)
    for j in range(T.shape[1]):
        T[n + 1, j] += slope_of(tableau, c) * T[n, j]
    tableau.MODE[c], tableau.SIGN[c] = STICK, 0.0


@nonallocating
def change(tableau: Tableau, m: int, c: int, which: int, theta: float) -> int:
    """Let c make its change of state number `which` (`margin`) at theta; returns the number of the change back."""
    T, state, sign = tableau.T, tableau.MODE[c], tableau.SIGN[c]
    k, size = unknown_of(m, c), len(tableau.T)
    if state == OPEN:
        slides = T[k + 1, size] + theta * T[k + 1, size + 1]
        slip(tableau, c, 0.0 if tableau.MU[c] <= 0.0 else -1.0 if slides > 0.0 else 1.0)
        return 0
    if state == STICK:
        tableau.MODE[c], tableau.SIGN[c] = SLIP, 1.0 if which == 0 else -1.0
        for j in range(size + 2):
            T[k + 1, j] -= slope_of(tableau, c) * T[k, j]
        pivot(tableau, k + 1)
        return 1
    if state == SLIP and which == 1:
        stick(tableau, c)
        return 0 if sign > 0.0 else 1
    if state == SLIP:
        pivot(tableau, k)
        for i in range(size):
            T[i, k] -= slope_of(tableau, c) * T[i, k + 1]
        tableau.MODE[c], tableau.SIGN[c] = OPEN, 0.0
        return 0
    if state == INSIDE:
        tableau.MODE[c], tableau.SIGN[c] = BOUND, -1.0 if which == 0 else 1.0
        T[k, size] -= bound_of(tableau, m, c)
        pivot(tableau, k)
        return 0
    bound = bound_of(tableau, m, c)
    pivot(tableau, k)
    T[k, size] += bound
    tableau.MODE[c], tableau.SIGN[c] = INSIDE, 0.0
    return 1 if sign > 0.0 else 0


@nonallocating
def margin(tableau: Tableau, m: int, c: int, which: int, z: int) -> float:
    """What keeps c from its change of state number `which`, which it makes at 0, at theta = 0 (z = 0) or per theta (1);
    inf if there is no such change.

    open 0: u_n; slip 0: lam, 1: -sign u_t; stick 0, 1: mu lam -+ beta; inside 0, 1: its distance from the lower and
    upper bound; at a bound 0: -sign u.
    """
    T, state, sign, column = tableau.T, tableau.MODE[c], tableau.SIGN[c], len(tableau.T) + z
    k = unknown_of(m, c)
    if state == STICK:
        return float(tableau.MU[c] * T[k, column] + (T[k + 1, column] if which == 1 else -T[k + 1, column]))
    if state == INSIDE:
        bound = 0.0 if z == 1 else tableau.LOW[c - m] if which == 0 else tableau.HIGH[c - m]
        return float(T[k, column] - bound if which == 0 else bound - T[k, column])
    if state == SLIP and which == 1 and sign != 0.0:
        return float(-sign * T[k + 1, column])
    if which == 0 and state != ABSENT:
        return float(-sign * T[k, column] if state == BOUND else T[k, column])
    return np.inf


@nonallocating
def bound_of(tableau: Tableau, m: int, c: int) -> float:
    """The bound of row c on the side of its sign, 0 if it is infinite."""
    bound = tableau.HIGH[c - m] if tableau.SIGN[c] > 0.0 else tableau.LOW[c - m]
    return float(bound) if abs(bound) < np.inf else 0.0
