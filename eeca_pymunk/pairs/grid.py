"""The grid: near lists of all shapes, renewed one at a time as shapes leave their margin circles.

A search on a level of `cells.py` visits the cells that the circle, enlarged by half a cell, overlaps; or all shapes of
the level, if there are more than some four cells for each. Static shapes have a grid of their own, built once
(`walls.py`).
"""

from __future__ import annotations

import math

from ..compiled import Table, fetch, nonallocating
from ..geometry.flight import norm, pose, rate
from ..model.scene import Scene, scene_of
from ..model.shapes import BATCH, LEVELS
from .cells import bucket, cell_at, enter, overlaps, set_circle, unlink
from .rules import append, circle_centre, may_collide, place_in, remove
from .walls import box_wall, seek_walls

_FIRST_CAPACITY = 8  # of a list: NEIGHBOURS shapes, for which margins are chosen


@nonallocating
def join(A: Scene, s: int, o: int) -> bool:
    """Enter two moving shapes that may meet into each other's lists. False if the pool is full."""
    return not may_collide(A, s, o) or (append(A, s, o) and append(A, o, s))


@nonallocating
def join_chosen(A: Scene, s: int, n: int) -> bool:
    """`join` s with those of the first n shapes in GRID.chosen that are not in its list. False if the pool is full."""
    chosen = A.GRID.chosen
    for k in range(n):
        fetch(A.LIST, chosen[k], 0)
        fetch(A.BODY, chosen[k], 0)
    room = True
    for k in range(n):
        # Cells may share a bucket: a shape may be found more than once.
        room = room and (place_in(A, s, chosen[k]) >= 0 or join(A, s, chosen[k]))
    return room


@nonallocating
def join_near(A: Scene, s: int, n: int) -> bool:
    """`join` s with the shapes near its margin circle in n buckets, whose first shapes are in GRID.walked. False if the
    pool is full. All chains advance together, so that their cache misses overlap."""
    MARK, chosen, walked = A.MARK, A.GRID.chosen, A.GRID.walked
    x, y, radius, found = MARK[s].x, MARK[s].y, MARK[s].reach, 0
    while n > 0:
        more = 0
        for k in range(n):
            o = walked[k]
            chosen[found] = o
            found += 1 if overlaps(A, o, x, y, radius) else 0
            after = int(MARK[o].following)
            fetch(MARK, after, 0)
            walked[more] = after
            more += 1 if after >= 0 else 0
            if found == BATCH:
                if not join_chosen(A, s, found):
                    return False
                found = 0
        n = more
    return join_chosen(A, s, found)


@nonallocating
def seek_moving(A: Scene, s: int) -> bool:
    """Enter neighbours of s, which is not in the grid, among the shapes that are; those in its list are skipped. False
    if the pool is full."""
    MARK, CELL, HEAD, GRID = A.MARK, A.CELL, A.HEAD, A.GRID
    x, y = MARK[s].x, MARK[s].y
    radius = MARK[s].reach
    mask = HEAD.shape[0] - 1
    length = 0.5 * GRID.cell
    for level in range(LEVELS):
        length *= 2.0
        shapes = GRID.level[level]
        if shapes == 0:
            continue
        reach = radius + 0.5 * length
        west, east = cell_at(x - reach, length), cell_at(x + reach, length)
        south, north = cell_at(y - reach, length), cell_at(y + reach, length)
        # The last level also holds all larger circles, so all its shapes are tested.
        last = level == LEVELS - 1
        if last or float(east - west + 1) * float(north - south + 1) > 4.0 * shapes + 16.0:
            for o in range(GRID.moving):
                here = CELL[o].level == level and CELL[o].bucket >= 0 and o != s
                if here and overlaps(A, o, x, y, radius) and place_in(A, s, o) < 0 and not join(A, s, o):
                    return False
            continue
        heads = 0
        for column in range(west, east + 1):
            for row in range(south, north + 1):
                o = HEAD[bucket(level, column, row, mask)]
                fetch(MARK, o, 0)
                GRID.walked[heads] = o
                heads += 1 if o >= 0 else 0
                if heads == BATCH or (heads > 0 and column == east and row == north):
                    if not join_near(A, s, heads):
                        return False
                    heads = 0
    return True


@nonallocating
def drop_distant(A: Scene, s: int) -> int:
    """Drop the moving shapes from the list of s that are not near its margin circle, and s from theirs; returns how
    many entries are kept, with their flags. Static shapes are dropped too, as `seek_walls` finds them again, except
    those with a flag, which would be lost."""
    LIST, POOL, FLAG, MARK, moving = A.LIST, A.POOL, A.FLAG, A.MARK, A.GRID.moving
    start, kept = LIST[s].start, 0
    for q in range(start, start + LIST[s].number):
        fetch(MARK, int(POOL[q]), 0)
        fetch(LIST, int(POOL[q]), 0)
    x, y, radius = MARK[s].x, MARK[s].y, MARK[s].reach
    for q in range(start, start + LIST[s].number):
        o = int(POOL[q])
        if overlaps(A, o, x, y, radius) if o < moving else FLAG[q] != 0:
            POOL[start + kept], FLAG[start + kept] = o, FLAG[q]
            kept += 1
        elif o < moving:
            remove(A, o, s)
    LIST[s].number = kept
    return kept


@nonallocating
def renew_circle(A: Scene, s: int, t: float, ahead: float) -> int:
    """Move the margin circle of s to its position at instant t, and renew its list.

    If the shape turns round the body's centre of mass more than once in a step, and by more than its margin, the circle
    is about that centre, with a margin of at least twice the arm: one arm contains the orbit of the shape, the other is
    left for the motion of the body. The larger margin stays. For slower shapes, such as the walls of a container, the
    list would be too long.

    Args:
        ahead: distance of the circle's centre ahead of the shape, or body, along its velocity, as a part of the margin
            (of the margin less the arm, if the circle is about the body's centre); below 1.

    Returns:
        the number of old entries that are kept; they come first. -1 if the pool is full: then `build` has to be called.
    """
    mark = A.MARK[s]
    margin = mark.margin
    if margin == math.inf:
        return int(A.LIST[s].number)
    unlink(A, s)
    i = A.LINK[s].owner
    arm = norm(A.SHAPE[s].centre_x, A.SHAPE[s].centre_y)
    turn = abs(A.BODY[i].spin) * A.PAR.dt
    if turn > 2.0 * math.pi and turn * arm > margin:
        x, y, _ = pose(A.BODY, i, t)
        mark.margin = max(margin, 2.0 * arm)
        margin = mark.margin - arm
    else:
        x, y = circle_centre(A, s, t)
    if ahead > 0.0:
        ux, uy, _ = rate(A.BODY, i, t)
        u = norm(ux, uy)
        if u > 0.0:
            x, y = x + ahead * margin * (ux / u), y + ahead * margin * (uy / u)
    set_circle(A, s, x, y)
    A.GRID.renewals += 1
    kept = drop_distant(A, s)
    found = seek_moving(A, s) and seek_walls(A, s)
    enter(A, s)
    return kept if found else -1


@nonallocating
def make_lists(A: Scene, t: float) -> bool:
    """Make all lists at instant t. False if the pool is full."""
    GRID, moving = A.GRID, A.GRID.moving
    if A.POOL.shape[0] < moving * _FIRST_CAPACITY:
        return False
    A.HEAD[:] = -1
    GRID.level[:] = 0
    for s in range(moving):
        A.LIST[s].start, A.LIST[s].capacity, A.LIST[s].number = s * _FIRST_CAPACITY, _FIRST_CAPACITY, 0
        A.CELL[s].bucket = -1
        x, y = circle_centre(A, s, t)
        set_circle(A, s, x, y)
    GRID.pool_end = moving * _FIRST_CAPACITY
    all_pairs = moving > 0 and A.MARK[0].margin == math.inf
    for s in range(moving):
        if not seek_walls(A, s):
            return False
        if all_pairs:
            for o in range(s):
                if not join(A, s, o):
                    return False
        else:
            # Each pair once: s is compared with the shapes entered before it.
            if not seek_moving(A, s):
                return False
            enter(A, s)
    return True


@nonallocating
def build(table: Table, t: float) -> bool:
    """Build all lists at instant t. False if the pool is full: call again with a larger one."""
    return make_lists(scene_of(table), t)


@nonallocating
def relist(A: Scene, t: float, walls: bool) -> bool:
    """Make all lists again at instant t, after filters have changed; if `walls`, outlines or places of static shapes.
    False if another scene is needed: there are margin circles, a grid of static shapes, or too small a pool."""
    if A.GRID.columns != 0 or (A.LIST.shape[0] > 0 and A.MARK[0].margin < math.inf):
        return False
    for w in range(A.BOX.shape[0] if walls else 0):
        box_wall(A, w)
    return make_lists(A, t)
