"""Budgets and tolerances that a step has not met, and for which shapes; the work of its solves, which budgets limit.

Work is counted in *looks*, about the time of one look at the gap of two shapes.
"""

from __future__ import annotations

from ..compiled import nonallocating
from ..compiled.records import Rows
from ..model.contacts import Solved
from ..model.islands import Island
from ..model.parameters.events import BODY_LOOKS, DIRECT_LOOKS, EVENT_LOOKS, OPERATION_LOOKS, PAIR_LOOKS, SWEEP_LOOKS
from ..model.parameters.impulses import DENSE_CONTACTS
from ..model.scene import Scene
from ..model.step import CONTACTS, SOLVES


@nonallocating
def note_unmet(A: Scene, kind: int, a: int, b: int, value: float, limit: float) -> None:
    """Note that a quantity of `kind` (`..model.step`) was `value` for shapes a and b (-1: unknown), beyond `limit`.
    Rows of the first ones in a step are stored, and in any case why a step has ended early; all are counted."""
    k, room = A.COUNT.unmet, A.MISSED.shape[0]
    A.COUNT.unmet = k + 1
    if k < room or kind == SOLVES:
        row = A.MISSED[min(k, room - 1)]
        row.kind, row.first, row.second, row.value, row.limit = kind, a, b, value, limit


@nonallocating
def looks_of(contacts: int, OUT: Rows[Solved]) -> float:
    """Work of a solve of so many contacts: of sweeps, direct solves, with dense matrices for few contacts, and
    homotopies. OUT (1,): its report; an array, since a row does not keep its array from being freed before a call."""
    out = OUT[0]
    each = SWEEP_LOOKS * out.sweeps + DIRECT_LOOKS * min(contacts, DENSE_CONTACTS) * out.direct
    return float(contacts * each + OPERATION_LOOKS * out.operations)


@nonallocating
def spend(A: Scene, bodies: int, pairs: int, solve: float) -> None:
    """Add the work of an interval, or of an impact, to that of the step: of so many bodies, of pairs of its geometry,
    and of its solve."""
    A.COUNT.work += EVENT_LOOKS + BODY_LOOKS * bodies + PAIR_LOOKS * pairs + solve


@nonallocating
def note_lock(A: Scene, OUT: Rows[Solved]) -> None:
    """Report the scale of an energy lock if it is the farthest from 1 in this step."""
    if abs(OUT[0].lock - 1.0) > abs(A.PAR.lock - 1.0):
        A.PAR.lock = OUT[0].lock


@nonallocating
def note_solution(A: Scene, isle: Island, OUT: Rows[Solved]) -> None:
    """Report the solve of an interval that is taken: its lock, its residual if that is above the tolerance."""
    note_lock(A, OUT)
    if OUT[0].residual > OUT[0].tolerance:
        note_unmet(A, CONTACTS, isle.PAIRS[0, 0], isle.PAIRS[0, 1], OUT[0].residual, OUT[0].tolerance)
    A.COUNT.solves += 1


@nonallocating
def count_solve(A: Scene, n: int, p: int, m: int, OUT: Rows[Solved]) -> None:
    """Count the solve of an island of n bodies with m contacts of p pairs, whether it is taken or not, and its work."""
    A.COUNT.solved += n
    A.COUNT.direct += OUT[0].direct
    spend(A, n, 2 * p, looks_of(m, OUT))
