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
GRAZED = heuristic(
    0.0001,
    "of the smaller shape",
    "Depth that shapes which touch and part may come to between two looks. Larger: fewer looks at what turns fast.",
)
SAME_INSTANT = round_off(1e-09, "of the step", "Two computations of an instant that differ by less are the same.")
AHEAD = work(0.4, "of the margin", "Distance by which a new margin circle is ahead of its shape.")
INSIDE = work(0.1, "of the margin", "Part of the margin that is left, above which a shape has not left its circle.")
STEP_LOOKS = work(
    32000,
    "looks",
    "Work of the events of a step after which it ends early: about .25 us each. Larger: longer steps.",
)
STEP_LOOKS_BODY = work(160, "looks", "What each body adds to it.")
MANY_BODIES = work(200, "bodies", "Number from which what a body adds grows with it, as piles are solved whole.")
BUDGET_TIME = work(1 / 30, "s", "Length of a step from which the budget grows with it.")
EVENT_LOOKS = work(4, "looks", "Work of an event, beside its forecasts.")
PAIR_LOOKS = work(4, "looks", "Work of the geometry of a pair in a solve.")
SWEEP_LOOKS = work(0.25, "looks", "Work of a contact in a sweep.")
DIRECT_LOOKS = work(0.25, "looks", "Work of a direct solution, times the square of its contacts.")
DEEP = round_off(1e3, "times the gap that counts as touching", "Overlap from which on points that part are no impact.")
