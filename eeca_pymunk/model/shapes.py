"""Records of shapes, of their neighbour lists, and of the sides on which thin ones are."""

from __future__ import annotations

from typing import Annotated

from ..arrays import IntArray
from ..compiled.records import Record

LEVELS = 64  # of the grid: level l has cells twice as long as l - 1
BATCH = 64  # shapes that a loop chooses before the next one looks at them


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


class Grid(Record):
    """The grid of shapes that move, that of static ones, and how much of the neighbour lists is in use."""

    pool_end: int  # first free place of POOL
    moving: int  # shapes [0, moving) move and have lists, the others are static
    leaves: int  # lists made again, of one shape each
    columns: int  # cells of the grid of static shapes; 0 where all of them are looked at
    rows: int
    left: float  # corner and length of these cells
    bottom: float
    wall_cell: float
    cell: float  # length of the cells of level 0 of the shapes that move
    level: Annotated[IntArray, LEVELS]  # shapes on each level
    # Scratch. Which shapes to choose cannot be guessed: a branch would wait for one row after the other.
    chosen: Annotated[IntArray, BATCH]  # shapes that a loop has chosen
    walked: Annotated[IntArray, BATCH]  # one shape in each of so many places of the grid


class Side(Record):
    """On which side of each other two thin shapes a < b are, see `..geometry.sides`."""

    key: int  # 1 + a k + b, of k shapes; 0 for a row never used, -1 for one that is free again
    nx: float  # unit normal from a to b
    ny: float
    deep: float  # length up to which they may overlap and still be on that side


class Corner(Record):
    """A corner of segments of one body, see `..geometry.corners`."""

    other: int  # 1 + the next segment about the end, 0 for none
    cosine: float  # of the angle to it
    sine: float
    thin: int  # of the first row of a shape: 1 if it is thin
