"""The implicit step of a component by Newton's iteration, and the step by one linear system.

`epsilon` on the diagonal of the impulses makes redundant rows solvable. It acts on increments only, so the solution
does not depend on it.
"""

from __future__ import annotations

from math import inf

from ..compiled import nonallocating
from ..model.joint_steps import LINEAR_STEP, STEP
from ..model.joints import CONDENSED, DEPENDENT, DUAL, OTHERWISE, Workspace
from ..model.parameters.joints import (
    BOUNDED_SOLVES,
    CONDENSED_PASSES,
    ELASTIC_ROUND_OFF,
    JOINT_ROUND_OFF,
    JOINT_ROUND_OFF_KEPT,
    JOINT_TOLERANCE,
    NEWTON_FLOOR,
    NEWTON_ITERATIONS,
    NEWTON_PROGRESS,
    REDUNDANT_EPSILON,
    SPACING,
)
from .dual import refresh
from .motion import balance_velocities, move
from .saturation import clamp
from .systems import apply, back, factorise, first_iterate, first_system, linearise

KEPT, NEW, FULL = 0, 1, 2  # factors of an iteration


@nonallocating
def drop_impulses(W: Workspace) -> None:
    """Set the impulses with which iterations begin to 0."""
    for k in range(W.joints):
        W.J.HINGE[k].lam[0] = W.J.HINGE[k].lam[1] = 0.0


@nonallocating
def iterate(W: Workspace, what: int, system: int, passes: int, h: float) -> None:
    """Solve the system for the right side with its factors, and change velocities and impulses by the solution.
    passes: of `condensed`."""
    back(W, system, passes, W.J.RIGHT)
    apply(W, what)
    move(W.J.LOCAL, W.bodies, h)


@nonallocating
def round_off_of_impulses(W: Workspace, h: float, length: float) -> float:
    """The round-off that the impulses of all joints leave in the balance of momentum, as `systems.balance` measures it:
    the way in h that the sum of their magnitudes would move a body, times the spacing of numbers; the largest one."""
    local, hinge, link, worst = W.J.LOCAL, W.J.HINGE, W.link, 0.0
    for i in range(W.bodies):
        for c in range(local[i].freedoms):
            total = 0.0
            one = local[i].first
            while one >= 0:
                k, end = one >> 1, one & 1
                for r in range(link[k].rows):
                    total += abs(hinge[k].lam[r] * hinge[k].rows[r, 3 * end + c])
                one = link[k].following[end]
            way = total * local[i].mobility[c] * abs(h)
            worst = max(worst, way / length if c < 2 else way)
    return SPACING * worst


@nonallocating
def is_round_off(worst: float, best: float, last: float, pace: float, floor: float, settled: bool, sure: bool) -> bool:
    """Whether an error of an iteration is round-off.

    Args:
        worst: the error.  best, last: the least before, and that of the last iteration, which was `pace` times that of
            the one before.  floor: below which errors that do not fall are.
        settled: whether these factors have served two iterations.  sure: whether no rows are redundant, whose impulses
            leave more round-off.
    """
    falls_no_more = settled and 0.5 * best < worst < floor
    return falls_no_more or (sure and worst < JOINT_ROUND_OFF and last * pace <= JOINT_TOLERANCE)


@nonallocating
def accept(W: Workspace, h: float, fit: bool, system: int) -> None:
    """End a solve that has converged; its factors are kept if they `fit`."""
    # A wide matrix is expensive to factor: the parts of a step share one while errors fall with it.
    W.J.COMPONENT[W.s].factored = 1 if fit and system == CONDENSED else 0
    W.J.PROGRESS.kept, W.J.TALLY.answers = W.s + 1 if fit else 0, system
    clamp(W, h)
    balance_velocities(W, h)


@nonallocating
def epsilon_for(W: Workspace, redundant: bool, give: float, worst: float) -> float:
    """`epsilon` of an iteration with this error: compliance makes rows independent, and a term beside it would divide
    errors only by 1 + give/epsilon."""
    if not redundant or give > 0.0:
        return 0.0
    return float(max(REDUNDANT_EPSILON, min(W.J.PROGRESS.most_epsilon, worst)))


@nonallocating
def solve(W: Workspace, h: float, length: float, redundant: bool, give: float) -> bool:
    """Solve the implicit step h of a component of size `length` from the present `lam` and `lead`, for v1 and `lam`.

    At convergence g is within JOINT_TOLERANCE of that size (or at round-off) of its targets, or within PROGRESS.near if
    that is more, and the balance of momentum holds to round-off. False without convergence after NEWTON_ITERATIONS, at
    the work PROGRESS.limit, or after more than 6 `stalls`: iterations whose error is no smaller than the least so far,
    or, below NEWTON_FLOOR, than half of the last one. After two stalls an error below NEWTON_FLOOR counts as round-off,
    which is that large for bodies in line; one below JOINT_ROUND_OFF does if at the `pace` of the iteration before it
    would be less than JOINT_TOLERANCE: round-off of stiff springs is larger. The factors of an iteration:

    | `factors` | are | of the next iteration |
    |---|---|---|
    | KEPT | those of an earlier iteration, or part of the step | KEPT; NEW if these are `slow` or do not `fit` |
    | NEW | computed now | KEPT; FULL if these are `slow` |
    | FULL | computed now, of `component.system` | FULL |

    It begins KEPT if the component has factors, else NEW. They `fit` while no bounded impulse reaches or leaves its
    bound, or slides along that of a disc. Entering FULL, redundant rows begin again without impulses.

    Impulses of elastic joints that contradict one another are as large as they are stiff, and cancel but for round-off:
    at this error the solve ends, and it fails if that is more than ELASTIC_ROUND_OFF, as joints have to be softer.

    Args:
        redundant: whether rows may be, and begin without impulses.  give: compliance over h², see `systems`.
    """
    component, progress = W.J.COMPONENT[W.s], W.J.PROGRESS
    first_iterate(W, STEP, h)
    factors = KEPT if component.factored > 0 else NEW
    system = W.J.TALLY.answers if factors == KEPT else first_system(component, STEP)
    component.factored = progress.kept = 0
    # since: iteration in which the solve has begun again, with FULL.  renewed: whether the last iteration was NEW.
    # pace: by which factor the last iteration has made the error smaller.
    best, last, pace, stalls, since, renewed = inf, inf, 1.0, 0, 0, False
    sure = component.dependence != DEPENDENT
    for iteration in range(NEWTON_ITERATIONS + 1):
        built = factors != KEPT
        worst = linearise(W, STEP, h, length, give, False, system, built)
        fit = factors == KEPT and component.factored != OTHERWISE
        floor = JOINT_ROUND_OFF_KEPT if factors != FULL else NEWTON_FLOOR if stalls > 1 else JOINT_ROUND_OFF
        at_floor = is_round_off(worst, best, last, pace, floor, iteration > since + 1, sure)
        # Next to the solution errors cannot fall by much.
        slow = not worst <= NEWTON_PROGRESS * last and (iteration > 2 or not worst <= JOINT_ROUND_OFF)
        if give > 0.0 and iteration > 1:
            left = round_off_of_impulses(W, h, length)
            if worst <= left and left > ELASTIC_ROUND_OFF:
                return False
            at_floor = at_floor or worst <= left
        if iteration > 0 and (worst <= max(JOINT_TOLERANCE, progress.near) or at_floor):
            accept(W, h, fit, system)
            return True
        if iteration > since + 3 and not worst < (0.5 * last if worst < NEWTON_FLOOR else best):
            stalls += 1
        best = min(best, worst)
        if not worst < 1e100 or stalls > 6 or iteration == NEWTON_ITERATIONS or progress.effort > progress.limit:
            return False
        last, pace = worst, worst / last if iteration > since else 1.0
        if factors == KEPT and (slow or not fit):
            factors = FULL if renewed and fit else NEW
            if factors == FULL:  # only nearly singular or long steps come here
                system, since, stalls, best, pace = component.system, iteration, 0, worst, 1.0
                if redundant:
                    drop_impulses(W)
                    first_iterate(W, STEP, h)
                    best = inf
        component.factored = 0
        if factors != KEPT:
            if not built:
                linearise(W, STEP, h, length, give, False, system, True)
            system = factorise(W, STEP, h, length, give, system, epsilon_for(W, redundant, give, worst))
            if system < 0:
                return False
        elif system == DUAL:
            refresh(W)
        passes = CONDENSED_PASSES if factors == FULL and not give > 0.0 else 1
        iterate(W, STEP, system, passes, h)
        renewed, factors = factors == NEW, FULL if factors == FULL else KEPT
    return False


@nonallocating
def solve_linearly(W: Workspace, h: float, length: float) -> bool:
    """Solve the step h by one linear system, for v1, `lam` and `force`: the rows of the start hold for the mean
    velocity, J x = 0, and springs are linearised about the start. False if the system has no solution."""
    hinge, link, local, component = W.J.HINGE, W.link, W.J.LOCAL, W.J.COMPONENT[W.s]
    for _ in range(BOUNDED_SOLVES):  # bounded rows hold; then those that were beyond a bound are at it
        first_iterate(W, LINEAR_STEP, h)
        system = first_system(component, LINEAR_STEP)
        linearise(W, LINEAR_STEP, h, length, 0.0, True, system, True)
        system = factorise(W, LINEAR_STEP, h, length, 0.0, system, REDUNDANT_EPSILON)
        if system < 0:
            return False
        iterate(W, LINEAR_STEP, system, CONDENSED_PASSES, h)
        if not clamp(W, h):
            break
    component.factored = 0
    for i in range(W.bodies):
        for c in range(3):
            if not abs(local[i].v1[c]) < 1e100:
                return False
    for k in range(W.joints):
        for c in range(6 if link[k].rows > 0 else 0):
            hinge[k].force[c] = 0.0
            for r in range(link[k].rows):
                hinge[k].force[c] += hinge[k].lam[r] * hinge[k].rows[r, c]
    return True
