"""The linear systems of Newton's method for the implicit step of a component.

Unknowns: velocities v1 of the bodies and impulses lam of the rows, the way being x = h (v0 + v1)/2 (symbols:
`..newton`):

    M (v1 - v0) = h M a + F(x) + J(x)^T lam,      g(x) = target,

with a the accelerations without joints, F the impulses of springs. Newton's equations for the changes of v1 and lam are
scaled by sqrt(M) and by the diagonal of J M^-1 J^T, and those of rows by 2/h, as g changes by (h/2) G per change of v1.
`give` > 0 makes rows elastic: g - target + (give h / 2 scale^2) lam = 0. Bounded rows follow Alart and Curnier: with
p = lam - u/A, A = 1/scale^2, either |p| <= bound and u = 0, or lam = bound p/|p|.

The same systems with `still` bodies (x = 0) correct poses, M dq = G^T mu, g(q + dq) = target (POSES), and velocities,
M dv = G^T lam, G (v + dv) = 0 (SPEEDS). They are called with h = 2, for which 2/h is 1. LINEAR_STEP has J x = 0 in
place of g. The whole system has bodies and rows; a *condensed* one the bodies alone (`condensed`), a *dual* one the
rows alone (`dual`).

`linearise` builds a system (`assemble`, `balance`), `factorise` takes its factors (`decompose`), `back` solves with
them, `apply` adds the solution.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import inlined
from ..model.joint_steps import LINEAR_STEP, POSES, SPEEDS, STEP, STIFF_NONE
from ..model.joints import BOUNDED, CONDENSED, DUAL, GEAR, INSTANTS, STEPS, WHOLE, Component, Workspace
from ..model.parameters.joints import STIFFEST
from .banded import back_banded, factor_banded
from .condensed import back_condensed, factor, put_row
from .dual import back_dual, factor_dual
from .effort import work_of_factors, work_of_rows, work_of_solution
from .entries import acts, along, idle, put_free, put_idle, put_stiffness, scale_rows, weigh
from .motion import move
from .rows import joint_rows, start_joint
from .saturation import put_bounded


@inlined
def first_system(component: Component, what: int) -> int:
    """The system to begin with for `what`: the dual one if that is taken for it."""
    least = INSTANTS if what in (POSES, SPEEDS) else STEPS
    return DUAL if component.dual_for >= least else int(component.system)


@inlined
def first_iterate(W: Workspace, what: int, h: float) -> None:
    """Set what is constant over the iterations, and the first iterate: motion with the accelerations that joints gave
    before (`lead`); for POSES and SPEEDS, and in a LINEAR_STEP for bodies that joints move, no motion, v1 = -v0."""
    local = W.J.LOCAL
    for k in range(W.joints):
        start_joint(W, k, what, h)
    for i in range(W.bodies):
        for c in range(3):
            local[i].v1[c] = local[i].v0[c] + h * (local[i].acceleration[c] + local[i].lead[c])
            if what in (POSES, SPEEDS) or (what == LINEAR_STEP and c < local[i].freedoms):
                local[i].v1[c] = -local[i].v0[c]
    move(local, W.bodies, h)


@inlined
def put_exact(W: Workspace, what: int, k: int, h: float, give: float, system: int, build: bool) -> float:
    """Write the equations of the rows of joint k that are exact or elastic; returns the largest of their errors for
    `what`. Rows that do not act are written as free; so are bounded ones if bodies are still, or their impulses
    given."""
    hinge, link, local, band = W.J.HINGE, W.link, W.J.LOCAL, W.J.COMPONENT[W.s].band
    a, b = link[k].body[0], link[k].body[1]
    per, slopes, bounded, farthest = 2.0 / h, what == STEP, link[k].bounded != 0, 0.0
    for r in range(link[k].rows):
        if bounded or not acts(link, k, r):
            put_free(W, k, r, system, build)
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
        row = link[k].first_row + r
        W.J.RIGHT[row] = -error * scale * per
        farthest = max(farthest, abs(error))
        weigh(W, k, r, 1.0 / give if give > 0.0 else STIFFEST, build)
        if build:
            put_row(W, k, r, slopes, system)
            if system == WHOLE:
                W.J.MATRIX[row * (3 * band + 1) + band] += give
    return farthest


@inlined
def assemble(W: Workspace, what: int, h: float, give: float, first: bool, system: int, build: bool) -> float:
    """Write the residuals of the rows for `what`, scaled, to RIGHT, and the joints' rows to HINGE; if `build`, also the
    matrix of the `system`, or for a dual one what it is made of. first: whether to compute the scales of rows. The
    bodies' `impulse` becomes that of all joints.

    Returns how far rows are from their targets, over the size of the component; for SPEEDS, the worst G v over it.
    """
    hinge, link, local, matrix = W.J.HINGE, W.link, W.J.LOCAL, W.J.MATRIX
    W.J.PROGRESS.effort += work_of_rows(W.joints)
    worst = 0.0
    still = what in (POSES, SPEEDS)
    slopes = what == STEP
    band = W.J.COMPONENT[W.s].band
    width = 3 * band + 1 if system == WHOLE else 2 * band + 1
    W.J.PROGRESS.factors_of = 0 if build else W.J.PROGRESS.factors_of
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
            put_idle(W, k, system, build)
            continue
        filled = STIFF_NONE
        if build or what != SPEEDS:  # else nothing has moved since rows were built
            filled = joint_rows(W, k, h, build and not still)
        a, b = link[k].body[0], link[k].body[1]
        if first or hinge[k].scale[0] == 0.0:
            scale_rows(W, k)
        if not still and (link[k].rows == 0 or acts(link, k, 0)):
            for c in range(3):
                local[a].impulse[c] += hinge[k].force[c]
                local[b].impulse[c] += hinge[k].force[c + 3]
            if build and filled != STIFF_NONE:
                put_stiffness(W, k, filled, h, system)
        if link[k].bounded == BOUNDED and not still and acts(link, k, 0):
            off = put_bounded(W, k, slopes, h, system, build)
        else:
            off = put_exact(W, what, k, h, give, system, build)
        # What a gear holds are angles: their round-off is that of rad, whatever its ratio.
        worst = max(worst, off / (max(hinge[k].unit, 1.0) if link[k].kind == GEAR else hinge[k].unit))
    return worst


@inlined
def balance(W: Workspace, h: float, extent: float) -> float:
    """Write the residuals of the balance of momentum, scaled, to RIGHT; the worst one as a way, over `extent` or as an
    angle."""
    local = W.J.LOCAL
    worst, over = 0.0, 1.0 / extent
    for i in range(W.bodies):
        for c in range(local[i].freedoms):
            mobility = local[i].mobility[c]
            off = local[i].v1[c] - local[i].v0[c] - h * local[i].acceleration[c] - mobility * local[i].impulse[c]
            W.J.RIGHT[local[i].column + c] = -off * local[i].unroot[c]
            error = abs(off * h) * (over if c < 2 else 1.0)
            worst = worst if error <= worst else error  # also if it is no number
    return worst


@inlined
def linearise(
    W: Workspace, what: int, h: float, extent: float, give: float, first: bool, system: int, build: bool
) -> float:
    """Build the right side, and the matrix if `build`; returns the largest error, over the size of the component.
    extent: that size, for the balance of momentum, which POSES and SPEEDS do not have."""
    for i in range(W.J.COMPONENT[W.s].unknowns + W.J.COMPONENT[W.s].impulses):
        W.J.RIGHT[i] = 0.0
    worst = assemble(W, what, h, give, first, system, build)
    if what in (POSES, SPEEDS):
        return worst
    error = balance(W, h, extent)
    return worst if error <= worst else error


@inlined
def decompose(W: Workspace, what: int, system: int, epsilon: float, give: float) -> bool:
    """Factor what `assemble` has built, in place, with `epsilon` on the diagonal of the rows, but for a condensed
    system, whose rows have the stiffness `weight`; False if that fails."""
    matrix = W.J.MATRIX
    size, band = W.J.COMPONENT[W.s].unknowns, W.J.COMPONENT[W.s].band
    W.J.PROGRESS.effort += work_of_factors(system, W.J.COMPONENT[W.s])
    if system == CONDENSED:
        return factor(matrix, size, band, W.J.PIVOTS)
    if system == DUAL:
        return factor_dual(W, what == STEP, epsilon + give)
    if epsilon > 0.0:
        for k in range(W.joints):
            for r in range(W.link[k].rows):
                matrix[(W.link[k].first_row + r) * (3 * band + 1) + band] += epsilon
    return factor_banded(matrix, size, band, W.J.PIVOTS)


@inlined
def factorise(W: Workspace, what: int, h: float, extent: float, give: float, system: int, epsilon: float) -> int:
    """Factor what `linearise` has built; if that fails for a dual system, build and factor the component's other
    system. Returns the system that is factored, -1 for none."""
    if decompose(W, what, system, epsilon, give):
        return system
    if system == DUAL:
        system = W.J.COMPONENT[W.s].system
        linearise(W, what, h, extent, give, False, system, True)
        if decompose(W, what, system, epsilon, give):
            return system
    return -1


@inlined
def back(W: Workspace, system: int, passes: int, right: FloatArray) -> None:
    """Solve with the factors of `decompose` in place of `right`: changes of velocities and of impulses, scaled.
    passes: of `condensed`, whose scratch is the second half of `right`."""
    size, band = W.J.COMPONENT[W.s].unknowns, W.J.COMPONENT[W.s].band
    W.J.PROGRESS.effort += work_of_solution(system, passes, W.joints, W.J.COMPONENT[W.s])
    if system == CONDENSED:
        passes = passes if W.J.COMPONENT[W.s].impulses > 0 else 1  # springs alone leave nothing to refine
        back_condensed(W, passes, size, band, W.J.MATRIX, right, len(right) - size)
    elif system == DUAL:
        back_dual(W, right)
    else:
        back_banded(W.J.MATRIX, size, band, W.J.PIVOTS, right)


@inlined
def apply(W: Workspace, what: int) -> None:
    """Add the scaled solution in RIGHT to what was solved for, and to impulses: of poses and speeds `pushed`."""
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
