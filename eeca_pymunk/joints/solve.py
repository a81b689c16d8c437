"""The implicit step of an island by Newton's iteration; the linear step that always succeeds; corrections.

Arguments that choose are never constants in calls (`int(POSES)`): numba would compile the whole anew for each.
`epsilon` on the impulses' block takes redundant rows: it acts on increments alone, so what is solved stays the same.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import merged, uncounted
from .banded import back_banded, factor_banded
from .boxes import bound_impulses, boxed_rows, push, rows_of
from .condensed import PASSES, back_condensed, factor
from .correct import goes_on, keep
from .dual import STRIDE, back_dual, factor_dual, refresh
from .motion import move, settle
from .newton import assemble
from .rows import start_joint
from .scratch import (
    AFTER,
    BAND,
    BEFORE,
    BOUNDED,
    COLUMN,
    CONDENSED,
    COS,
    DUAL,
    DUAL_BAND,
    DUAL_SIZE,
    EFFORT,
    FORCE,
    FREE,
    FREEDOMS,
    GOT,
    L_ROW,
    L_ROWS,
    L_SOFT,
    LAM,
    LEAD,
    LIMIT,
    LINEAR_STEP,
    MOBILITY,
    NEAR,
    POSE,
    POSES,
    PUSHED,
    RIGID,
    ROOT,
    ROWS,
    ROWS_OF,
    SCALE,
    SIN,
    SLOPES,
    SPEEDS,
    STEP,
    SYSTEM,
    UNKNOWNS,
    UNROOT,
    WHOLE,
)

TOLERANCE = 3e-16  # of joints and momenta, over the size of the island
ROUND_OFF = 3e-14  # below this, an error that no longer halves is round-off
LASTING_ROUND_OFF = 2e-15  # likewise with lasting factors
_FALLS = 0.03  # of an error, that an iteration with factors of an earlier one may leave
FLOOR = 1e-11  # below this, it is if it has not fallen twice
MOST_ITERATIONS = 25
LEAST_EPSILON = 1e-10
CLOSING_EPSILON = 1e-5
MOST_CLOSINGS = 8
MOST_PASSES = 12
_WIDE = 16  # band from which on factors are computed several numbers at a time
_ROWS_COST = 500.0  # operations, of the rows of a joint


@merged
def begin(
    what: int, joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray,
    bodies: int, h: float,
) -> None:  # fmt: skip
    """What stays the same over the iterations, and the first iterate: motion with the accelerations that joints gave
    before (LEAD), or no motion where joints act."""
    for k in range(joints):
        start_joint(joint, hinge, link, k, local, h)
    for i in range(bodies):
        for c in range(3):
            local[i, AFTER + c] = local[i, BEFORE + c] + h * (local[i, FREE + c] + local[i, LEAD + c])
            if what in (POSES, SPEEDS) or (what == LINEAR_STEP and c < node[i, FREEDOMS]):
                local[i, AFTER + c] = -local[i, BEFORE + c]
    move(local, bodies, h)


@merged
def balance(local: FloatArray, node: IntArray, bodies: int, h: float, length: float, right: FloatArray) -> float:
    """Residuals of the balance of momentum, scaled, into `right`; the worst as a way, over length or as an angle."""
    worst, over = 0.0, 1.0 / length
    for i in range(bodies):
        for c in range(node[i, FREEDOMS]):
            mobility = local[i, MOBILITY + c]
            off = local[i, AFTER + c] - local[i, BEFORE + c] - h * local[i, FREE + c] - mobility * local[i, GOT + c]
            right[node[i, COLUMN] + c] = -off * local[i, UNROOT + c]
            worst = max(worst, abs(off * h) * (over if c < 2 else 1.0))
    return worst


@merged
def apply(
    what: int, link: IntArray, hinge: FloatArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    right: FloatArray,
) -> None:  # fmt: skip
    """Add the solution of a scaled system to what was solved for, and to impulses."""
    column = POSE if what == POSES else BEFORE if what == SPEEDS else AFTER
    for i in range(bodies):
        for c in range(node[i, FREEDOMS]):
            local[i, column + c] += right[node[i, COLUMN] + c] * local[i, ROOT + c]
        if what == POSES:
            local[i, COS], local[i, SIN] = np.cos(local[i, POSE + 2]), np.sin(local[i, POSE + 2])
    impulse = PUSHED if what in (POSES, SPEEDS) else LAM
    for k in range(joints):
        for r in range(link[k, L_ROWS]):
            hinge[k, impulse + r] += right[link[k, L_ROW] + r] * hinge[k, SCALE + r]


@merged
def decompose(
    what: int, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    system: int, epsilon: float, give: float, span: IntArray, matrix: FloatArray, more: FloatArray, pivots: IntArray,
) -> bool:  # fmt: skip
    """Factors in the place of what `assemble` has built, with `epsilon` on the rows' block; False if there are none.
    `more` is scratch, as in `back`."""
    size, band = span[UNKNOWNS], span[BAND]
    if system == CONDENSED:
        return factor(matrix, size, band)
    if system == DUAL:
        slopes = SLOPES if what == STEP else ROWS
        return factor_dual(hinge, link, joints, local, node, bodies, slopes, epsilon + give, span, matrix, more, pivots)
    if epsilon > 0.0:
        for k in range(joints):
            for r in range(link[k, L_ROWS]):
                matrix[(link[k, L_ROW] + r) * (3 * band + 1) + band] += epsilon
    return factor_banded(matrix, size, band, pivots)


@merged
def back(
    what: int, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    system: int, passes: int, span: IntArray, matrix: FloatArray, right: FloatArray, more: FloatArray,
    pivots: IntArray,
) -> None:  # fmt: skip
    """Solve with the factors of `decompose` in place of `right`: changes of velocities, and of impulses. `more` is
    scratch, see `plan.Room`."""
    size, band = span[UNKNOWNS], span[BAND]
    if system == CONDENSED:
        back_condensed(hinge, link, joints, node, passes, size, band, matrix, right, len(right) - size)
    elif system == DUAL:
        back_dual(hinge, link, joints, local, node, bodies, span, matrix, right, more)
    else:
        back_banded(matrix, size, band, pivots, right)


@uncounted
def bounded_rows(link: IntArray, joints: int) -> bool:
    """Whether any joint has bounded rows in the matrix."""
    count = 0
    for k in range(joints):
        count += 1 if link[k, L_SOFT] == BOUNDED else 0
    return count > 0


@uncounted
def answer_boxes(
    what: int, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray, bodies: int,
    system: int, passes: int, boxes: int, span: IntArray, matrix: FloatArray, right: FloatArray, more: FloatArray,
    pivots: IntArray,
) -> None:  # fmt: skip
    """Columns of `boxes`, with the factors of `decompose`: what a unit impulse along each boxed row does."""
    size = span[UNKNOWNS] + span[ROWS_OF]
    first = STRIDE * span[DUAL_SIZE]
    for i in range(size):
        more[first + boxes * size + i] = right[i]
    at = first
    for k in range(joints):
        for r in range(rows_of(link, k)):
            push(link, hinge, local, node, k, r, size, right)
            back(
                what, hinge, link, joints, local, node, bodies, system, passes, span, matrix, right, more, pivots
            )  # fmt: skip
            for i in range(size):
                more[at + i] = right[i]
            at += size
    for i in range(size):
        right[i] = more[at + i]


@uncounted
def effort(system: int, fresh: bool, boxes: int, joints: int, span: IntArray) -> float:
    """About how many operations an iteration takes: rows, factors, solutions."""
    size, band = (span[DUAL_SIZE], span[DUAL_BAND]) if system == DUAL else (span[UNKNOWNS], span[BAND])
    turns = 1 + boxes if fresh else 1
    # Wide bands take several numbers at once.
    factors = (4.0 if system == WHOLE else 0.5 if band >= _WIDE else 2.0) * size * band * band
    return float(_ROWS_COST * joints + (factors if fresh else 0.0) + 6.0 * turns * size * (band + 4))


@uncounted
def solve(
    what: int, joint: FloatArray, hinge: FloatArray, link: IntArray, joints: int, local: FloatArray, node: IntArray,
    bodies: int, h: float, length: float, loops: bool, give: float, span: IntArray, matrix: FloatArray,
    right: FloatArray, more: FloatArray, pivots: IntArray, stiff: FloatArray, found: FloatArray,
) -> int:  # fmt: skip
    """Solve for `what` (see `scratch`) from the present LAM; the number of iterations, -1 if that fails.

    STEP: at convergence g is within 3e-16 of the island's size (or at round-off) of its targets, and the balance of
    momentum holds to round-off. Given up after 25 iterations, or 6 in which the error did not fall. Factors serve for
    as long as errors fall by _FALLS with them, the dual system where they do with fresh ones.
    LINEAR_STEP: one linear system. POSES: until g is on its targets, at most 8 times. SPEEDS: see `correct`; what was
    before stays at KEPT. These two take h = 2. found[2:5] are scratch; found[NEAR], of a STEP, is the error of g and of
    the balance that is near enough, if more than round-off: momentum is balanced all the same.
    """
    begin(what, joint, hinge, link, joints, local, node, bodies, h)
    best, last, stalls = 1e300, 1e300, 0
    if what == SPEEDS:
        keep(hinge, joints, local, bodies, found)
    system = DUAL if span[RIGID] > (1 if what in (STEP, LINEAR_STEP) else 0) else span[SYSTEM]
    lasting = what == STEP and not (system != DUAL and bounded_rows(link, joints))
    ready, fresh, since = False, False, 0
    boxes = boxed_rows(link, joints) if what in (STEP, LINEAR_STEP) else 0
    unscaled = what != STEP or hinge[0, SCALE] == 0.0  # rows have not been in this step yet
    for iteration in range(MOST_ITERATIONS + 1 if what == STEP else MOST_PASSES + 3 * joints):
        for i in range(span[UNKNOWNS] + span[ROWS_OF]):
            right[i] = 0.0
        build = not ready
        worst = assemble(
            what, joint, hinge, link, joints, local, node, bodies, h, give, unscaled and iteration == 0, system, build,
            span, matrix, right, stiff,
        )  # fmt: skip
        found[2] = worst
        if what not in (POSES, SPEEDS):
            worst = max(worst, balance(local, node, bodies, h, length, right))
        if what == STEP:
            floor = LASTING_ROUND_OFF if lasting else FLOOR if stalls > 1 else ROUND_OFF
            at_floor = iteration > since + 1 and worst > 0.5 * best and best < floor
            if iteration > 0 and (worst <= max(TOLERANCE, found[NEAR]) or at_floor):
                settle(local, bodies, h)
                return iteration
            # What began next to its solution has not far to fall.
            slow = not worst <= _FALLS * last and (iteration > 2 or not worst <= ROUND_OFF)
            if worst < best:
                best = worst
            elif iteration > since + 3:
                stalls += 1
            if not worst < 1e100 or stalls > 6 or iteration == MOST_ITERATIONS or found[EFFORT] > found[LIMIT]:
                return -1
            last = worst
            if ready and slow:
                ready = False
                if fresh:
                    # Hardly any step that is not nearly singular, or long, comes here: full Newton from now on.
                    lasting, system, since = False, span[SYSTEM], iteration
                    best, stalls = worst, 0
                    if loops:
                        for k in range(joints):
                            hinge[k, LAM] = hinge[k, LAM + 1] = 0.0
                        begin(what, joint, hinge, link, joints, local, node, bodies, h)
                        best = 1e300
        elif what == POSES and (worst <= 1e-14 or iteration == MOST_CLOSINGS):
            return iteration
        epsilon = 0.0
        if loops or what != STEP:
            epsilon = max(LEAST_EPSILON, min(1e-2, worst)) if what == STEP else LEAST_EPSILON
            if what == POSES:  # rows that contradict each other must not move bodies far
                epsilon = CLOSING_EPSILON
        fresh = not ready
        while not ready:
            if not build:
                for i in range(span[UNKNOWNS] + span[ROWS_OF]):
                    right[i] = 0.0
                assemble(
                    what, joint, hinge, link, joints, local, node, bodies, h, give, False, system, True, span, matrix,
                    right, stiff,
                )  # fmt: skip
                if what not in (POSES, SPEEDS):
                    balance(local, node, bodies, h, length, right)
            if decompose(
                what, hinge, link, joints, local, node, bodies, system, epsilon, give, span, matrix, more, pivots
            ):  # fmt: skip
                ready = True
            elif system == DUAL:
                system, build = span[SYSTEM], False
            else:
                return -1
        if system == DUAL and not fresh:
            refresh(hinge, link, joints, local, node, SLOPES if what == STEP else ROWS)
        passes = 1 if give > 0.0 or not fresh else PASSES - 1 if lasting else PASSES
        found[EFFORT] += effort(system, fresh, boxes, joints, span)
        if boxes > 0 and fresh:
            answer_boxes(
                what, hinge, link, joints, local, node, bodies, system, passes, boxes, span, matrix, right, more,
                pivots,
            )  # fmt: skip
        back(
            what, hinge, link, joints, local, node, bodies, system, passes, span, matrix, right, more, pivots
        )  # fmt: skip
        if boxes > 0:
            bound_impulses(link, hinge, local, node, joints, boxes, h, fresh, span, right, more)
        ready = lasting
        apply(what, link, hinge, joints, local, node, bodies, right)
        if what in (POSES, SPEEDS):
            if what == SPEEDS and not goes_on(joint, hinge, link, joints, local, bodies, found):
                return iteration
            begin(what, joint, hinge, link, joints, local, node, bodies, h)
            continue
        move(local, bodies, h)
        if what == LINEAR_STEP:
            for i in range(bodies):
                for c in range(3):
                    if not abs(local[i, AFTER + c]) < 1e100:
                        return -1
            for k in range(joints):
                for c in range(6 if link[k, L_ROWS] > 0 else 0):
                    hinge[k, FORCE + c] = 0.0
                    for r in range(link[k, L_ROWS]):
                        hinge[k, FORCE + c] += hinge[k, LAM + r] * hinge[k, ROWS + 6 * r + c]
            return 0
    return -1
