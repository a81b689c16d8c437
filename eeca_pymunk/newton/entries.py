"""Entries of one joint in the linear system of its component: rows, columns, stiffness, all scaled (see `systems`).

Entries are scaled by the `root` of a body's direction and by the `scale` of a row, so that the bodies' part of the
matrix is 1 but for stiffness, and the diagonal of J M^-1 J^T is 1. `matrix` is banded: A[i, j] stands at i (3 band + 1)
+ j - i + band in a whole system (`banded`), at i (2 band + 1) + j - i + band in the others (`condensed`).
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..model.joint_steps import STIFF_ALL, JointStep
from ..model.joints import DUAL, GROOVE, OTHERWISE, RATCHET, ROTARY_LIMIT, SLIDE, WHOLE, Coupling, Workspace


@inlined
def is_limit(kind: int) -> bool:
    """Whether joints of this kind are limits alone, with one row that acts on one side."""
    return kind in (SLIDE, ROTARY_LIMIT, RATCHET)


@inlined
def acts(link: Rows[Coupling], k: int, r: int) -> bool:
    """Whether row r of joint k acts: a limit's row does if the joint stands on it."""
    kind = link[k].kind
    if kind == GROOVE:
        return r == 0 or link[k].side != 0
    return not is_limit(kind) or link[k].side != 0


@inlined
def acting_rows(link: Rows[Coupling], k: int) -> int:
    """How many rows of joint k act, the first ones."""
    if not acts(link, k, 0):
        return 0
    return 1 if link[k].kind == GROOVE and link[k].side == 0 else int(link[k].rows)


@inlined
def idle(link: Rows[Coupling], k: int) -> bool:
    """Whether joint k is a limit on which it does not stand: it is left out of solves and tested afterwards
    (`..joints.bounds.first_bound`)."""
    return not acts(link, k, 0) and link[k].bounded == 0


@inlined
def interval_of(link: Rows[Coupling], k: int, r: int, bound: float) -> tuple[float, float]:
    """Least and largest impulse of row r of joint k with |impulse| <= `bound`: (-bound, bound); of a limit, or the end
    of a groove, the half of it that pushes inwards."""
    if is_limit(link[k].kind) or (link[k].kind == GROOVE and r == 1):
        return (0.0, bound) if link[k].side < 0 else (-bound, 0.0)
    return -bound, bound


@inlined
def along(hinge: JointStep, r: int, v_a: FloatArray, v_b: FloatArray) -> float:
    """Row J number r of a joint times the velocities v_a and v_b (3,) of its bodies, or their ways."""
    total = 0.0
    for c in range(3):
        total += hinge.rows[r, c] * v_a[c] + hinge.rows[r, 3 + c] * v_b[c]
    return total


@nonallocating
def size_of_terms(hinge: JointStep, r: int, v_a: FloatArray, v_b: FloatArray) -> float:
    """The sum of the magnitudes of the terms of `along`, whose round-off is relative to it."""
    total = 0.0
    for c in range(3):
        total += abs(hinge.rows[r, c] * v_a[c])
        total += abs(hinge.rows[r, 3 + c] * v_b[c])
    return total


@inlined
def put_rows(W: Workspace, k: int, r: int, slopes: bool, weight: float) -> None:
    """Scaled row G (`slopes`, else J; times `weight`) and column -J^T of row r of joint k in a whole system."""
    link, hinge, local, matrix, band = W.link, W.J.HINGE, W.J.LOCAL, W.J.MATRIX, W.J.COMPONENT[W.s].band
    row, scale, width = link[k].first_row + r, hinge[k].scale[r], 3 * band + 1
    G = hinge[k].slopes if slopes else hinge[k].rows
    for end in range(2):
        i = link[k].body[end]
        for c in range(local[i].freedoms):
            root = scale * local[i].root[c]
            d = local[i].column + c - row
            matrix[row * width + d + band] += weight * G[r, 3 * end + c] * root
            matrix[(row + d) * width + band - d] -= hinge[k].rows[r, 3 * end + c] * root


@inlined
def put_condensed(W: Workspace, k: int, r: int) -> None:
    """Add weight J^T G of row r of joint k, as `condensed.freeze_row` left it, to a condensed matrix."""
    link, hinge, local, matrix, band = W.link, W.J.HINGE, W.J.LOCAL, W.J.MATRIX, W.J.COMPONENT[W.s].band
    weight, width = hinge[k].weight[r], 2 * band + 1
    for end in range(2):
        i = link[k].body[end]
        for c in range(local[i].freedoms):
            factor = weight * hinge[k].frozen_rows[r, 3 * end + c]
            row = local[i].column + c
            for other in range(2):
                m = link[k].body[other]
                first = row * width + local[m].column - row + band
                for d in range(local[m].freedoms):
                    matrix[first + d] += factor * hinge[k].frozen_slopes[r, 3 * other + d]


@inlined
def put_stiffness(W: Workspace, k: int, filled: int, h: float, system: int) -> None:
    """Add -(h/2) STIFF of joint k, scaled, to the matrix (x changes by h/2 per change of v1); of a dual system its
    diagonal alone, to `inertia`. filled: which part of STIFF is not 0, STIFF_NONE ... STIFF_ALL."""
    link, local, stiff, matrix, band = W.link, W.J.LOCAL, W.J.STIFF, W.J.MATRIX, W.J.COMPONENT[W.s].band
    low = 0 if filled == STIFF_ALL else 2
    width = 3 * band + 1 if system == WHOLE else 2 * band + 1
    for end in range(2):
        i = link[k].body[end]
        if system == DUAL:
            for c in range(low, local[i].freedoms):
                local[i].inertia[c] -= stiff[3 * end + c, 3 * end + c] * 0.5 * h * local[i].root[c] ** 2
            continue
        for other in range(2):
            if filled != STIFF_ALL and end != other:
                continue
            m = link[k].body[other]
            for c in range(low, local[i].freedoms):
                factor = 0.5 * h * local[i].root[c]
                row = local[i].column + c
                first = row * width + local[m].column - row + band
                for d in range(low, local[m].freedoms):
                    matrix[first + d] -= stiff[3 * end + c, 3 * other + d] * factor * local[m].root[d]


@inlined
def weigh(W: Workspace, k: int, r: int, weight: float, build: bool) -> None:
    """Set the `weight` of row r of joint k. If the matrix is kept, `factored` says whether it has to be another one."""
    if not build and W.J.HINGE[k].weight[r] != weight:
        W.J.COMPONENT[W.s].factored = OTHERWISE
    W.J.HINGE[k].weight[r] = weight


@inlined
def put_free(W: Workspace, k: int, r: int, system: int, build: bool) -> None:
    """Write the equation of row r of joint k, which does not act: its impulse becomes 0."""
    hinge, row, band = W.J.HINGE, W.link[k].first_row + r, W.J.COMPONENT[W.s].band
    weigh(W, k, r, 0.0, build)
    W.J.RIGHT[row] = -hinge[k].lam[r] / hinge[k].scale[r]
    if build and system == WHOLE:
        W.J.MATRIX[row * (3 * band + 1) + band] = 1.0


@inlined
def put_idle(W: Workspace, k: int, system: int, build: bool) -> None:
    """Write the equation of the row of joint k, which is `idle`: its impulse is 0 and stays 0."""
    hinge, band = W.J.HINGE, W.J.COMPONENT[W.s].band
    weigh(W, k, 0, 0.0, build)
    hinge[k].lam[0] = 0.0
    if build and system == WHOLE:
        W.J.MATRIX[W.link[k].first_row * (3 * band + 1) + band] = 1.0


@inlined
def scale_rows(W: Workspace, k: int) -> None:
    """Set the `scale` of the rows of joint k, 1/sqrt(J M^-1 J^T)."""
    link, hinge, local = W.link, W.J.HINGE, W.J.LOCAL
    for r in range(link[k].rows):
        total = 0.0
        for end in range(2):
            i = link[k].body[end]
            for c in range(3):
                total += local[i].mobility[c] * hinge[k].rows[r, 3 * end + c] ** 2
        hinge[k].scale[r] = 1.0 / np.sqrt(total) if total > 0.0 else 1.0
