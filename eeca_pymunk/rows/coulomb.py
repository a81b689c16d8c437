"""The law of one contact with Coulomb friction, in closed form.

    0 <= lam  _|_  u_n - b >= 0,   |beta| <= mu lam,   u_t = 0 or beta = -mu lam sign(u_t),

with its 2 x 2 matrix ((A_nn, A_nt), (A_nt, A_tt)). Tried in turn are sticking, slipping one way, and the other; if
none obeys the law, the contact has no friction. (Nor have several contacts that have no solution together:
`drop_friction`.) Newton's law of restitution with friction creates energy where the slip reverses; therefore each
contact's loss D_n + D_t = -lam (u_n- + b)/2 - beta (u_t- + u_t+)/2 is kept non-negative, by less friction where it
would be negative: *friction limited by energy*.

| function | of a contact whose | gives | for |
|---|---|---|---|
| `coulomb` | velocities without its impulse are known | the impulse; it states all of the law | `lawful` |
| `lawful` | impulse has a value now | the impulse: that of sticking, as of most, else `coulomb` | sweeps |
| `mode_of` | impulse has a value now | the equations that hold for it | direct solutions, homotopies, residuals |
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..model.contacts import Row
from ..model.parameters.impulses import JAMMED, SINGULAR
from .build import normal_rate, tangent_rate

OPEN, STICK, SLIP = 1, 2, 3  # modes of a contact


@nonallocating
def drop_friction(ROWS: Rows[Row], m: int) -> None:
    """Let m contacts have no friction: wedged between surfaces that move, or conveyed into a corner, they would need
    impulses without bound. What is left of the law, 0 <= lam _|_ u_n - b >= 0, has a solution if any velocities
    satisfy it."""
    for i in range(m):
        ROWS[i].friction = 0.0


@nonallocating
def coulomb(
    qn: float, qt: float, ann: float, ant: float, att: float, mu: float, un: float, ut: float, target: float
) -> tuple[float, float]:
    """(lam, beta) of one contact whose velocities without its impulse are u_n = target + qn, qn < 0, and u_t = qt.

    Args:
        ann, ant, att: its matrix.  mu: friction.
        un, ut: its velocities before the interval or impact, from which the loss counts.
    """
    det = ann * att - ant * ant
    lam, beta = 0.0, 0.0
    done = False
    if det > SINGULAR * ann * att:
        lam = (qt * ant - qn * att) / det
        beta = (qn * ant - qt * ann) / det
        done = lam >= 0.0 and abs(beta) <= mu * lam
    if not done:
        # Slipping against the motion there would be without friction, then the other way (Painleve: neither).
        sign = -1.0 if qt - qn * ant / ann > 0.0 else 1.0
        for _ in range(2):
            den = ann + sign * mu * ant
            if den > JAMMED * ann:
                lam = -qn / den
                beta = sign * mu * lam
                if sign * (qt + ant * lam + att * beta) <= 0.0:
                    done = True
                    break
            sign = -sign
        if not done:
            return -qn / ann, 0.0
    if beta * ut > 0.0:
        # With lam = -(qn + ant beta) / ann the loss is a quadratic in T = |beta|: s T^2 + p T + c <= 0, c <= 0.
        sign = 1.0 if beta > 0.0 else -1.0
        loss = min(un + target, 0.0) / ann
        s = max(det, 0.0) / ann
        p = sign * (ut + qt - ant * qn / ann - ant * loss)
        c = -qn * loss
        T = abs(beta)
        if T * (s * T + p) + c > 0.0:
            root = math.sqrt(max(p * p - 4.0 * s * c, 0.0))
            most = -2.0 * c / (p + root) if p > 0.0 else (root - p) / (2.0 * s)
            beta = sign * min(T, max(most, 0.0))
            lam = max(-(qn + ant * beta) / ann, 0.0)  # linear in T between two values >= 0, as mu lam - T is
    return lam, beta


@inlined
def lossless_slip(row: Row, lam: float, beta: float) -> float:
    """Tangential velocity u_t+ with which a contact with these impulses loses no energy: beta (u_t- + u_t+) =
    -lam (u_n- + b)."""
    return float(-row.ut - lam * min(row.un + row.target, 0.0) / beta)


@nonallocating
def mode_of(row: Row, V: FloatArray, lam: float, beta: float, near: float) -> tuple[int, float]:
    """The mode of a contact with these impulses at velocities V (k, 3), and the sign of its friction in SLIP, which is
    0 without friction.

    | mode | where | law |
    |---|---|---|
    | OPEN | lam = 0 | u_n >= target |
    | SLIP | abs(beta) >= (1 - near) mu lam | beta = sign mu lam, sign u_t <= 0 |
    | SLIP, sign 0 | beta = 0, no loss along n, slip reversed: friction against it would give energy | none |
    | STICK | else | u_t = `limited_slip` |
    """
    if not lam > 0.0:
        return OPEN, 0.0
    most = row.friction * lam
    if not abs(beta) < most * (1.0 - near):
        return SLIP, 0.0 if beta == 0.0 or most <= 0.0 else 1.0 if beta > 0.0 else -1.0
    lossless = beta == 0.0 and lam * min(row.un + row.target, 0.0) == 0.0
    return SLIP if lossless and tangent_rate(row, V) * row.ut < 0.0 else STICK, 0.0


@inlined
def limits_slip(row: Row, lam: float, beta: float) -> bool:
    """Whether a contact with these impulses would give energy if it stuck."""
    return bool(beta * row.ut > -lam * min(row.un + row.target, 0.0))


@nonallocating
def limited_slip(row: Row, lam: float, beta: float) -> float:
    """`lossless_slip` where a contact with these impulses would give energy if it stuck; else 0: it may stick."""
    return lossless_slip(row, lam, beta) if limits_slip(row, lam, beta) else 0.0


@nonallocating
def activate(ROWS: Rows[Row], m: int, i: int, V: FloatArray, L: FloatArray) -> None:
    """Let the inactive contact i (`Row.activation`) become active if it closes faster than its activation velocity
    without its own impulse; and with it those after it, up to m, of the same two bodies that do, as both corners of a
    face: if it acted first, they would part."""
    j = i
    while j < m and ROWS[j].a == ROWS[i].a and ROWS[j].b == ROWS[i].b:
        row = ROWS[j]
        if normal_rate(row, V) - L[j, 0] * row.a_nn - L[j, 1] * row.a_nt < row.activation:
            row.activation = np.inf
        elif j == i:
            return
        j += 1


@inlined
def lawful(row: Row, V: FloatArray, lam0: float, beta0: float, stays: bool) -> tuple[float, float, bool]:
    """The impulses (lam, beta) of a contact by its law, and whether it slips. All other impulses are given: V (k, 3)
    are the velocities with these, and with its own (lam0, beta0). An inactive contact (`activate`) has none.

    Where friction alone could separate the surfaces, a_nn < mu |a_nt|, a contact may stick although it would open
    without its impulses. If `stays`, a contact that sticks then remains closed, with u_t = `limited_slip`, as long as
    its friction is inside the cone.
    """
    ann, ant, att, mu = row.a_nn, row.a_nt, row.a_tt, row.friction
    short = normal_rate(row, V) - row.target if row.activation == np.inf else np.inf
    if short >= 0.0 and lam0 == 0.0 and beta0 == 0.0:
        return 0.0, 0.0, False
    if mu <= 0.0:
        return max(lam0 - row.k_n * short, 0.0), 0.0, False
    qn = short - lam0 * ann - beta0 * ant
    if not (qn < 0.0 or (stays and lam0 > 0.0)):
        return 0.0, 0.0, False
    ut = tangent_rate(row, V)
    # Most contacts stick.
    lam = lam0 - (row.w_nn * short + row.w_nt * ut)
    beta = beta0 - (row.w_nt * short + row.w_tt * ut)
    sticks = abs(beta) <= mu * lam
    if sticks and (beta * row.ut <= 0.0 if stays else not limits_slip(row, lam, beta)):
        return lam, beta, False
    if not qn < 0.0:
        off = ut - limited_slip(row, lam0, beta0)
        lam = lam0 - (row.w_nn * short + row.w_nt * off)
        beta = beta0 - (row.w_nt * short + row.w_tt * off)
        closed = beta * row.ut > 0.0 and abs(beta) <= mu * lam
        return (lam, beta, False) if closed else (0.0, 0.0, False)
    qt = ut - beta0 * att - lam0 * ant
    lam, beta = coulomb(qn, qt, ann, ant, att, mu, row.un, row.ut, row.target)
    return lam, beta, True
