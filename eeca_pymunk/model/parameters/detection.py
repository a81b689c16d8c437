"""Finding contacts: gaps, normals, sides, near lists."""

from __future__ import annotations

from .record import accuracy, heuristic, round_off, work

# fmt: off
GAP_ROUND_OFF = round_off(1e-12, "of positions and sizes",
    "Error of a gap. Smaller: contacts that have closed are missed. Larger: impacts are early.")
CORNER_ROUND_OFF = round_off(4.0, "times GAP_ROUND_OFF",
    "Error of corners whose place follows from the angle of a body.")
DIRECTION_ROUND_OFF = round_off(1e-12, "of coordinates and sizes",
    "Distance of two points below which their direction is round-off and the normal of the edge is used.")
MANY_CORNERS = work(9, "corners",
    "Corners of two polygons from which on their edges are compared in one turn around them.")
AXIS_TIE = round_off(1e-14, "of the sizes",
    "Separation by which the axis of a longer edge is preferred. Larger: less precise axes.")
EDGE_TIE = round_off(1.0 + 1e-09, "ratio of squared lengths",
    "Edges whose squared lengths differ by less count as equally long.")
FACE_WIDTH = accuracy(1e-06, "of the larger shape",
    "Width of a common face below which it is one point. Smaller: two contacts at one place, singular.")
SLENDER = heuristic(0.7, "area over (length / 2)^2",
    "Polygons below it are thin and remember sides as segments do: planks in a container that turns stay inside.")
FLUSH = heuristic(0.0005, "of the smaller shape",
    "Distance, and overlap on either side, up to which thin shapes of which nothing is known lie flush: the geometry "
    "does not tell their side. Smaller: what rests, deeper than that after a long step, falls through when it is set "
    "back. Larger: what a program places at rest below a wall, closer than that, sticks to it.")
SAME_SIDE = heuristic(0.9, "cosine", "Normals above which the shapes of a body are on the same side of another shape.")
CORNER_MEET = round_off(1e-9, "of the segments' size", "Distance within which ends of segments form a corner.")
ALIGNED = round_off(1e-6, "1 - cosine", "Angle up to which the surfaces of two shapes are flush.")
SAME_NORMAL = round_off(1e-12, "1 - cosine", "Angle up to which a normal is that of an edge.")
FACE_PASSES = accuracy(0.99, "cosine",
    "Angle between the face along which a pair is nearest and the surface along which it passes a corner. Larger: what "
    "lies on shapes that are turned a little against each other sinks into them.")
STRAIGHT = round_off(1e-6, "sine", "Angle between segments that meet below which they form one straight wall.")
MARGIN_OF_FAST = work(2.0, "times the displacement in a step",
    "Margin of a fast shape in its near list. Smaller: lists are renewed more often. Larger: more pairs.")
FARTHEST_CELL = work(1000000000000000.0, "cells", "Longest displacement of a step for which neighbours are searched.")
CELL_LIMIT = work(2.0**50, "cells", "Distance from the origin beyond which all positions are in one cell.")
ALL_PAIRS = work(16, "moving shapes", "Number up to which each shape is in the near list of every other.")
NEIGHBOURS = work(8.0, "shapes",
    "Length of a near list for which margins are chosen; the cheapest for packings from .05 to .65.")
MOST_NEIGHBOURS = work(20.0, "shapes", "Mean length of near lists above which margins are halved.")
MARGIN_LEAST = work(0.1, "radii", "Smallest margin.")
MARGIN_MOST = work(20.0, "radii", "Largest margin, and that of few shapes.")
MARGIN_HALVINGS = work(8, "number", "Halvings of margins, at most.")
ALL_WALLS = work(16, "static shapes", "Number up to which all static shapes are tested without a grid.")
REHEARSAL_NEAR = work(2.0, "times the ways in a step",
    "Distance within which pairs with handlers are near: the step is rehearsed, so that pymunk may call these.")
REHEARSAL_SHIFT = round_off(1e-07, "of the height above the lowest body",
    "Way of a body towards its support in a rehearsal. Smaller: round-off decides when a contact begins and ends.")
