"""Systems of components in the rows alone, the bodies' unknowns eliminated: S mu = c - G A^-1 b, S = G A^-1 J^T, with
the symbols of `condensed`.

A is taken as diagonal: the masses, and the diagonal of the rows' STIFF. For pivots this is exact. For other joints
without springs the neglected part is of the order (h w)^2, w the rate at which they turn; errors shrink by this factor
in each iteration. `solve.solve` uses the component's other system if that is too slow.
"""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import inlined
from ..model.joints import Workspace
from ..model.parameters.joints import LEAST_INERTIA
from .condensed import factor, freeze_end, substitute

STRIDE = 6  # numbers of scratch in MORE for each row: its J, and its G over the inertia, of one body


@inlined
def number_rows(W: Workspace) -> int:
    """Number the rows that act (`JointStep.dual`), in the order of the plan: limits on which no joint stands have no
    place in the matrix. Returns how many they are. PIVOTS is scratch."""
    hinge, link, numbers, size = W.J.HINGE, W.link, W.J.PIVOTS, W.J.COMPONENT[W.s].dual_size
    for i in range(size):
        numbers[i] = 0
    for k in range(W.joints):
        for r in range(link[k].rows):
            if hinge[k].weight[r] != 0.0:
                numbers[link[k].first_dual + r] = 1
    count = 0
    for i in range(size):
        acting = numbers[i]
        numbers[i] = count
        count += acting
    for k in range(W.joints):
        # Rows that do not act come after those of their joint that do.
        if link[k].rows > 0:
            hinge[k].dual = numbers[link[k].first_dual]
    return int(count)


@inlined
def factor_dual(W: Workspace, slopes: bool, add: float) -> bool:
    """LU factors of S + `add` in `matrix`; False if there are none that can be trusted.

    Args:
        slopes: whether the rows G are the slopes of the joints, or J; they and the rows J are frozen (`condensed`).
        add: on the diagonal, for rows that are elastic or may be redundant.

    `inertia` of the bodies is the diagonal of A as `systems.assemble` left it; its reciprocal on return. MORE and
    PIVOTS are scratch, STRIDE and 1 times the rows.
    """
    hinge, link, local, matrix, more, numbers = W.J.HINGE, W.link, W.J.LOCAL, W.J.MATRIX, W.J.MORE, W.J.PIVOTS
    size, band = number_rows(W), W.J.COMPONENT[W.s].dual_band
    W.J.COMPONENT[W.s].dual_rows = size
    width = 2 * band + 1
    for i in range(size * width):
        matrix[i] = 0.0
    for i in range(size):
        matrix[i * width + band] = add
    for i in range(W.bodies):
        freedoms = local[i].freedoms
        if freedoms == 0:
            continue
        a, b, c = local[i].inertia[0], local[i].inertia[1], local[i].inertia[2] if freedoms > 2 else 1.0
        if not (a > LEAST_INERTIA and b > LEAST_INERTIA and c > LEAST_INERTIA):
            return False
        a, b, c = 1.0 / a, 1.0 / b, 1.0 / c
        local[i].inertia[0], local[i].inertia[1], local[i].inertia[2] = a, b, c
        x, y, z = local[i].root[0], local[i].root[1], local[i].root[2] if freedoms > 2 else 0.0
        # The rows on this body, then all pairs of them.
        count, one = 0, local[i].first
        while one >= 0:
            k, end = one >> 1, one & 1  # see `Coupling.following`
            for r in range(link[k].rows):
                if hinge[k].weight[r] == 0.0:
                    continue
                freeze_end(hinge, k, end, r, slopes, x, y, z)
                p, J, G = STRIDE * count, hinge[k].frozen_rows, hinge[k].frozen_slopes
                more[p], more[p + 1], more[p + 2] = J[r, 3 * end], J[r, 3 * end + 1], J[r, 3 * end + 2]
                more[p + 3], more[p + 4] = G[r, 3 * end] * a, G[r, 3 * end + 1] * b
                more[p + 5] = G[r, 3 * end + 2] * c
                numbers[count] = hinge[k].dual + r
                count += 1
            one = link[k].following[end]
        for m in range(count):
            p = STRIDE * m
            gx, gy, gw = more[p + 3], more[p + 4], more[p + 5]
            begin = numbers[m] * 2 * band + band
            for n in range(count):
                q = STRIDE * n
                matrix[begin + numbers[n]] += gx * more[q] + gy * more[q + 1] + gw * more[q + 2]
    return factor(matrix, size, band)


@inlined
def refresh(W: Workspace, slopes: bool) -> None:
    """Freeze the rows of the present iterate for `back_dual`, although the factors are of an earlier one: these rows
    say how impulses change velocities, and they turn in long steps."""
    local = W.J.LOCAL
    for k in range(W.joints):
        for end in range(2):
            i = W.link[k].body[end]
            if local[i].freedoms == 0:
                continue
            x, y, z = local[i].root[0], local[i].root[1], local[i].root[2] if local[i].freedoms > 2 else 0.0
            for r in range(W.link[k].rows):
                if W.J.HINGE[k].weight[r] != 0.0:
                    freeze_end(W.J.HINGE, k, end, r, slopes, x, y, z)


@inlined
def back_dual(W: Workspace, right: FloatArray) -> None:
    """Solve with the factors of `factor_dual` in place of `right`, bodies and rows; MORE is scratch for the rows."""
    hinge, link, local, more = W.J.HINGE, W.link, W.J.LOCAL, W.J.MORE
    for i in range(W.bodies):
        for c in range(local[i].freedoms):
            right[local[i].column + c] *= local[i].inertia[c]
    for k in range(W.joints):
        rows, row = link[k].rows, link[k].first_row
        for r in range(rows):
            if hinge[k].weight[r] != 0.0:
                more[hinge[k].dual + r] = right[row + r]
        for end in range(2):
            i = link[k].body[end]
            first, freedoms = local[i].column, local[i].freedoms
            if freedoms == 0:
                continue
            x, y, w = right[first], right[first + 1], right[first + 2] if freedoms > 2 else 0.0
            for r in range(rows):
                if hinge[k].weight[r] == 0.0:
                    continue
                at, G = 3 * end, hinge[k].frozen_slopes
                more[hinge[k].dual + r] -= G[r, at] * x + G[r, at + 1] * y + G[r, at + 2] * w
    substitute(W.J.MATRIX, W.J.COMPONENT[W.s].dual_rows, W.J.COMPONENT[W.s].dual_band, more, 0)
    for k in range(W.joints):
        rows, row = link[k].rows, link[k].first_row
        for r in range(rows):
            if hinge[k].weight[r] != 0.0:
                right[row + r] = more[hinge[k].dual + r]
        for end in range(2):
            i = link[k].body[end]
            first, freedoms = local[i].column, local[i].freedoms
            if freedoms == 0:
                continue
            x = y = w = 0.0
            for r in range(rows):
                if hinge[k].weight[r] == 0.0:
                    continue
                at, push, J = 3 * end, more[hinge[k].dual + r], hinge[k].frozen_rows
                x += push * J[r, at]
                y += push * J[r, at + 1]
                w += push * J[r, at + 2]
            right[first] += x * local[i].inertia[0]
            right[first + 1] += y * local[i].inertia[1]
            if freedoms > 2:
                right[first + 2] += w * local[i].inertia[2]
