"""Records of shapes, of their neighbour lists, and of the sides on which thin ones are."""

from __future__ import annotations

from typing import Annotated

from ..arrays import IntArray
from ..compiled.records import Record

LEVELS = 64  # of the grid: level l has cells twice as long as l - 1, so that radii may differ by a factor of 2^63
BATCH = 64  # shapes that a loop chooses before the next one looks at them


class Shape(Record):
    """Size and material of a solid shape. Shapes are ordered by body row, so that the shape of a single disk has the
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


SURFACE_FIELDS = "elasticity", "friction", "surface_x", "surface_y"


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
    """The margin circle of a shape, and its neighbours in its bucket of the grid.

    The near list of the shape is valid as long as the centre of its bounding circle is inside the margin circle. All
    fields are floats, which fill one cache line.
    """

    x: float  # centre: that of the bounding circle when the list was made, or a point ahead on its path
    y: float
    margin: float  # radius, length; infinite where every shape is in every list
    reach: float  # `bound` and `margin` together when the shape was entered into the grid
    following: float  # next and previous shape in the bucket, -1 for none
    previous: float
    usual: float  # `margin` of the shape while it is slow
    spare: float  # fills the cache line


class Cell(Record):
    """The place of a shape in the grid."""

    level: int
    bucket: int


class List(Record):
    """The near list of a shape: rows [start, start + number) of POOL."""

    start: int
    capacity: int
    number: int
    later: int  # shape of a single disk's next impact after it has left its margin circle; CHECK or NOTHING


class Grid(Record):
    """The grid of moving shapes, that of static ones, and the use of POOL."""

    pool_end: int  # first free place of POOL
    moving: int  # shapes [0, moving) move and have lists, the others are static
    renewals: int  # number of near lists that were renewed
    halvings: int  # how often the margins that were chosen first have been halved
    columns: int  # of the grid of static shapes; 0 if all of them are tested without a grid
    rows: int
    left: float  # x and y of its corner
    bottom: float
    wall_cell: float  # length of its cells
    cell: float  # length of the cells of level 0 of the shapes that move
    level: Annotated[IntArray, LEVELS]  # number of shapes on each level
    # Scratch. A branch that selects shapes would be predicted badly, so loops write candidates to a list instead.
    chosen: Annotated[IntArray, BATCH]  # shapes that a loop has selected
    walked: Annotated[IntArray, BATCH]  # one shape in each of several buckets


class Side(Record):
    """The side of each other on which two thin shapes a < b are, see `..geometry.sides`."""

    key: int  # 1 + a k + b, of k shapes; 0 for a row never used, -1 for a deleted one (the search goes on behind it)
    nx: float  # unit normal from a to b
    ny: float
    deep: float  # depth up to which they may overlap and still be on that side: length


class Corner(Record):
    """A corner of segments of one body, see `..geometry.corners`."""

    other: int  # 1 + the next segment about the end, 0 for none
    cosine: float  # of the angle to it
    sine: float
    thin: int  # of the first row of a shape: 1 if it is thin


class HandledShape(Record):
    """A box that contains a shape with collision handlers, where a rehearsal puts it. Lengths in those of the space."""

    body: int  # row of STATES, -1 for static shapes, which have their place from the start
    x: float  # its centre from the body's centre of mass, along its own sides
    y: float
    angle: float  # of its sides in coordinates of the body
    half_x: float  # half its sides
    half_y: float
    rounding: float  # radius of the shape, and a part of its size against round-off
    extent: float  # largest distance of a point of the box from the centre of mass
    at_x: float  # its centre, cosine and sine of its angle, in the space
    at_y: float
    cos: float
    sin: float
    reach: float  # `rounding`, and the ways within which it counts as near
