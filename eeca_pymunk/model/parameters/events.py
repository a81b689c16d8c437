"""The event loop: when shapes meet, and how much of it a step may do."""

from __future__ import annotations

from .record import heuristic, round_off, work

# fmt: off
APPROACH_ROUND_OFF = round_off(1e-13, "of the speeds",
    "Closing speed of touching shapes below which they do not approach.")
DISTANCE_ROUND_OFF = round_off(1e-09, "of the squared distance",
    "Distance of touching disks within which APPROACH_ROUND_OFF applies.")
MISS_DISTANCE = round_off(1.000001, "ratio of squares",
    "Two paths miss each other if their least distance exceeds the sum of radii by this factor.")
PATH_REACH = round_off(1.0000001, "ratio",
    "Two bodies cannot meet in the step if their paths miss each other by this factor.")
SEARCH_AHEAD = work(1.5, "times the time that is left", "Circles that cannot meet until then need no root finding.")
ADVANCES = work(1000, "number", "Evaluations of a gap in a part of a step in one search for an impact, at most.")
RESOLUTION = work(64, "in a step",
    "Intervals, looks at shapes that touch, hits times the bodies of an island, impacts of a body before it rests, "
    "or is squeezed; a bounce slower than |a| dt over it is none. Larger: dearer steps of what rattles.")
WORK_JOINTED = work(2, "times those of other islands", "Hits on islands with joints, and solves of their bodies.")
BUSY_STEPS = work(32, "steps",
    "Steps for which bodies are busy after an impact was passed over. Larger: fewer single impacts of piles that "
    "settle. With this and REST_RETRY at 8, falling piles cost a tenth more, and three times as many of their steps "
    "pass over impacts.")
BUSY_WORK = work(0.5, "of a step's work", "After which an island becomes busy that is hit as often as a step allows.")
FARTHEST_MARGIN = work(0.7, "of the margin",
    "Distance of the centre of a single disk's new margin circle ahead of it, at most.")
SAME_INSTANT = round_off(1e-09, "of the step", "Two computations of an instant that differ by less agree.")
AHEAD = work(0.4, "of the margin", "Distance of the centre of a new margin circle ahead of its shape.")
MARGIN_LEFT = work(0.1, "of the margin", "Part of the margin that is left of a shape that counts as inside its circle.")
STEP_LOOKS = work(48000, "looks",
    "Work of the events of a step after which it ends early: about .3 us each. Larger: longer steps.")
STEP_LOOKS_BODY = work(80, "looks", "What each body adds to it.")
MANY_BODIES = work(200, "bodies", "Number from which what a body adds grows with it, as piles are solved whole.")
BUDGET_TIME = work(1 / 30, "s", "Length of a step from which the budget grows with it.")
LONGEST_SEARCH = work(1.25, "of the budget",
    "Work of a step at which a search for an impact ends where it is: the step ends early there.")
EVENT_LOOKS = work(5, "looks", "Work of an event, beside its predictions.")
VERTICES_LOOK = work(40, "pairs of vertices", "Number that costs as much as the rest of a look.")
SHAPES_LOOK = work(16, "shapes", "Further shapes of a body whose prediction costs a look, beside their near lists.")
ENTRY_LOOKS = work(0.75, "looks", "Work of a shape in a near list that a prediction looks through.")
BODY_LOOKS = work(7.5, "looks", "Work of a body in a solve.")
PAIR_LOOKS = work(1.25, "looks", "Work of the geometry of a pair in a solve, or of the gap that leaves it out.")
OPERATION_LOOKS = work(0.00125, "looks", "Work of an operation of a homotopy.")
SWEEP_LOOKS = work(0.28, "looks", "Work of a contact in a sweep.")
DIRECT_LOOKS = work(0.1, "looks", "Work of a direct solution, times its contacts, times these up to DENSE_CONTACTS.")
INITIAL_PENETRATION = heuristic(1e-06, "of the smaller shape",
    "Overlap above which shapes that the program placed into each other are separated. Smaller: large piles move on.")
