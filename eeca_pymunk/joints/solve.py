"""The implicit step of an island by Newton's iteration; the linear step that always succeeds; corrections.

Arguments that choose are never constants in calls (`int(POSES)`): numba would compile the whole anew for each.
`epsilon` on the impulses' block takes redundant rows: it acts on increments alone, so what is solved stays the same.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import inlined, nonallocating
from ..compiled.records import Rows
from ..model.joint_steps import LINEAR_STEP, POSES, SPEEDS, STEP
from ..model.joints import BOUNDED, CONDENSED, DUAL, WHOLE, Component, Coupling, Workspace
from ..model.parameters.joints import (
    CLOSING_EPSILON,
    CLOSINGS,
    CONDENSED_PASSES,
    FACTOR_BAND,
    JOINT_ROUND_OFF,
    JOINT_ROUND_OFF_KEPT,
    JOINT_TOLERANCE,
    NEWTON_FLOOR,
    NEWTON_ITERATIONS,
    NEWTON_PROGRESS,
    REDUNDANT_EPSILON,
    REDUNDANT_PASSES,
    ROW_WORK,
)
from .banded import back_banded, factor_banded
from .boxes import bound_impulses, boxed_rows, push, rows_of
from .condensed import back_condensed, factor
from .correct import goes_on, keep
from .dual import STRIDE, back_dual, factor_dual, refresh
from .motion import move, settle
from .newton import assemble
from .rows import start_joint


@inlined
def begin(W: Workspace, what: int, h: float) -> None:
    """What stays the same over the iterations, and the first iterate: motion with the accelerations that joints gave
    before (`lead`), or no motion where joints act."""
    local = W.J.LOCAL
    for k in range(W.joints):
        start_joint(W, k, h)
    for i in range(W.bodies):
        for c in range(3):
            local[i].v1[c] = local[i].v0[c] + h * (local[i].acceleration[c] + local[i].lead[c])
            if what in (POSES, SPEEDS) or (what == LINEAR_STEP and c < local[i].freedoms):
                local[i].v1[c] = -local[i].v0[c]
    move(local, W.bodies, h)


@inlined
def balance(W: Workspace, h: float, length: float) -> float:
    """Residuals of the balance of momentum, scaled, into `right`; the worst as a way, over length or as an angle."""
    local = W.J.LOCAL
    worst, over = 0.0, 1.0 / length
    for i in range(W.bodies):
        for c in range(local[i].freedoms):
            mobility = local[i].mobility[c]
            off = local[i].v1[c] - local[i].v0[c] - h * local[i].acceleration[c] - mobility * local[i].impulse[c]
            W.J.RIGHT[local[i].column + c] = -off * local[i].unroot[c]
            worst = max(worst, abs(off * h) * (over if c < 2 else 1.0))
    return worst


@inlined
def apply(W: Workspace, what: int) -> None:
    """Add the solution of a scaled system to what was solved for, and to impulses."""
    local = W.J.LOCAL
    for i in range(W.bodies):
        for c in range(local[i].freedoms):
            changed = local[i].pose if what == POSES else local[i].v0 if what == SPEEDS else local[i].v1
            changed[c] += W.J.RIGHT[local[i].column + c] * local[i].root[c]
        if what == POSES:
            local[i].cos, local[i].sin = np.cos(local[i].pose[2]), np.sin(local[i].pose[2])
    for k in range(W.joints):
        for r in range(W.link[k].rows):
            impulse = W.J.HINGE[k].pushed if what in (POSES, SPEEDS) else W.J.HINGE[k].lam
            impulse[r] += W.J.RIGHT[W.link[k].first_row + r] * W.J.HINGE[k].scale[r]


@inlined
def decompose(W: Workspace, what: int, system: int, epsilon: float, give: float) -> bool:
    """Factors in the place of what `assemble` has built, with `epsilon` on the rows' block; False if there are none.
    `more` is scratch, as in `back`."""
    matrix = W.J.MATRIX
    size, band = W.J.COMPONENT[W.s].unknowns, W.J.COMPONENT[W.s].band
    if system == CONDENSED:
        return factor(matrix, size, band)
    if system == DUAL:
        return factor_dual(W, what == STEP, epsilon + give)
    if epsilon > 0.0:
        for k in range(W.joints):
            for r in range(W.link[k].rows):
                matrix[(W.link[k].first_row + r) * (3 * band + 1) + band] += epsilon
    return factor_banded(matrix, size, band, W.J.PIVOTS)


@inlined
def back(W: Workspace, what: int, system: int, passes: int, right: FloatArray) -> None:
    """Solve with the factors of `decompose` in place of `right`: changes of velocities, and of impulses. `more` is
    scratch, see `plan.Room`."""
    size, band = W.J.COMPONENT[W.s].unknowns, W.J.COMPONENT[W.s].band
    if system == CONDENSED:
        back_condensed(W, passes, size, band, W.J.MATRIX, right, len(right) - size)
    elif system == DUAL:
        back_dual(W, right)
    else:
        back_banded(W.J.MATRIX, size, band, W.J.PIVOTS, right)


@nonallocating
def bounded_rows(link: Rows[Coupling], joints: int) -> bool:
    """Whether any joint has bounded rows in the matrix."""
    count = 0
    for k in range(joints):
        count += 1 if link[k].soft == BOUNDED else 0
    return count > 0


@nonallocating
def answer_boxes(W: Workspace, what: int, system: int, passes: int, boxes: int) -> None:
    """Columns of `boxes`, with the factors of `decompose`: what a unit impulse along each boxed row does."""
    component, right, more = W.J.COMPONENT[W.s], W.J.RIGHT, W.J.MORE
    size = component.unknowns + component.impulses
    first = STRIDE * component.dual_size
    for i in range(size):
        more[first + boxes * size + i] = right[i]
    at = first
    for k in range(W.joints):
        for r in range(rows_of(W.link, k)):
            push(W.link, W.J.HINGE, W.J.LOCAL, k, r, size, right)
            back(W, what, system, passes, right)
            for i in range(size):
                more[at + i] = right[i]
            at += size
    for i in range(size):
        right[i] = more[at + i]


@nonallocating
def effort(system: int, fresh: bool, boxes: int, joints: int, component: Component) -> float:
    """About how many operations an iteration takes: rows, factors, solutions."""
    size, band = (component.dual_size, component.dual_band) if system == DUAL else (component.unknowns, component.band)
    turns = 1 + boxes if fresh else 1
    # Wide bands take several numbers at once.
    factors = (4.0 if system == WHOLE else 0.5 if band >= FACTOR_BAND else 2.0) * size * band * band
    return float(ROW_WORK * joints + (factors if fresh else 0.0) + 6.0 * turns * size * (band + 4))


@nonallocating
def solve(W: Workspace, what: int, h: float, length: float, loops: bool, give: float) -> int:
    """Solve for `what` (see `..model.joints`) from the present `lam`; the number of iterations, -1 if that fails.

    STEP: at convergence g is within 3e-16 of the island's size (or at round-off) of its targets, and the balance of
    momentum holds to round-off. Given up after 25 iterations, or 6 in which the error did not fall. Factors serve for
    as long as errors fall by NEWTON_PROGRESS with them, the dual system where they do with fresh ones. LINEAR_STEP: one
    linear system. POSES: until g is on its targets, at most 8 times. SPEEDS: see `correct`; what was before stays at
    `v_kept`. These two take h = 2. PROGRESS.near, of a STEP, is the error of g and of the balance that is near enough,
    if more than round-off: momentum is balanced all the same.
    """
    hinge, link, local, component, right, progress = (
        W.J.HINGE,
        W.link,
        W.J.LOCAL,
        W.J.COMPONENT[W.s],
        W.J.RIGHT,
        W.J.PROGRESS,
    )
    begin(W, what, h)
    best, last, stalls = 1e300, 1e300, 0
    if what == SPEEDS:
        keep(W)
    system = DUAL if component.rigid > (1 if what in (STEP, LINEAR_STEP) else 0) else component.system
    lasting = what == STEP and not (system != DUAL and bounded_rows(link, W.joints))
    # A wide matrix is dear to factor: the parts of a step have one, while errors fall with it.
    ready, fresh, since = lasting and component.factored > 0, False, 0
    component.factored = 0
    boxes = boxed_rows(link, W.joints) if what in (STEP, LINEAR_STEP) else 0
    unscaled = what != STEP or hinge[0].scale[0] == 0.0  # rows have not been in this step yet
    for iteration in range(NEWTON_ITERATIONS + 1 if what == STEP else REDUNDANT_PASSES + 3 * W.joints):
        for i in range(component.unknowns + component.impulses):
            right[i] = 0.0
        build = not ready
        worst = assemble(W, what, h, give, unscaled and iteration == 0, system, build)
        progress.error = worst
        if what not in (POSES, SPEEDS):
            worst = max(worst, balance(W, h, length))
        if what == STEP:
            floor = JOINT_ROUND_OFF_KEPT if lasting else NEWTON_FLOOR if stalls > 1 else JOINT_ROUND_OFF
            at_floor = iteration > since + 1 and worst > 0.5 * best and best < floor
            if iteration > 0 and (worst <= max(JOINT_TOLERANCE, progress.near) or at_floor):
                component.factored = 1 if ready and system == CONDENSED and boxes == 0 else 0
                settle(local, W.bodies, h)
                return iteration
            # What began next to its solution has not far to fall.
            slow = not worst <= NEWTON_PROGRESS * last and (iteration > 2 or not worst <= JOINT_ROUND_OFF)
            if worst < best:
                best = worst
            elif iteration > since + 3:
                stalls += 1
            if not worst < 1e100 or stalls > 6 or iteration == NEWTON_ITERATIONS or progress.effort > progress.limit:
                return -1
            last = worst
            if ready and slow:
                ready = False
                if fresh:
                    # Hardly any step that is not nearly singular, or long, comes here: full Newton from now on.
                    lasting, system, since = False, component.system, iteration
                    best, stalls = worst, 0
                    if loops:
                        for k in range(W.joints):
                            hinge[k].lam[0] = hinge[k].lam[1] = 0.0
                        begin(W, what, h)
                        best = 1e300
        elif what == POSES and (worst <= 1e-14 or iteration == CLOSINGS):
            return iteration
        epsilon = 0.0
        if loops or what != STEP:
            epsilon = max(REDUNDANT_EPSILON, min(1e-2, worst)) if what == STEP else REDUNDANT_EPSILON
            if what == POSES:  # rows that contradict each other must not move bodies far
                epsilon = CLOSING_EPSILON
        fresh = not ready
        while not ready:
            if not build:
                for i in range(component.unknowns + component.impulses):
                    right[i] = 0.0
                assemble(W, what, h, give, False, system, True)
                if what not in (POSES, SPEEDS):
                    balance(W, h, length)
            if decompose(W, what, system, epsilon, give):  # fmt: skip
                ready = True
            elif system == DUAL:
                system, build = component.system, False
            else:
                return -1
        if system == DUAL and not fresh:
            refresh(W, what == STEP)
        passes = 1 if give > 0.0 or not fresh else CONDENSED_PASSES - 1 if lasting else CONDENSED_PASSES
        progress.effort += effort(system, fresh, boxes, W.joints, component)
        if boxes > 0 and fresh:
            answer_boxes(W, what, system, passes, boxes)
        back(W, what, system, passes, right)
        if boxes > 0:
            bound_impulses(W, boxes, h, fresh)
        ready = lasting
        apply(W, what)
        if what in (POSES, SPEEDS):
            if what == SPEEDS and not goes_on(W):
                return iteration
            begin(W, what, h)
            continue
        move(local, W.bodies, h)
        if what == LINEAR_STEP:
            for i in range(W.bodies):
                for c in range(3):
                    if not abs(local[i].v1[c]) < 1e100:
                        return -1
            for k in range(W.joints):
                for c in range(6 if link[k].rows > 0 else 0):
                    hinge[k].force[c] = 0.0
                    for r in range(link[k].rows):
                        hinge[k].force[c] += hinge[k].lam[r] * hinge[k].rows[r, c]
            return 0
    return -1
