"""Rows of bounded impulses that are BOXED, solved together: motors, and joints whose max_force is finite.

Each iteration linearises all other equations. Let u be the velocity along a boxed row after that, less its target, and
w (n, n) the change of u per boxed impulse, with the response of all joints that hold exactly. The n impulses solve,
together,

    |lam| <= max_force h,    u = 0 inside of the bound,    u of the other sign than lam where lam is at the bound,

(a pivot's two as a disc; if exact joints fix u, which no impulse changes, lam is at its bound unless u = 0), so that
lam never exceeds its bound, in no iteration and on no rung of `..joints.ladder`: the work of such a row is at most
max_force times the way along it. Sweeps find which rows are at their bounds, a direct solution solves for the others.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..model.joints import BOXED, Coupling, Workspace
from ..model.parameters import joints as parameters
from ..rows.bounded import FIRST_OF_DISC, SECOND_OF_DISC, SINGLE, on_half_disc, on_interval
from .condensed import factor, substitute
from .entries import acting_rows, interval_of, put_free, size_of_terms


class Boxes(NamedTuple):
    """The n boxed rows of a component, views of MORE. Of all its `size` unknowns, scaled:

    KEPT (size,): a right side.  COLUMN (n size,): row by row, their changes by a unit impulse.

    W (n n,): change of u by unit impulses.  LU (n (2 n - 1),): factors of a part of W.  U, X (n,): u and the impulses.
    LOW, HIGH: least and largest impulses.  PART: SINGLE or the place in a disc (`..rows.bounded`).  STEP: of a direct
    solution.  INSIDE: 1 for impulses inside of their bounds.
    """

    n: int
    size: int
    KEPT: FloatArray
    COLUMN: FloatArray
    W: FloatArray
    LU: FloatArray
    U: FloatArray
    X: FloatArray
    LOW: FloatArray
    HIGH: FloatArray
    PART: FloatArray
    STEP: FloatArray
    INSIDE: FloatArray


@nonallocating
def room_for_boxes(n: int, size: int) -> int:
    """Numbers of MORE for n rows and `size` unknowns, without the scratch of a dual system."""
    return (n + 1) * size + (3 * n + 7) * n if n > 0 else 0


@inlined
def boxes_of(W: Workspace, n: int) -> Boxes:
    """The memory of n boxed rows, behind the scratch of a dual system."""
    component = W.J.COMPONENT[W.s]
    size = component.unknowns + component.impulses
    M = W.J.MORE[component.dual_size :]
    w = (n + 1) * size
    u = w + 3 * n * n
    return Boxes(
        n, size, M[:size], M[size:w], M[w : w + n * n], M[w + n * n : u], M[u : u + n], M[u + n : u + 2 * n],
        M[u + 2 * n : u + 3 * n], M[u + 3 * n : u + 4 * n], M[u + 4 * n : u + 5 * n], M[u + 5 * n : u + 6 * n],
        M[u + 6 * n : u + 7 * n],
    )  # fmt: skip


@nonallocating
def rows_of(link: Rows[Coupling], k: int) -> int:
    """Number of rows of joint k that act, if it is boxed; else 0."""
    return acting_rows(link, k) if link[k].bounded == BOXED else 0


@nonallocating
def boxed_rows(W: Workspace) -> int:
    """How many rows are boxed."""
    count = 0
    for k in range(W.joints):
        count += rows_of(W.link, k)
    return count


@nonallocating
def unit_impulse(W: Workspace, k: int, r: int) -> None:
    """Write a unit impulse along row r of joint k, scaled, to RIGHT."""
    component = W.J.COMPONENT[W.s]
    for i in range(component.unknowns + component.impulses):
        W.J.RIGHT[i] = 0.0
    for end in range(2):
        body = W.J.LOCAL[W.link[k].body[end]]
        for c in range(body.freedoms):
            W.J.RIGHT[body.column + c] += W.J.HINGE[k].rows[r, 3 * end + c] * body.root[c]


@nonallocating
def rate_along(W: Workspace, k: int, r: int, change: FloatArray, at: int) -> float:
    """The velocity along row r of joint k of the scaled change[at :]."""
    total = 0.0
    for end in range(2):
        body = W.J.LOCAL[W.link[k].body[end]]
        for c in range(body.freedoms):
            total += W.J.HINGE[k].rows[r, 3 * end + c] * body.root[c] * change[at + body.column + c]
    return total


@nonallocating
def measure_boxes(W: Workspace, B: Boxes, h: float, fresh: bool) -> None:
    """Write W, if columns are `fresh`; u for the solution in RIGHT; impulses and their bounds."""
    link, n, i = W.link, B.n, 0
    for k in range(W.joints):
        hinge, rows = W.J.HINGE[k], rows_of(link, k)
        for r in range(rows):
            for c in range(n if fresh else 0):
                B.W[i * n + c] = rate_along(W, k, r, B.COLUMN, c * B.size)
            B.U[i] = hinge.value[r] * 2.0 / h + rate_along(W, k, r, W.J.RIGHT, 0)
            if not B.W[i * n + i] > 0.0:
                a, b = W.J.LOCAL[link[k].body[0]], W.J.LOCAL[link[k].body[1]]
                speeds = abs(hinge.target[r]) + size_of_terms(hinge, r, a.v1, b.v1)  # whose sum u is
                if abs(B.U[i]) <= parameters.MOTOR_OFF * speeds:
                    B.U[i] = 0.0  # no impulse changes round-off
            B.X[i] = hinge.lam[r]
            B.LOW[i], B.HIGH[i] = interval_of(link, k, r, hinge.bound * abs(h))
            B.PART[i] = SINGLE if rows == 1 else FIRST_OF_DISC if r == 0 else SECOND_OF_DISC
            i += 1


@inlined
def change_box(B: Boxes, i: int, to: float) -> float:
    """Set impulse i to `to`, and update u; returns the amount of the change."""
    change = to - B.X[i]
    if change != 0.0:
        B.X[i] = to
        for j in range(B.n):
            B.U[j] += B.W[j * B.n + i] * change
    return float(abs(change))


@nonallocating
def sweep_boxes(B: Boxes) -> float:
    """One sweep over all rows; the largest change of an impulse, over the largest impulse."""
    worst, largest, n = 0.0, 1e-300, B.n
    for i in range(n):
        a, x = B.W[i * n + i], B.X[i]
        if B.PART[i] == SINGLE:
            worst = max(worst, change_box(B, i, on_interval(a, B.U[i], x, B.LOW[i], B.HIGH[i])))
        elif B.PART[i] == FIRST_OF_DISC:
            b, c = 0.5 * (B.W[i * n + i + 1] + B.W[(i + 1) * n + i]), B.W[(i + 1) * n + i + 1]
            to, other = min(max(x, -B.HIGH[i]), B.HIGH[i]), 0.0
            if a > 0.0 and c > 0.0:
                half = B.LOW[i + 1], B.HIGH[i + 1]
                to, other = on_half_disc(a, b, c, B.U[i], B.U[i + 1], x, B.X[i + 1], B.HIGH[i], half)
            worst = max(worst, change_box(B, i, to), change_box(B, i + 1, other))
        largest = max(largest, abs(B.X[i]))
    return float(worst / largest)


@inlined
def free_of_bounds(B: Boxes, i: int) -> bool:
    """Whether impulse i is inside of its bounds."""
    inside = B.LOW[i] < B.X[i] < B.HIGH[i]
    if B.PART[i] == SINGLE:
        return bool(inside)
    y, bound = B.X[i + 1 if B.PART[i] == FIRST_OF_DISC else i - 1], max(B.HIGH[i], -B.LOW[i])
    return bool(inside and B.X[i] * B.X[i] + y * y < bound * bound * (1.0 - 1e-14))


@nonallocating
def direct_boxes(B: Boxes) -> None:
    """Solve u = 0 for the rows inside of their bounds, as if these had none; then clamp each impulse to its bounds."""
    n, width = B.n, 2 * B.n - 1
    for i in range(n):
        inside = free_of_bounds(B, i)
        B.STEP[i], B.INSIDE[i] = -B.U[i] if inside else 0.0, 1.0 if inside else 0.0
    for i in range(n):
        for j in range(n):
            B.LU[i * width + n - 1 + j - i] = B.W[i * n + j] if B.INSIDE[i] > 0.0 and B.INSIDE[j] > 0.0 else 0.0
        pivot = B.LU[i * width + n - 1]
        B.LU[i * width + n - 1] = pivot * (1.0 + parameters.BOX_REDUNDANT) if pivot > 0.0 else 1.0
    if not factor(B.LU, n, n - 1):
        return
    substitute(B.LU, n, n - 1, B.STEP, 0)
    for i in range(n):
        to = B.X[i] + B.STEP[i]
        if math.isfinite(to):
            change_box(B, i, min(max(to, B.LOW[i]), B.HIGH[i]))


@nonallocating
def solve_boxes(B: Boxes) -> int:
    """Solve for the impulses within their bounds, by sweeps and direct solutions in turn; how many sweeps it took."""
    sweeps = 0
    for turn in range(parameters.BOX_ROUNDS):
        for _ in range(parameters.BOX_SWEEPS):
            sweeps += 1
            if sweep_boxes(B) <= parameters.BOX_RESIDUAL:
                return sweeps
        if turn + 1 < parameters.BOX_ROUNDS:
            direct_boxes(B)
    return sweeps


@nonallocating
def apply_boxes(W: Workspace, B: Boxes) -> None:
    """Add the effect of the changes of the boxed impulses, and these changes, scaled, to the solution in RIGHT."""
    right, link, row = W.J.RIGHT, W.link, 0
    for k in range(W.joints):
        for r in range(rows_of(link, k)):
            change = B.X[row] - W.J.HINGE[k].lam[r]
            for i in range(B.size if change != 0.0 else 0):
                right[i] += change * B.COLUMN[row * B.size + i]
            row += 1
    row = 0
    for k in range(W.joints):
        for r in range(rows_of(link, k)):
            right[link[k].first_row + r] = (B.X[row] - W.J.HINGE[k].lam[r]) / W.J.HINGE[k].scale[r]
            row += 1


@nonallocating
def bound_impulses(W: Workspace, n: int, h: float, fresh: bool) -> None:
    """Complete the solution in RIGHT, which has no change of the n boxed impulses. fresh: whether the columns are new,
    by `solve.find_columns`."""
    B, work = boxes_of(W, n), n * (parameters.BOX_ROW_WORK + parameters.BOX_WORK * n)
    measure_boxes(W, B, h, fresh)
    for i in range(n):
        work += parameters.DISC_WORK if B.PART[i] == FIRST_OF_DISC else 0.0
    W.J.PROGRESS.effort += work * solve_boxes(B)
    W.J.PROGRESS.effort += parameters.BOX_COLUMN_WORK * n * B.size
    apply_boxes(W, B)


@nonallocating
def leave_box(W: Workspace, k: int, system: int, build: bool) -> None:
    """Write equations for the rows of joint k, which are boxed: the impulse of a row stays, or becomes 0 if it does not
    act."""
    for r in range(W.link[k].rows):
        put_free(W, k, r, system, build)
        if r < rows_of(W.link, k):
            W.J.RIGHT[W.link[k].first_row + r] = 0.0
