"""What a step has not met: budgets that were spent, tolerances that were not reached, and of which shapes."""

from __future__ import annotations

from ..compiled import uncounted
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
