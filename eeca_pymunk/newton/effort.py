"""Number of operations of the parts of an iteration, for the budget of a step; each part adds its own where it is
computed (`systems`)."""

from __future__ import annotations

from ..compiled import inlined
from ..model.joint_steps import Progress
from ..model.joints import CONDENSED, DUAL, WHOLE, Component
from ..model.parameters.events import RESOLUTION
from ..model.parameters.joints import BACK_WORK, FACTOR_BAND, FACTOR_WORK, REFINEMENT_WORK, ROW_WORK


@inlined
def work_of_rows(joints: int) -> float:
    """Operations of the rows of so many joints, and of the balance of their bodies."""
    return ROW_WORK * (joints + 1)


@inlined
def work_of_factors(system: int, component: Component) -> float:
    """Operations to factor a system."""
    size, band = (component.dual_size, component.dual_band) if system == DUAL else (component.unknowns, component.band)
    if system == WHOLE:  # in whose bands most entries are 0
        return float(0.5 * size * (FACTOR_WORK + 0.5 * band * band))
    # Wide bands are factored several numbers at a time.
    each = 0.5 if band >= FACTOR_BAND else 2.0
    return float(size * (FACTOR_WORK + each * band * band))


@inlined
def work_of_solution(system: int, passes: int, joints: int, component: Component) -> float:
    """Operations of a solution with these factors; in a condensed system of `passes`, each refined by all rows."""
    # A dual system also has products with its rows, of 24 numbers each.
    size, more = (
        (component.dual_size, component.dual_band + 24) if system == DUAL else (component.unknowns, component.band)
    )
    one = BACK_WORK * size * (more + 6)
    if system == CONDENSED and component.impulses > 0:
        return float(passes * (one + REFINEMENT_WORK * joints))
    return float(one)


@inlined
def work_of_iteration(system: int, passes: int, joints: int, component: Component) -> float:
    """Operations of an iteration with new factors."""
    solution = work_of_solution(system, passes, joints, component)
    return work_of_rows(joints) + work_of_factors(system, component) + solution


@inlined
def pays_for_many(progress: Progress, begun: float) -> bool:
    """Whether the budget of a step pays for RESOLUTION times the work since `begun`: for many shorter intervals."""
    return RESOLUTION * (progress.effort - begun) <= progress.budget
