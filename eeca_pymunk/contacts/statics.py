"""Whether an island that hardly moves comes to a stand: an equilibrium of its contacts that takes all its motion.

At midstep, what rests with a speed of u is sent back with -u, so that its place is kept and no energy made: tiny
motions of a pile go on for ever, and so do those that come from solves cut short. The rigid pile rather loses them in
bounces that are over within the step. It stands iff impulses inside their cones leave no velocity at all, after N steps
at most, and hold it from then on,

    v / N + h a + M^-1 (G^T lam + T^T beta) = 0   and   h a + M^-1 (G^T lam + T^T beta) = 0,

from the velocities v that it has: what slides without friction, rolls, or topples does not. Only what is slower than
REST_CANDIDATE |a| h is tested, and N of a body grows with its speed, so that it stops no more than
REST_CANDIDATE |a| h^2 / 2 from where it would. What is faster, up to the IMPACT_SPEED |a| h below which
contacts persist, may only freeze: the first of the two equilibria ends its motion, and the next solve shows whether it
holds.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, uncounted
from ..compiled.records import Rows
from ..model.contacts import Problem, Row
from ..model.parameters.rest import (
    REST_CANDIDATE_LARGE,
    REST_SPEED,
    STATICS_FACTORS,
    STATICS_FACTORS_NEAREST,
    STOPPING_STEPS,
)
from ..rows.equilibrium import equilibrium, point_speed
from ..rows.inplace import copy


@uncounted
def at_rest(ROWS: Rows[Row], V: FloatArray, n: int, m: int, close: float) -> bool:
    """Set the rows' targets as if nothing moved; whether no surface and no body but the n first moves."""
    for i in range(n, len(V)):
        if V[i, 0] != 0.0 or V[i, 1] != 0.0 or V[i, 2] != 0.0:
            return False
    for i in range(m):
        if ROWS[i].surface != 0.0:
            return False
        if ROWS[i].target + max(ROWS[i].un, 0.0) >= -close:
            ROWS[i].target = 0.0
        ROWS[i].un = 0.0
        ROWS[i].ut = 0.0
        ROWS[i].wake = np.inf
    return True


@kernel
def comes_to_stand(
    problem: Problem, L: FloatArray, V: FloatArray, FREE: FloatArray, FELT: FloatArray, VN: FloatArray, change: float,
    calm: float,
) -> tuple[bool, int]:  # fmt: skip
    """Look for an equilibrium that ends the motion V (k, 3) of the n bodies, which are FREE without impulses.

    Args:
        ROWS, L: the m contacts and first guesses; out, if the island stands, with targets and velocities of 0 and the
            impulses that hold it from then on, without those that stop it.
        FELT: (k,) how far bodies extend, 0 of those whose turning no contact feels.
        V: 0 out, if it stands, but for spins that nothing feels.  VN: (k, 3) out, velocities at the end; if it does not
            stand, a motion that nothing holds, of any size.
        change: |a| h, to which speeds are compared.  calm: that of the bodies at most; so may gaps of contacts that
            bear change in h, up to REST_CANDIDATE_LARGE. Above that they are only calmed.
    Returns:
        Whether the island stands, and factors it took.
    """
    n = problem.n
    VN[:] = 0.0
    if not at_rest(problem.ROWS, V, n, problem.m, min(calm, REST_CANDIDATE_LARGE) * change):
        return False, 0
    PULL, START = FREE - V, FREE - V
    for i in range(n):
        speed = point_speed(V[i, 0], V[i, 1], V[i, 2], FELT[i])
        steps = min(STOPPING_STEPS, calm * change / speed) if speed > 0.0 else 1.0
        for c in range(3 if FELT[i] > 0.0 else 2):
            START[i, c] += V[i, c] / max(steps, 1.0)
    factors, accuracy = 0, REST_SPEED * change
    for nearest in (False, True):
        if nearest and calm > REST_CANDIDATE_LARGE:
            break
        LEFT = PULL if nearest else START
        found, more = equilibrium(
            problem, L, LEFT, FELT, accuracy, STATICS_FACTORS_NEAREST if nearest else STATICS_FACTORS, nearest
        )
        factors += more
        if not found:
            copy(VN, LEFT)
            return False, factors
    for i in range(n):
        for c in range(3 if FELT[i] > 0.0 else 2):
            V[i, c] = 0.0
            VN[i, c] = 0.0
    return True, factors
