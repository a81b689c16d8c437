"""Whether static forces hold an island that is slow: impulses of its contacts, in balance, that end all its motion.

The midpoint rule returns a resting contact that opens with u at -u, so that its place is kept and no energy is made;
small motions of a pile therefore never end, nor do those from truncated solves. A rigid pile would lose them in bounces
within the step. It comes to rest if impulses inside the friction cones leave no velocity, after N steps at most, and
others hold it from then on,

    v / N + h a + M^-1 (G^T lam + T^T beta) = 0   and   h a + M^-1 (G^T lam + T^T beta) = 0.

Bodies below r |a| h are tested, with r = REST_CANDIDATE, in large islands REST_CANDIDATE_LARGE. N of a body is at most
r |a| h / |v|, so that it stops no farther than r |a| h^2 / 2 from where it would be, and at most STOPPING_STEPS. Faster
bodies, up to IMPACT_SPEED |a| h below which contacts persist, may only be frozen (without `hold`): the first
equilibrium ends their motion, and the next solve shows whether they stay.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..geometry.flight import point_speed
from ..model.contacts import Problem
from ..model.parameters.rest import (
    REST_CANDIDATE_LARGE,
    REST_SPEED,
    STATICS_FACTORS,
    STATICS_FACTORS_NEAREST,
    STOPPING_STEPS,
)
from ..rows.equilibrium import equilibrium
from ..rows.inplace import copy


@nonallocating
def set_motionless(problem: Problem, V: FloatArray, FREE: FloatArray, close: float) -> bool:
    """Set targets and velocities of the rows to 0, those without motion. Returns False if a surface or one of the fixed
    bodies, from n on, moves, with velocities V at the start and FREE at the end; some rows may be changed then. close:
    length/time; a contact whose gap would have to close faster keeps its target, which is below 0, and so exerts no
    static force."""
    ROWS, _, _, _, n, m = problem
    for i in range(n, len(V)):
        for c in range(3):
            if V[i, c] != 0.0 or FREE[i, c] != 0.0:
                return False
    for i in range(m):
        if ROWS[i].surface != 0.0:
            return False
        if ROWS[i].target + max(ROWS[i].un, 0.0) >= -close:
            ROWS[i].target = 0.0
        ROWS[i].un = 0.0
        ROWS[i].ut = 0.0
        ROWS[i].activation = np.inf
    return True


@kernel
def find_static_forces(
    problem: Problem, L: FloatArray, V: FloatArray, FREE: FloatArray, LEVER: FloatArray, VN: FloatArray, change: float,
    rest_speed: float, hold: bool,
) -> tuple[bool, int]:  # fmt: skip
    """Search static forces that end the motion V (k, 3) of the n bodies of a problem, and, if `hold`, hold them then.

    Args:
        problem, L: the m contacts and initial impulses (m, 2); if forces are found, targets and velocities of its rows
            become 0, and L the impulses over h that hold the bodies from then on, without those that stop them; without
            `hold` both.
        V: becomes 0, except for free spins, if forces are found.  FREE: (k, 3) velocities at the end without impulses.
        LEVER: (k,) the lengths by which spins count in speeds, see `..model.islands`.
        VN: (k, 3) out, velocities at the end; if nothing is found, a motion against which no contact acts, of any size.
        change: |a| h, to which speeds are relative.
        rest_speed: largest speed relative to it, up to REST_CANDIDATE_LARGE also that at which gaps of loaded contacts
            may close.

    Returns:
        Whether static forces are found, and the number of factorisations.
    """
    n = problem.n
    VN[:] = 0.0
    if not set_motionless(problem, V, FREE, min(rest_speed, REST_CANDIDATE_LARGE) * change):
        return False, 0
    PULL, START = FREE - V, FREE - V
    for i in range(n):
        speed = point_speed(V[i, 0], V[i, 1], V[i, 2], LEVER[i])
        steps = min(STOPPING_STEPS, rest_speed * change / speed) if speed > 0.0 else 1.0
        for c in range(3 if LEVER[i] > 0.0 else 2):
            START[i, c] += V[i, c] / max(steps, 1.0)
    factors, accuracy = 0, REST_SPEED * change
    for LEFT, most in ((START, STATICS_FACTORS), (PULL, STATICS_FACTORS_NEAREST)):
        found, more = equilibrium(problem, L, LEFT, LEVER, accuracy, most)
        factors += more
        if not found:
            copy(VN, LEFT)
            return False, factors
        if not hold:
            break
    for i in range(n):
        for c in range(3 if LEVER[i] > 0.0 else 2):
            V[i, c] = 0.0
            VN[i, c] = 0.0
    return True, factors
