"""Intervals that are cut short give no energy.

Forces of an interval are right for the whole of it: a soft landing pushes before the shapes touch. Cut after s, the
impulses have lost D = W - dE, with the work W of bodies without mobility and moving surfaces. If that is negative, all
of them are scaled by one q, which conserves momenta: with w = (a - a_free) s for each body, and velocities v at the
start,

    dE(q) = q B + q^2 C,   B = sum m (v + a_free s / 2) . w,   C = sum m w^2 / 2,   W(q) = q W,

so that D(q) = 0 for q = (W - B) / C, or 0 if that is negative.
"""

from __future__ import annotations

from ..compiled import nonallocating
from ..contacts.single import move_to
from ..model.parameters.intervals import REPAY_ROUND_OFF
from ..model.scene import Scene


@nonallocating
def scale_forces(A: Scene, root: int, q: float) -> None:
    """Scale the contact forces of an island's interval by q, whose bodies are at its start, and set their losses to
    0."""
    BODY, PULL = A.BODY, A.PULL
    i = root
    while i >= 0:
        BODY[i].ax = PULL[i, 0] + q * (BODY[i].ax - PULL[i, 0])
        BODY[i].ay = PULL[i, 1] + q * (BODY[i].ay - PULL[i, 1])
        BODY[i].angular = PULL[i, 2] + q * (BODY[i].angular - PULL[i, 2])
        i = A.MEMBER[i].following
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root == root:
            R = A.PUSHED[c]
            R.normal, R.tangential, R.work, R.change = q * R.normal, q * R.tangential, q * R.work, q * R.change
            R.un_before, R.un_after, R.ut_before, R.ut_after = 0.0, 0.0, 0.0, 0.0


@nonallocating
def repay(A: Scene, root: int, t: float) -> None:
    """Before the interval of an island ends at instant t: scale its impulses, if they have given energy, as above."""
    BODY, PULL = A.BODY, A.PULL
    lost, work, size, start = 0.0, 0.0, 0.0, -1.0
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root != root:
            continue
        R = A.PUSHED[c]
        start = R.start
        f = (t - R.start) / R.length
        normal = -f * R.normal * (R.un_before + 0.5 * f * (R.un_after - R.un_before))
        tangential = -f * R.tangential * (R.ut_before + 0.5 * f * (R.ut_after - R.ut_before))
        lost += normal + tangential
        work += f * R.work
        size += abs(normal) + abs(tangential)
    if lost >= -REPAY_ROUND_OFF * size or start < 0.0:
        return
    s, B, C = t - start, 0.0, 0.0
    i = root
    while i >= 0:
        # Where gaps were looked at within the interval, the body is ahead on its path.
        move_to(BODY, i, start)
        body = BODY[i]
        wx, wy, turn = (body.ax - PULL[i, 0]) * s, (body.ay - PULL[i, 1]) * s, (body.angular - PULL[i, 2]) * s
        B += ((body.vx + 0.5 * PULL[i, 0] * s) * wx + (body.vy + 0.5 * PULL[i, 1] * s) * wy) / body.inv_mass
        C += 0.5 * (wx * wx + wy * wy) / body.inv_mass
        if body.inv_inertia > 0.0:
            B += (body.spin + 0.5 * PULL[i, 2] * s) * turn / body.inv_inertia
            C += 0.5 * turn * turn / body.inv_inertia
        i = A.MEMBER[i].following
    if C > 0.0:
        scale_forces(A, root, min(max((work - B) / C, 0.0), 1.0))
