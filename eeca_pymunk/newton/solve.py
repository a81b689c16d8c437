"""The implicit step of a component by Newton's iteration, and the step by one linear system.

`epsilon` on the diagonal of the impulses makes redundant rows solvable. It acts on increments only, so the solution
does not depend on it.
"""

from __future__ import annotations

from math import inf

from ..compiled import nonallocating
from ..model.joint_steps import LINEAR_STEP, STEP, Newton
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

OLD, NEW, FULL = 0, 1, 2  # factors of an iteration


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
def round_off_of_impulses(W: Workspace, h: float, extent: float) -> float:
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
            worst = max(worst, way / extent if c < 2 else way)
    return SPACING * worst


@nonallocating
def is_round_off(N: Newton, sure: bool) -> bool:
    """Whether the error of a solve is round-off. sure: whether no rows are redundant, whose impulses leave more."""
    floor = JOINT_ROUND_OFF_KEPT if N.factors != FULL else NEWTON_FLOOR if N.stalls > 1 else JOINT_ROUND_OFF
    served_twice = N.iteration > N.since + 1
    falls_no_more = served_twice and 0.5 * N.least < N.error < floor
    return falls_no_more or (sure and N.error < JOINT_ROUND_OFF and N.last * N.pace <= JOINT_TOLERANCE)


@nonallocating
def accept(W: Workspace, h: float, current: bool) -> None:
    """End a solve that has converged; its factors are kept if they are `current`."""
    system = W.J.NEWTON.system
    # A wide matrix is expensive to factor: the parts of a step share one while errors fall with it.
    W.J.COMPONENT[W.s].factored = 1 if current and system == CONDENSED else 0
    W.J.PROGRESS.factors_of, W.J.TALLY.answers = W.s + 1 if current else 0, system
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
def begin_solve(W: Workspace) -> None:
    """The record of a solve before its first iteration, with the factors that the component has."""
    N, component = W.J.NEWTON, W.J.COMPONENT[W.s]
    N.factors = OLD if component.factored > 0 else NEW
    N.system = W.J.TALLY.answers if N.factors == OLD else first_system(component, STEP)
    component.factored = W.J.PROGRESS.factors_of = 0
    N.least = N.last = inf
    N.pace, N.stalls, N.since, N.renewed = 1.0, 0, 0, 0


@nonallocating
def note_error(N: Newton) -> None:
    """Note an error that is not the last one: whether it is a stall, and by which factor it has changed."""
    if N.iteration > N.since + 3 and not N.error < (0.5 * N.last if N.error < NEWTON_FLOOR else N.least):
        N.stalls += 1
    N.least, N.pace = min(N.least, N.error), N.error / N.last if N.iteration > N.since else 1.0
    N.last = N.error


@nonallocating
def choose_factors(W: Workspace, h: float, slow: bool, current: bool, redundant: bool) -> None:
    """The factors of an iteration by the table of `solve`."""
    N = W.J.NEWTON
    if N.factors != OLD or not (slow or not current):
        return
    N.factors = FULL if N.renewed > 0 and current else NEW
    if N.factors == FULL:  # only nearly singular or long steps come here
        N.system, N.since, N.stalls, N.least, N.pace = W.J.COMPONENT[W.s].system, N.iteration, 0, N.error, 1.0
        if redundant:
            drop_impulses(W)
            first_iterate(W, STEP, h)
            N.least = inf


@nonallocating
def solve(W: Workspace, h: float, extent: float, redundant: bool, give: float) -> bool:
    """Solve the implicit step h of a component of size `extent` from the present `lam` and `lead`, for v1 and `lam`.

    At convergence g is within JOINT_TOLERANCE of that size (or at round-off) of its targets, or within PROGRESS.near if
    that is more, and the balance of momentum holds to round-off. False without convergence after NEWTON_ITERATIONS, at
    the work PROGRESS.limit, or after more than 6 `stalls`: iterations whose error is no smaller than the least so far,
    or, below NEWTON_FLOOR, than half of the last one. After two stalls an error below NEWTON_FLOOR counts as round-off,
    which is that large for bodies in line; one below JOINT_ROUND_OFF does if at the `pace` of the iteration before it
    would be less than JOINT_TOLERANCE: round-off of stiff springs is larger. The factors of an iteration:

    | `factors` | are | of the next iteration |
    |---|---|---|
    | OLD | those of an earlier iteration, or part of the step | OLD; NEW if these are `slow` or not `current` |
    | NEW | computed now | OLD; FULL if these are `slow` |
    | FULL | computed now, of `component.system` | FULL |

    It begins OLD if the component has factors, else NEW. They are `current` while no bounded impulse reaches or leaves
    its bound, or slides along that of a disc. Entering FULL, redundant rows begin again without impulses.

    Impulses of elastic joints that contradict one another are as large as they are stiff, and cancel but for round-off:
    at this error the solve ends, and it fails if that is more than ELASTIC_ROUND_OFF, as joints have to be softer.

    Args:
        redundant: whether rows may be, and begin without impulses.  give: compliance over h², see `systems`.
    """
    N, component, progress = W.J.NEWTON, W.J.COMPONENT[W.s], W.J.PROGRESS
    first_iterate(W, STEP, h)
    begin_solve(W)
    sure = component.dependence != DEPENDENT
    for iteration in range(NEWTON_ITERATIONS + 1):
        built = N.factors != OLD
        N.iteration, N.error = iteration, linearise(W, STEP, h, extent, give, False, N.system, built)
        current = N.factors == OLD and component.factored != OTHERWISE
        left = round_off_of_impulses(W, h, extent) if give > 0.0 and iteration > 1 else 0.0
        if N.error <= left and left > ELASTIC_ROUND_OFF:
            return False
        if iteration > 0 and (N.error <= max(JOINT_TOLERANCE, progress.near, left) or is_round_off(N, sure)):
            accept(W, h, current)
            return True
        # Next to the solution errors cannot fall by much.
        slow = not N.error <= NEWTON_PROGRESS * N.last and (iteration > 2 or not N.error <= JOINT_ROUND_OFF)
        note_error(N)
        if not N.error < 1e100 or N.stalls > 6 or iteration == NEWTON_ITERATIONS or progress.effort > progress.limit:
            return False
        choose_factors(W, h, slow, current, redundant)
        component.factored = 0
        if N.factors != OLD:
            if not built:
                linearise(W, STEP, h, extent, give, False, N.system, True)
            N.system = factorise(W, STEP, h, extent, give, N.system, epsilon_for(W, redundant, give, N.error))
            if N.system < 0:
                return False
        elif N.system == DUAL:
            refresh(W)
        passes = CONDENSED_PASSES if N.factors == FULL and not give > 0.0 else 1
        iterate(W, STEP, N.system, passes, h)
        N.renewed, N.factors = int(N.factors == NEW), FULL if N.factors == FULL else OLD
    return False


@nonallocating
def solve_linearly(W: Workspace, h: float, extent: float) -> bool:
    """Solve the step h by one linear system, for v1, `lam` and `force`: the rows of the start hold for the mean
    velocity, J x = 0, and springs are linearised about the start. False if the system has no solution."""
    hinge, link, local, component = W.J.HINGE, W.link, W.J.LOCAL, W.J.COMPONENT[W.s]
    for _ in range(BOUNDED_SOLVES):  # bounded rows hold; then those that were beyond a bound are at it
        first_iterate(W, LINEAR_STEP, h)
        system = first_system(component, LINEAR_STEP)
        linearise(W, LINEAR_STEP, h, extent, 0.0, True, system, True)
        system = factorise(W, LINEAR_STEP, h, extent, 0.0, system, REDUNDANT_EPSILON)
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
