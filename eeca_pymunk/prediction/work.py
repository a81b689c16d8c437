"""How much work a step may take."""

from __future__ import annotations

from ..compiled import inlined
from ..model.parameters.detection import MANY_CORNERS
from ..model.parameters.events import BUDGET_TIME, VERTICES_LOOK
from ..model.scene import Scene


@inlined
def growth(A: Scene, dt: float) -> float:
    """Factor on the budgets of a step of length dt: its share, up to BUDGET_TIME; beyond it times dt / BUDGET_TIME."""
    return float(A.PAR.share * max(1.0, dt / BUDGET_TIME))


@inlined
def look_work(A: Scene, a: int, b: int) -> float:
    """Work of a look at shapes a and b, in looks: those at shapes of many vertices take longer, by all pairs of these,
    or from MANY_CORNERS on by six for each."""
    p, q = A.LINK[a].vertices, A.LINK[b].vertices
    return float(1.0 + (p * q if min(p, q) < MANY_CORNERS else 6.0 * (p + q)) / VERTICES_LOOK)


@inlined
def most_work(A: Scene) -> float:
    """Largest work of the events of this step, in looks."""
    return float(A.COUNT.budget * growth(A, A.PAR.dt))
