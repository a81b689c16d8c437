"""Kernels of reading: the rows of bodies and shapes, from the values that pymunk has."""

from __future__ import annotations

import math

from . import layout
from .arrays import FloatArray, IntArray
from .compiled import Table, nonallocating
from .compiled.records import Rows
from .model.shapes import Link, Shape
from .model.step import NOT_FINITE
from .model.values import (
    CARRIED,
    CORNERS,
    DISKS,
    DYNAMIC,
    DYNAMICS,
    ECCENTRICS,
    MOVERS,
    STATIC,
    STEERERS,
    BodyValues,
    Reading,
    ShapeValues,
    reading_of,
)
from .transfer import read_states


@nonallocating
def place_points(
    BODIES: Rows[BodyValues], SHAPES: Rows[ShapeValues], POINT: FloatArray, POINT_PLACED: FloatArray
) -> None:  # fmt: skip
    """Convert the vertices of static shapes to world coordinates, and those of others to coordinates about the centre
    of mass; leave out a vertex that repeats the one before: a segment of length 0 is a disk."""
    at, to = 0, 0
    for s in range(SHAPES.shape[0]):
        one, body = SHAPES[s], BODIES[SHAPES[s].owner]
        c, z, first = math.cos(body.angle), math.sin(body.angle), to
        for _ in range(one.points):
            x, y = POINT[at, 0], POINT[at, 1]
            if body.kind == STATIC:
                x, y = body.x + (c * x - z * y), body.y + (z * x + c * y)
            else:
                x, y = x - body.centre_x, y - body.centre_y
            at += 1
            if to == first or x != POINT_PLACED[to - 1, 0] or y != POINT_PLACED[to - 1, 1]:
                POINT_PLACED[to, 0], POINT_PLACED[to, 1] = x, y
                to += 1
        one.first, one.vertices = first, to - first


@nonallocating
def give_rows(BODIES: Rows[BodyValues], SHAPES: Rows[ShapeValues], POINT_PLACED: FloatArray, ORDER: IntArray) -> int:
    """Number the bodies that are not static: single disks, other dynamic bodies, kinematic ones, each group by `place`.
    ORDER (n,) is scratch.

    Returns:
        the number of single disks.
    """
    for i in range(BODIES.shape[0]):
        BODIES[i].shapes, BODIES[i].row = 0, -1
        ORDER[BODIES[i].place] = i
    for s in range(SHAPES.shape[0]):
        # The sum is 1 for a single disk: one shape, a circle about the centre of mass.
        k = SHAPES[s].first
        centred = SHAPES[s].vertices == 1 and POINT_PLACED[k, 0] == 0.0 and POINT_PLACED[k, 1] == 0.0
        BODIES[SHAPES[s].owner].shapes += 1 if centred else 2
    row, disks = 0, 0
    for rank in range(3):
        for p in range(BODIES.shape[0]):
            body = BODIES[ORDER[p]]
            group = 2 if body.kind != DYNAMIC else 0 if body.shapes == 1 else 1
            if body.kind != STATIC and group == rank:
                body.row = row
                row += 1
        disks = row if rank == 0 else disks
    return disks


@nonallocating
def order_shapes(BODIES: Rows[BodyValues], SHAPES: Rows[ShapeValues], ground: int, ORDER: IntArray) -> None:
    """Write the shapes into ORDER, sorted by the rows of their bodies (stable; those of the ground last). The rest of
    ORDER is scratch."""
    k = SHAPES.shape[0]
    for i in range(ground + 2):
        ORDER[k + i] = 0
    for s in range(k):
        row = BODIES[SHAPES[s].owner].row
        ORDER[k + 1 + (ground if row < 0 else row)] += 1
    for i in range(ground):
        ORDER[k + i + 1] += ORDER[k + i]
    for s in range(k):
        row = BODIES[SHAPES[s].owner].row
        next_one = k + (ground if row < 0 else row)
        ORDER[ORDER[next_one]] = s
        ORDER[next_one] += 1


@nonallocating
def write_shape(POINT_PLACED: FloatArray, values: ShapeValues, SHAPE: Shape, LINK: Link, VERTEX: FloatArray) -> None:
    """Write one shape's vertices, with the outward normals of the edges that begin there, and its sizes."""
    n, first = values.vertices, values.first
    low_x, low_y, high_x, high_y = math.inf, math.inf, -math.inf, -math.inf
    for j in range(n):
        x, y, k = POINT_PLACED[first + j, 0], POINT_PLACED[first + j, 1], first + j + 1 if j + 1 < n else first
        # The outside of a counter-clockwise outline (pymunk's hulls) is on the right of every edge.
        ex, ey = POINT_PLACED[k, 0] - x, POINT_PLACED[k, 1] - y
        length = math.hypot(ex, ey)
        length = length if length > 0.0 else 1.0
        to = VERTEX[LINK.first + j]
        to[0], to[1], to[2], to[3] = x, y, ey / length, -ex / length
        low_x, low_y, high_x, high_y = min(low_x, x), min(low_y, y), max(high_x, x), max(high_y, y)
    SHAPE.centre_x, SHAPE.centre_y = 0.5 * (low_x + high_x), 0.5 * (low_y + high_y)
    far, away = 0.0, 0.0
    for j in range(first, first + n):
        far = max(far, math.hypot(POINT_PLACED[j, 0], POINT_PLACED[j, 1]))
        away = max(away, math.hypot(POINT_PLACED[j, 0] - SHAPE.centre_x, POINT_PLACED[j, 1] - SHAPE.centre_y))
    SHAPE.extent, SHAPE.bound = values.rounding + far, values.rounding + away


@nonallocating
def write_rows(table: Table) -> None:
    """Write the rows of bodies and of their shapes, without velocities, for the present poses of static bodies. BODY
    and VERTEX must contain zeros."""
    R = reading_of(table)
    BODIES, SHAPES, BODY, LINK, ORDER, now = R.BODIES, R.SHAPES, R.BODY, R.LINK, R.ORDER, R.STATES[layout.READ]
    for i in range(BODIES.shape[0]):
        BODIES[i].x, BODIES[i].y, BODIES[i].angle = now[i, 0], now[i, 1], now[i, 2]
    for s in range(SHAPES.shape[0]):
        SHAPES[s].owner = R.OWNER[s]
    place_points(BODIES, SHAPES, R.POINT, R.POINT_PLACED)
    disks = give_rows(BODIES, SHAPES, R.POINT_PLACED, ORDER)
    ground = BODY.shape[0] - 1
    for i in range(BODIES.shape[0]):
        if BODIES[i].row >= 0:
            body = BODY[BODIES[i].row]
            body.inv_mass, body.inv_inertia = BODIES[i].inverse_mass, BODIES[i].inverse_moment
    order_shapes(BODIES, SHAPES, ground, ORDER)
    at, carried = 0, 0
    for k in range(SHAPES.shape[0]):
        values, row = SHAPES[ORDER[k]], BODIES[SHAPES[ORDER[k]].owner].row
        link, shape = LINK[k], R.SHAPE[k]
        link.owner, link.first, link.vertices = ground if row < 0 else row, at, values.vertices
        link.group, link.categories, link.mask = values.group, values.categories, values.mask
        shape.rounding, shape.elasticity, shape.friction = values.rounding, values.elasticity, values.friction
        shape.surface_x, shape.surface_y = values.surface_x, values.surface_y
        write_shape(R.POINT_PLACED, values, shape, link, R.VERTEX)
        at += values.vertices
        carried += 1 if row >= 0 else 0
        body = BODY[link.owner]
        body.extent = max(body.extent, shape.extent)
        if k < disks:
            body.elasticity, body.friction = shape.elasticity, shape.friction
    for i in range(ground + 1):
        BODY[i].due = -math.inf
    R.TOTALS[DISKS], R.TOTALS[CARRIED], R.TOTALS[CORNERS] = disks, carried, at


@nonallocating
def clear_exchange(R: Reading) -> None:
    """Initialise IDS, EXTRA, the changes in HOOKED, and STATES[WRITTEN], unknown (NaN) but for static bodies."""
    R.TOTALS[DYNAMICS] = R.TOTALS[ECCENTRICS] = R.TOTALS[STEERERS] = R.TOTALS[MOVERS] = 0
    for i in range(R.BODIES.shape[0]):
        body = R.BODIES[i]
        eccentric = 1 if body.centre_x != 0.0 or body.centre_y != 0.0 else 0
        R.IDS[layout.BODY_ROW, i] = body.row
        R.IDS[layout.FLAGS, i] = layout.ECCENTRIC * eccentric + layout.STEERED * body.steered
        R.EXTRA[i, layout.COG_X], R.EXTRA[i, layout.COG_Y] = body.centre_x, body.centre_y
        R.EXTRA[i, layout.ACCELERATION_X] = R.EXTRA[i, layout.ACCELERATION_Y] = 0.0
        R.EXTRA[i, layout.ANGULAR_ACCELERATION] = 0.0
        for c in range(layout.STATE_COLUMNS):
            R.HOOKED[layout.CHANGES_BEFORE, i, c], R.HOOKED[layout.CHANGES_AFTER, i, c] = 0.0, 0.0
            R.STATES[layout.WRITTEN, i, c] = R.STATES[layout.READ, i, c] if body.kind == STATIC else math.nan
        R.TOTALS[DYNAMICS] += 1 if body.kind == DYNAMIC else 0
        R.TOTALS[ECCENTRICS] += eccentric
        R.TOTALS[STEERERS] += body.steered
        R.TOTALS[MOVERS] += body.moved


@nonallocating
def read_space(table: Table, arranged: int) -> int:
    """Write all rows of a space that was just read, with the poses and velocities of STATES[READ].

    Args:
        arranged: 1 if rows are numbered in pymunk's order, else in the order of `BodyValues.place`.

    Returns:
        the status of `transfer.read_states`; NOT_FINITE also for a static body.
    """
    R = reading_of(table)
    for i in range(R.STATES.shape[1]):
        for c in range(layout.STATE_COLUMNS):
            if not abs(R.STATES[layout.READ, i, c]) < math.inf:
                return NOT_FINITE
    if arranged != 0:
        for i in range(R.BODIES.shape[0]):
            R.BODIES[i].place = i
    write_rows(table)
    clear_exchange(R)
    return read_states(R.STATES, R.IDS, R.EXTRA, R.BODY, 0.0, 0.0, 1.0)
