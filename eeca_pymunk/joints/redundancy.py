"""Whether the rows of a component with cycles of joints depend on one another, at the poses of the step's start.

The linkages of machines and rings of bodies have cycles, and most of them no redundant row: their impulses are unique,
and a step begins with those of the last one. Impulses of redundant rows are not, and begin anew (`..newton.solve`).
"""

from __future__ import annotations

from ..compiled import nonallocating
from ..model.joint_steps import SPEEDS
from ..model.joints import DUAL, Workspace
from ..newton.dual import are_independent, factor_dual
from ..newton.systems import assemble, first_iterate


@nonallocating
def rows_depend(W: Workspace) -> bool:
    """Whether rows that act depend on one another, or nearly so (`..newton.dual.are_independent`)."""
    first_iterate(W, SPEEDS, 2.0)
    assemble(W, SPEEDS, 2.0, 0.0, True, DUAL, True)
    independent = factor_dual(W, False, 0.0) and are_independent(W)
    for k in range(W.joints):
        W.J.HINGE[k].scale[0] = 0.0  # a step scales rows by its first iterate
    return not independent
