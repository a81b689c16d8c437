"""The linear systems of Newton's method for the implicit step of an island.

Unknowns: velocities v1 of the bodies and impulses lam of the rows, the way being x = h (v0 + v1)/2:

    M (v1 - v0) = h M a + F(x) + J(x)^T lam,      g(x) = target.

Systems are scaled by sqrt(M) and by the diagonal of G M^-1 G^T. `give` > 0 makes rows elastic:
g - target + (give h / 2 scale^2) lam = 0. Soft rows follow Alart and Curnier: with p = lam - u/A, A = 1/scale^2, either
|p| <= bound and u = 0, or lam = bound p/|p|.

The same systems with `still` bodies (h v_m = 0) correct poses, M dq = G^T mu, g(q + dq) = target, and velocities,
M dv = G^T lam, G (v + dv) = 0. The whole system has bodies and rows; a *condensed* one the bodies alone (`condensed`),
a *dual* one the rows alone (`dual`).
"""

from __future__ import annotations

from ..compiled import inlined
from ..model.joint_steps import LINEAR_STEP, NO_BEND, POSES, SPEEDS, STEP
from ..model.joints import BOUNDED, BOXED, CONDENSED, DUAL, WHOLE, Workspace
from ..model.parameters.joints import STIFFEST
from .boxes import leave_box
from .condensed import freeze
from .entries import along, held, put_condensed, put_free, put_rows, put_stiffness, scale_rows
from .rows import joint_rows
from .soft import put_soft


@inlined
def assemble(W: Workspace, what: int, h: float, give: float, first: bool, system: int, build: bool) -> float:
    """Residuals of the rows for `what` (see `..model.joints`), scaled, in RIGHT, and the joints' rows in HINGE.

    Where it is to `build`, the matrix of the `system` too, or of a dual one what it is made of.
    Returns how far rows are from their targets, over the size of the island; for SPEEDS, the worst G v.
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
        bend = joint_rows(W, k, h, build and not still)
        a, b = link[k].body[0], link[k].body[1]
        if first:
            scale_rows(link, hinge, local, k)
        if not still and (link[k].rows == 0 or held(link, k, 0)):
            for c in range(3):
                local[a].impulse[c] += hinge[k].force[c]
                local[b].impulse[c] += hinge[k].force[c + 3]
            if build and bend != NO_BEND:
                put_stiffness(link, local, k, W.J.STIFF, bend, h, system, band, matrix)
        soft = link[k].soft != 0
        if link[k].soft == BOUNDED and not still and held(link, k, 0):
            off = put_soft(W, k, slopes, h, system, build, band)
            worst = max(worst, off / hinge[k].size)
            continue
        if link[k].soft == BOXED and not still and held(link, k, 0):
            off = put_soft(W, k, slopes, h, system, False, band)
            worst = max(worst, off / hinge[k].size)
            leave_box(link, hinge, k, build, system == WHOLE, band, matrix, right)
            continue
        farthest = 0.0
        for r in range(link[k].rows):
            if soft or not held(link, k, r):
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
                freeze(hinge, link, local, k, r, slopes)
                put_condensed(link, hinge, local, k, r, band, matrix)
            elif build and system == WHOLE:
                put_rows(link, hinge, local, k, r, slopes, 1.0, band, matrix)
                matrix[(link[k].first_row + r) * width + band] += give
        worst = max(worst, farthest / hinge[k].size)
    return worst
