"""The linear systems of Newton's method for the implicit step of an island.

Unknowns: velocities v1 of the bodies and impulses lam of the rows, the way being x = h (v0 + v1)/2:

    M (v1 - v0) = h M a + F(x) + J(x)^T lam,      g(x) = target.

Systems are scaled by sqrt(M) and by the diagonal of G M^-1 G^T. `give` > 0 makes rows elastic:
g - target + (give h / 2 SCALE^2) lam = 0. Soft rows follow Alart and Curnier: with p = lam - u/A, A = 1/SCALE^2, either
|p| <= bound and u = 0, or lam = bound p/|p|.

The same systems with `still` bodies (h v_m = 0) correct poses, M dq = G^T mu, g(q + dq) = target, and velocities,
M dv = G^T lam, G (v + dv) = 0. The whole system has bodies and rows; a *condensed* one the bodies alone (`condensed`),
a *dual* one the rows alone (`dual`).
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import merged
from .boxes import leave_box
from .condensed import freeze
from .entries import along, held, put_condensed, put_free, put_rows, put_stiffness, scale_rows
from .rows import joint_rows
from .scratch import (
    BAND,
    BEFORE,
    BOUNDED,
    BOXED,
    COLUMN,
    CONDENSED,
    DUAL,
    FORCE,
    FREEDOMS,
    GOT,
    INERTIA,
    L_A,
    L_B,
    L_ROW,
    L_ROWS,
    L_SOFT,
    LAM,
    LINEAR_STEP,
    NO_BEND,
    POSES,
    ROWS,
    SCALE,
    SIZE,
    SLOPES,
    SPEEDS,
    STEP,
    STIFFEST,
    TARGET,
    UNKNOWNS,
    VALUE,
    WAY,
    WEIGHT,
    WHOLE,
)
from .soft import put_soft


@merged
def assemble(
    what: int, joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray,
    bodies: int, h: float, give: float, first: bool, system: int, build: bool, span: IntArray, matrix: FloatArray,
    right: FloatArray, stiff: FloatArray,
) -> float:  # fmt: skip
    """Residuals of the rows for `what` (see `scratch`), scaled, in `right`, and the joints' rows in `hinge`.

    Where it is to `build`, the matrix of the `system` too, or of a dual one what it is made of.
    Returns how far rows are from their targets, over the size of the island; for SPEEDS, the worst G v.
    """
    worst, per = 0.0, 2.0 / h
    still = what in (POSES, SPEEDS)
    slopes = SLOPES if what == STEP else ROWS
    band = span[BAND]
    width = 3 * band + 1 if system == WHOLE else 2 * band + 1
    if build and system != DUAL:
        for i in range(span[UNKNOWNS] * width):
            matrix[i] = 0.0
    for i in range(bodies):
        for c in range(3):
            local[i, GOT + c] = 0.0
            local[i, INERTIA + c] = 1.0 if build else local[i, INERTIA + c]
        if build and system != DUAL:
            for c in range(node[i, FREEDOMS]):
                matrix[(node[i, COLUMN] + c) * width + band] = 1.0
    for k in range(joints):
        bend = joint_rows(joint, hinge, link, k, local, h, build and not still, stiff)
        a, b = link[k, L_A], link[k, L_B]
        if first:
            scale_rows(link, hinge, local, k)
        if not still and (link[k, L_ROWS] == 0 or held(link, k, 0)):
            for c in range(3):
                local[a, GOT + c] += hinge[k, FORCE + c]
                local[b, GOT + c] += hinge[k, FORCE + 3 + c]
            if build and bend != NO_BEND:
                put_stiffness(link, local, node, k, stiff, bend, h, system, band, matrix)
        soft = link[k, L_SOFT] != 0
        if link[k, L_SOFT] == BOUNDED and not still and held(link, k, 0):
            off = put_soft(link, hinge, local, node, k, slopes, h, system, build, band, matrix, right)
            worst = max(worst, off / hinge[k, SIZE])
            continue
        if link[k, L_SOFT] == BOXED and not still and held(link, k, 0):
            off = put_soft(link, hinge, local, node, k, slopes, h, system, False, band, matrix, right)
            worst = max(worst, off / hinge[k, SIZE])
            leave_box(link, hinge, k, build, system == WHOLE, band, matrix, right)
            continue
        farthest = 0.0
        for r in range(link[k, L_ROWS]):
            if soft or not held(link, k, r):
                put_free(link, hinge, k, r, system, build, band, matrix, right)
                continue
            scale = hinge[k, SCALE + r]
            if what == SPEEDS:
                error = along(hinge, link, k, ROWS + 6 * r, local, BEFORE)
            elif what == LINEAR_STEP:
                error = along(hinge, link, k, ROWS + 6 * r, local, WAY)
            else:
                error = hinge[k, VALUE + r] - hinge[k, TARGET + r]
                if give > 0.0:
                    error += give * 0.5 * h * hinge[k, LAM + r] / scale**2
            right[link[k, L_ROW] + r] = -error * scale * per
            farthest = max(farthest, abs(error))
            hinge[k, WEIGHT + r] = 1.0 / give if give > 0.0 else STIFFEST
            if build and system == CONDENSED:
                freeze(hinge, link, local, node, k, r, slopes)
                put_condensed(link, hinge, node, k, r, band, matrix)
            elif build and system == WHOLE:
                put_rows(link, hinge, local, node, k, r, slopes, 1.0, band, matrix)
                matrix[(link[k, L_ROW] + r) * width + band] += give
        worst = max(worst, farthest / hinge[k, SIZE])
    return worst
