"""Records of bodies and shapes as pymunk has them, before rows are made of them."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import FloatArray, IntArray
from ..compiled import Opener
from ..compiled.records import Record, Rows
from .bodies import Body
from .shapes import Link, Shape

STATIC, DYNAMIC, KINEMATIC = 0, 1, 2


class BodyValues(Record):
    """A body as pymunk has it, in pymunk's order."""

    kind: int  # STATIC (also of a sleeping body), DYNAMIC or KINEMATIC
    place: int  # rank of the body when rows are given out
    steered: int  # 1 if it has a `velocity_func` of the program
    moved: int  # 1 if it has a `position_func` of the program
    mass: float  # infinite unless dynamic
    moment: float  # infinite unless dynamic
    inverse_mass: float
    inverse_moment: float
    centre_x: float  # centre of mass in the body's coordinates: length
    centre_y: float
    x: float  # pose: length, length, rad
    y: float
    angle: float
    row: int  # of BODY, -1 of static bodies
    shapes: int  # scratch of `..world_rows`: 1 for one disk about the centre of mass, 2 or more otherwise
    asleep: int  # 1 if it sleeps


class ShapeValues(Record):
    """A solid shape as pymunk has it, in pymunk's order. Its vertices are consecutive rows of POINT, counter-clockwise,
    in the coordinates of its body."""

    owner: int  # number of its body, in pymunk's order
    points: int  # number of its vertices
    group: int  # of its filter
    categories: int
    mask: int
    rounding: float  # length
    elasticity: float
    friction: float
    surface_x: float  # surface velocity, length/time
    surface_y: float
    first: int  # of its rows of POINT_PLACED: the first, and their number
    vertices: int


class Measures(Record):
    """What memory the scene of these rows needs depends on this (`..impacts.scene_memory`)."""

    moving: int  # shapes that move
    vertices: int  # the most of a shape, at least 2
    thin: int  # thin shapes that move or sleep, 0 if no thin shapes may meet
    lossy: int  # 1 if any elasticity is below 1


class Reading(NamedTuple):
    """A space as pymunk has it, and the rows that are made of it.

    BODIES (N,), SHAPES (k,): values, in pymunk's order; OWNER (k,): `owner` of the shapes; POINT (v, 2): the vertices
    of all shapes. STATES, IDS, EXTRA, ENDS, HOOKED: see `..layout`. Out: POINT_PLACED (v, 2), the vertices that differ
    from the one before, of static shapes in world coordinates, of others about the centre of mass; BODY (moving bodies
    + 1,), SHAPE, LINK (k,), VERTEX (v, 4), whose rows in use come first; ORDER (k + N + 2,), the index in SHAPES of
    every row of SHAPE, and scratch; TOTALS: counts of what was read. MEASURED: by
    `..impacts.scene_memory.measure_scene`.
    """

    TOTALS: IntArray
    BODIES: Rows[BodyValues]
    SHAPES: Rows[ShapeValues]
    OWNER: IntArray
    POINT: FloatArray
    POINT_PLACED: FloatArray
    STATES: FloatArray
    IDS: IntArray
    EXTRA: FloatArray
    ENDS: FloatArray
    HOOKED: FloatArray
    BODY: Rows[Body]
    SHAPE: Rows[Shape]
    LINK: Rows[Link]
    VERTEX: FloatArray
    ORDER: IntArray
    MEASURED: Measures


reading_of = Opener(Reading)
# Places in TOTALS: numbers of single disks; of dynamic bodies; of solid shapes of moving bodies; of rows of VERTEX in
# use; of bodies whose centre of mass is not the origin; with velocity functions; with position functions.
DISKS, DYNAMICS, CARRIED, CORNERS, ECCENTRICS, STEERERS, MOVERS = 0, 1, 2, 3, 4, 5, 6
TOTALS_KEPT = 7
