"""Bodies that were put into others by their user: nothing brings them to rest on each other, so that no island would
lift them apart. They are in one until they are."""

from __future__ import annotations

from ..compiled import kernel
from ..layout import IM, OWNER, SIZE
from ..pairs.layout import NUMBER, START
from ..pairs.lists import far_apart
from ..pairs.rules import barred, law
from .islands import approach, carrier, unite
from .layout import CRAMMED, DT, FIRST_SHAPE, PULLED, PUT, SHAPES, TIED, Scene

_DEEP = 1e-6  # overlap over the size of the smaller shape, above which that is meant


@kernel
def hold_crammed(A: Scene) -> None:
    """At the start of a step, put into one island what is deep in one another and neither flies apart within the step
    nor hits: lossy shapes of bodies that no joint holds."""
    BODY, LINK, dt = A.BODY, A.LINK, A.PAR[DT]
    A.COUNT[CRAMMED] = 0
    for i in range(BODY.shape[0] - 1):
        if A.MEMBER[i, PUT] == 0:
            continue
        A.MEMBER[i, PUT] = 0
        if A.MEMBER[i, TIED] >= 0:
            continue
        for s in range(A.STATE[i, FIRST_SHAPE], A.STATE[i, FIRST_SHAPE] + A.STATE[i, SHAPES]):
            for w in range(A.LIST[s, START], A.LIST[s, START] + A.LIST[s, NUMBER]):
                o = int(A.POOL[w])
                j = LINK[o, OWNER]
                if (BODY[j, IM] > 0.0 and A.MEMBER[j, TIED] >= 0) or (carrier(A, i) and carrier(A, j)):
                    continue
                if barred(A.RULE, s, o) or law(A.SHAPE, A.RULE, s, o)[0] >= 1.0:
                    continue
                if o < A.LIST.shape[0] and far_apart(BODY, A.SHAPE, LINK, s, o, 0.0, 0.0):
                    continue
                g, u, _, _ = approach(BODY, A.SHAPE, LINK, A.VERTEX, A.WORK, A.PULL, s, o, 0.0)
                if g >= -_DEEP * min(A.SHAPE[s, SIZE], A.SHAPE[o, SIZE]) or u * dt > -g:
                    continue
                A.MEMBER[i, PUT], A.COUNT[CRAMMED] = 1, 1
                if -u <= A.PAR[PULLED] * dt:
                    a, b = (j, i) if carrier(A, i) else (i, j)
                    unite(A, a, a if carrier(A, b) else b)
