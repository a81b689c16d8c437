"""Contacts that persist: how long an interval is, how precisely it is solved, how overlaps are corrected."""

from __future__ import annotations

from .record import accuracy, heuristic, round_off, work

# fmt: off
TOUCH = accuracy(1e-07, "of the smaller shape",
    "Gap within which shapes touch. Smaller: round-off opens resting contacts. Larger: bodies rest apart.")
ELASTIC_REST = accuracy(1e-06, "of |a| dt", "Speed below which a touching elastic contact persists.")
ELASTIC_REST_ON = accuracy(0.001, "of |a| dt", "Speed below which an elastic contact that carried a force persists.")
SOLVES_BEFORE_HASTE = heuristic(3, "solves of every body in a step",
    "Work after which large islands are neither hit nor joined in the step.")
IMPACT_SPEED = accuracy(2.0, "of |a| h",
    "Approach speed from which a contact that closes in an interval is an impact; what is slower may freeze.")
SAGITTA = accuracy(0.01, "of the smaller body",
    "How far points of a turning wall leave their chord in one interval with joints. Larger: jointed bodies creep on "
    "such walls.")
NORMAL_TURN = accuracy(0.1, "rad", "Rotation of a normal in one interval. Larger: longer intervals, coarser rolling.")
EXACT_CONTACTS = heuristic(12, "contacts, or pairs that may touch",
    "Number up to which an interval ends where a slipping contact begins to stick or a normal has rotated.")
STICK_TOLERANCE = accuracy(1e-06, "of the friction limit",
    "Friction and slip, relative to their bounds, below which a contact sticks.")
LARGE_SWEEPS = work(24, "sweeps", "Sweeps of a large island at the start of a step.")
LARGE_SWEEPS_HIT = work(12, "sweeps", "Sweeps of a large island that was hit within the step.")
INTERVAL_WAY = heuristic(0.5, "of the smaller shape; rad",
    "Relative way of two bodies in contact in one interval, and their rotation. Larger: contacts move while they are "
    "held fixed.")
TRAVEL_MARGIN = accuracy(1.1, "of the way by the speeds and accelerations at its start",
    "Reach of shapes within an interval. Smaller: impulses within it bring shapes together that are not in it. Larger: "
    "more candidates.")
REACH_ROUND_OFF = round_off(1e-9, "of a body", "Reach of a body at rest within an interval.")
INTERVAL_DEPTH = heuristic(0.05, "of the smaller shape", "Depth by which a contact may close in one interval.")
INTERVAL_DEPTH_WIDTH = heuristic(0.1, "of both half widths",
    "Depth by which a contact may close in one interval, or an impact that is passed over by the end of the step: a "
    "tenth of the way through. Larger: cheaper and deeper piles.")
INTERVAL_DEPTH_LEAST = heuristic(0.0001, "of the smaller shape",
    "Depth that an interval may always reach. Up to it the nearer way out may be the wrong one: thin shapes that "
    "touch within it are on the side that they remember.")
INTERVAL_RETRY = heuristic(1.5, "ratio",
    "Excess of a displacement, rotation or depth over its limit from which on an interval is solved again, shorter.")
SMALL_SWEEPS = work(40, "sweeps",
    "Sweeps of an impact on a pile before its direct solves, of a small island that waits for its next one, and of "
    "many contacts of a small island with joints.")
UNSOLVED_PART = work(4.0, "ratio",
    "Factor by which an interval with joints becomes shorter, at most, where its contacts are not solved.")
SLIGHT_DEPTH = heuristic(0.1, "of what an interval allows",
    "Depth of a contact that may stay: beyond it all losses of the step pay for lifting. Smaller: piles move on.")
INTERVAL_GROWTH = work(8.0, "ratio", "Factor by which an interval with joints is longer than the last one, at most.")
INTERVAL_TRIES = work(12, "number", "Attempts at an interval, each shorter, at most.")
MIDSTEP_PASSES = work(3, "solves", "Further solves of `Midstep` for bodies that impulses move into others, at most.")
LARGE_ISLAND = heuristic(24, "bodies",
    "Size from which on an island is large: hits act on BLOCK_BODIES, sweeps are limited.")
MIDPOINT_SAME = round_off(1e-07, "of the smaller shape",
    "Half the displacement of a pair below which the geometry at the middle is that of the start.")
MANIFOLD_ROUND_OFF = round_off(1e-09, "of the smaller shape", "Tolerance of a manifold.")
INTERVAL_RESIDUAL = accuracy(1e-12, "of |a| h", "Residual of islands near rest and of elastic islands.")
RESIDUAL_OF_SPEED = accuracy(0.001, "of the fastest speed",
    "What stands for |a| h in residuals, and in WEDGED, where nothing accelerates.")
INTERVAL_UNMET = accuracy(1e-06, "of |a| h", "Residual beyond which few contacts count as unsolved in reports.")
INTERVAL_RESIDUAL_MOVING = accuracy(1e-07, "of |a| h", "Residual of a large moving island.")
INTERVAL_RESIDUAL_SPEED = accuracy(0.0001, "of its speed",
    "The same, relative to its speed; and of impacts on it, relative to the approach speed.")
DIRECT = work(20, "direct solutions", "Direct solutions of an island near rest, or elastic, at most.")
DIRECT_MOVING = work(6, "direct solutions",
    "Direct solutions of a moving island of few bodies, or of a hit on a pile, at most.")
FIRST_SWEEPS = work(4, "sweeps", "Sweeps of an island before its first direct solution.")
SWEEPS_AFTER = work(4, "sweeps", "Sweeps of an island after each direct solution.")
DIRECT_PROGRESS = work(0.2, "ratio of residuals",
    "Progress of a direct solution and the sweeps after it above which it has failed.")
FAILED_DIRECT = work(8, "direct solutions", "Direct solutions without progress after which the solve ends.")
FAILED_DIRECT_AGAIN = work(2, "direct solutions",
    "Direct solutions without progress after which the solve ends if that of the last step failed.")
LONGEST_BACKOFF = work(32.0, "solves", "Largest number of solves in a row in which direct solutions are suspended.")
OVERLAP_LEFT = accuracy(1e-09, "of the smallest body", "Overlap that is not corrected.")
LIFT_RESIDUAL = accuracy(0.1, "of OVERLAP_LEFT", "Change of a gap in a sweep at which a correction is solved.")
CORRECTION_STEP = accuracy(0.25, "of the smaller body",
    "Way of any point of a body by the correction in one interval, at most: half of what would take its centre "
    "through a thin wall that it touches. More turns boxes in large piles to and fro, deeper and deeper into each "
    "other.")
CORRECTION_SWEEPS = work(20, "sweeps",
    "Sweeps of the penetration correction, at least. With 8, piles of a thousand bodies without friction keep "
    "overlaps of a tenth of a radius; with 40, falling piles cost .15 more.")
CORRECTION_WORK = work(1000, "contacts swept", "Work for further sweeps of the penetration correction of few contacts.")
WALL_SWEEPS = work(8, "sweeps",
    "Sweeps over contacts with what nothing moves, after a solve or a correction that has not converged, at most.")
CORRECTION_ROUND_OFF = round_off(1e-14, "of its work", "Round-off of the work of a correction.")
CORRECTION_SHARE = accuracy(0.99, "of a budget that does not suffice",
    "Part of the energy lost that a correction uses; the rest covers changes of moments of inertia.")
CORRECTION_TRIES = work(5, "number",
    "How often a correction is made smaller, as moments of inertia change with it; the last one is none.")
REPAY_ROUND_OFF = round_off(1e-13, "of the energies",
    "Energy gain of a shortened interval below which its forces are not replaced.")
