"""Rows of bounded impulses that are BOXED, solved together: motors, and joints whose max_force is finite.

Each iteration linearises all other equations. Let u be the velocity along a boxed row after that, less its target, and
w (n, n) the change of u per boxed impulse, with the response of all joints that hold exactly. The n impulses solve,
together,

    |lam| <= max_force h,    u = 0 inside of the bound,    u of the other sign than lam where lam is at the bound,

(a pivot's two as a disc; if exact joints fix u, which no impulse changes, lam is at its bound unless u = 0), so that
lam never exceeds its bound, in no iteration and on no rung of `..joints.ladder`: the work of such a row is at most
max_force times the way along it. Sweeps find which rows are at their bounds, a direct solution solves for the others.

MORE has, with N unknowns of the component, one after the other:

    scratch of a dual system
    n columns and a right side (N each): the scaled changes of all unknowns by unit impulses
    from number w:   w (n, n), factors (n (2 n - 1),)
    from number u:   seven arrays (n,): u; the impulses; their least, their largest values; SINGLE or the place in a
                     disc (`..rows.bounded`); steps; 1 for impulses inside their bounds
"""

from __future__ import annotations

import math

from ..arrays import FloatArray
from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.joints import BOXED, Coupling, Workspace
from ..model.parameters import joints as parameters
from ..rows.bounded import FIRST_OF_DISC, SECOND_OF_DISC, SINGLE, on_half_disc, on_interval
from .condensed import factor, substitute
from .entries import acting_rows, interval_of, put_free, size_of_terms


@nonallocating
def room_for_boxes(n: int, size: int) -> int:
    """Numbers of MORE for n rows and `size` unknowns, without the scratch of a dual system."""
    return (n + 1) * size + (3 * n + 7) * n if n > 0 else 0


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
def measure_boxes(W: Workspace, w: int, u: int, n: int, h: float, fresh: bool) -> None:
    """Write w, if columns are `fresh`; u for the solution in RIGHT; impulses and their bounds."""
    hinge, link, component, more = W.J.HINGE, W.link, W.J.COMPONENT[W.s], W.J.MORE
    size = component.unknowns + component.impulses
    cols = component.dual_size
    row = 0
    for k in range(W.joints):
        rows = rows_of(link, k)
        for r in range(rows):
            if fresh:
                for c in range(n):
                    more[w + row * n + c] = rate_along(W, k, r, more, cols + c * size)
            more[u + row] = hinge[k].value[r] * 2.0 / h + rate_along(W, k, r, W.J.RIGHT, 0)
            if not more[w + row * n + row] > 0.0:
                a, b = W.J.LOCAL[link[k].body[0]], W.J.LOCAL[link[k].body[1]]
                speeds = abs(hinge[k].target[r]) + size_of_terms(hinge[k], r, a.v1, b.v1)  # whose sum u is
                if abs(more[u + row]) <= parameters.MOTOR_OFF * speeds:
                    more[u + row] = 0.0  # no impulse changes round-off
            more[u + n + row] = hinge[k].lam[r]
            more[u + 2 * n + row], more[u + 3 * n + row] = interval_of(link, k, r, hinge[k].bound * abs(h))
            more[u + 4 * n + row] = SINGLE if rows == 1 else FIRST_OF_DISC if r == 0 else SECOND_OF_DISC
            row += 1


@nonallocating
def change_box(more: FloatArray, w: int, u: int, n: int, i: int, to: float) -> float:
    """Set impulse i to `to`, and update u; returns the amount of the change."""
    change = to - more[u + n + i]
    if change != 0.0:
        more[u + n + i] = to
        for j in range(n):
            more[u + j] += more[w + j * n + i] * change
    return float(abs(change))


@nonallocating
def sweep_boxes(more: FloatArray, w: int, u: int, n: int) -> float:
    """One sweep over all rows; the largest change of an impulse, over the largest impulse."""
    worst, largest = 0.0, 1e-300
    for i in range(n):
        a, x = more[w + i * n + i], more[u + n + i]
        low, high = more[u + 2 * n + i], more[u + 3 * n + i]
        if more[u + 4 * n + i] == SINGLE:
            worst = max(worst, change_box(more, w, u, n, i, on_interval(a, more[u + i], x, low, high)))
        elif more[u + 4 * n + i] == FIRST_OF_DISC:
            b = 0.5 * (more[w + i * n + i + 1] + more[w + (i + 1) * n + i])
            c, y = more[w + (i + 1) * n + i + 1], more[u + n + i + 1]
            ux, uy = more[u + i], more[u + i + 1]
            if a > 0.0 and c > 0.0:
                half = more[u + 2 * n + i + 1], more[u + 3 * n + i + 1]
                to, other = on_half_disc(a, b, c, ux, uy, x, y, high, half)
            else:
                to, other = min(max(x, -high), high), 0.0
            worst = max(worst, change_box(more, w, u, n, i, to), change_box(more, w, u, n, i + 1, other))
        largest = max(largest, abs(more[u + n + i]))
    return float(worst / largest)


@nonallocating
def free_of_bounds(more: FloatArray, u: int, n: int, i: int) -> bool:
    """Whether impulse i is inside of its bounds."""
    x, low, high = more[u + n + i], more[u + 2 * n + i], more[u + 3 * n + i]
    if more[u + 4 * n + i] == SINGLE:
        return bool(low < x < high)
    y = more[u + n + i + 1] if more[u + 4 * n + i] == FIRST_OF_DISC else more[u + n + i - 1]
    bound = max(high, -low)
    return bool(low < x < high and x * x + y * y < bound * bound * (1.0 - 1e-14))


@nonallocating
def direct_boxes(more: FloatArray, w: int, u: int, n: int) -> None:
    """Solve u = 0 for the rows inside of their bounds, as if these had none; then clamp each impulse to its bounds."""
    lu, step, width = w + n * n, u + 5 * n, 2 * n - 1
    for i in range(n):
        inside = free_of_bounds(more, u, n, i)
        more[step + i] = -more[u + i] if inside else 0.0
        more[step + n + i] = 1.0 if inside else 0.0
    for i in range(n):
        for j in range(n):
            both = more[step + n + i] > 0.0 and more[step + n + j] > 0.0
            more[lu + i * width + n - 1 + j - i] = more[w + i * n + j] if both else 0.0
        pivot = more[lu + i * width + n - 1]
        more[lu + i * width + n - 1] = pivot * (1.0 + parameters.BOX_REDUNDANT) if pivot > 0.0 else 1.0
    matrix = more[lu : lu + n * width]
    if not factor(matrix, n, n - 1):
        return
    substitute(matrix, n, n - 1, more, step)
    for i in range(n):
        to = more[u + n + i] + more[step + i]
        if math.isfinite(to):
            change_box(more, w, u, n, i, min(max(to, more[u + 2 * n + i]), more[u + 3 * n + i]))


@nonallocating
def count_discs(more: FloatArray, u: int, n: int) -> int:
    """Number of the n rows that begin a disc, whose sweeps are more work."""
    count = 0
    for i in range(n):
        count += int(more[u + 4 * n + i] == FIRST_OF_DISC)
    return count


@nonallocating
def solve_boxes(more: FloatArray, w: int, u: int, n: int) -> int:
    """Solve for the impulses within their bounds, by sweeps and direct solutions in turn; how many sweeps it took."""
    sweeps = 0
    for turn in range(parameters.BOX_ROUNDS):
        worst = 1.0
        for _ in range(parameters.BOX_SWEEPS):
            worst = sweep_boxes(more, w, u, n)
            sweeps += 1
            if worst <= parameters.BOX_RESIDUAL:
                return sweeps
        if turn + 1 < parameters.BOX_ROUNDS:
            direct_boxes(more, w, u, n)
    return sweeps


@nonallocating
def apply_boxes(W: Workspace, u: int, n: int) -> None:
    """Add the effect of the changes of the boxed impulses, and these changes, scaled, to the solution in RIGHT."""
    hinge, link, component, more = W.J.HINGE, W.link, W.J.COMPONENT[W.s], W.J.MORE
    size = component.unknowns + component.impulses
    cols = component.dual_size
    row = 0
    for k in range(W.joints):
        for r in range(rows_of(link, k)):
            change = more[u + n + row] - hinge[k].lam[r]
            if change != 0.0:
                for i in range(size):
                    W.J.RIGHT[i] += change * more[cols + row * size + i]
            row += 1
    row = 0
    for k in range(W.joints):
        for r in range(rows_of(link, k)):
            W.J.RIGHT[link[k].first_row + r] = (more[u + n + row] - hinge[k].lam[r]) / hinge[k].scale[r]
            row += 1


@nonallocating
def bound_impulses(W: Workspace, n: int, h: float, fresh: bool) -> None:
    """Complete the solution in RIGHT, which has no change of the n boxed impulses. fresh: whether the columns are new,
    by `solve.find_columns`."""
    component = W.J.COMPONENT[W.s]
    w = component.dual_size + (n + 1) * (component.unknowns + component.impulses)
    u = w + 3 * n * n
    measure_boxes(W, w, u, n, h, fresh)
    sweep = n * (parameters.BOX_ROW_WORK + parameters.BOX_WORK * n) + parameters.DISC_WORK * count_discs(W.J.MORE, u, n)
    W.J.PROGRESS.effort += sweep * solve_boxes(W.J.MORE, w, u, n)
    W.J.PROGRESS.effort += parameters.BOX_COLUMN_WORK * n * (component.unknowns + component.impulses)
    apply_boxes(W, u, n)


@nonallocating
def leave_box(W: Workspace, k: int, system: int, build: bool) -> None:
    """Write equations for the rows of joint k, which are boxed: the impulse of a row stays, or becomes 0 if it does not
    act."""
    for r in range(W.link[k].rows):
        put_free(W, k, r, system, build)
        if r < rows_of(W.link, k):
            W.J.RIGHT[W.link[k].first_row + r] = 0.0
