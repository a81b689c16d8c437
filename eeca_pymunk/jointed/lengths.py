"""How long intervals of islands with joints may be; `..islands.candidates` is the same for other islands.

Between both ends of an interval paths are parabolas, which are searched for impacts; joints only hold at the ends.
Therefore bodies that may meet others turn by no more than half a radian, and leave their free flight by no more than
half their size; contacts close by no more than their depth limit, and their points part by no more than half the
size of the smaller body. These are the aims: an interval is solved again from INTERVAL_RETRY times as much on.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import kernel, nonallocating
from ..contacts.forces import shapes_of
from ..geometry.flight import fastest, norm
from ..geometry.sides import pair_of
from ..geometry.widths import depth_limit, smaller, turns
from ..islands.candidates import shortest_interval
from ..islands.depths import closes_too_far, too_deep_at_end
from ..model.joints import Joints
from ..model.parameters.intervals import INTERVAL_GROWTH, INTERVAL_RETRY, INTERVAL_WAY, SAGITTA
from ..model.scene import Scene
from ..pairs.rules import barred, far_apart
from ..rows.build import normal_rate
from .advance import Interval, separation

_CUBIC = 4.0 / 27.0  # largest value of s^2 (1 - s)


@nonallocating
def may_meet_others(A: Scene, i: int, way: float, t: float, h: float, KEY: IntArray, m: int) -> bool:
    """Whether body i, whose points move by at most `way` in an interval h from instant t, may leave its margin circles,
    or meet a shape that is not in the m contacts KEY."""
    for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
        if norm(A.BODY[i].x - A.MARK[s].x, A.BODY[i].y - A.MARK[s].y) + A.BODY[i].extent + way > A.MARK[s].margin:
            return True
        for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
            o = int(A.POOL[w])
            b = A.BODY[A.LINK[o].owner]
            if barred(A, s, o) or far_apart(A, s, o, t, 2.0 * (way + fastest(b) * h + A.PAR.pulled * h * h)):
                continue
            pair, known = pair_of(A, s, o), False
            for z in range(m):
                known = known or KEY[z] >> 1 == pair
            if not known:
                return True
    return False


@nonallocating
def excess_of_body(
    A: Scene, i: int, wx: float, wy: float, turned: float, V: FloatArray, ACC: FloatArray, t: float, h: float,
    KEY: IntArray, m: int,
) -> float:  # fmt: skip
    """How many times too long an interval h from instant t is for the motion of body i; 0 if that is no more than
    INTERVAL_RETRY, or the body meets nothing but the m contacts KEY.

    With way w = (wx, wy, turned), velocity V at the end and accelerations ACC without joints and contacts, the body
    leaves its free flight by w - h (v + h ACC/2) at the end. In between, the cubic through places and velocities at
    both ends leaves the parabola by (4/27) h |v + V - 2 w/h|: this detects bodies that swing there and back.
    """
    b = A.BODY[i]
    if b.extent == 0.0:
        return 0.0
    x, y = wx - h * (b.vx + 0.5 * h * ACC[0]), wy - h * (b.vy + 0.5 * h * ACC[1])
    bend = _CUBIC * norm(h * (b.vx + V[0]) - 2.0 * wx, h * (b.vy + V[1]) - 2.0 * wy)
    turned = max(abs(turned), _CUBIC * abs(h * (b.spin + V[2]) - 2.0 * turned))
    far = max(norm(x, y), bend) / (INTERVAL_WAY * b.extent)
    for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes):
        if turns(A, s):
            far = max(far, turned / INTERVAL_WAY)
    way = norm(x + h * b.vx, y + h * b.vy) + bend + A.PAR.pulled * h * h + min(turned, math.pi) * b.extent
    return far if far > INTERVAL_RETRY and may_meet_others(A, i, way, t, h, KEY, m) else 0.0


@nonallocating
def excess_alone(A: Scene, J: Joints, s: int, t: float, h: float) -> float:
    """`excess` for component s alone, with its end in the scratch."""
    far, first = 0.0, J.COMPONENT[s].first_body
    for w in range(J.COMPONENT[s].end_body - first):
        if J.LOCAL[w].freedoms > 0:
            i, local = int(J.JOINED[first + w].body), J.LOCAL[w]
            b = A.BODY[i]
            wx, wy, turned = local.pose[0] - b.x, local.pose[1] - b.y, local.pose[2] - b.angle
            far = max(far, excess_of_body(A, i, wx, wy, turned, local.v0, A.PULL[i], t, h, A.BLOCK, 0))
    return far


@nonallocating
def within_sagitta(A: Scene, found: IntArray, t: float) -> float:
    """Length of an interval from instant t: to the end of the step, or until the points of a rotating wall leave their
    chord by SAGITTA times the size of a body that touches it, R (w h)^2 / 8 at a distance R from the wall's centre.
    Bodies that friction and joints hold on such a wall creep by as much. At least `shortest_interval`. `found` (p, 2):
    pairs of shapes."""
    most = 0.0
    for c in range(found.shape[0]):
        small = smaller(A, found[c, 0], found[c, 1])
        for s in (found[c, 0], found[c, 1]):
            wall = A.BODY[A.LINK[s].owner]
            if wall.inv_mass == 0.0 and turns(A, s):
                most = max(most, wall.spin * wall.spin * wall.extent / (8.0 * SAGITTA * small))
    h = A.PAR.dt - t
    return h if most * h * h <= 1.0 else max(1.0 / math.sqrt(most), shortest_interval(A))


@nonallocating
def points_part(interval: Interval, L: FloatArray) -> float:
    """How many times too long an interval is as the points of a contact that pushes with impulses L (m, 2), on two
    moving bodies, part by more than INTERVAL_WAY of the smaller body: the impulse would act at two places, and change
    the angular momentum."""
    isle, ROWS, MID, far = interval.isle, interval.ROWS, interval.motion.MID, 0.0
    for z in range(interval.m):
        a, b = ROWS[z].a, ROWS[z].b
        if L[z, 0] != 0.0 and isle.IM[a] > 0.0 and isle.IM[b] > 0.0:
            along, across = separation(ROWS[z], MID)
            far = max(far, (abs(along) + abs(across)) / (INTERVAL_WAY * min(isle.EXTENT[a], isle.EXTENT[b])))
    return far


@kernel
def excess(A: Scene, interval: Interval, L: FloatArray) -> float:
    """How many times too long an interval is for the motion of its bodies under impulses L (m, 2) of its contacts;
    what is no more than INTERVAL_RETRY for single bodies counts as 0."""
    isle, _, ROWS, motion, _, m, n, t, h, _ = interval
    far, KEY = 0.0, np.empty(m, np.int64)
    for z in range(m):
        KEY[z] = ROWS[z].key
    for q in range(n):
        i, turned = int(isle.WHO[q]), motion.END[q, 2] - isle.POSE[q, 2]
        far = max(
            far,
            excess_of_body(A, i, motion.WAY[q, 0], motion.WAY[q, 1], turned, motion.V[q], isle.ACC[q], t, h, KEY, m),
        )
    far = max(far, closes_too_far(A, isle, ROWS, motion.EVEN, m, h), points_part(interval, L))
    return max(far, too_deep_on_way(A, interval))


@kernel
def too_deep_on_way(A: Scene, interval: Interval) -> float:
    """How many times too long an interval is because one of m contacts is deeper at its end, or in its middle, than the
    linear rows predict: a body that slides along a rotating wall may be past the wall's end by then."""
    isle, _, ROWS, motion, _, m, _, _, h, _ = interval
    MIDDLE = isle.POSE + 0.25 * (h * isle.V + motion.WAY)
    half = too_deep_at_end(A, isle, MIDDLE, ROWS, m, 0.5 * h, True)
    return max(2.0 * half, too_deep_at_end(A, isle, motion.END, ROWS, m, h, True))


@nonallocating
def forced_deeper(A: Scene, interval: Interval) -> int:
    """A contact that joints force deeper than an interval allows, -1 if there is none; only one that is LEFT_OUT
    can be, as no impulse moves it."""
    ROWS, LEFT_OUT, WAY = interval.ROWS, interval.C.LEFT_OUT, interval.motion.WAY
    for z in range(interval.m):
        closed = normal_rate(ROWS[z], WAY)
        a, b = shapes_of(A, ROWS[z])
        if LEFT_OUT[z] != 0 and closed < 0.0 and ROWS[z].gap + closed < -depth_limit(A, a, b):
            return z
    return -1


@nonallocating
def next_length(h: float, far: float) -> float:
    """Largest length of the interval after one of length h that was `far` <= INTERVAL_RETRY times too long (`excess`):
    h/far, at least INTERVAL_RETRY h and at most INTERVAL_GROWTH h."""
    return h * max(INTERVAL_RETRY, 1.0 / max(far, 1.0 / INTERVAL_GROWTH))
