"""Whether an island that hardly moves comes to a stand: an equilibrium of its contacts that takes all its motion.

At midstep, what rests with a speed of u is sent back with -u, so that its place is kept and no energy made: tiny
motions of a pile go on for ever, and no impulses meet all their targets. The rigid pile rather loses them in bounces
that are over within the step. It stands iff impulses inside their cones leave no velocity at all,

    v + h a + M^-1 (G^T lam + T^T beta) = 0,   lam >= 0,   |beta| <= mu lam,

from the velocities v that it has: what slides without friction, rolls, or topples does not. Only what is slower than
CALM |a| h is asked, so that nothing stops more than CALM |a| h^2 / 2 from where it would.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, uncounted
from ..rows.layout import SURFACE, TARGET, UN, UT, WAKE
from ..rows.sweeps import velocities
from .relax import FRESH, relax

STANDS = 1e-9  # speed relative to |a| h, below which a body stands
CALM = 1e-3  # and below which it may come to a stand
_CLOSED = 1e-3  # velocity relative to |a| h, by which the gap of a contact that bears may change in a step
_ROUNDS = 8  # direct solutions at most


@uncounted
def at_rest(ROWS: FloatArray, V: FloatArray, n: int, m: int, close: float) -> bool:
    """Set the rows' targets as if nothing moved; whether no surface and no body but the n first moves."""
    for i in range(n, len(V)):
        if V[i, 0] != 0.0 or V[i, 1] != 0.0 or V[i, 2] != 0.0:
            return False
    for i in range(m):
        if ROWS[i, SURFACE] != 0.0:
            return False
        if ROWS[i, TARGET] + max(ROWS[i, UN], 0.0) >= -close:
            ROWS[i, TARGET] = 0.0
        ROWS[i, UN] = 0.0
        ROWS[i, UT] = 0.0
        ROWS[i, WAKE] = np.inf
    return True


@uncounted
def bound(vx: float, vy: float, spin: float, extent: float) -> float:
    """A bound on the speed of the points of a body, no farther than extent from its centre of mass."""
    return abs(vx) + abs(vy) + extent * abs(spin)


@uncounted
def fastest(V: FloatArray, EXTENT: FloatArray, n: int) -> float:
    """A bound on the speed of all points of the n bodies."""
    found = 0.0
    for i in range(n):
        found = max(found, bound(V[i, 0], V[i, 1], V[i, 2], EXTENT[i]))
    return found


@kernel
def comes_to_stand(
    A: IntArray, B: IntArray, ROWS: FloatArray, L: FloatArray, V: FloatArray, FREE: FloatArray, IM: FloatArray,
    II: FloatArray, POSE: FloatArray, EXTENT: FloatArray, VN: FloatArray, n: int, m: int, change: float,
) -> tuple[bool, int, int]:  # fmt: skip
    """Look for an equilibrium that ends the motion V (k, 3) of the n bodies, which are FREE without impulses.

    Args:
        ROWS, L: the m contacts and first guesses; out, if the island stands, with targets and velocities of 0 and the
            impulses that hold it from then on, without those that stop it.
        V: 0 out, if it stands.  VN: (k, 3) out, velocities at the end.
        change: |a| h, to which speeds are compared.
    Returns:
        Whether the island stands, sweeps, direct solutions.
    """
    if not at_rest(ROWS, V, n, m, _CLOSED * change):
        return False, 0, 0
    PULL = FREE - V
    sweeps, rounds = 0, 0
    for attempt in range(2):
        START = FREE if attempt == 0 else PULL
        STATE = np.array(FRESH)
        velocities(A, B, ROWS, L, START, IM, II, m, VN)
        some, more, _ = relax(
            A, B, ROWS, L, VN, START, IM, II, POSE, n, m, _ROUNDS, 1e-3 * STANDS * change, 0.0, STATE, 0
        )  # fmt: skip
        sweeps += some
        rounds += more
        velocities(A, B, ROWS, L, START, IM, II, m, VN)
        if fastest(VN, EXTENT, n) > STANDS * change:
            return False, sweeps, rounds
    for i in range(n):
        for c in range(3):
            V[i, c] = 0.0
            VN[i, c] = 0.0
    return True, sweeps, rounds
