"""The event loop: when shapes meet, and how much of it a step may do."""

from __future__ import annotations

from .record import heuristic, round_off, work

APPROACH_ROUND_OFF = round_off(
    1e-13, "of the speeds", "Closing speed of touching shapes below which they do not approach."
)
DISTANCE_ROUND_OFF = round_off(1e-09, "of the squared distance", "Distance within which APPROACH_ROUND_OFF counts.")
MISS_DISTANCE = round_off(
    1.000001, "ratio of squares", "Two paths miss if their least distance exceeds the sum of radii by this."
)
PATH_REACH = round_off(1.0000001, "ratio", "Two bodies cannot meet in the step if they miss each other by this.")
SEARCH_AHEAD = work(1.5, "times the time that is left", "Circles that cannot meet until then need no root.")
ADVANCES = work(
    1000,
    "number",
    "Evaluations of a gap in one search for an impact: a double root halves its error, a single one squares it.",
)
RESOLUTION = work(
    64,
    "in a step",
    "Intervals, looks at shapes that touch, hits times the bodies of an island, impacts of a body before it rests, or "
    "is squeezed; a bounce slower than |a| dt over it is none. Larger: dearer steps of what rattles.",
)
FARTHEST_MARGIN = work(
    0.7, "of the margin", "Distance by which a lone disk's new margin circle may be ahead of it, at most."
)
SAME_INSTANT = round_off(1e-09, "of the step", "Two computations of an instant that differ by less are the same.")
AHEAD = work(0.4, "of the margin", "Distance by which a new margin circle is ahead of its shape.")
INSIDE = work(0.1, "of the margin", "Part of the margin that is left, above which a shape has not left its circle.")
SOLVES_PER_BODY = work(
    512,
    "solves of every body in a step",
    "Work of a step after which it ends early. Larger: longer steps where bodies are squeezed.",
)
INITIAL_PENETRATION = heuristic(
    1e-06, "of the smaller shape", "Overlap above which shapes that were put into one another come apart in one step."
)
