"""Kernels of a new scene: how much memory it needs, and what its arrays have before the first step."""

from __future__ import annotations

import math

from ..compiled import Table, kernel, nonallocating
from ..geometry.corners import find_corners, thin
from ..model.parameters.impulses import AUGMENTATION
from ..model.scene import scene_of
from ..model.values import reading_of
from ..pairs.margins import begin_lists


@nonallocating
def measure_scene(reading: Table) -> None:
    """Write MEASURED."""
    R = reading_of(reading)
    M, LINK, ground = R.MEASURED, R.LINK, R.BODY.shape[0] - 1
    M.moving, M.vertices, M.lossy, few, many = 0, 2, 0, 0, 0
    for s in range(LINK.shape[0]):
        M.moving += 1 if LINK[s].owner < ground else 0
        if thin(LINK[s], R.VERTEX):
            # A scene remembers the sides of what sleeps, for when it wakes.
            few += 1 if LINK[s].owner < ground or R.BODIES[R.SHAPES[R.ORDER[s]].owner].asleep > 0 else 0
            many += 1
        M.vertices = max(M.vertices, LINK[s].vertices)
        if R.SHAPE[s].elasticity < 1.0:
            M.lossy = 1
    M.thin = few if many > 1 else 0


@kernel
def begin_scene(table: Table, limit: int, disks: int, together: int, budget: int, lossy: int) -> int:
    """Write to the arrays of a new scene, which contain zeros, what is not 0 in it: of bodies, of CORNER, of KEYS, and
    these fields of COUNT. Returns what `begin_lists` does."""
    A = scene_of(table)
    A.COUNT.limit, A.COUNT.disks, A.COUNT.together = limit, disks, together
    A.COUNT.budget, A.COUNT.lossy = budget, lossy
    A.PAR.share = 1.0
    A.KEYS[:] = -1
    ground = A.BODY.shape[0] - 1
    for i in range(A.BODY.shape[0]):
        A.PLACE[i] = -1
        A.STATE[i].island = -1
        A.MEMBER[i].tied, A.MEMBER[i].next_tied = -1, -1
        A.RESTING[i].augmentation, A.RESTING[i].longest = AUGMENTATION, math.inf
    for s in range(A.LINK.shape[0]):
        if A.LINK[s].owner < ground:
            A.STATE[A.LINK[s].owner].shapes += 1
    first = 0
    for i in range(A.BODY.shape[0]):
        A.STATE[i].first_shape = first
        first += A.STATE[i].shapes
    if A.CORNER.shape[0] > 0:
        find_corners(A.LINK, A.VERTEX, A.CORNER)
    return begin_lists(table)
