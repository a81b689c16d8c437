"""Initial penetration: bodies that the program has placed into others. Their contacts need not persist, so that no
island would correct the overlap: they are united to one until it is corrected."""

from __future__ import annotations

from ..compiled import kernel, nonallocating
from ..geometry.sides import smaller
from ..model.bodies import AT_REST
from ..model.parameters.events import INITIAL_PENETRATION
from ..model.scene import Scene
from ..pairs.lists import far_apart
from ..pairs.rules import barred, law
from .at_rest import disturb
from .membership import approach, fixed_support, unite


@nonallocating
def penetrates(A: Scene, s: int, o: int) -> tuple[bool, float, float]:
    """Whether shapes s and o overlap deeply and are pushed apart: they are lossy, and no rule bars the pair. And the
    gap (length) and its rate (length/time)."""
    if barred(A, s, o) or law(A, s, o)[0] >= 1.0 or far_apart(A, s, o, 0.0, 0.0):
        return False, 0.0, 0.0
    g, u, _, _, _ = approach(A, s, o, 0.0)
    return g < -INITIAL_PENETRATION * smaller(A, s, o), g, u


@nonallocating
def wake_penetrated(A: Scene) -> None:
    """At the start of a step: let the islands at rest be solved again that bodies without mobility overlap deeply which
    the program has placed."""
    for i in range(A.BODY.shape[0] - 1):
        if A.MEMBER[i].placed == 0 or A.BODY[i].inv_mass > 0.0:
            continue
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                o = int(A.POOL[w])
                if A.MEMBER[A.LINK[o].owner].rest == AT_REST and penetrates(A, s, o)[0]:
                    disturb(A, A.LINK[o].owner)


@kernel
def hold_penetrating(A: Scene) -> None:
    """At the start of a step: unite bodies with deep initial penetration that neither separate within the step nor hit
    each other; of lossy shapes, without joints. `Member.placed` remains set while the overlap does."""
    BODY, LINK, dt = A.BODY, A.LINK, A.PAR.dt
    A.COUNT.any_placed = 0
    for i in range(BODY.shape[0] - 1):
        placed = A.MEMBER[i].placed
        if placed == 0:
            continue
        A.MEMBER[i].placed = 0
        if A.MEMBER[i].tied >= 0:
            continue
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                o = int(A.POOL[w])
                j = LINK[o].owner
                if (BODY[j].inv_mass > 0.0 and A.MEMBER[j].tied >= 0) or (fixed_support(A, i) and fixed_support(A, j)):
                    continue
                deep, g, u = penetrates(A, s, o)
                if not deep or u * dt > -g:
                    continue
                A.MEMBER[i].placed, A.COUNT.any_placed = placed, 1
                if -u <= A.PAR.pulled * dt:
                    a, b = (j, i) if fixed_support(A, i) else (i, j)
                    unite(A, a, a if fixed_support(A, b) else b)
