"""Rows of bounded impulse, BOUNDED, in the matrix: motors, and joints whose max_force is finite.

In each iteration each joint is decided by itself, by Alart and Curnier (see `systems`): it sticks or is at its bound.
For rows that are BOXED only the residual is computed here: `boxes` solves for them together, if they are few.
"""

from __future__ import annotations

import numpy as np

from ..compiled import nonallocating
from ..model.joints import CONDENSED, Workspace
from ..model.parameters.joints import STIFFEST
from ..rows.bounded import pulls
from .condensed import freeze_row, put_row
from .entries import acting_rows, interval_of, put_free, put_rows


@nonallocating
def bound_otherwise(W: Workspace, before: int, after: int) -> bool:
    """Change `bounded` of joints from `before` to `after`; returns whether there are any."""
    some = False
    for k in range(W.joints):
        if W.link[k].bounded == before:
            W.link[k].bounded, some = after, True
    return some


@nonallocating
def put_bounded(W: Workspace, k: int, slopes: bool, h: float, system: int, build: bool) -> float:
    """Write the equations of the rows of joint k, whose impulses are bounded; their residual, as `value`: length or
    angle.

    With p = lam - rho u, u = 2 value/h, rho = scale^2 (the smaller one of two): u = 0 if p is within the bounds, else
    lam is the nearest impulse within them. `turn` is the derivative of that of a disc, bound p/|p|, by p. At the end of
    a groove these are half of a disc: the nearest impulse to one that pulls has no part along the groove.
    """
    hinge, link, local, matrix, right, band = (
        W.J.HINGE, W.link, W.J.LOCAL, W.J.MATRIX, W.J.RIGHT, W.J.COMPONENT[W.s].band
    )  # fmt: skip
    row, rows, bound = link[k].first_row, acting_rows(link, k), hinge[k].bound * abs(h)
    width, worst = 3 * band + 1, 0.0
    low, high = interval_of(link, k, 0, bound)
    rho = hinge[k].scale[0] ** 2
    if rows == 2:
        rho = min(rho, hinge[k].scale[1] ** 2)
    p0 = hinge[k].lam[0] - rho * hinge[k].value[0] * 2.0 / h
    p1 = hinge[k].lam[1] - rho * hinge[k].value[1] * 2.0 / h if rows == 2 else 0.0
    if rows == 2 and pulls(p1, interval_of(link, k, 1, bound)):
        rows, worst = 1, abs(hinge[k].lam[1] * h) / hinge[k].scale[1] ** 2
    for r in range(rows, link[k].rows):
        put_free(W, k, r, system, build)
    size = np.sqrt(p0 * p0 + p1 * p1)
    sticks = low <= p0 <= high if rows == 1 else size <= bound
    for r in range(rows):
        scale = hinge[k].scale[r]
        if sticks:
            off = hinge[k].value[r]
            worst = max(worst, abs(off))
            right[row + r] = -off * scale * 2.0 / h
            hinge[k].weight[r] = STIFFEST
            if build:
                put_row(W, k, r, slopes, system)
            continue
        p_r = p0 if r == 0 else p1
        goal = min(max(p0, low), high) if rows == 1 else bound * p_r / size
        off = hinge[k].lam[r] - goal
        worst = max(worst, abs(off * h) / scale**2)
        right[row + r] = -off / scale
        hinge[k].weight[r] = -1.0
        if build and system == CONDENSED:
            freeze_row(W, k, r, slopes)
        if not build or system == CONDENSED:
            continue
        put_rows(W, k, r, slopes, 0.0)
        if rows == 1:
            matrix[row * width + band] += 1.0
            continue
        for q in range(2):
            same = 1.0 if q == r else 0.0
            turn = (same - p_r * (p0 if q == 0 else p1) / size**2) * bound / size
            matrix[(row + r) * width + q - r + band] += (same - turn) * hinge[k].scale[q] / scale
            for end in range(2):
                i = link[k].body[end]
                for c in range(local[i].freedoms):
                    slope = hinge[k].slopes[q, 3 * end + c] * local[i].root[c]
                    matrix[(row + r) * width + local[i].column + c - row - r + band] += turn * rho / scale * slope
    return worst
