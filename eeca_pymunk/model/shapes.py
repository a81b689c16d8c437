"""Records of shapes and of their neighbour lists."""

from __future__ import annotations

from ..compiled.records import Record


class Shape(Record):
    """Size and material of a solid shape. Shapes are ordered by body row, so that the shape of a lone disk has the
    number of its body."""

    rounding: float  # length, radius of a circle, of a segment's or polygon's rounding
    extent: float  # length from the body's centre of mass to the shape's farthest point
    elasticity: float
    friction: float
    surface_x: float  # surface velocity, length/time
    surface_y: float
    centre_x: float  # of the shape's bounding circle, in the body's frame: length
    centre_y: float
    bound: float  # radius of that circle: length


class Link(Record):
    """What a shape belongs to.

    VERTEX (v, 4) has the vertices of all shapes, counter-clockwise about the centre of mass in the body's frame, and
    the outward unit normal of the edge that begins there (0 for a point). One vertex is a disk, two are a segment (with
    two edges, one for each side), more a polygon; `rounding` rounds them all.
    """

    owner: int  # row of the body
    first: int  # first vertex, number of vertices
    vertices: int
    group: int  # of the shape's filter
    categories: int
    mask: int


class Mark(Record):
    """The margin circle of a shape, drawn about where its list was made or ahead of that, and its neighbours in the
    grid."""

    x: float  # centre of the margin circle: where that of the bounding circle was, or a way before it
    y: float
    margin: float  # how far it may go from there: length; infinite where every shape is in every list
    reach: float  # of the bounding circle and the margin from the centre, as the grid has it
    following: float  # shapes in the same place of the grid, -1 for none
    previous: float
    spare_0: float  # to the end of a cache line
    spare_1: float


class Cell(Record):
    """The place of a shape in the grid."""

    level: int
    bucket: int


class List(Record):
    """Where the neighbours of a shape stand in POOL."""

    start: int
    capacity: int
    number: int
    later: int  # the shape that a lone disk meets if it goes straight on when it leaves its circle
