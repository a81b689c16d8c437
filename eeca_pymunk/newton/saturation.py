"""Rows of bounded impulse, BOUNDED, in the matrix: motors, and joints whose max_force is finite.

In each iteration each joint is decided by itself, by Alart and Curnier (see `systems`): it sticks or is at its bound.
"""

from __future__ import annotations

import math

import numpy as np

from ..compiled import nonallocating
from ..model.joints import BOUNDED, CONDENSED, OTHERWISE, WHOLE, Workspace
from ..model.parameters.joints import REDUNDANT_EPSILON, STIFFEST
from ..rows.bounded import leaves_half
from .condensed import freeze_row, put_row
from .entries import acting_rows, interval_of, put_free, put_rows, weigh

INSIDE = 1.0 - 1e-12  # part of its bound from which on an impulse counts as at it


@nonallocating
def put_bounded(W: Workspace, k: int, slopes: bool, h: float, system: int, build: bool) -> float:
    """Write the equations of the rows of joint k, whose impulses are bounded; their residual, as `value`: length or
    angle.

    With p = lam - rho u, u = 2 value/h, rho = scale^2 (the smaller one of two): u = 0 if p is within the bounds,
    else lam is the nearest impulse within them. `turn` is the derivative of that of a disc, bound p/|p|, by p. At
    the end of a groove these are half of a disc: the nearest impulse to one that pulls has no part along the
    groove. In a LINEAR_STEP (without `slopes`) p is lam: rows hold until they have come to their bounds.
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
    per = 2.0 * rho / h if slopes else 0.0
    p0 = hinge[k].lam[0] - per * hinge[k].value[0]
    p1 = hinge[k].lam[1] - per * hinge[k].value[1] if rows == 2 else 0.0
    if not slopes:
        bound, low, high = bound * INSIDE, low * INSIDE, high * INSIDE
    if rows == 2 and leaves_half(p1, interval_of(link, k, 1, bound)):
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
            weigh(W, k, r, STIFFEST, build)
            if build:
                put_row(W, k, r, slopes, system)
                if system == WHOLE and W.J.COMPONENT[W.s].cycles_with_bounded > 0:
                    matrix[(row + r) * width + band] += REDUNDANT_EPSILON
            continue
        p_r = p0 if r == 0 else p1
        goal = min(max(p0, low), high) if rows == 1 else bound * p_r / size
        off = hinge[k].lam[r] - goal
        worst = max(worst, abs(off * h) / scale**2)
        right[row + r] = -off / scale
        weigh(W, k, r, -1.0, build)
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
            turn = (same - p_r * (p0 if q == 0 else p1) / size**2) * bound / size if slopes else 0.0
            matrix[(row + r) * width + q - r + band] += (same - turn) * hinge[k].scale[q] / scale
            for end in range(2):
                i = link[k].body[end]
                for c in range(local[i].freedoms):
                    slope = hinge[k].slopes[q, 3 * end + c] * local[i].root[c]
                    matrix[(row + r) * width + local[i].column + c - row - r + band] += turn * rho / scale * slope
    if not build and rows == 2 and not sticks:  # it slides: another matrix
        W.J.COMPONENT[W.s].factored = OTHERWISE
    return worst


@nonallocating
def clamp(W: Workspace, h: float) -> bool:
    """Move impulses into their bounds; whether one was beyond them by more than round-off."""
    beyond = False
    for k in range(W.joints):
        lam, bound, size = W.J.HINGE[k].lam, W.J.HINGE[k].bound * abs(h), 0.0
        for r in range(acting_rows(W.link, k) if W.link[k].bounded == BOUNDED else 0):
            low, high = interval_of(W.link, k, r, bound)
            to = min(max(lam[r], low), high)
            beyond = beyond or abs(lam[r] - to) > (1.0 - INSIDE) * bound
            lam[r], size = to, math.hypot(size, to)
        if size > bound:
            beyond = beyond or size * INSIDE > bound
            lam[0], lam[1] = lam[0] * (bound / size), lam[1] * (bound / size)
    return beyond
