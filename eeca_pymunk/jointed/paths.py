"""Which shapes an island with joints passes through on the path of its interval."""

from __future__ import annotations

import math

from ..compiled import nonallocating
from ..geometry.gap import gap
from ..geometry.sides import depth_limit, remembers, smaller
from ..model.parameters.events import ENTRY_LOOKS
from ..model.parameters.intervals import INTERVAL_DEPTH
from ..model.parameters.joints import MEET_MANY
from ..model.scene import Scene
from ..pairs.lists import far_apart
from ..pairs.rules import barred
from ..prediction.impact_times import time_of_impact
from .ends import under_way


@nonallocating
def crossing_of_paths(A: Scene, a: int, b: int, t: float) -> tuple[float, bool]:
    """The instant before t at which the paths of shapes a and b, apart at t, meet; and whether there is one."""
    through, certain = time_of_impact(A, a, b, t, math.inf)
    return through, bool(certain and through < t)


@nonallocating
def is_beyond(A: Scene, a: int, b: int, through: float, t: float) -> bool:
    """Whether shapes a and b, whose paths meet at instant `through`, are on the far sides of each other at t: the
    normals at both instants are opposite."""
    before, after = gap(A, a, b, through), gap(A, a, b, t)
    return bool(before[1] * after[1] + before[2] * after[2] < 0.0)


@nonallocating
def passes_through(A: Scene, root: int, t: float) -> float:
    """The first instant at which a shape of an island has passed through one without contact with it, on the interval
    that ends at t; t if it is deeper there than an interval allows and than at its start; infinity if neither. A
    shortened interval needs this test: its path is another one, which was not searched for impacts."""
    i = root if under_way(A, root) else -1
    while i >= 0:
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
            # Near lists are looked through as in a prediction.
            A.COUNT.work += ENTRY_LOOKS * A.LIST[s].number
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                o = int(A.POOL[w])
                twice = o < s and A.STATE[A.LINK[o].owner].island == A.STATE[i].island  # in the list of o, too
                if twice or A.FLAG[w] != 0 or barred(A, s, o):
                    continue
                began = max(A.BODY[i].since, A.BODY[A.LINK[o].owner].since)
                g = math.inf if far_apart(A, s, o, t, 0.0) else gap(A, s, o, t)[0]
                if g > 0.0:
                    through, met = crossing_of_paths(A, s, o, t)
                    if met and through > began + A.PAR.instant and is_beyond(A, s, o, through, t):
                        return through
                    continue
                small = smaller(A, s, o)
                # Thin shapes that are deeper remember their sides.
                deep = INTERVAL_DEPTH * small if remembers(A, s, o) else depth_limit(A, s, o)
                if g < -deep and g < gap(A, s, o, began)[0] - MEET_MANY * small:
                    return t
        i = A.MEMBER[i].following
    return math.inf
