"""The memory of an event loop's arrays, used again by the loop of the next reading of the space: how much a scene
needs, and what is in it before the first step."""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import Table, kernel, nonallocating
from ..compiled.layouts import ROWS, Layout, Plan
from ..compiled.library import result_of
from ..compiled.records import Rows
from ..geometry import corners
from ..joints.workspace import NO_LINKAGE, JointMemory
from ..model.bodies import Body
from ..model.parameters.impulses import AUGMENTATION
from ..model.scene import Scene, scene_of
from ..model.shapes import Link, Shape
from ..model.values import reading_of
from ..pairs.margins import begin_lists
from ..pairs.setup import NO_GRID, filled, pool_sizes
from .memory import OF_SCENE

RULE_COLUMNS = 6
_MISSED = 32  # rows of MISSED: those reported of a step
# Rows of PUSHED at first, a power of 2, as KEYS is a hash table: _CONTACTS; or, where contacts may persist, so many for
# each body, and _MOST_AT_FIRST at most. `islands.building.begin_islands` wants up to 4 rows for each entry of a near
# list, and lists have NEIGHBOURS = 8 entries.
_CONTACTS, _CONTACTS_OF_A_BODY, _MOST_AT_FIRST = 256, 32, 1 << 16
_FORCES_OF_A_CONTACT = 4  # rows of KEYS: half are free, half of the others have the forces of the last step
_EVENTS_OF_A_BODY = 8  # rows of the heap: one of them is valid, and all others are removed at once when it is full
_IMPULSES_OF_A_BODY = 4  # rows of LOG at first: few bodies have more impulses in a step
_FEW = 64  # rows that the heap and LOG have besides, for scenes of few bodies
_NO_RULE: FloatArray = np.zeros((0, RULE_COLUMNS))
_ZEROS = (*OF_SCENE, "PULL", "BEGAN", "HEAP_TIME", "HEAP_BODY", "BLOCK", "BOX", "CORNER", "MISSED")
_FILLED = "LOG", "KEYS", "FORCES", "PUSHED_BY", "PUSHED"  # before they are read


@nonallocating
def measure_scene(reading: Table) -> None:
    """Write MEASURED."""
    R = reading_of(reading)
    M, LINK, ground = R.MEASURED, R.LINK, R.BODY.shape[0] - 1
    M.moving, M.vertices, M.lossy, few, many = 0, 2, 0, 0, 0
    for s in range(LINK.shape[0]):
        M.moving += 1 if LINK[s].owner < ground else 0
        if corners.thin(LINK[s], R.VERTEX):
            # A scene remembers the sides of what sleeps, for when it wakes.
            few += 1 if LINK[s].owner < ground or R.BODIES[R.SHAPES[R.ORDER[s]].owner].asleep > 0 else 0
            many += 1
        M.vertices = max(M.vertices, LINK[s].vertices)
        if R.SHAPE[s].elasticity < 1.0:
            M.lossy = 1
    M.thin = few if many > 1 else 0


@kernel
def begin_scene(table: Table, limit: int, disks: int, together: int, budget: int, lossy: int) -> int:
    """Write to the arrays of a new scene, which contain zeros, what is not 0 in it: of bodies, of CORNER, of KEYS,
    these fields of COUNT, and PAR.share. Returns what `begin_lists` does."""
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
        corners.find_corners(A.LINK, A.VERTEX, A.CORNER)
    return begin_lists(table)


@cache
def _arrays() -> Plan[Scene]:
    return Plan(
        Scene, _ZEROS + _FILLED, len(_ZEROS), ("BODY", "SHAPE", "LINK", "VERTEX"),
        {"RULE": _NO_RULE, "CSR": NO_GRID},
        {"CORE": (2, ROWS, 4), "PULL": (ROWS, 3), "BEGAN": (ROWS, 3), "BOX": (ROWS, 4), "VERTEX": (ROWS, 4)},
    )  # fmt: skip


class Laid(NamedTuple):
    """The rows of a world, see `..model`; BODY has the present poses, and single disks first, so many `disks`.
    measured: their `Measures`."""

    BODY: Rows[Body]
    SHAPE: Rows[Shape]
    LINK: Rows[Link]
    VERTEX: FloatArray
    disks: int
    measured: Sequence[int]


class SceneMemory:
    """Memory for the scenes of one stepper: each replaces the one before, whose arrays it overwrites.

    Attributes:
        joints: for their joints.
        log, contacts: numbers of rows that LOG and PUSHED have at least, as an earlier scene needed them.
        thin: number of thin shapes that move or sleep in the last scene, 0 if no thin shapes may meet.
    """

    thin: int

    def __init__(self) -> None:
        self._layout = Layout(_arrays())
        self.joints, self.log, self.contacts = JointMemory(), 0, 0
        self._unjointed: tuple[Table, int] = None, 0
        self._words: IntArray = np.zeros(64, np.int64)
        self._other: SceneMemory | None = None

    def other(self) -> SceneMemory:
        """Memory for the next scene, while the last one here still exists: two take turns."""
        if self._other is None:
            self._other = SceneMemory()
            self._other._other = self
        self._other.log, self._other.contacts = self.log, self.contacts
        return self._other

    def scene(self, laid: Laid, limit: int, together: bool, budget: int) -> Table:
        """The table of a scene that has taken no step; the arrays given are kept, not copied. The numbers are fields of
        COUNT."""
        BODY, SHAPE, LINK, VERTEX, disks, (moving, vertices, self.thin, lossy) = laid
        n, k = len(BODY), len(LINK)
        room = _CONTACTS
        while room < max(min(_CONTACTS_OF_A_BODY * n, _MOST_AT_FIRST) if lossy else 0, self.contacts):
            room *= 2
        pool, heads = pool_sizes(moving)
        events, forces = _EVENTS_OF_A_BODY * n + _FEW, _FORCES_OF_A_CONTACT * room
        counts = {
            "PAR": 1, "COUNT": 1, "GRID": 1,
            "BODY": n, "STATE": n, "MEMBER": n, "RESTING": n, "PLACE": n, "PULL": n, "BEGAN": n, "BLOCK": n,
            "HEAP_TIME": events, "HEAP_BODY": events, "LOG": max(_IMPULSES_OF_A_BODY * n + _FEW, self.log),
            "SHAPE": k, "LINK": k, "MARK": moving, "CELL": moving, "LIST": moving, "BOX": k - moving,
            "POOL": pool, "FLAG": pool, "HEAD": heads, "VERTEX": len(VERTEX), "CORE": vertices,
            "SIDE": corners.side_rows(self.thin, k), "CORNER": 4 * k if self.thin else 0,
            "KEYS": forces, "FORCES": forces, "PUSHED_BY": room, "PUSHED": room, "MISSED": _MISSED,
        }  # fmt: skip
        table = self._layout.lay(counts, BODY, SHAPE, LINK, VERTEX)
        (begin,) = self._layout.bound(begin_scene)
        found = result_of("begin_scene", begin(limit, disks, together, budget, lossy))
        return filled(table, SHAPE, moving, found)

    def words(self, numbers: Sequence[int]) -> IntArray:
        """An array that begins with these numbers: the same one as long as it suffices, as calls of kernels with other
        ones take longer."""
        if len(numbers) > len(self._words):
            self._words = np.zeros(2 * len(numbers), np.int64)
        self._words.data.cast("B")[: 8 * len(numbers)] = array("q", numbers).tobytes()
        return self._words

    def records(self) -> tuple[memoryview, memoryview, memoryview]:
        """PAR as numbers, COUNT and LOG as integers, of the last scene."""
        layout = self._layout
        return layout.floats("PAR"), layout.integers("COUNT"), layout.integers("LOG")

    def unjointed(self, scene: Table, n: int) -> Table:
        """The table `Joints` of a scene without joints, of n bodies; also of later scenes, up to twice as many."""
        if self._unjointed[1] < n:
            self._unjointed = JointMemory().plan(scene, 2 * n, NO_LINKAGE), 2 * n
        return self._unjointed[0]
