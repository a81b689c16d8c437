"""Response of a component of joints to impulses on its bodies: the change of velocities per impulse.

About a solved step, d v1 = S p for impulses p spread over the step, S the bodies' block of the inverse of Newton's
matrix, with springs and bounded joints. Rows turn with the bodies, and so does the force of joints (STIFF): without it
taut joints would allow motion across. It is left out for joints that press hard, with which S would not be positive. At
one instant (an impact), S = M^-1 - M^-1 G^T (G M^-1 G^T)^-1 G M^-1: exact joints let no velocity through, and all
others exert no impulse.
"""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..model.joint_steps import STEP, STIFF_ALL, STIFF_NONE
from ..model.joints import CONDENSED, DUAL, GEAR, GROOVE, INDEPENDENT, Workspace
from ..model.parameters.joints import CONDENSED_PASSES, REDUNDANT_EPSILON, RESPONSE_PASSES, TAUT
from .dual import are_independent
from .entries import acts
from .motion import go_back, move
from .rows import joint_rows, start_joint
from .systems import assemble, back, decompose, first_iterate, first_system


@nonallocating
def inertia_taken(W: Workspace, k: int, c: int, full: bool, h: float) -> float:
    """A bound of the part of a body's inertia that STIFF of joint k takes: (h/2) times the sum of the magnitudes in its
    row c (0 to 5: body c // 3, direction c % 3), scaled by the roots of mobilities; of STIFF_TURNS (not `full`), the
    diagonal alone."""
    link, local = W.link[k], W.J.LOCAL
    root = local[link.body[c // 3]].root[c % 3]
    total = 0.0
    for d in range(6):
        if d == c or full:
            total += abs(W.J.STIFF[c, d]) * local[link.body[d // 3]].root[d % 3]
    return float(0.5 * abs(h) * total * root)


@nonallocating
def turns_over(W: Workspace, k: int) -> bool:
    """Whether the force F of joint k, between points of two bodies, makes the rotation of one of them about its point
    unstable: r . F < 0, with the arm r of the point at the end; F pushes the point towards the centre of mass."""
    hinge = W.J.HINGE[k]
    for end in range(2):
        body, arm = W.J.LOCAL[W.link[k].body[end]], hinge.arm_a if end == 0 else hinge.arm_b
        x, y = body.turn_cos * arm[0] - body.turn_sin * arm[1], body.turn_sin * arm[0] + body.turn_cos * arm[1]
        if body.mobility[2] > 0.0 and x * hinge.force[3 * end] + y * hinge.force[3 * end + 1] < 0.0:
            return True
    return False


@nonallocating
def bend_rows(W: Workspace, k: int, h: float) -> None:
    """Give joint k the impulse of the whole step in `lam`, so that its rows turn with their force. A joint *pulls* if
    its STIFF adds to the inertia of its bodies, and *presses* if it takes from it: lam is 0 if the joint presses, and
    it and the joints before it that press would take more than TAUT of the `inertia` of one of its bodies.

    The part that a full STIFF takes is bounded by the sums of its rows (Gershgorin), so that the remaining inertia of
    all bodies is positive. A groove's force turns with body a: its STIFF has both signs, whatever its diagonal. So has
    that of a pin or slide that pulls, if it `turns_over` a body. Bounded impulses that are given bend as others do.
    """
    hinge, local = W.J.HINGE, W.J.LOCAL
    hinge[k].lam[0], hinge[k].lam[1] = hinge[k].total[0], hinge[k].total[1]
    filled = joint_rows(W, k, h, True)
    full = filled == STIFF_ALL
    pulls, slight = W.link[k].kind != GROOVE and not (full and W.link[k].kind < GEAR and turns_over(W, k)), True
    for c in range(6 if filled != STIFF_NONE else 0):
        if full or c % 3 == 2:
            at = W.link[k].body[c // 3]
            pulls = pulls and W.J.STIFF[c, c] * local[at].mobility[c % 3] <= 0.0
            slight = slight and local[at].inertia[c % 3] - inertia_taken(W, k, c, full, h) >= 1.0 - TAUT
    if filled == STIFF_NONE or not (pulls or slight):
        hinge[k].lam[0] = hinge[k].lam[1] = 0.0
        return
    for c in range(0 if pulls else 6):
        if full or c % 3 == 2:
            local[W.link[k].body[c // 3]].inertia[c % 3] -= inertia_taken(W, k, c, full, h)


@nonallocating
def prepare_response(W: Workspace, what: int, h: float) -> bool:
    """Compute what `respond` needs: factors in MATRIX and PIVOTS, and in TALLY how answers are computed with them.
    Returns False if there are none.

    `what` is STEP, after `take_step` (whose start becomes that of `local` again), or SPEEDS, at the present poses.
    """
    link, local, component, tally = W.link, W.J.LOCAL, W.J.COMPONENT[W.s], W.J.TALLY
    if what == STEP:
        for i in range(W.bodies):
            for c in range(3):
                local[i].v1[c] = local[i].v0[c]
        go_back(W)
        for k in range(W.joints):
            start_joint(W, k, what, h)
        move(local, W.bodies, h)
        for i in range(W.bodies):
            for c in range(3):
                local[i].inertia[c] = 1.0
        for k in range(W.joints):
            if link[k].rows > 0 and acts(link, k, 0):
                bend_rows(W, k, h)
    else:
        first_iterate(W, what, h)
    system = first_system(component, what)
    give = W.J.JOINT[link[0].joint].compliance / h**2 if what == STEP else 0.0
    cyclic, sure = component.cycles > 0 and give == 0.0, component.dependence == INDEPENDENT
    # Of a step an answer is a derivative, for iterations; at an instant it is a change of velocities.
    tally.passes = 1 if give > 0.0 or (sure and what == STEP) else CONDENSED_PASSES
    epsilon = 0.0 if not cyclic or (sure and (what == STEP or system == DUAL)) else REDUNDANT_EPSILON
    while True:
        for i in range(component.unknowns + component.impulses):
            W.J.RIGHT[i] = 0.0
        assemble(W, what, h, give, True, system, True)
        if decompose(W, what, system, epsilon, give):
            # Poses at an instant are others than those at which rows were found to be independent.
            if what == STEP or not cyclic or epsilon > 0.0 or are_independent(W):
                tally.answers = system
                # Newton's matrix, but for bounded rows that are given, and joints that press hard.
                W.J.PROGRESS.factors_of = W.s + 1 if what == STEP and component.bounded_rows == 0 else 0
                tally.refined = RESPONSE_PASSES if cyclic and epsilon > 0.0 and system != CONDENSED else 0
                return True
        if epsilon == 0.0:
            epsilon = REDUNDANT_EPSILON
        elif system != DUAL:
            return False
        else:
            system = component.system


@nonallocating
def respond(W: Workspace, push: FloatArray) -> None:
    """Replace impulses on the bodies by the changes of velocity that they cause, with the factors of
    `prepare_response`.

    push: (bodies, 3) impulses (mass length/time, mass length²/time) in, velocities (length/time, 1/time) out.
    """
    local, component, right, tally = W.J.LOCAL, W.J.COMPONENT[W.s], W.J.RIGHT, W.J.TALLY
    size = component.unknowns + component.impulses
    for i in range(size):
        right[i] = 0.0
    for i in range(W.bodies):
        for c in range(local[i].freedoms):
            right[local[i].column + c] = push[i, c] * local[i].root[c]
    back(W, tally.answers, tally.passes, right)
    # (A + epsilon) x = b leaves b - A x = epsilon x in the rows, and each correction d leaves epsilon d.
    rest = right[size : 2 * size]
    for i in range(size if tally.refined > 0 else 0):
        rest[i] = right[i]
    for _ in range(tally.refined):
        for i in range(W.bodies):
            for c in range(local[i].freedoms):
                rest[local[i].column + c] = 0.0
        for k in range(W.joints):
            for r in range(W.link[k].rows):
                rest[W.link[k].first_row + r] *= REDUNDANT_EPSILON
        back(W, tally.answers, tally.passes, rest)
        for i in range(size):
            right[i] += rest[i]
    for i in range(W.bodies):
        for c in range(3):
            if c < local[i].freedoms:
                push[i, c] = right[local[i].column + c] * local[i].root[c]
            else:
                push[i, c] *= local[i].mobility[c]
