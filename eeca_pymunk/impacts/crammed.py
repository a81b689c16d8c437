"""Bodies that were put into others by their user: nothing brings them to rest on each other, so that no island would
lift them apart. They are in one until they are."""

from __future__ import annotations

from ..compiled import kernel
from ..layout import BOUND, IM, OWNER, SIZE
from ..pairs.layout import NUMBER, START
from ..pairs.lists import centre
from ..pairs.rules import barred, law
from .islands import approach, carrier, unite
from .layout import DT, FIRST_SHAPE, PULLED, PUT, SHAPES, TIED, Scene

_DEEP = 1e-6  # overlap over the size of the smaller shape, above which that is meant


@kernel
def hold_crammed(A: Scene) -> None:
    """At the start of a step, put into one island what is deep in one another and neither flies apart within the step
    nor hits: lossy shapes of bodies that no joint holds."""
    BODY, LINK, dt = A.BODY, A.LINK, A.PAR[DT]
    for i in range(BODY.shape[0] - 1):
        if A.MEMBER[i, PUT] == 0:
            continue
        A.MEMBER[i, PUT] = 0
        for s in range(A.STATE[i, FIRST_SHAPE], A.STATE[i, FIRST_SHAPE] + A.STATE[i, SHAPES]):
            for w in range(A.LIST[s, START], A.LIST[s, START] + A.LIST[s, NUMBER]):
                o = int(A.POOL[w])
                j = LINK[o, OWNER]
                if A.MEMBER[i, TIED] >= 0 or (BODY[j, IM] > 0.0 and A.MEMBER[j, TIED] >= 0):
                    continue
                if (BODY[i, IM] == 0.0 and BODY[j, IM] == 0.0) or barred(A.RULE, s, o):
                    continue
                if law(A.SHAPE, A.RULE, s, o)[0] >= 1.0:
                    continue
                if o < A.LIST.shape[0]:
                    ax, ay = centre(BODY, A.SHAPE, LINK, s, 0.0)
                    bx, by = centre(BODY, A.SHAPE, LINK, o, 0.0)
                    apart = A.SHAPE[s, BOUND] + A.SHAPE[o, BOUND]
                    if (bx - ax) * (bx - ax) + (by - ay) * (by - ay) > apart * apart:
                        continue
                g, u, _, _ = approach(BODY, A.SHAPE, LINK, A.VERTEX, A.WORK, A.PULL, s, o, 0.0)
                if g >= -_DEEP * min(A.SHAPE[s, SIZE], A.SHAPE[o, SIZE]) or u * dt > -g:
                    continue
                A.MEMBER[i, PUT] = 1
                if -u <= A.PAR[PULLED] * dt:
                    a, b = (j, i) if BODY[i, IM] == 0.0 else (i, j)
                    unite(A, a, a if carrier(A, b) else b)
