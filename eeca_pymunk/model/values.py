"""Records of bodies and shapes as pymunk has them, before rows are made of them."""

from __future__ import annotations

from ..compiled.records import Record

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


class ShapeValues(Record):
    """A solid shape as pymunk has it, in pymunk's order. Its vertices are consecutive rows, counter-clockwise, in the
    coordinates of its body."""

    owner: int  # number of its body, in pymunk's order
    vertices: int
    group: int  # of its filter
    categories: int
    mask: int
    rounding: float  # length
    elasticity: float
    friction: float
    surface_x: float  # surface velocity, length/time
    surface_y: float
    first: int  # its first vertex
