"""How much work a step may take."""

from __future__ import annotations

from ..compiled import inlined
from ..model.parameters.events import BUDGET_TIME
from ..model.scene import Scene


@inlined
def growth(dt: float) -> float:
    """Factor on the budgets of a step of length dt: 1 up to BUDGET_TIME, beyond it dt / BUDGET_TIME."""
    return max(1.0, dt / BUDGET_TIME)


@inlined
def most_work(A: Scene) -> float:
    """Largest work of the events of this step, in looks."""
    return float(A.COUNT.budget * growth(A.PAR.dt))
