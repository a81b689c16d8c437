"""Initial penetration: bodies that the program has placed into others. Their contacts need not persist, so that no
island would correct the overlap: they are united to one until it is corrected."""

from __future__ import annotations

from ..compiled import kernel
from ..geometry.sides import smaller
from ..model.parameters.events import INITIAL_PENETRATION
from ..model.scene import Scene
from ..pairs.lists import far_apart
from ..pairs.rules import barred, law
from .membership import approach, fixed_support, unite


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
                if barred(A, s, o) or law(A, s, o)[0] >= 1.0:
                    continue
                if far_apart(A, s, o, 0.0, 0.0):
                    continue
                g, u, _, _, _ = approach(A, s, o, 0.0)
                if g >= -INITIAL_PENETRATION * smaller(A, s, o) or u * dt > -g:
                    continue
                A.MEMBER[i].placed, A.COUNT.any_placed = placed, 1
                if -u <= A.PAR.pulled * dt:
                    a, b = (j, i) if fixed_support(A, i) else (i, j)
                    unite(A, a, a if fixed_support(A, b) else b)
