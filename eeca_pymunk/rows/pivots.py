"""States of contacts and bounded rows on a homotopy of solved problems (`homotopy.py`); each change is a pivot.

In the functions c numbers a contact, c < m, or the row c - m; s is its sign, `which` one of the two changes of its
state (`margin`)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import inlined, kernel, nonallocating
from .coulomb import OPEN, SLIP, STICK
from .inplace import add_multiple

ABSENT, INSIDE, BOUND = 0, 4, 5  # states beside OPEN, STICK, SLIP: none; of bounded rows inside of their bounds, at one


class Tableau(NamedTuple):
    """A place on the homotopy, of m contacts and n bounded rows: contact i has the unknowns 2 i (normal) and 2 i + 1
    (tangential), row i the unknown 2 m + i; size = 2 m + n.

    MODE, SIGN (m + n,): states; sign of the friction that slips, or of the bound; else 0.  MU (m,): friction, as long
    as the homotopy lasts.  LOW, HIGH (n,): bounds.  TARGET_T (m,): u_t of contacts that stick, not 0 where energy
    limits friction (`coulomb.mode_of`). T (size + 3, size): an unknown is an impulse and a velocity less its target;
    its state makes one of both basic, and the other, nonbasic, is 0. Row k has all basic ones by changes of the
    nonbasic one of unknown k; row `size` their values at theta = 0, the next their changes per theta, the last is
    scratch. Where a contact slips, beta stands for beta - s mu lam.

    A pivot changes each row of T by itself, so a row is brought up to date when it is needed (`update`). BY (room, 3),
    COLUMN (room, size), OF (room,): the pivots, each of unknown OF; see `take_pivot`.  MADE (1,): how many.
    FROM (size,): how many of them row k has taken.
    """

    MODE: IntArray
    SIGN: FloatArray
    MU: FloatArray
    LOW: FloatArray
    HIGH: FloatArray
    TARGET_T: FloatArray
    T: FloatArray
    BY: FloatArray
    COLUMN: FloatArray
    OF: IntArray
    MADE: IntArray
    FROM: IntArray


@kernel
def make_tableau(m: int, n: int, pivots: int) -> Tableau:
    """A tableau without states, in which there is room for so many pivots."""
    count, size = m + n, 2 * m + n
    N, Z = np.zeros(count + pivots + 1 + size, np.int64), np.zeros(3 * count)
    OF, MADE, FROM = N[count : count + pivots], N[count + pivots : count + pivots + 1], N[count + pivots + 1 :]
    return Tableau(
        N[:count], Z[:count], Z[count : count + m], Z[count + m : 2 * count], Z[2 * count : 2 * count + n],
        Z[2 * count + n :], np.empty((size + 3, size)), np.empty((pivots, 3)), np.empty((pivots, size)), OF, MADE, FROM,
    )  # fmt: skip


@inlined
def unknown_of(m: int, c: int) -> int:
    """The normal unknown of contact c < m, or the unknown of the row c - m."""
    return 2 * c if c < m else m + c


@nonallocating
def take_pivot(tableau: Tableau, p: int, j: int) -> None:
    """Apply pivot number p to row j of T.

    BY[p]: -1 / the entry of the pivot; before it, and after it, how much of the normal entry is added to the tangential
    one, as beta - s mu lam becomes beta or beta becomes it.
    """
    T, BY, COLUMN, k = tableau.T, tableau.BY, tableau.COLUMN, tableau.OF[p]
    if BY[p, 1] != 0.0:
        T[j, k] += BY[p, 1] * T[j, k - 1]
    amount = T[j, k] * BY[p, 0]
    T[j, k] = amount
    if amount != 0.0:
        add_multiple(T[j], COLUMN[p], amount)
    if BY[p, 2] != 0.0:
        T[j, k] += BY[p, 2] * T[j, k - 1]


@nonallocating
def update(tableau: Tableau, k: int) -> None:
    """Bring row k of T up to date."""
    for p in range(tableau.FROM[k], tableau.MADE[0]):
        take_pivot(tableau, p, k)
    tableau.FROM[k] = tableau.MADE[0]


@nonallocating
def own_rate(tableau: Tableau, k: int, slope: float) -> float:
    """Change of the basic quantity of unknown k by its nonbasic one, if that of the next changes by `slope` with it."""
    update(tableau, k)
    if slope == 0.0:
        return float(tableau.T[k, k])
    update(tableau, k + 1)
    return float(tableau.T[k, k] + slope * tableau.T[k + 1, k])


@nonallocating
def pivot(tableau: Tableau, k: int, before: float, after: float) -> None:
    """Exchange the basic and the nonbasic quantity of unknown k. before, after: see `take_pivot`."""
    T, BY, COLUMN, p = tableau.T, tableau.BY, tableau.COLUMN, tableau.MADE[0]
    size = T.shape[1]
    update(tableau, k)
    if before != 0.0:
        T[k, k] += before * T[k, k - 1]
    BY[p, 0], BY[p, 1], BY[p, 2], tableau.OF[p] = -1.0 / T[k, k], before, after, k
    for i in range(size):
        COLUMN[p, i], T[k, i] = T[k, i], 0.0
    COLUMN[p, k], T[k, k] = 0.0, -1.0  # the row begins anew, with this pivot
    tableau.FROM[k], tableau.MADE[0] = p, p + 1
    take_pivot(tableau, p, size)
    take_pivot(tableau, p, size + 1)


@nonallocating
def add_friction(tableau: Tableau, n: int, slope: float) -> None:
    """Let the nonbasic beta of the contact with normal unknown n change by `slope` with its nonbasic lam."""
    if slope != 0.0:
        if tableau.FROM[n] != tableau.FROM[n + 1]:
            update(tableau, n)
            update(tableau, n + 1)
        add_multiple(tableau.T[n], tableau.T[n + 1], slope)


@nonallocating
def slope_of(tableau: Tableau, c: int) -> float:
    """beta / lam of a contact that slips."""
    return float(tableau.SIGN[c] * tableau.MU[c])


@nonallocating
def slip(tableau: Tableau, c: int, sign: float) -> None:
    """Let contact c, which is open, slip with friction of that sign: lam becomes basic, and beta follows it."""
    tableau.MODE[c], tableau.SIGN[c] = SLIP, sign
    add_friction(tableau, 2 * c, slope_of(tableau, c))
    pivot(tableau, 2 * c, 0.0, 0.0)


@nonallocating
def stick(tableau: Tableau, c: int) -> None:
    """Let contact c, which slips, stick: beta becomes basic."""
    pivot(tableau, 2 * c + 1, 0.0, slope_of(tableau, c))
    tableau.MODE[c], tableau.SIGN[c] = STICK, 0.0


@nonallocating
def change(tableau: Tableau, m: int, c: int, which: int, theta: float) -> int:
    """Let c make its change of state number `which` (`margin`) at theta; returns the number of the change back."""
    T, state, sign = tableau.T, tableau.MODE[c], tableau.SIGN[c]
    k, size = unknown_of(m, c), tableau.T.shape[1]
    if state == OPEN:
        slides = T[size, k + 1] + theta * T[size + 1, k + 1]
        slip(tableau, c, 0.0 if tableau.MU[c] <= 0.0 else -1.0 if slides > 0.0 else 1.0)
        return 0
    if state == STICK:
        tableau.MODE[c], tableau.SIGN[c] = SLIP, 1.0 if which == 0 else -1.0
        pivot(tableau, k + 1, -slope_of(tableau, c), 0.0)
        return 1
    if state == SLIP and which == 1:
        stick(tableau, c)
        return 0 if sign > 0.0 else 1
    if state == SLIP:
        pivot(tableau, k, 0.0, 0.0)
        add_friction(tableau, k, -slope_of(tableau, c))
        tableau.MODE[c], tableau.SIGN[c] = OPEN, 0.0
        return 0
    if state == INSIDE:
        tableau.MODE[c], tableau.SIGN[c] = BOUND, -1.0 if which == 0 else 1.0
        T[size, k] -= bound_of(tableau, m, c)
        pivot(tableau, k, 0.0, 0.0)
        return 0
    bound = bound_of(tableau, m, c)
    pivot(tableau, k, 0.0, 0.0)
    T[size, k] += bound
    tableau.MODE[c], tableau.SIGN[c] = INSIDE, 0.0
    return 1 if sign > 0.0 else 0


@nonallocating
def margin(tableau: Tableau, m: int, c: int, which: int, z: int) -> float:
    """What keeps c from its change of state number `which`, which it makes at 0, at theta = 0 (z = 0) or per theta (1);
    inf if there is no such change.

    open 0: u_n; slip 0: lam, 1: -sign u_t; stick 0, 1: mu lam -+ beta; inside 0, 1: its distance from the lower and
    upper bound; at a bound 0: -sign u.
    """
    T, state, sign, column = tableau.T, tableau.MODE[c], tableau.SIGN[c], tableau.T.shape[1] + z
    k = unknown_of(m, c)
    if state == STICK:
        return float(tableau.MU[c] * T[column, k] + (T[column, k + 1] if which == 1 else -T[column, k + 1]))
    if state == INSIDE:
        bound = 0.0 if z == 1 else tableau.LOW[c - m] if which == 0 else tableau.HIGH[c - m]
        return float(T[column, k] - bound if which == 0 else bound - T[column, k])
    if state == SLIP and which == 1 and sign != 0.0:
        return float(-sign * T[column, k + 1])
    if which == 0 and state != ABSENT:
        return float(-sign * T[column, k] if state == BOUND else T[column, k])
    return np.inf


@nonallocating
def bound_of(tableau: Tableau, m: int, c: int) -> float:
    """The bound of row c on the side of its sign, 0 if it is infinite."""
    bound = tableau.HIGH[c - m] if tableau.SIGN[c] > 0.0 else tableau.LOW[c - m]
    return float(bound) if abs(bound) < np.inf else 0.0
