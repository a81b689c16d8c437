"""Which bodies are predicted, and prefetching of memory for the next events."""

from __future__ import annotations

import math

from ..compiled import fetch, inlined, nonallocating
from ..model.bodies import AT_REST, NOTHING
from ..model.scene import Scene
from .disks import first_impact, set_next_event, still_valid
from .next_event import predict


@nonallocating
def predict_next(A: Scene, i: int, t: float, several: bool) -> None:
    """Predict the next event of body i at instant t of the loop; `several` as in `disks.first_impact`."""
    if i < A.COUNT.disks and A.STATE[i].island < 0:
        best, other = first_impact(A, i, 0, math.inf, NOTHING, several)
        set_next_event(A, i, best, other, t)
    else:
        predict(A, i, t)


@nonallocating
def predict_all(A: Scene, n: int, t: float) -> None:
    """Predict the next events of the n bodies in A.BLOCK at instant t. A pair of two of them is tested only for the
    body with the lower number. That is enough: no impact of the pair comes before the next event of this body, after
    which it is predicted again, with all shapes of its lists."""
    for q in range(n):
        A.PLACE[A.BLOCK[q]] = q
    for q in range(n):
        predict_next(A, A.BLOCK[q], t, True)
    for q in range(n):
        A.PLACE[A.BLOCK[q]] = -1


@nonallocating
def predict_due(A: Scene) -> None:
    """At the start of a step, predict the next events of all bodies whose prediction is void or due in this step, and
    of all bodies in islands that are not at rest."""
    n, dt, disks = 0, A.PAR.dt, A.COUNT.disks
    for i in range(A.BODY.shape[0] - 1):
        alone = A.STATE[i].island < 0
        if A.BODY[i].due < dt or not (alone or A.MEMBER[i].rest == AT_REST):
            if not (alone and i < disks and still_valid(A, i)):
                A.BLOCK[n] = i
                n += 1
    predict_all(A, n, 0.0)


@inlined
def fetch_body(A: Scene, i: int) -> None:
    """Prefetch the rows of body i for an event; the row of BODY fills two cache lines, of eight numbers each."""
    fetch(A.BODY, i, 0)
    fetch(A.BODY, i, 8)
    fetch(A.STATE, i, 0)


@inlined
def look_ahead(A: Scene, now: int) -> None:
    """Prefetch rows while the event of body `now` is processed: the near list of its partner; of the first event in the
    heap the near list, and the rows of the partner; of the next two only the rows that say where these are."""
    LIST, disks = A.LIST, A.COUNT.disks
    n = min(A.COUNT.heap, 3)
    for k in range(1, n):
        i = A.HEAP_BODY[k]
        fetch_body(A, i)
        if i < disks:
            fetch(LIST, i, 0)
    if n > 0:
        i = A.HEAP_BODY[0]
        if i < disks:
            fetch(A.POOL, LIST[i].start, 0)
            fetch(A.MARK, i, 0)
            o = A.STATE[i].other
            if 0 <= o < disks:
                fetch_body(A, o)
                fetch(LIST, o, 0)
    o = A.STATE[now].other
    if 0 <= o < disks:
        fetch(A.POOL, LIST[o].start, 0)
