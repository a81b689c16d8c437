"""Coulomb's law and bounded impulses along a path of solved problems, from any impulses to the solution.

In the plane both are piecewise linear: contacts are open (lam = 0, u_n >= b), stick (u = (b, 0)) or slip (beta =
s mu lam, s u_t <= 0); a bounded row has its target velocity, or its impulse is at a bound. Impulses that sweeps leave
solve it exactly for other free velocities, q + theta p with theta = 1, where p takes their residuals away. From there
theta goes to 0 along the solution, which is linear until a state changes; then on, with growing or falling theta, as
the new state allows (Lemke 1965; of contacts Stewart and Trinkle 1996). A change is one pivot, also where contacts jam
with redundant impulses, which sweeps carry round for ever. A path that begins without impulses ends if no target is
positive and no surface conveys (Anitescu and Potra 1997); others may run to infinity.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..model.contacts import JointedProblem
from ..model.parameters.impulses import PATH_CHANGES, PATH_CHANGES_ANEW, PATH_REFINEMENTS
from .bounded import SINGLE, bounded_rate
from .build import normal_rate, tangent_rate
from .dense import matrix_jointed
from .sweeps import velocities

# States: of what takes no part, of contacts, of bounded rows inside of their bounds and at one.
OUT, OPEN, STICK, SLIP, INSIDE, BOUND = 0, 1, 2, 3, 4, 5


class Path(NamedTuple):
    """A place on the path, of m contacts and n bounded rows: contact i has the unknowns 2 i (normal) and 2 i + 1
    (tangential), row i the unknown 2 m + i; size = 2 m + n.

    STATE, SIGN (m + n,): states; sign of the friction that slips, or of the bound; else 0.  MU (m,), LOW, HIGH (n,).
    T (size, size + 2): of each unknown the impulse, or the velocity less its target, that its state leaves free, by
    those of all that it fixes, which are 0; then its value at theta = 0, and per theta. Where a contact slips, beta
    stands for beta - s mu lam.  R (size + 2,): room for a row.
    """

    STATE: IntArray
    SIGN: FloatArray
    MU: FloatArray
    LOW: FloatArray
    HIGH: FloatArray
    T: FloatArray
    R: FloatArray


@nonallocating
def pivot(path: Path, k: int) -> None:
    """Exchange what unknown k leaves free for what it fixes."""
    T, R = path.T, path.R
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
def slope_of(path: Path, c: int) -> float:
    """beta / lam of a contact that slips."""
    return float(path.SIGN[c] * path.MU[c])


@nonallocating
def let_slip(path: Path, c: int, sign: float) -> None:
    """Let contact c, which is open, slip with friction of that sign."""
    T, n = path.T, 2 * c
    path.STATE[c], path.SIGN[c] = SLIP, sign
    for i in range(len(T)):
        T[i, n] += slope_of(path, c) * T[i, n + 1]
    pivot(path, n)


@nonallocating
def hold(path: Path, c: int) -> None:
    """Let contact c, which slips, stick."""
    T, n = path.T, 2 * c
    pivot(path, n + 1)
    for j in range(T.shape[1]):
        T[n + 1, j] += slope_of(path, c) * T[n, j]
    path.STATE[c], path.SIGN[c] = STICK, 0.0


@nonallocating
def change(path: Path, m: int, c: int, which: int, theta: float) -> int:
    """Let c make its change of state number `which` (`margin`) at theta; returns the number of the change back."""
    T, state, sign = path.T, path.STATE[c], path.SIGN[c]
    k, size = 2 * c if c < m else m + c, len(path.T)
    if state == OPEN:
        slides = T[k + 1, size] + theta * T[k + 1, size + 1]
        let_slip(path, c, 0.0 if path.MU[c] <= 0.0 else -1.0 if slides > 0.0 else 1.0)
        return 0
    if state == STICK:
        path.STATE[c], path.SIGN[c] = SLIP, 1.0 if which == 0 else -1.0
        for j in range(size + 2):
            T[k + 1, j] -= slope_of(path, c) * T[k, j]
        pivot(path, k + 1)
        return 1
    if state == SLIP and which == 1:
        hold(path, c)
        return 0 if sign > 0.0 else 1
    if state == SLIP:
        pivot(path, k)
        for i in range(size):
            T[i, k] -= slope_of(path, c) * T[i, k + 1]
        path.STATE[c], path.SIGN[c] = OPEN, 0.0
        return 0
    if state == INSIDE:
        path.STATE[c], path.SIGN[c] = BOUND, -1.0 if which == 0 else 1.0
        T[k, size] -= path.LOW[c - m] if which == 0 else path.HIGH[c - m]
        pivot(path, k)
        return 0
    pivot(path, k)
    T[k, size] += path.HIGH[c - m] if sign > 0.0 else path.LOW[c - m]
    path.STATE[c], path.SIGN[c] = INSIDE, 0.0
    return 1 if sign > 0.0 else 0


@nonallocating
def margin(path: Path, m: int, c: int, which: int, z: int) -> float:
    """What keeps c from its change of state number `which`, which it makes at 0, at theta = 0 (z = 0) or per theta (1);
    inf if there is no such change.

    open 0: u_n; slip 0: lam, 1: -sign u_t; stick 0, 1: mu lam -+ beta; inside 0, 1: its distance from the lower and
    upper bound; at a bound 0: -sign u.
    """
    T, state, sign, column = path.T, path.STATE[c], path.SIGN[c], len(path.T) + z
    k = 2 * c if c < m else m + c
    if state == STICK:
        return float(path.MU[c] * T[k, column] + (T[k + 1, column] if which == 1 else -T[k + 1, column]))
    if state == INSIDE:
        bound = 0.0 if z == 1 else path.LOW[c - m] if which == 0 else path.HIGH[c - m]
        return float(T[k, column] - bound if which == 0 else bound - T[k, column])
    if state == SLIP and which == 1 and sign != 0.0:
        return float(-sign * T[k + 1, column])
    if which == 0 and state != OUT:
        return float(-sign * T[k, column] if state == BOUND else T[k, column])
    return np.inf


@kernel
def begin(problem: JointedProblem, L: FloatArray, V: FloatArray) -> Path:
    """The path's start at impulses L (m + n, 2) with velocities V (k, 3). Contacts that sleep, discs, and rows that
    joints hold take no part: their impulses stay."""
    A, B, ROWS, C, D, m = problem
    n = D.USED[0]
    size = 2 * m + n
    path = Path(
        np.zeros(m + n, np.int64), np.zeros(m + n), np.zeros(m), np.zeros(n), np.zeros(n), np.zeros((size, size + 2)),
        np.empty(size + 2),
    )  # fmt: skip
    T, X, W = path.T, np.zeros(size), np.empty((size, size))
    AT, KIND = np.empty(size, np.int64), np.empty(size, np.int64)
    for k in range(size):
        AT[k], KIND[k] = (k // 2, k % 2) if k < 2 * m else (k - 2 * m, 2)
    matrix_jointed(problem, np.zeros(m), AT, KIND, size, W)
    for i in range(m):
        path.MU[i] = max(ROWS[i].friction, 0.0)
        if C.OUT[i] == 0 and not ROWS[i].wake < np.inf:
            path.STATE[i] = OPEN
            T[2 * i, size] = normal_rate(A, B, ROWS, V, i) - ROWS[i].target
            T[2 * i + 1, size] = tangent_rate(A, B, ROWS, V, i)
            X[2 * i], X[2 * i + 1] = L[i, 0], L[i, 1]
    for i in range(n):
        row, k = D.ROWS[i], 2 * m + i
        path.LOW[i], path.HIGH[i] = row.low, row.high
        if row.part == SINGLE and W[k, k] > 0.0:
            path.STATE[m + i], path.SIGN[m + i] = BOUND, 1.0 if L[m + i, 0] >= row.high else -1.0
            T[k, size] = row.speed + bounded_rate(D, i, V)
            X[k] = L[m + i, 0]
    for k in range(size):
        for r in range(size):
            T[r, k] = W[r, k]
    take_states(path, m, X)
    return path


@kernel
def take_states(path: Path, m: int, X: FloatArray) -> None:
    """States of the impulses X (size,), and the velocities per theta that take from those, T[:, size], by which they
    are not lawful."""
    STATE, T, size = path.STATE, path.T, len(path.T)
    P = np.zeros(size)
    for c in range(len(STATE)):
        if STATE[c] == OUT:
            continue
        k = 2 * c if c < m else m + c
        u, x = T[k, size], X[k]
        if c >= m:
            inside = path.LOW[c - m] < x < path.HIGH[c - m]
            P[k] = -u if inside or path.SIGN[c] * u > 0.0 else 0.0
        elif x <= 0.0:
            P[k] = max(-u, 0.0)
        else:
            P[k] = -u
            # The sign of a slip, or 0 where it sticks.
            s = 0.0 if abs(X[k + 1]) < (1.0 - 1e-9) * path.MU[c] * x else 1.0 if X[k + 1] > 0.0 else -1.0
            if s * T[k + 1, size] > 0.0 or (s == 0.0 and path.MU[c] > 0.0):
                P[k + 1] = -T[k + 1, size]
    for r in range(size):
        T[r, size + 1] = P[r]
        for k in range(size):
            T[r, size] -= T[r, k] * X[k]
    for c in range(len(STATE)):
        k = 2 * c if c < m else m + c
        if STATE[c] == BOUND:
            bound = path.HIGH[c - m] if path.SIGN[c] > 0.0 else path.LOW[c - m]
            for r in range(size):
                T[r, size] += T[r, k] * (bound if abs(bound) < np.inf else 0.0)
    for c in range(len(STATE)):
        k = 2 * c if c < m else m + c
        if STATE[c] == BOUND and path.LOW[c - m] < X[k] < path.HIGH[c - m]:
            bound = path.HIGH[c - m] if path.SIGN[c] > 0.0 else path.LOW[c - m]
            pivot(path, k)
            T[k, size] += bound if abs(bound) < np.inf else 0.0
            STATE[c], path.SIGN[c] = INSIDE, 0.0
        elif STATE[c] == OPEN and X[k] > 0.0:
            sticks = abs(X[k + 1]) < (1.0 - 1e-9) * path.MU[c] * X[k]
            sign = 0.0 if path.MU[c] <= 0.0 else 1.0 if X[k + 1] > 0.0 else -1.0
            let_slip(path, c, sign)
            if sticks:
                hold(path, c)


@nonallocating
def give(path: Path, m: int, X: FloatArray, L: FloatArray) -> None:
    """Set the impulses L of the present states, by the unknowns X (size,) that these leave free."""
    for c in range(len(path.STATE)):
        k, state = 2 * c if c < m else m + c, path.STATE[c]
        if state == BOUND:
            L[c, 0] = path.HIGH[c - m] if path.SIGN[c] > 0.0 else path.LOW[c - m]
        elif state != OUT:
            L[c, 0] = X[k] if state != OPEN else 0.0
            if c < m:
                L[c, 1] = X[k + 1] if state == STICK else slope_of(path, c) * L[c, 0]


@nonallocating
def refine(problem: JointedProblem, path: Path, V: FloatArray, X: FloatArray) -> None:
    """Correct the unknowns X (size,) by the velocities V that the present states fix and that are not 0: the proximal
    term and round-off of pivots leave them."""
    A, B, ROWS, _, D, m = problem
    for c in range(len(path.STATE)):
        k, state = 2 * c if c < m else m + c, path.STATE[c]
        for z in range(2 if state == STICK else 1 if state in (SLIP, INSIDE) else 0):
            if c >= m:
                off = D.ROWS[c - m].speed + bounded_rate(D, c - m, V)
            else:
                off = tangent_rate(A, B, ROWS, V, c) if z == 1 else normal_rate(A, B, ROWS, V, c) - ROWS[c].target
            for i in range(len(X)):
                X[i] -= path.T[i, k + z] * off


@kernel
def follow_path(problem: JointedProblem, L: FloatArray, V: FloatArray, FREE: FloatArray, anew: bool) -> bool:
    """Impulses L (m + n, 2) and velocities V (k, 3) at the end of the path from these; False, with nothing changed, if
    its end is not reached.

    Args:
        FREE: (k, 3) velocities without any impulses of the problem.  anew: whether it begins without impulses, and may
            be longer.
    """
    m = problem.m
    path = begin(problem, L, V)
    T, count, size = path.T, len(path.STATE), len(path.T)
    X = np.empty(size)
    theta, way, changed, number = 1.0, -1.0, -1, 0
    for _ in range((PATH_CHANGES_ANEW if anew else PATH_CHANGES) * count):
        nearest = np.inf
        if changed >= 0:
            way = 1.0 if margin(path, m, changed, number, 1) > 0.0 else -1.0
        changed = -1
        for c in range(count):
            for which in range(2):
                rate = way * margin(path, m, c, which, 1)
                if rate < 0.0:
                    left = max(margin(path, m, c, which, 0) + theta * way * rate, 0.0) / -rate
                    if left < nearest:
                        nearest, changed, number = left, c, which
        if way < 0.0 and theta <= nearest:
            for k in range(size):
                X[k] = T[k, size]
            give(path, m, X, L)
            velocities(problem, L, FREE, V)
            for _ in range(PATH_REFINEMENTS):
                refine(problem, path, V, X)
                give(path, m, X, L)
                velocities(problem, L, FREE, V)
            return True
        if changed < 0:
            return False
        theta += way * nearest
        number = change(path, m, changed, number, theta)
    return False
