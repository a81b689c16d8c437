"""Intervals that are cut short give no energy.

Forces of an interval are right for the whole of it: a soft landing pushes before the shapes touch. Cut after s, an
impulse J with the mean relative velocity u has lost D = -J.u, and has given energy if that is negative. Then each
impulse of the island is scaled by a factor f of its own, from 0 to 1, such that they minimise

    sum f J.u_free + (1/4) (f J).A (f J),    u(f) = u_free + (1/2) A f J,

with the velocities u_free without impulses and the response A of the bodies. The derivative by f is J.u(f): at the
minimum no impulse gives energy, and none that is smaller than it was would lose any. What bears a load keeps as much of
its force as the load has kept; momenta are conserved. The minimum is approached by sweeps over the contacts, from f = 0
for those that have given energy, and f = 1 for the others. If they still give E = sum f J.u(f) > 0, one more factor q =
1 - E / C removes that, common to all: with the changes of velocity w that they cause, C = sum m w^2 / 2, q times these
impulses give q (E - C) + q^2 C.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import inlined, kernel, nonallocating
from ..compiled.records import Rows, empty
from ..contacts.single import move_to
from ..model.islands import PART, Part
from ..model.parameters.intervals import REPAY_ROUND_OFF, REPAY_STEP, REPAY_SWEEPS
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


@kernel
def parts_of(A: Scene, root: int, t: float) -> Rows[Part]:
    """The impulses of an island's contacts up to instant t, all of them left but those that have given energy."""
    m = 0
    for c in range(A.COUNT.pushes):
        m += A.PUSHED_BY[c].root == root
    found, m = empty(m, PART), 0
    for c in range(A.COUNT.pushes):
        if A.PUSHED_BY[c].root != root:
            continue
        R, one = A.PUSHED[c], found[m]
        over = (t - R.start) / R.length
        one.contact, one.a, one.b = c, A.LINK[A.PUSHED_BY[c].a].owner, A.LINK[A.PUSHED_BY[c].b].owner
        n, tangent = over * R.normal, over * R.tangential
        one.x, one.y = n * R.nx - tangent * R.ny, n * R.ny + tangent * R.nx
        one.turn_a, one.turn_b = n * R.arm_na + tangent * R.arm_ta, n * R.arm_nb + tangent * R.arm_tb
        a, b = A.BODY[one.a], A.BODY[one.b]
        one.mass_a = one.inertia_a = one.mass_b = one.inertia_b = 0.0
        if A.STATE[one.a].island == root:
            one.mass_a, one.inertia_a = a.inv_mass, a.inv_inertia
        if A.STATE[one.b].island == root:
            one.mass_b, one.inertia_b = b.inv_mass, b.inv_inertia
        normal, tangential = losses(A, c, t)
        one.slope = -normal - tangential
        one.left = 1.0 if one.slope <= REPAY_ROUND_OFF * (abs(normal) + abs(tangential)) else 0.0
        one.curvature = (one.mass_a + one.mass_b) * (one.x * one.x + one.y * one.y)
        one.curvature += one.inertia_a * one.turn_a * one.turn_a + one.inertia_b * one.turn_b * one.turn_b
        one.curvature *= 0.5
        m += 1
    return found


@inlined
def work(one: Part, W: FloatArray) -> float:
    """J.u of a contact at velocities W (n, 3) of the bodies."""
    a, b = one.a, one.b
    along = one.x * (W[b, 0] - W[a, 0]) + one.y * (W[b, 1] - W[a, 1])
    turning: float = one.turn_b * W[b, 2] - one.turn_a * W[a, 2]
    return along + turning


@inlined
def power(one: Part, W: FloatArray) -> float:
    """J.u of a contact up to the cut (energy), after changes W (n, 3) of the velocities at the cut."""
    return one.slope + 0.5 * work(one, W)


@inlined
def push(one: Part, part: float, W: FloatArray) -> None:
    """Add to W (n, 3) the changes of velocity by a part of the impulse of a contact."""
    a, b = one.a, one.b
    W[a, 0] -= one.mass_a * part * one.x
    W[a, 1] -= one.mass_a * part * one.y
    W[a, 2] -= one.inertia_a * part * one.turn_a
    W[b, 0] += one.mass_b * part * one.x
    W[b, 1] += one.mass_b * part * one.y
    W[b, 2] += one.inertia_b * part * one.turn_b


@nonallocating
def reduce_parts(PARTS: Rows[Part], W: FloatArray) -> None:
    """Change the parts that are left as in the docstring of the module. W (n, 3): the changes of velocity at the cut by
    what is taken away."""
    for z in range(len(PARTS)):
        push(PARTS[z], PARTS[z].left - 1.0, W)
    for _ in range(REPAY_SWEEPS):
        worst = 0.0
        for z in range(len(PARTS)):
            one = PARTS[z]
            if one.curvature > 0.0:
                left = min(max(one.left - power(one, W) / one.curvature, 0.0), 1.0)
                worst = max(worst, abs(left - one.left))
                push(one, left - one.left, W)
                one.left = left
        if worst < REPAY_STEP:
            return


@nonallocating
def common_factor(PARTS: Rows[Part], W: FloatArray, U: FloatArray) -> float:
    """The factor q of all that is left of impulses, as in the docstring of the module; W (n, 3) as in `reduce_parts`, U
    (n, 3) zeros."""
    gain, size, square = 0.0, 0.0, 0.0
    for z in range(len(PARTS)):
        one = PARTS[z]
        gain += one.left * power(one, W)
        size += one.left * abs(one.slope)
        push(one, one.left, U)
    for z in range(len(PARTS)):
        square += 0.5 * PARTS[z].left * work(PARTS[z], U)
    if gain <= REPAY_ROUND_OFF * size or square <= 0.0:
        return 1.0
    return max(1.0 - gain / square, 0.0)


@kernel
def repay(A: Scene, root: int, t: float) -> None:
    """Before the interval of an island ends at instant t: if its contacts have given energy up to t, scale their
    impulses as in the docstring of the module."""
    if not gives(A, root, t):
        return
    BODY, PARTS = A.BODY, parts_of(A, root, t)
    start, length = A.PUSHED[PARTS[0].contact].start, A.PUSHED[PARTS[0].contact].length
    W, U = np.zeros((len(BODY), 3)), np.zeros((len(BODY), 3))
    reduce_parts(PARTS, W)
    q = common_factor(PARTS, W, U)
    W[:] = 0.0
    for z in range(len(PARTS)):
        PARTS[z].left *= q
        push(PARTS[z], PARTS[z].left - 1.0, W)
    more = length / (t - start)  # the change of velocity at the end of the interval, to that at the cut
    for z in range(len(PARTS)):
        one, R = PARTS[z], A.PUSHED[PARTS[z].contact]
        R.normal, R.tangential, R.work, R.change = (
            one.left * R.normal, one.left * R.tangential, one.left * R.work, one.left * R.change,
        )  # fmt: skip
        x, y = W[one.b, 0] - W[one.a, 0], W[one.b, 1] - W[one.a, 1]
        R.un_after += more * (R.nx * x + R.ny * y + R.arm_nb * W[one.b, 2] - R.arm_na * W[one.a, 2])
        R.ut_after += more * (R.nx * y - R.ny * x + R.arm_tb * W[one.b, 2] - R.arm_ta * W[one.a, 2])
    i = root
    while i >= 0:
        # Tests whether contacts persist may have moved the body along its path, to an instant within the interval.
        move_to(BODY, i, start)
        BODY[i].ax += W[i, 0] / (t - start)
        BODY[i].ay += W[i, 1] / (t - start)
        BODY[i].angular += W[i, 2] / (t - start)
        i = A.MEMBER[i].following
