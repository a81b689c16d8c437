"""The linear systems of Newton's method for the implicit step of a component.

Unknowns: velocities v1 of the bodies and impulses lam of the rows, the way being x = h (v0 + v1)/2:

    M (v1 - v0) = h M a + F(x) + J(x)^T lam,      g(x) = target.

Systems are scaled by sqrt(M) and by the diagonal of G M^-1 G^T. `give` > 0 makes rows elastic:
g - target + (give h / 2 scale^2) lam = 0. Bounded rows follow Alart and Curnier: with p = lam - u/A, A = 1/scale^2,
either |p| <= bound and u = 0, or lam = bound p/|p|.

The same systems with `still` bodies (h v_m = 0) correct poses, M dq = G^T mu, g(q + dq) = target, and velocities,
M dv = G^T lam, G (v + dv) = 0. The whole system has bodies and rows; a *condensed* one the bodies alone (`condensed`),
a *dual* one the rows alone (`dual`).
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..model.joint_steps import LINEAR_STEP, NO_BEND, POSES, SPEEDS, STEP
from ..model.joints import BOUNDED, BOXED, CONDENSED, DUAL, WHOLE, Component, Workspace
from ..model.parameters.joints import FACTOR_BAND, ROW_WORK, STIFFEST
from .banded import back_banded, factor_banded
from .bounded import put_bounded
from .boxes import leave_box
from .condensed import back_condensed, factor, freeze_row
from .dual import back_dual, factor_dual
from .entries import along, held, idle, put_condensed, put_free, put_idle, put_rows, put_stiffness, scale_rows
from .motion import move
from .rows import joint_rows, start_joint


@inlined
def first_iterate(W: Workspace, what: int, h: float) -> None:
    """What stays the same over the iterations, and the first iterate: motion with the accelerations that joints gave
    before (`lead`), or no motion where joints act."""
    local = W.J.LOCAL
    for k in range(W.joints):
        start_joint(W, k, h)
    for i in range(W.bodies):
        for c in range(3):
            local[i].v1[c] = local[i].v0[c] + h * (local[i].acceleration[c] + local[i].lead[c])
            if what in (POSES, SPEEDS) or (what == LINEAR_STEP and c < local[i].freedoms):
                local[i].v1[c] = -local[i].v0[c]
    move(local, W.bodies, h)


@inlined
def assemble(W: Workspace, what: int, h: float, give: float, first: bool, system: int, build: bool) -> float:
    """Residuals of the rows for `what` (see `..model.joints`), scaled, in RIGHT, and the joints' rows in HINGE.

    Where it is to `build`, the matrix of the `system` too, or of a dual one what it is made of.
    Returns how far rows are from their targets, over the size of the component; for SPEEDS, the worst G v.
    """
    hinge, link, local, matrix, right = W.J.HINGE, W.link, W.J.LOCAL, W.J.MATRIX, W.J.RIGHT
    worst, per = 0.0, 2.0 / h
    still = what in (POSES, SPEEDS)
    slopes = what == STEP
    band = W.J.COMPONENT[W.s].band
    width = 3 * band + 1 if system == WHOLE else 2 * band + 1
    if build and system != DUAL:
        for i in range(W.J.COMPONENT[W.s].unknowns * width):
            matrix[i] = 0.0
    for i in range(W.bodies):
        for c in range(3):
            local[i].impulse[c] = 0.0
            local[i].inertia[c] = 1.0 if build else local[i].inertia[c]
        if build and system != DUAL:
            for c in range(local[i].freedoms):
                matrix[(local[i].column + c) * width + band] = 1.0
    for k in range(W.joints):
        if not still and idle(link, k):
            put_idle(link, hinge, k, system, build, band, matrix)
            continue
        bend = NO_BEND
        if build or what != SPEEDS:  # else nothing has moved since rows were built
            bend = joint_rows(W, k, h, build and not still)
        a, b = link[k].body[0], link[k].body[1]
        if first or hinge[k].scale[0] == 0.0:
            scale_rows(link, hinge, local, k)
        if not still and (link[k].rows == 0 or held(link, k, 0)):
            for c in range(3):
                local[a].impulse[c] += hinge[k].force[c]
                local[b].impulse[c] += hinge[k].force[c + 3]
            if build and bend != NO_BEND:
                put_stiffness(link, local, k, W.J.STIFF, bend, h, system, band, matrix)
        bounded = link[k].bounded != 0
        if link[k].bounded == BOUNDED and not still and held(link, k, 0):
            off = put_bounded(W, k, slopes, h, system, build, band)
            worst = max(worst, off / hinge[k].size)
            continue
        if link[k].bounded == BOXED and not still and held(link, k, 0):
            off = put_bounded(W, k, slopes, h, system, False, band)
            worst = max(worst, off / hinge[k].size)
            leave_box(link, hinge, k, system, build, band, matrix, right)
            continue
        farthest = 0.0
        for r in range(link[k].rows):
            if bounded or not held(link, k, r):
                put_free(link, hinge, k, r, system, build, band, matrix, right)
                continue
            scale = hinge[k].scale[r]
            if what == SPEEDS:
                error = along(hinge[k], r, local[a].v0, local[b].v0)
            elif what == LINEAR_STEP:
                error = along(hinge[k], r, local[a].way, local[b].way)
            else:
                error = hinge[k].value[r] - hinge[k].target[r]
                if give > 0.0:
                    error += give * 0.5 * h * hinge[k].lam[r] / scale**2
            right[link[k].first_row + r] = -error * scale * per
            farthest = max(farthest, abs(error))
            hinge[k].weight[r] = 1.0 / give if give > 0.0 else STIFFEST
            if build and system == CONDENSED:
                freeze_row(hinge, link, local, k, r, slopes)
                put_condensed(link, hinge, local, k, r, band, matrix)
            elif build and system == WHOLE:
                put_rows(link, hinge, local, k, r, slopes, 1.0, band, matrix)
                matrix[(link[k].first_row + r) * width + band] += give
        worst = max(worst, farthest / hinge[k].size)
    return worst


@inlined
def balance(W: Workspace, h: float, length: float) -> float:
    """Residuals of the balance of momentum, scaled, into `right`; the worst as a way, over length or as an angle."""
    local = W.J.LOCAL
    worst, over = 0.0, 1.0 / length
    for i in range(W.bodies):
        for c in range(local[i].freedoms):
            mobility = local[i].mobility[c]
            off = local[i].v1[c] - local[i].v0[c] - h * local[i].acceleration[c] - mobility * local[i].impulse[c]
            W.J.RIGHT[local[i].column + c] = -off * local[i].unroot[c]
            worst = max(worst, abs(off * h) * (over if c < 2 else 1.0))
    return worst


@inlined
def linearise(
    W: Workspace, what: int, h: float, length: float, give: float, first: bool, system: int, build: bool
) -> float:
    """`assemble` anew, of steps with the balance of momentum; the largest error."""
    for i in range(W.J.COMPONENT[W.s].unknowns + W.J.COMPONENT[W.s].impulses):
        W.J.RIGHT[i] = 0.0
    worst = assemble(W, what, h, give, first, system, build)
    return worst if what in (POSES, SPEEDS) else max(worst, balance(W, h, length))


@inlined
def decompose(W: Workspace, what: int, system: int, epsilon: float, give: float) -> bool:
    """Factors in the place of what `assemble` has built, with `epsilon` on the rows' block; False if there are none."""
    matrix = W.J.MATRIX
    size, band = W.J.COMPONENT[W.s].unknowns, W.J.COMPONENT[W.s].band
    if system == CONDENSED:
        return factor(matrix, size, band)
    if system == DUAL:
        return factor_dual(W, what == STEP, epsilon + give)
    if epsilon > 0.0:
        for k in range(W.joints):
            for r in range(W.link[k].rows):
                matrix[(W.link[k].first_row + r) * (3 * band + 1) + band] += epsilon
    return factor_banded(matrix, size, band, W.J.PIVOTS)


@inlined
def factorise(W: Workspace, what: int, h: float, length: float, give: float, system: int, epsilon: float) -> int:
    """Factors of what `linearise` has built; where a dual system has none, of the component's other system, which is
    built for that. The system that has factors, -1 for none."""
    if decompose(W, what, system, epsilon, give):
        return system
    if system == DUAL:
        system = W.J.COMPONENT[W.s].system
        linearise(W, what, h, length, give, False, system, True)
        if decompose(W, what, system, epsilon, give):
            return system
    return -1


@inlined
def back(W: Workspace, system: int, passes: int, right: FloatArray) -> None:
    """Solve with the factors of `decompose` in place of `right`: changes of velocities, and of impulses."""
    size, band = W.J.COMPONENT[W.s].unknowns, W.J.COMPONENT[W.s].band
    if system == CONDENSED:
        back_condensed(W, passes, size, band, W.J.MATRIX, right, len(right) - size)
    elif system == DUAL:
        back_dual(W, right)
    else:
        back_banded(W.J.MATRIX, size, band, W.J.PIVOTS, right)


@inlined
def apply(W: Workspace, what: int) -> None:
    """Add the solution of a scaled system to what was solved for, and to impulses."""
    local = W.J.LOCAL
    for i in range(W.bodies):
        for c in range(local[i].freedoms):
            changed = local[i].pose if what == POSES else local[i].v0 if what == SPEEDS else local[i].v1
            changed[c] += W.J.RIGHT[local[i].column + c] * local[i].root[c]
        if what == POSES:
            local[i].cos, local[i].sin = np.cos(local[i].pose[2]), np.sin(local[i].pose[2])
    for k in range(W.joints):
        for r in range(W.link[k].rows):
            impulse = W.J.HINGE[k].pushed if what in (POSES, SPEEDS) else W.J.HINGE[k].lam
            impulse[r] += W.J.RIGHT[W.link[k].first_row + r] * W.J.HINGE[k].scale[r]


@nonallocating
def effort(system: int, fresh: bool, boxes: int, joints: int, component: Component) -> float:
    """About how many operations an iteration takes: rows, factors, solutions."""
    size, band = (component.dual_size, component.dual_band) if system == DUAL else (component.unknowns, component.band)
    turns = 1 + boxes if fresh else 1
    # Wide bands take several numbers at once.
    factors = (4.0 if system == WHOLE else 0.5 if band >= FACTOR_BAND else 2.0) * size * band * band
    return float(ROW_WORK * joints + (factors if fresh else 0.0) + 6.0 * turns * size * (band + 4))
