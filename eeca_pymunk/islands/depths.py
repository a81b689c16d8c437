"""How far contacts may close in one interval, by their rows, which are linear, and by the poses at its end."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import FloatArray
from ..compiled import kernel, nonallocating
from ..compiled.records import Rows
from ..contacts.forces import shapes_of
from ..geometry.flight import norm, opening_rate_at, pose
from ..geometry.gap import gap_along, gap_at
from ..geometry.sides import held_side, remembers
from ..geometry.widths import depth_limit, half_width, smaller, turns
from ..model.contacts import Row
from ..model.islands import Island, IslandContacts
from ..model.parameters import intervals
from ..model.scene import Scene
from ..pairs.rules import barred
from ..rows.build import normal_rate
from .candidates import before_end, excess_way


@nonallocating
def left_to_lift(A: Scene, end: float) -> float:
    """Depth, in parts of the smallest body, up to which contacts are not lifted at the end of an interval: OVERLAP_LEFT
    at the end of the step; before it half of what the correction at the end of the step, which moves no point by more
    than CORRECTION_STEP, may lift: what a wall that turns fast carries along sinks in each interval until then."""
    return 0.5 * intervals.CORRECTION_STEP if before_end(A, end) else intervals.OVERLAP_LEFT


@nonallocating
def lifts_through(A: Scene, isle: Island, END: FloatArray, JUMP: FloatArray, n: int, end: float) -> bool:
    """Whether penetration corrections JUMP (k, 6) of the n bodies of an island, at poses END (k, 3) at instant `end`,
    lead a shape into one of a body without mobility, deeper than an interval may: contacts of the interval have neither
    all walls nor all corners that they may reach. Shapes are looked at that they move by a quarter of their width."""
    for q in range(n):
        x, y, angle = END[q, 0], END[q, 1], END[q, 2]
        way = norm(JUMP[q, 0], JUMP[q, 1]) + abs(JUMP[q, 2]) * isle.EXTENT[q]
        i = int(isle.WHO[q])
        for s in range(A.STATE[i].first_shape, A.STATE[i].first_shape + A.STATE[i].shapes if way > 0.0 else 0):
            if half_width(A, s) >= 2.0 * way:
                continue
            for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
                o = int(A.POOL[w])
                wall = int(A.LINK[o].owner)
                if A.BODY[wall].inv_mass > 0.0 or barred(A, s, o):
                    continue
                wx, wy, turn = pose(A.BODY, wall, end)
                after = gap_at(A, s, x + JUMP[q, 0], y + JUMP[q, 1], angle + JUMP[q, 2], o, wx, wy, turn)[0]
                if after < -depth_limit(A, s, o) and after < gap_at(A, s, x, y, angle, o, wx, wy, turn)[0]:
                    return True
    return False


@nonallocating
def known_depth(A: Scene, a: int, b: int) -> float:
    """Depth (length) up to which the gap of shapes a and b tells on which side of each other they are: to the middle of
    both, or, in contact, as far as the memory of thin ones reaches."""
    if remembers(A, a, b):
        return held_side(A, a, b)
    return half_width(A, a) + half_width(A, b)


@nonallocating
def closing_allowed(A: Scene, a: int, b: int, gap: float) -> float:
    """Way (length) that shapes a and b with this gap may close in an interval: an open gap and
    `depth_limit`. Let w be the sum of their half widths: at depths from w/2 to w the limit falls linearly to
    INTERVAL_DEPTH_LEAST. So what rocks on a rounded side, deeper and deeper, is integrated more finely, and does not
    rock through a wall. Joints may press bodies into others with any force: with them it is the whole limit."""
    width, most = half_width(A, a) + half_width(A, b), depth_limit(A, a, b)
    held = max(A.MEMBER[A.LINK[a].owner].tied, A.MEMBER[A.LINK[b].owner].tied) >= 0
    if not held and width > 0.0 and 2.0 * (width + gap) < width:
        most = max(2.0 * (width + gap) / width * most, intervals.INTERVAL_DEPTH_LEAST * smaller(A, a, b))
    return max(gap, 0.0) + most


@nonallocating
def too_deep(A: Scene, a: int, b: int, gap: float, closing: float) -> float:
    """How many times too long an interval is in which a contact of shapes a and b with this gap closes by `closing`
    (lengths); 0 if it gets no deeper than INTERVAL_RETRY times its limit. What is more is at least so much that the
    interval is solved again, also where most of the way is a gap."""
    if not closing > intervals.INTERVAL_DEPTH_LEAST * smaller(A, a, b):
        return 0.0
    room, apart = closing_allowed(A, a, b, gap), max(gap, 0.0)
    if not closing > apart + intervals.INTERVAL_RETRY * (room - apart):
        return 0.0
    return max(closing / room, 1.01 * intervals.INTERVAL_RETRY)


@nonallocating
def turns_corners(A: Scene, isle: Island, END: FloatArray, row: Row, a: int, b: int) -> bool:
    """Whether shape a or b of a contact is no centred disk and turns by more than NORMAL_TURN until poses END (k, 3):
    others come near than the contact's points, and these do not move along its row."""
    for q in (row.a, row.b):
        s = a if A.LINK[a].owner == isle.WHO[q] else b
        if turns(A, s) and abs(END[q, 2] - isle.POSE[q, 2]) > intervals.NORMAL_TURN:
            return True
    return False


@kernel
def too_deep_at_end(A: Scene, isle: Island, END: FloatArray, ROWS: Rows[Row], m: int, h: float, every: bool) -> float:
    """How many times too long an interval h is in which a pair closes farther than `closing_allowed`, by its gaps at
    the poses END (k, 3); 0 if none does. `every`: of all pairs, else of thin shapes, and of shapes with corners that
    turn."""
    far, last = 0.0, -1
    for z in range(m):
        a, b = shapes_of(A, ROWS[z])
        pair = ROWS[z].key >> 1
        if pair != last and (every or remembers(A, a, b) or turns_corners(A, isle, END, ROWS[z], a, b)):
            far = max(far, deep_at_end(A, isle, END, ROWS, m, h, z))
        last = pair
    return far


@kernel
def closes_too_far(A: Scene, isle: Island, ROWS: Rows[Row], VN: FloatArray, m: int, h: float) -> float:
    """How many times too long an interval h is whose m contacts close too far by their rows, which are linear, and by
    the poses at its end; 0 if it is not.

    Rows have the normals of the middle. Where these rotate, velocities along them at the start and the end do not tell
    the way between: bodies that a turning wall carries along do not close. The poses tell it, unless the way may have
    led to the other side of a shape.

    Args:
        VN: (k, 3) velocities at the end; of jointed bodies, whose paths are no parabolas, 2 W/h - v with the way W and
            the velocity v at the start.
    """
    far, last, known, END = 0.0, -1, 0.0, np.empty((0, 3))
    for z in range(m):
        a, b = shapes_of(A, ROWS[z])
        pair = ROWS[z].key >> 1
        closing = -0.5 * h * (ROWS[z].un + normal_rate(ROWS[z], VN))
        deep = too_deep(A, a, b, ROWS[z].gap, closing)
        if deep == 0.0:
            continue
        if closing - max(ROWS[z].gap, 0.0) < known_depth(A, a, b):
            if len(END) == 0:  # few intervals come here
                END = isle.POSE + 0.5 * h * (isle.V + VN)
            if pair != last:
                known = deep_at_end(A, isle, END, ROWS, m, h, z)
            last, deep = pair, min(deep, known)
        far = max(far, deep)
    return far


@kernel
def deep_at_end(A: Scene, isle: Island, END: FloatArray, ROWS: Rows[Row], m: int, h: float, z: int) -> float:
    """How many times too long an interval h is in which the pair of contact z closes as far as at poses END (k, 3); 0
    if it is not.

    The pair closes by u s + c s^2 in a time s, with its velocity u at the start, and c from the way u h + c h^2 to END:
    by its room r after s = 2 r / (u + sqrt(u^2 + 4 c r)), and the interval is h/s times too long. Where the normal at
    END is against that of the row, the way may have led to the other side: the pair is as deep as the row's normal
    tells. That need not be deep: at a corner the shortest way out changes.
    """
    pair, p, q = ROWS[z].key >> 1, ROWS[z].a, ROWS[z].b
    a, b = shapes_of(A, ROWS[z])
    sign = 1.0
    if isle.WHO[p] != A.LINK[a].owner:
        p, q, sign = q, p, -1.0
    gap = ROWS[z].gap
    for other in (z - 1, z + 1):
        if 0 <= other < m and ROWS[other].key >> 1 == pair:
            gap = min(gap, ROWS[other].gap)
    after, nx, ny, _, _ = gap_at(A, a, END[p, 0], END[p, 1], END[p, 2], b, END[q, 0], END[q, 1], END[q, 2])
    mx, my = sign * ROWS[z].nx, sign * ROWS[z].ny
    along = nx * mx + ny * my
    if along < 0.0 and after > 0.0:
        after *= along
    elif along < 0.0:
        told = gap_along(A, a, END[p, 0], END[p, 1], END[p, 2], b, END[q, 0], END[q, 1], END[q, 2], mx, my)
        after = max(told, min(gap, 0.0) - known_depth(A, a, b))
    closing = gap - after
    if too_deep(A, a, b, gap, closing) == 0.0:
        return 0.0
    S, V, room = isle.POSE, isle.V, closing_allowed(A, a, b, gap)
    _, nx, ny, x, y = gap_at(A, a, S[p, 0], S[p, 1], S[p, 2], b, S[q, 0], S[q, 1], S[q, 2])
    way = max(-h * opening_rate_at(S, V, p, q, nx, ny, x, y), 0.0)
    root = math.sqrt(max(way * way + 4.0 * (closing - way) * room, 0.0))
    return max((way + root) / (2.0 * room), 1.01 * intervals.INTERVAL_RETRY)


@nonallocating
def rises_too_far(A: Scene, ROWS: Rows[Row], L: FloatArray, VN: FloatArray, m: int, h: float) -> float:
    """How many times too long an interval h is within which one of m contacts is too far open; up to INTERVAL_RETRY it
    is not.

    A contact with an impulse that opens with u at the start and closes with u+ at the end has a constant force in
    between, under which it rises to (1/2) h u^2 / (u - u+); in truth it is open, without a force, and rises to u^2/2a
    only. If the interval is cut, its bodies have the energy of the larger height, and are elsewhere if solved again.
    """
    far = 0.0
    for z in range(m):
        before, after = ROWS[z].un, normal_rate(ROWS[z], VN)
        if before > 0.0 and after < 0.0 and L[z, 0] > 0.0:
            a, b = shapes_of(A, ROWS[z])
            far = max(far, 0.5 * h * before * before / ((before - after) * intervals.INTERVAL_DEPTH * smaller(A, a, b)))
    return far


@kernel
def times_too_long(A: Scene, isle: Island, contacts: IslandContacts, m: int, h: float) -> float:
    """How many times too long a solved interval h of m contacts is; up to INTERVAL_RETRY it is not. Poses at the end
    tell what rows do not: of thin shapes, and of corners of bodies that turn."""
    ROWS, VN = contacts.ROWS, contacts.VN
    far = max(excess_way(A, ROWS, isle.V, VN, m, h), closes_too_far(A, isle, ROWS, VN, m, h))
    far = max(far, rises_too_far(A, ROWS, contacts.L, VN, m, h))
    turned = 0.0
    for q in range(len(VN)):
        turned = max(turned, 0.5 * h * abs(isle.V[q, 2] + VN[q, 2]))
    if far <= intervals.INTERVAL_RETRY and (len(A.SIDE) > 0 or turned > intervals.NORMAL_TURN):
        END = isle.POSE + 0.5 * h * (isle.V + VN)
        far = max(far, too_deep_at_end(A, isle, END, ROWS, m, h, False))
    return far
