"""Rows of velocity with bounded impulses: motors, and joints whose max_force is finite (see `newton`)."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import uncounted
from .condensed import freeze
from .entries import put_condensed, put_free, put_rows
from .layout import GROOVE, RATCHET, ROTARY_LIMIT, SLIDE
from .scratch import (
    BOUND,
    COLUMN,
    CONDENSED,
    FREEDOMS,
    L_A,
    L_KIND,
    L_ROW,
    L_ROWS,
    L_SIDE,
    LAM,
    ROOT,
    SCALE,
    SLOPES,
    STIFFEST,
    VALUE,
    WEIGHT,
)


@uncounted
def put_soft(
    link: IntArray, hinge: FloatArray, local: FloatArray, node: IntArray, k: int, slopes: int, h: float,
    system: int, build: bool, band: int, matrix: FloatArray, right: FloatArray,
) -> float:  # fmt: skip
    """Rows of velocity of joint k with bounded impulses; the residual as a length."""
    row, rows, bound = link[k, L_ROW], link[k, L_ROWS], hinge[k, BOUND] * abs(h)
    kind, side, width = link[k, L_KIND], link[k, L_SIDE], 3 * band + 1
    if kind == GROOVE and side == 0:
        rows = 1
        put_free(link, hinge, k, rows, system, build, band, matrix, right)
    low, high = -bound, bound
    if kind in (SLIDE, ROTARY_LIMIT, RATCHET):
        low, high = (0.0, bound) if side < 0 else (-bound, 0.0)
    rho = hinge[k, SCALE] ** 2
    if rows == 2:
        rho = min(rho, hinge[k, SCALE + 1] ** 2)
    p0 = hinge[k, LAM] - rho * hinge[k, VALUE] * 2.0 / h
    p1 = hinge[k, LAM + 1] - rho * hinge[k, VALUE + 1] * 2.0 / h if rows == 2 else 0.0
    size = np.sqrt(p0 * p0 + p1 * p1)
    sticks = low <= p0 <= high if rows == 1 else size <= bound
    worst = 0.0
    for r in range(rows):
        scale = hinge[k, SCALE + r]
        if sticks:
            off = hinge[k, VALUE + r]
            worst = max(worst, abs(off))
            right[row + r] = -off * scale * 2.0 / h
            hinge[k, WEIGHT + r] = STIFFEST
            if build and system == CONDENSED:
                freeze(hinge, link, local, node, k, r, slopes)
                put_condensed(link, hinge, node, k, r, band, matrix)
            elif build:
                put_rows(link, hinge, local, node, k, r, slopes, 1.0, band, matrix)
            continue
        p_r = p0 if r == 0 else p1
        goal = min(max(p0, low), high) if rows == 1 else bound * p_r / size
        off = hinge[k, LAM + r] - goal
        worst = max(worst, abs(off * h) / scale**2)
        right[row + r] = -off / scale
        hinge[k, WEIGHT + r] = -1.0
        if build and system == CONDENSED:
            freeze(hinge, link, local, node, k, r, slopes)
        if not build or system == CONDENSED:
            continue
        put_rows(link, hinge, local, node, k, r, slopes, 0.0, band, matrix)
        if rows == 1:
            matrix[row * width + band] += 1.0
            continue
        for q in range(2):
            same = 1.0 if q == r else 0.0
            turn = (same - p_r * (p0 if q == 0 else p1) / size**2) * bound / size
            matrix[(row + r) * width + q - r + band] += (same - turn) * hinge[k, SCALE + q] / scale
            for end in range(2):
                i = link[k, L_A + end]
                for c in range(node[i, FREEDOMS]):
                    slope = hinge[k, SLOPES + 6 * q + 3 * end + c] * local[i, ROOT + c]
                    matrix[(row + r) * width + node[i, COLUMN] + c - row - r + band] += turn * rho / scale * slope
    return worst
