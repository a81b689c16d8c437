"""The event loop: when shapes meet, and how much of it a step may do."""

from __future__ import annotations

from .record import heuristic, round_off, work

APPROACH_ROUND_OFF = round_off(
    1e-13, "of the speeds", "Closing speed of touching shapes below which they do not approach."
)
DISTANCE_ROUND_OFF = round_off(
    1e-09, "of the squared distance", "Distance of touching disks within which APPROACH_ROUND_OFF applies."
)
MISS_DISTANCE = round_off(
    1.000001,
    "ratio of squares",
    "Two paths miss each other if their least distance exceeds the sum of radii by this factor.",
)
PATH_REACH = round_off(
    1.0000001, "ratio", "Two bodies cannot meet in the step if their paths miss each other by this factor."
)
SEARCH_AHEAD = work(1.5, "times the time that is left", "Circles that cannot meet until then need no root finding.")
ADVANCES = work(
    1000,
    "number",
    "Evaluations of a gap in one search for an impact, at most; its inverse is the least advance of touching shapes.",
)
STRIDE = heuristic(
    1 / 16,
    "of the time that is left",
    "Advance by ADVANCES evaluations below which the search stops. Larger: bounces shorter than it are not resolved.",
)
FARTHEST_MARGIN = work(
    0.7, "of the margin", "Distance of the centre of a single disk's new margin circle ahead of it, at most."
)
SAME_INSTANT = round_off(1e-09, "of the step", "Two computations of an instant that differ by less agree.")
AHEAD = work(0.4, "of the margin", "Distance of the centre of a new margin circle ahead of its shape.")
INSIDE = work(0.1, "of the margin", "Part of the margin that must be left for a shape to count as inside its circle.")
SQUEEZED_IMPACTS = heuristic(
    50,
    "impacts of a body in a step",
    "Number after which its impacts with kinematic bodies are ignored where walls close in. Larger: slower steps.",
)
SOLVES_PER_BODY = work(
    512,
    "solves of every body in a step",
    "Work after which a step ends early. Larger: slower steps where bodies are squeezed.",
)
INITIAL_PENETRATION = heuristic(
    1e-06, "of the smaller shape", "Overlap above which shapes that the program placed into each other are separated."
)
