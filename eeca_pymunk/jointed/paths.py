"""The path of an island with joints in its interval: which shapes it passes through, and when it may meet others."""

from __future__ import annotations

import math

from ..compiled import kernel, nonallocating
from ..geometry.flight import opening_rate, pose, rate
from ..geometry.gap import gap
from ..geometry.sides import remembers
from ..geometry.widths import depth_limit, smaller
from ..islands.membership import members_of
from ..joints.start import release_limits
from ..joints.workspace import workspace
from ..model.joints import Joints
from ..model.parameters.events import ENTRY_LOOKS
from ..model.parameters.intervals import INTERVAL_DEPTH
from ..model.parameters.joints import MEET_DEEP
from ..model.scene import Scene
from ..pairs.rules import barred, far_apart
from ..prediction.impact_times import time_of_impact
from ..prediction.work import look_work
from .component import project_speeds
from .ends import under_way
from .gathered import gather_alone


@nonallocating
def allowed_velocity(A: Scene, J: Joints, i: int, t: float) -> tuple[float, float, float]:
    """The velocity of body i at instant t; where its path begins at t, the part of it that its joints allow.

    The mean velocity over any interval, however short, satisfies the joints, so the other part (an error of a step,
    which elastic impacts keep) is reversed within it. Shapes that touch and open by that part alone close from the
    start on.
    """
    s = J.OF[i]
    if s >= 0 and A.BODY[i].since == t:
        W, first = workspace(J, s), J.COMPONENT[s].first_body
        extent = gather_alone(A, J, s, t, 0.0)
        release_limits(W)
        project_speeds(J, s, extent)
        for w in range(W.bodies):
            if J.JOINED[first + w].body == i:
                return J.LOCAL[w].v0[0], J.LOCAL[w].v0[1], J.LOCAL[w].v0[2]
    return rate(A.BODY, i, t)


@nonallocating
def gap_and_rate(A: Scene, J: Joints, a: int, b: int, t: float, allowed: bool) -> tuple[float, float]:
    """Gap of shapes a and b on the paths of their bodies at instant t, and its rate, negative if it closes; by the
    velocities that joints allow, if `allowed`."""
    i, j = A.LINK[a].owner, A.LINK[b].owner
    g, nx, ny, px, py = gap(A, a, b, t)
    xi, yi, _ = pose(A.BODY, i, t)
    xj, yj, _ = pose(A.BODY, j, t)
    one = allowed_velocity(A, J, i, t) if allowed else rate(A.BODY, i, t)
    two = allowed_velocity(A, J, j, t) if allowed else rate(A.BODY, j, t)
    arm_i, arm_j = (px - xi) * ny - (py - yi) * nx, (px - xj) * ny - (py - yj) * nx
    still = 0.0, 0.0, 0.0
    return g, opening_rate(nx, ny, 0.0, arm_j, still, two) - opening_rate(nx, ny, 0.0, arm_i, still, one)


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
                g = math.inf
                if not far_apart(A, s, o, t, 0.0):
                    A.COUNT.work += look_work(A, s, o)
                    g = gap(A, s, o, t)[0]
                if g > 0.0:
                    through, met = crossing_of_paths(A, s, o, t)
                    if met and through > began + A.PAR.instant and is_beyond(A, s, o, through, t):
                        return through
                    continue
                small = smaller(A, s, o)
                # Thin shapes that are deeper remember their sides.
                deep = INTERVAL_DEPTH * small if remembers(A, s, o) else depth_limit(A, s, o)
                if g < -deep and g < gap(A, s, o, began)[0] - MEET_DEEP * small:
                    return t
        i = A.MEMBER[i].following
    return math.inf


@nonallocating
def begun(A: Scene, i: int) -> float:
    """The latest instant at which an interval of an island without joints has begun or ended, of those islands that
    shapes of body i may touch."""
    latest = 0.0
    for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
        for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
            j = A.LINK[A.POOL[w]].owner
            root = A.STATE[j].island
            if root >= 0 and A.MEMBER[root].jointed == 0:
                latest = max(latest, A.BODY[j].since)
    return latest


@kernel
def instants_between(A: Scene, i: int, j: int, roots: tuple[int, int], t: float) -> tuple[float, float]:
    """The least and the latest instant at which bodies i and j may meet, as predicted for t: not before any path
    begins, where overlapping shapes would have met, nor after an interval's end or the next event of other bodies."""
    least, latest = A.BODY[i].since, A.PAR.dt
    if A.BODY[j].inv_mass > 0.0:
        least = max(least, A.BODY[j].since)
    for end in range(2):
        root = roots[end]
        if under_way(A, root):
            least, latest = max(least, A.BODY[root].since), min(latest, A.RESTING[root].until)
            for member in members_of(A, root):
                least = max(least, begun(A, member))
        elif end == 0 or A.BODY[j].inv_mass > 0.0:
            least = max(least, begun(A, i if end == 0 else j))
    if A.COUNT.heap > 0:
        latest = min(latest, max(t, A.HEAP_TIME[0]))
    return least, latest
