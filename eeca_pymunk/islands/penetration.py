"""Bodies that were put into others by their user: nothing brings them to rest on each other, so that no island would
lift them apart. They are in one until they are."""

from __future__ import annotations

from ..compiled import kernel
from ..model.parameters.events import INITIAL_PENETRATION
from ..model.scene import Scene
from ..pairs.lists import far_apart
from ..pairs.rules import barred, law
from .membership import approach, carrier, unite


@kernel
def hold_penetrating(A: Scene) -> None:
    """At the start of a step, put into one island what is deep in one another and neither flies apart within the step
    nor hits: lossy shapes of bodies that no joint holds."""
    BODY, LINK, dt = A.BODY, A.LINK, A.PAR.dt
    A.COUNT.crammed = 0
    for i in range(BODY.shape[0] - 1):
        put = A.MEMBER[i].put
        if put == 0:
            continue
        A.MEMBER[i].put = 0
        if A.MEMBER[i].tied >= 0:
            continue
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                o = int(A.POOL[w])
                j = LINK[o].owner
                if (BODY[j].inv_mass > 0.0 and A.MEMBER[j].tied >= 0) or (carrier(A, i) and carrier(A, j)):
                    continue
                if barred(A.RULE, s, o) or law(A.SHAPE, A.RULE, s, o)[0] >= 1.0:
                    continue
                if o < A.LIST.shape[0] and far_apart(A, s, o, 0.0, 0.0):
                    continue
                g, u, _, _ = approach(A, s, o, 0.0)
                if g >= -INITIAL_PENETRATION * min(A.SHAPE[s].extent, A.SHAPE[o].extent) or u * dt > -g:
                    continue
                A.MEMBER[i].put, A.COUNT.crammed = put, 1
                if -u <= A.PAR.pulled * dt:
                    a, b = (j, i) if carrier(A, i) else (i, j)
                    unite(A, a, a if carrier(A, b) else b)
