"""The bounded solve of an island: sweeps alone in large moving islands; else sweeps and direct solves in turn.

Sweeps pass a stack's weight to its floor slowly; a direct solve does it at once, as soon as sweeps have found the
active contacts. In disordered moving piles these change with every step, and sweeps alone cost less. Where neither
converges, as with light bodies wedged between heavy ones, few contacts are solved by homotopies (`..rows.laws`), and
direct solves are left out for some steps.

The state of an island lasts across steps (`Rest.augmentation`, `wait`, `backoff`): log10 of the augmentation R, solves
without direct ones before the next that has some, and their number after its next failure.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel
from ..model.bodies import Rest
from ..model.contacts import Problem, Solved
from ..model.parameters import intervals
from ..model.parameters.impulses import REFINED_AUGMENTATION, REFINEMENTS_INTERVAL
from ..rows.conjugate import sweep_conjugate
from ..rows.direct import refine_and_sweep
from ..rows.laws import solve_few, solved_exactly
from ..rows.sweeps import sweep


@kernel
def relax(
    problem: Problem, L: FloatArray, V: FloatArray, FREE: FloatArray, rounds: int, fine: float, coarse: float,
    rest: Rest, most: int, out: Solved,
) -> float:  # fmt: skip
    """Solve a contact problem from the initial impulses L (m, 2) and velocities V (k, 3), which are replaced.

    Args:
        FREE: (k, 3) velocities without impulses.
        rounds: largest number of direct solves; 0 for a large moving island.
        fine: change of velocity in a sweep at which the solve ends.
        coarse: that with which a moving island is content, or one near rest after a direct solve.
        rest: of the island, changed.
        most: largest number of sweeps of a large island that moves, or waits for its next direct solve.
        out: numbers of sweeps and direct solves, and operations of homotopies, are added.

    Returns:
        The change of velocity in the last sweep.
    """
    few, waits = solved_exactly(problem.n, problem.m), rest.wait > 0.0
    if rounds == 0 or waits:
        rest.wait = max(rest.wait - 1.0, 0.0)
    if rounds == 0 or (waits and not few):
        sweeps, worst = sweep_conjugate(problem, L, V, max(fine, coarse), most)
        out.sweeps += sweeps
        return worst
    sweeps, worst = 0, np.inf
    while sweeps < intervals.FIRST_SWEEPS and worst > fine:
        worst = sweep(problem, L, V)
        sweeps += 1
    out.sweeps += sweeps
    if worst <= fine:
        return worst
    fails, done, last = 0, 0, worst
    while done < rounds and not waits:
        passes = REFINEMENTS_INTERVAL if rest.augmentation > REFINED_AUGMENTATION else 1
        rest.augmentation, worst, taken = refine_and_sweep(
            problem, L, V, FREE, rest.augmentation, passes, fine, worst, intervals.SWEEPS_AFTER
        )  # fmt: skip
        done += 1
        out.sweeps += taken
        if worst <= max(fine, coarse):
            break
        if worst > intervals.DIRECT_PROGRESS * last:
            fails += 1
        last = worst
        if fails >= (intervals.FAILED_DIRECT_AGAIN if few or rest.backoff > 0.0 else intervals.FAILED_DIRECT):
            break
    out.direct += done
    failed = worst > max(fine, coarse)
    if failed and few:
        worst = solve_few(problem, L, V, max(fine, coarse), out)
    if not waits:
        rest.backoff = min(2.0 * rest.backoff + 2.0, intervals.LONGEST_BACKOFF) if failed else 0.0
        rest.wait = rest.backoff
    return worst
