"""Records of what bodies and shapes of pymunk say of themselves."""

from __future__ import annotations

from ..compiled.records import Record

STATIC, DYNAMIC, KINEMATIC = 0, 1, 2


class GivenBody(Record):
    """A body as pymunk has it, in pymunk's order."""

    kind: int  # STATIC, also of one asleep, DYNAMIC or KINEMATIC
    place: int  # its place in the order in which rows are given out
    steered: int  # 1 with a velocity function of its own
    moved: int  # 1 with a position function of its own
    mass: float  # infinite unless dynamic, as the moment
    moment: float
    inverse_mass: float
    inverse_moment: float
    centre_x: float  # of mass, in the body's coordinates: length
    centre_y: float
    x: float  # pose: length, length, rad
    y: float
    angle: float
    row: int  # of BODY, -1 of static ones
    shapes: int  # how many


class GivenShape(Record):
    """A solid shape as pymunk has it, in pymunk's order; its vertices stand one after the other, in the coordinates of
    its body, counter-clockwise."""

    owner: int  # place of its body
    vertices: int
    group: int  # of its filter
    categories: int
    mask: int
    rounding: float
    elasticity: float
    friction: float
    surface_x: float
    surface_y: float
    first: int  # its first vertex
