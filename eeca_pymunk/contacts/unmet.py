"""What a step has not met: budgets that were spent, tolerances that were not reached, and of which shapes."""

from __future__ import annotations

from ..compiled import uncounted
from ..model.parameters.events import (
    BUDGET_TIME,
    DIRECT_LOOKS,
    EVENT_LOOKS,
    PAIR_LOOKS,
    SWEEP_LOOKS,
)
from ..model.parameters.impulses import DENSE_CONTACTS
from ..model.scene import Scene


@uncounted
def note_unmet(A: Scene, kind: int, a: int, b: int, value: float, limit: float) -> None:
    """Note that something of `kind` (`..model.step`) of shapes a and b was `value` where `limit` holds; a and b may be
    -1. The first ones of a step are kept, all are counted."""
    k = A.COUNT.unmet
    A.COUNT.unmet = k + 1
    if k < A.MISSED.shape[0]:
        row = A.MISSED[k]
        row.kind, row.first, row.second, row.value, row.limit = kind, a, b, value, limit


@uncounted
def spend(A: Scene, pairs: int, contacts: int, sweeps: int, direct: int) -> None:
    """Count the work of a solve of contacts: its geometry, sweeps, and direct solutions, with dense matrices of few."""
    few = min(contacts, DENSE_CONTACTS)
    one = PAIR_LOOKS * pairs + contacts * (SWEEP_LOOKS * sweeps + DIRECT_LOOKS * few * direct)
    A.COUNT.work += EVENT_LOOKS + int(one)


@uncounted
def most_work(A: Scene) -> float:
    """The work that the events of this step may come to."""
    return float(A.COUNT.budget * max(1.0, A.PAR.dt / BUDGET_TIME))
