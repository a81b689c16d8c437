"""Systems of wide components in the bodies' unknowns alone: the joints' rows are stiff springs, and then corrected.

[A  -J^T; G  give] [x; mu] = [b; c], with A the bodies' part, x and mu the changes of velocities and impulses, all
scaled, becomes (A + R J^T G) dx = b + R J^T (c - G x), dmu = R (c - G x - G dx), repeated with the remaining c
(`missing`). R is the stiffness of the rows, their `weight`. The balance of the bodies holds after the first pass, each
further one multiplies the rows' error by 1/(1 + R s), s the least eigenvalue of G A^-1 J^T. Rows may be redundant. The
band is that of the bodies' graph, and needs no pivots. Factors also serve for later iterates, so the scaled rows with
which they were made are stored, *frozen* (`frozen_rows`, `frozen_slopes`).
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import inlined, nonallocating
from ..model.joints import CONDENSED, WHOLE, Workspace
from ..model.parameters.joints import FACTOR_BAND
from ..rows.inplace import add_multiple
from .entries import put_condensed, put_rows


@inlined
def dot(row: FloatArray, i: int, other: FloatArray, k: int, n: int) -> float:
    """The product of row[i : i + n] and other[k : k + n], in four independent sums, which the processor overlaps."""
    a = b = c = d = 0.0
    whole = n & -4
    for j in range(0, whole, 4):
        a += row[i + j] * other[k + j]
        b += row[i + j + 1] * other[k + j + 1]
        c += row[i + j + 2] * other[k + j + 2]
        d += row[i + j + 3] * other[k + j + 3]
    for j in range(whole, n):
        a += row[i + j] * other[k + j]
    return float((a + b) + (c + d))


@inlined
def factor(matrix: FloatArray, size: int, band: int, first: IntArray) -> bool:
    """LU factors without pivots in place of `matrix`, A[i, j] at i (2 band + 1) + j - i + band, reciprocals on the
    diagonal; False if a pivot vanishes. first: out, the first column of each row of L that is not 0."""
    width = 2 * band + 1
    for k in range(size):
        first[k] = k
    for k in range(size):
        at = k * width + band
        pivot = matrix[at]
        if not abs(pivot) > 1e-300:
            return False
        inverse = 1.0 / pivot
        matrix[at] = inverse
        reach = min(band + 1, size - k)
        for i in range(k + 1, k + reach):
            to = i * width + k - i + band
            below = matrix[to]
            if below != 0.0:
                below *= inverse
                matrix[to] = below
                first[i] = min(first[i], k)
                if band >= FACTOR_BAND:
                    add_multiple(matrix[to + 1 : to + reach], matrix[at + 1 : at + reach], -below)
                else:
                    for j in range(1, reach):
                        matrix[to + j] -= below * matrix[at + j]
    return True


@inlined
def substitute(
    matrix: FloatArray, size: int, band: int, first: IntArray, right: FloatArray, at: int
) -> None:  # fmt: skip
    """Solve with the factors of `factor`, in place of right[at : at + size]."""
    width = 2 * band + 1
    for i in range(size):
        n = i - first[i]
        begin = i * width + band - n
        if band >= FACTOR_BAND:
            right[at + i] -= dot(matrix, begin, right, at + i - n, n)
        else:
            total = right[at + i]
            for j in range(n):
                total -= matrix[begin + j] * right[at + i - n + j]
            right[at + i] = total
    for i in range(size - 1, -1, -1):
        n = min(band, size - 1 - i)
        begin = i * width + band
        total = right[at + i]
        if band >= FACTOR_BAND:
            total -= dot(matrix, begin + 1, right, at + i + 1, n)
        else:
            # The unknown found last is used last, so that no other product waits for it.
            for j in range(n, 0, -1):
                total -= matrix[begin + j] * right[at + i + j]
        right[at + i] = total * matrix[begin]


@inlined
def freeze_row(W: Workspace, k: int, r: int, slopes: bool) -> None:
    """Store the entries J and G (`slopes`, else J for both) of row r of joint k, scaled by the row's scale and the
    roots of its bodies."""
    hinge = W.J.HINGE[k]
    G = hinge.slopes if slopes else hinge.rows
    for end in range(2):
        root, at = W.J.LOCAL[W.link[k].body[end]].root, 3 * end
        for c in range(3):
            factor = hinge.scale[r] * root[c]
            hinge.frozen_rows[r, at + c] = factor * hinge.rows[r, at + c]
            hinge.frozen_slopes[r, at + c] = factor * G[r, at + c]


@inlined
def put_row(W: Workspace, k: int, r: int, slopes: bool, system: int) -> None:
    """Add row r of joint k, which acts, to a condensed or a whole system (of a dual one `dual.factor_dual` reads it);
    arguments as of `freeze_row`."""
    if system == CONDENSED:
        freeze_row(W, k, r, slopes)
        put_condensed(W, k, r)
    elif system == WHOLE:
        put_rows(W, k, r, slopes, 1.0)


@inlined
def add_column(W: Workspace, k: int, r: int, amount: float, right: FloatArray, at: int) -> None:
    """Add `amount` of the frozen column J^T of row r of joint k to right[at :]."""
    for end in range(2):
        body = W.J.LOCAL[W.link[k].body[end]]
        for c in range(body.freedoms):
            right[at + body.column + c] += amount * W.J.HINGE[k].frozen_rows[r, 3 * end + c]


@inlined
def row_times(W: Workspace, k: int, r: int, right: FloatArray, at: int) -> float:
    """The frozen row G number r of joint k times right[at :]."""
    total = 0.0
    for end in range(2):
        body = W.J.LOCAL[W.link[k].body[end]]
        for c in range(body.freedoms):
            total += W.J.HINGE[k].frozen_slopes[r, 3 * end + c] * right[at + body.column + c]
    return total


@nonallocating
def back_condensed(
    W: Workspace, passes: int, size: int, band: int, matrix: FloatArray, right: FloatArray, room: int
) -> None:
    """Solve the condensed system with the factors of its matrix in place of `right`: `size` unknowns of bodies, then
    those of rows; right[room : room + size] is scratch. A row of weight < 0 has a known change of its impulse."""
    hinge, link = W.J.HINGE, W.link
    for i in range(size):
        right[room + i] = right[i]
        right[i] = 0.0
    for k in range(W.joints):
        for r in range(link[k].rows):
            row = link[k].first_row + r
            if hinge[k].weight[r] < 0.0:
                add_column(W, k, r, right[row], right, room)
            elif hinge[k].weight[r] > 0.0:
                hinge[k].missing[r] = right[row]
                right[row] = 0.0
    for _ in range(passes):
        for k in range(W.joints):
            for r in range(link[k].rows):
                if hinge[k].weight[r] > 0.0:
                    add_column(W, k, r, hinge[k].weight[r] * hinge[k].missing[r], right, room)
        substitute(matrix, size, band, W.J.PIVOTS, right, room)
        for k in range(W.joints):
            for r in range(link[k].rows):
                if hinge[k].weight[r] > 0.0:
                    hinge[k].missing[r] -= row_times(W, k, r, right, room)
                    right[link[k].first_row + r] += hinge[k].weight[r] * hinge[k].missing[r]
        for i in range(size):
            right[i] += right[room + i]
            right[room + i] = 0.0
