"""Intervals that are cut short give no energy.

Forces of an interval are right for the whole of it: a soft landing pushes before the shapes touch. Cut after s, the
impulses have lost D = W - dE, with the work W of bodies without mobility and moving surfaces. If that is negative, the
impulses on bodies that they connect, and that have given energy, are scaled by one q, which conserves momenta: with
w = (a - a_free) s for each body, and velocities v at the start,

    dE(q) = q B + q^2 C,   B = sum m (v + a_free s / 2) . w,   C = sum m w^2 / 2,   W(q) = q W,

so that D(q) = 0 for q = (W - B) / C, or 0 if that is negative. What no impulse connects with these bodies keeps its
forces: with less, what rests would sink into its support.
"""

from __future__ import annotations

import numpy as np

from ..arrays import IntArray
from ..compiled import inlined, kernel, nonallocating
from ..compiled.records import Rows, empty
from ..contacts.single import move_to
from ..joints.plan import root as set_of
from ..model.islands import CONNECTED_WORK, ConnectedWork
from ..model.parameters.intervals import REPAY_ROUND_OFF
from ..model.scene import Scene


@inlined
def losses(A: Scene, c: int, t: float) -> tuple[float, float]:
    """Losses (energy) of contact c of an interval by normal impulse and by friction up to instant t. As velocities are
    linear, D_n = -f lam (u_n + f (u_n+ - u_n) / 2) with the part f of the interval that is over, and D_t likewise."""
    R = A.PUSHED[c]
    f = (t - R.start) / R.length
    normal = -f * R.normal * (R.un_before + 0.5 * f * (R.un_after - R.un_before))
    tangential = -f * R.tangential * (R.ut_before + 0.5 * f * (R.ut_after - R.ut_before))
    return normal, tangential


@nonallocating
def gives(A: Scene, root: int, t: float) -> bool:
    """Whether the contacts of an island have given energy up to instant t."""
    lost, size = 0.0, 0.0
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root == root:
            normal, tangential = losses(A, c, t)
            lost += normal + tangential
            size += abs(normal) + abs(tangential)
    return lost < -REPAY_ROUND_OFF * size


@nonallocating
def body_in(A: Scene, root: int, c: int) -> tuple[int, int]:
    """The bodies of an island that contact c connects: one, and the other, or the same one again."""
    i, j = A.LINK[A.PUSHED_BY[c].a].owner, A.LINK[A.PUSHED_BY[c].b].owner
    if A.BODY[i].inv_mass == 0.0 or A.STATE[i].island != root:
        return j, j
    if A.BODY[j].inv_mass == 0.0 or A.STATE[j].island != root:
        return i, i
    return i, j


@nonallocating
def connect(A: Scene, root: int, SET: IntArray, SUMS: Rows[ConnectedWork]) -> None:
    """Make the sets of bodies of an island that impulses connect (`SET`, a forest), with sums of 0."""
    i = root
    while i >= 0:
        SET[i] = i
        one = SUMS[i]
        one.lost = one.size = one.work = one.linear = one.square = 0.0
        i = A.MEMBER[i].following
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root == root and (A.PUSHED[c].normal != 0.0 or A.PUSHED[c].tangential != 0.0):
            i, j = body_in(A, root, c)
            SET[set_of(SET, i)] = set_of(SET, j)


@nonallocating
def share(one: ConnectedWork) -> float:
    """The factor q of the impulses of a connected set that have given energy."""
    return min(max((one.work - one.linear) / one.square, 0.0), 1.0)


@nonallocating
def scale_forces(A: Scene, root: int, SET: IntArray, SUMS: Rows[ConnectedWork]) -> None:
    """Scale the impulses of the sets of an island that have given energy, whose bodies are at the start of its
    interval, and set their losses to 0."""
    BODY, PULL = A.BODY, A.PULL
    i = root
    while i >= 0:
        one = SUMS[set_of(SET, i)]
        if one.square > 0.0:
            q = share(one)
            BODY[i].ax = PULL[i, 0] + q * (BODY[i].ax - PULL[i, 0])
            BODY[i].ay = PULL[i, 1] + q * (BODY[i].ay - PULL[i, 1])
            BODY[i].angular = PULL[i, 2] + q * (BODY[i].angular - PULL[i, 2])
        i = A.MEMBER[i].following
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root != root:
            continue
        one = SUMS[set_of(SET, body_in(A, root, c)[0])]
        if one.square > 0.0:
            R, q = A.PUSHED[c], share(one)
            R.normal, R.tangential, R.work, R.change = q * R.normal, q * R.tangential, q * R.work, q * R.change
            R.un_before, R.un_after, R.ut_before, R.ut_after = 0.0, 0.0, 0.0, 0.0


@kernel
def repay(A: Scene, root: int, t: float) -> None:
    """Before the interval of an island ends at instant t: scale the impulses that have given energy up to t, as in the
    docstring of the module."""
    if not gives(A, root, t):
        return
    BODY, PULL, start = A.BODY, A.PULL, t
    SET, SUMS = np.empty(len(BODY), np.int64), empty(len(BODY), CONNECTED_WORK)
    connect(A, root, SET, SUMS)
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root == root:
            R, one = A.PUSHED[c], SUMS[set_of(SET, body_in(A, root, c)[0])]
            start = R.start
            normal, tangential = losses(A, c, t)
            one.lost += normal + tangential
            one.size += abs(normal) + abs(tangential)
            one.work += (t - R.start) / R.length * R.work
    s, i = t - start, root
    while i >= 0:
        one = SUMS[set_of(SET, i)]
        if one.lost < -REPAY_ROUND_OFF * one.size:
            # Tests whether contacts persist may have moved the body along its path, to an instant within the interval.
            move_to(BODY, i, start)
            body = BODY[i]
            wx, wy, turn = (body.ax - PULL[i, 0]) * s, (body.ay - PULL[i, 1]) * s, (body.angular - PULL[i, 2]) * s
            along = (body.vx + 0.5 * PULL[i, 0] * s) * wx + (body.vy + 0.5 * PULL[i, 1] * s) * wy
            one.linear += along / body.inv_mass
            one.square += 0.5 * (wx * wx + wy * wy) / body.inv_mass
            if body.inv_inertia > 0.0:
                one.linear += (body.spin + 0.5 * PULL[i, 2] * s) * turn / body.inv_inertia
                one.square += 0.5 * turn * turn / body.inv_inertia
        i = A.MEMBER[i].following
    scale_forces(A, root, SET, SUMS)
