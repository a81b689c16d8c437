"""Whether the rows of a component with cycles of joints depend on one another, at the poses of the step's start.

The linkages of machines and rings of bodies have cycles, and most of them no redundant row: their impulses are unique,
and a step begins with those of the last one. Impulses of redundant rows are not, and begin anew (`..newton.solve`).
"""

from __future__ import annotations

from ..compiled import nonallocating
from ..model.joint_steps import SPEEDS
from ..model.joints import DUAL, Workspace
from ..model.parameters.joints import CONDENSED_PASSES, NEWTON_ITERATIONS, TRY_WORK
from ..newton.dual import are_independent, factor_dual
from ..newton.effort import work_of_iteration
from ..newton.systems import assemble, first_iterate


@nonallocating
def affords_try(W: Workspace) -> bool:
    """Whether a step's work pays for a solution with the impulses of the last step that fails, as of wide nets that are
    folded: all its iterations take less than TRY_WORK of it."""
    component = W.J.COMPONENT[W.s]
    one = work_of_iteration(component.system, CONDENSED_PASSES, W.joints, component)
    return bool(NEWTON_ITERATIONS * one <= TRY_WORK * W.J.PROGRESS.budget)


@nonallocating
def rows_depend(W: Workspace) -> bool:
    """Whether rows that act depend on one another, or nearly so (`..newton.dual.are_independent`)."""
    first_iterate(W, SPEEDS, 2.0)
    assemble(W, SPEEDS, 2.0, 0.0, True, DUAL, True)
    independent = factor_dual(W, False, 0.0) and are_independent(W)
    for k in range(W.joints):
        W.J.HINGE[k].scale[0] = 0.0  # a step scales rows by its first iterate
    return not independent
