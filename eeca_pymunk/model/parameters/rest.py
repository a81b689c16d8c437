"""Rest: what is tested for static forces, when, and with how much work; when bodies fall asleep."""

from __future__ import annotations

from .record import accuracy, heuristic, work

# fmt: off
REST_SPEED = accuracy(1e-09, "of |a| dt", "Speed that static forces may leave.")
REST_CANDIDATE = heuristic(0.001, "of |a| dt",
    "Speed below which a body of a small island is tested for static forces. Larger: slow motion stops.")
REST_CANDIDATE_LARGE = heuristic(0.5, "of |a| dt",
    "Speed below which a body of a large island is tested for static forces.")
STOPPING_STEPS = heuristic(10.0, "steps", "Steps in which a body that is put to rest would stop, at most.")
STATICS_FACTORS = work(12, "factorisations", "Factorisations to find static forces, at most.")
STATICS_FACTORS_NEAREST = work(6, "factorisations", "Further factorisations to approach the guess.")
STATICS_START = accuracy(0.1, "of the mean guess", "Least impulse at the start of the interior-point iteration.")
STATICS_SUM = accuracy(10.0, "n times the momenta of n bodies",
    "Sum of the impulses of static forces beyond which none are sought.")
STATICS_STEP = accuracy(0.99, "of the distance to the boundary", "Step of the interior-point iteration.")
REST_RETRY = work(32, "steps",
    "Steps from one test for rest to the next. Larger: fewer factorisations, later rest.")
SUPPORT_FACTORS = work(4, "factorisations",
    "Factorisations to find the forces by which an island at rest supports moving bodies.")
SUPPORT_ROUNDS = work(8, "rounds", "Rounds in which support forces propagate to the islands below.")
MOVING_SHARE = heuristic(0.1, "of the bodies",
    "Part of an island, or one body, that may move while the rest of it is at rest, as a disk on a plank.")
PARTIAL_REST_FACTORS_STEP = work(8, "factorisations",
    "Factorisations of a freeze after which its island is not tested for partial rest in the step.")
SLEEP_SPEED = accuracy(1e-06, "of |g| dt", "Speed of a body that counts as at rest and may fall asleep.")
WAKE_ALL = work(4, "attempts",
    "Attempts at a step, of which each has touched bodies that slept and were woken, after which all bodies wake.")
SLEEP_RETRY = work(16, "steps", "Steps from one search for groups that may fall asleep to the next.")
SLEEP_SHARE = work(8, "parts of the bodies awake", "A group of one such part or more falls asleep at once.")
SLEEP_PATIENCE = work(120, "steps",
    "Steps after which smaller groups fall asleep: the space is then read again, and forces of contacts are lost.")
