"""Contacts that persist: how long an interval is, how precisely it is solved, how overlaps are corrected."""

from __future__ import annotations

from .record import accuracy, heuristic, round_off, work

TOUCH = accuracy(
    1e-07,
    "of the smaller shape",
    "Gap within which shapes touch. Smaller: round-off opens resting contacts. Larger: bodies rest apart.",
)
ELASTIC_REST = accuracy(1e-06, "of |a| dt", "Speed below which an elastic contact rests.")
ELASTIC_REST_ON = accuracy(0.001, "of |a| dt", "The same if it rested before.")
SOLVES_BEFORE_HASTE = heuristic(
    3, "solves of every body in a step", "Work after which islands are solved less precisely."
)
IMPACT_SPEED = accuracy(
    2.0,
    "of |a| h",
    "Approach speed from which a contact that closes in an interval is an impact; what is slower may freeze.",
)
NORMAL_TURN = accuracy(0.1, "rad", "Rotation of a normal in one interval. Larger: longer intervals, coarser rolling.")
EXACT_CONTACTS = heuristic(
    12, "contacts", "Number up to which an interval ends where a contact begins to stick or normals turn."
)
STICK = accuracy(1e-06, "of the friction limit", "Friction and slip below which a contact sticks.")
LARGE_SWEEPS = work(24, "sweeps", "Sweeps of a large island at the start of a step.")
LARGE_SWEEPS_HIT = work(12, "sweeps", "The same after it was hit within the step.")
INTERVAL_WAY = heuristic(
    0.5,
    "of the smaller shape; rad",
    "Relative way of two bodies in contact in one interval, and their rotation. Larger: contacts move while they are "
    "held fixed.",
)
INTERVAL_DEPTH = heuristic(0.05, "of the smaller shape", "Depth by which a contact may close in one interval.")
INTERVAL_DEPTH_WIDTH = heuristic(
    0.1,
    "of both widths",
    "Depth by which a contact may close in one interval, or an impact that is passed over by the end of the step: a "
    "tenth of the way through. Larger: cheaper and deeper piles.",
)
INTERVAL_DEPTH_LEAST = heuristic(
    0.0001,
    "of the smaller shape",
    "Depth that an interval may always reach. Up to it the nearer way out may be the wrong one: thin shapes that touch "
    "within it are on the side that they remember.",
)
INTERVAL_RETRY = heuristic(
    1.5, "ratio", "An interval is solved again, shorter, if bodies went farther than they should by this ratio."
)
SMALL_SWEEPS = work(40, "sweeps", "Sweeps of a small island that moves, and of an impact on a large one.")
INTERVAL_TRIES = work(12, "number", "Attempts at an interval, each shorter.")
MIDSTEP_PASSES = work(3, "solves", "Further solves of `Midstep` for bodies that impulses move into others.")
LARGE_ISLAND = heuristic(
    24, "bodies", "Size from which an island is large: impacts act on BLOCK_BODIES, sweeps are limited."
)
MIDPOINT_SAME = round_off(
    1e-07, "of the smaller shape", "Half way below which the geometry at the middle is that of the start."
)
MANIFOLD_ROUND_OFF = round_off(1e-09, "of the smaller shape", "Tolerance of a manifold.")
INTERVAL_RESIDUAL = accuracy(1e-12, "of |a| h", "Residual of an island, and of elastic ones.")
INTERVAL_RESIDUAL_MOVING = accuracy(1e-07, "of |a| h", "Residual of a large or moving island.")
INTERVAL_RESIDUAL_SPEED = accuracy(
    0.0001, "of its speed", "The same, relative to its speed; and of impacts on it, relative to the approach speed."
)
DIRECT = work(20, "direct solutions", "Direct solutions of an island near rest, or elastic.")
DIRECT_MOVING = work(6, "direct solutions", "The same of a moving island of few contacts.")
FIRST_SWEEPS = work(10, "sweeps", "Sweeps before the first direct solution.")
SWEEPS_AFTER = work(4, "sweeps", "Sweeps after each.")
BACKOFF_CONTACTS = work(
    40, "contacts", "Number beyond which direct solutions that did not converge are not tried again for some steps."
)
FAILED_DIRECT = work(8, "direct solutions", "Direct solutions without progress that end the solve.")
FAILED_DIRECT_AGAIN = work(2, "direct solutions", "The same where those of the last step failed.")
LONGEST_BACKOFF = work(32.0, "steps", "Longest time without direct solutions.")
OVERLAP_LEFT = accuracy(1e-09, "of the size", "Overlap that is not corrected.")
CORRECTION_ROUND_OFF = round_off(1e-14, "of its work", "Round-off of the work of a correction.")
CORRECTION_SHARE = accuracy(
    0.99,
    "of a budget that does not suffice",
    "Part of the energy lost that a correction uses; the rest is for the moments of inertia.",
)
REPAY_ROUND_OFF = round_off(1e-13, "of the energies", "Energy below which nothing is paid back.")
