"""Systems of components in the rows alone, the bodies' unknowns eliminated: S mu = c - G A^-1 b, S = G A^-1 J^T, with
the symbols of `condensed`.

A is taken as diagonal: the masses, and the diagonal of the rows' STIFF. For pivots this is exact. For other joints
without springs the neglected part is of the order (h w)^2, w the rate at which they turn; errors shrink by this factor
in each iteration. `solve.solve` uses the component's other system if that is too slow.
"""

from __future__ import annotations

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..model.joints import Workspace
from ..model.parameters.joints import LEAST_INERTIA, ROW_APART
from .condensed import add_column, factor, freeze_row, row_times, substitute


@inlined
def freeze_over_inertia(W: Workspace, k: int, r: int, slopes: bool) -> None:
    """`freeze_row` with G A^-1 in place of G: `inertia` of the bodies is the diagonal of A^-1."""
    freeze_row(W, k, r, slopes)
    for end in range(2):
        for c in range(3):
            W.J.HINGE[k].frozen_slopes[r, 3 * end + c] *= W.J.LOCAL[W.link[k].body[end]].inertia[c]


@inlined
def put_pairs(W: Workspace, one: int, first: int) -> None:
    """Add the products of the rows of a joint on a body with those of all joints on it to S. `one`, `first`: that joint
    and the first of these, as `Coupling.following`."""
    hinge, link, matrix, band = W.J.HINGE, W.link, W.J.MATRIX, W.J.COMPONENT[W.s].dual_band
    k, at = one >> 1, 3 * (one & 1)
    for r in range(link[k].rows):
        if hinge[k].weight[r] == 0.0:
            continue
        G, begin = hinge[k].frozen_slopes, (link[k].first_dual + r) * 2 * band + band
        gx, gy, gw = G[r, at], G[r, at + 1], G[r, at + 2]
        other = first
        while other >= 0:
            m, to = other >> 1, 3 * (other & 1)
            for q in range(link[m].rows):
                if hinge[m].weight[q] != 0.0:
                    rows = hinge[m].frozen_rows
                    product = gx * rows[q, to] + gy * rows[q, to + 1] + gw * rows[q, to + 2]
                    matrix[begin + link[m].first_dual + q] += product
            other = link[m].following[other & 1]


@inlined
def factor_dual(W: Workspace, slopes: bool, add: float) -> bool:
    """LU factors of S + `add` in MATRIX; False if there are none that can be trusted. Rows that do not act are those of
    the unit matrix.

    Args:
        slopes: whether the rows G are the slopes of the joints, or J; they and the rows J are frozen (`condensed`).
        add: on the diagonal, for rows that are elastic or may be redundant.

    `inertia` of the bodies is the diagonal of A as `systems.assemble` left it; its reciprocal on return.
    """
    link, local, matrix, component = W.link, W.J.LOCAL, W.J.MATRIX, W.J.COMPONENT[W.s]
    size, band = component.dual_size, component.dual_band
    for i in range(W.bodies):
        for c in range(local[i].freedoms):
            if not local[i].inertia[c] > LEAST_INERTIA:
                return False
            local[i].inertia[c] = 1.0 / local[i].inertia[c]
    for i in range(size * (2 * band + 1)):
        matrix[i] = 0.0
    for k in range(W.joints):
        for r in range(link[k].rows):
            acting = W.J.HINGE[k].weight[r] != 0.0
            matrix[(link[k].first_dual + r) * (2 * band + 1) + band] = add if acting else 1.0
            if acting:
                freeze_over_inertia(W, k, r, slopes)
    for i in range(W.bodies):
        one = local[i].first if local[i].freedoms > 0 else -1
        while one >= 0:
            put_pairs(W, one, local[i].first)
            one = link[one >> 1].following[one & 1]
    return factor(matrix, size, band, W.J.PIVOTS)


@nonallocating
def are_independent(W: Workspace) -> bool:
    """Whether no row depends on others, or nearly so, by the factors of S = J M^-1 J^T without a term on the diagonal,
    which is 1: a pivot is the square of the distance of a row from the span of those before it."""
    component = W.J.COMPONENT[W.s]
    for i in range(component.dual_size):
        inverse = W.J.MATRIX[i * (2 * component.dual_band + 1) + component.dual_band]
        if not 0.0 < inverse * ROW_APART <= 1.0:
            return False
    return True


@inlined
def refresh(W: Workspace) -> None:
    """Freeze the rows of the present iterate for `back_dual`, although the factors are of an earlier one: these rows
    say how impulses change velocities, and they turn in long steps."""
    for k in range(W.joints):
        for r in range(W.link[k].rows):
            if W.J.HINGE[k].weight[r] != 0.0:
                freeze_over_inertia(W, k, r, True)


@inlined
def back_dual(W: Workspace, right: FloatArray) -> None:
    """Solve with the factors of `factor_dual` in place of `right`, bodies and rows; MORE is scratch for the rows."""
    hinge, link, local, more = W.J.HINGE, W.link, W.J.LOCAL, W.J.MORE
    for k in range(W.joints):
        for r in range(link[k].rows):
            left = right[link[k].first_row + r] - row_times(W, k, r, right, 0) if hinge[k].weight[r] != 0.0 else 0.0
            more[link[k].first_dual + r] = left
    component = W.J.COMPONENT[W.s]
    substitute(W.J.MATRIX, component.dual_size, component.dual_band, W.J.PIVOTS, more, 0)
    for k in range(W.joints):
        for r in range(link[k].rows):
            if hinge[k].weight[r] != 0.0:
                right[link[k].first_row + r] = more[link[k].first_dual + r]
                add_column(W, k, r, more[link[k].first_dual + r], right, 0)
    for i in range(W.bodies):
        for c in range(local[i].freedoms):
            right[local[i].column + c] *= local[i].inertia[c]
