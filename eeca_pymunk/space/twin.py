"""Detection: the margin twin finds the pairs that may touch, and keeps the list while it is complete (design 7).

pymunk reports a contact only where shapes overlap. The twin is a private space of grown shapes, each with a margin of
its own; its arbiters are the pairs whose gap is below the sum of their margins. The list is a Verlet list: it stays
complete until some shape has used its margin up.

For a crowd of disks between few walls a cell list takes the place of the private space: it finds the same pairs. Of a
step of 16 000 disks pymunk's detection was 58 to 70 %, five times what the cell list takes.
"""

from __future__ import annotations

import math

import numpy as np

from .._rounds.cells import CellList
from .._rounds.contacts import Pairs
from .._rounds.features import distance_from_axes, length
from ..arrays import FloatArray, IntArray
from .bodies import Bodies
from .grown import GrownSpace
from .shapes import Shapes

_HASH_FROM = 200  # moving shapes from which a spatial hash pays (measured: equal cost near 150), or a cell list
_MANY = 2000  # moving shapes from which detection waits for memory (measured)
_FOLLOWED_BY = 16  # walls up to which growing them costs less than following the mean motion saves
_FEW = 0.05  # part of the disks of a crowd for which a list of pairs is made longer rather than anew
_WIDEST = 20.0  # cells that the margin of one disk may span in a hash


class MarginTwin:
    """Candidate pairs of a space's shapes. Rebuild it when shapes come, go or change.

    Found anew, margins are powers of sqrt(2) times a thousandth of the radius, and a disk's margin follows its own
    speed, so that one fast disk does not make neighbours of everybody.
    """

    # Steps that a margin should last at the disk's own speed, and at the mean speed, which an impulse may give to any
    # disk; neither is worth more than so many radii, beyond which pairs cost more than finding them anew.
    steps_ahead, most_ahead = 4.0, 2.0
    steps_struck, most_struck = 5.0, 0.35
    # The same of a cell list, which costs less to make, and less still to make longer (measured).
    steps_ahead_cells, most_struck_cells = 1.2, 0.8

    def __init__(self, bodies: Bodies, shapes: Shapes, state: FloatArray) -> None:
        self.bodies, self.shapes = bodies, shapes
        self.detections = 0
        self.memory: object = None  # what a closure keeps from step to step; gone with the shapes it is about
        self._static = state[bodies.static, :3]
        self._moving: IntArray = np.flatnonzero(shapes.wall < 0)
        self._row: IntArray = shapes.row[self._moving]
        self._size: FloatArray = shapes.size[self._moving]
        self._unit: FloatArray = 1e-3 * np.maximum(self._size, np.finfo(float).tiny)
        self._follows = len(shapes) - len(self._moving) <= _FOLLOWED_BY < len(self._moving)
        # (N,) how far the farthest point of a body goes for each radian.
        self._lever: FloatArray = np.zeros(len(bodies))
        if shapes.general:
            np.maximum.at(self._lever, self._row, self._size)
        self._one_each = len(np.unique(self._row)) == len(self._row)
        self._center: FloatArray | None = None
        self._drift: FloatArray = np.zeros(2)
        # By body: how far it gets from its start in the step, and how far it may.
        self._reach: FloatArray = np.zeros(len(bodies))
        self._room: FloatArray = np.full(len(bodies), np.inf)
        self._pairs = Pairs(shapes, np.zeros(0, np.intp), np.zeros(0, np.intp))
        self._cell = 5.0 * float(np.median(self._size)) if len(self._moving) >= _HASH_FROM else 0.0
        pose = bodies.poses(state, shapes.general)
        self._build(pose[self._row])

    def _build(self, center: FloatArray) -> None:
        self._space: CellList | GrownSpace
        if self._cell > 0.0 and not self.shapes.general and len(self.shapes) - len(self._moving) <= _FOLLOWED_BY:
            self._space = CellList(self.shapes, self._moving)
        else:
            offset = self.bodies.center_of_gravity[self.shapes.row]
            self._space = GrownSpace(self.shapes, self._moving, offset, center, self._cell)
        self._margin: FloatArray = np.zeros(len(self._moving))
        self._wall_margin = 0.0

    def is_current(self, state: FloatArray) -> bool:
        """False when a static body was moved since the twin was built."""
        return bool(np.array_equal(self._static, state[self.bodies.static, :3]))

    def candidates(self, position: FloatArray, displacement: FloatArray, slack: FloatArray) -> Pairs:
        """Every pair whose gap can close within a step, sorted by `Pairs.key`.

        Gaps close by relative motion alone: reaches and margins are taken in the frame that moves with the disks on
        average, in which a falling crowd hardly moves and the walls do.

        Args:
            position: (N, 2) of the bodies at the start of the step, or (N, 3) with the angle.
            displacement: (N, 2 or 3) of the bodies over the step.
            slack: (N,) length by which a path may leave the straight line of its displacement.
        """
        center, moving = position.take(self._row, axis=0), displacement.take(self._row, axis=0)
        follows = self._follows and len(moving) > 0
        self._drift = moving[:, :2].mean(axis=0) if follows else np.zeros(2)
        reach = self._sweep(moving, self._row, self._drift) + slack[self._row]
        self._reach[self._row] = reach
        if self._center is None:
            self._detect(center)
            return self._allowed()
        moved = center - self._center
        frame = moved[:, :2].mean(axis=0) if follows else np.zeros(2)
        self._moved = self._sweep(moved, self._row, frame)
        walls = math.hypot(*frame) + math.hypot(*self._drift)
        if walls > self._wall_margin:
            self._detect(center)
        else:
            self._complete(center)
        return self._allowed()

    def _complete(self, center: FloatArray) -> None:
        """Find what the list lacks for the reaches of the disks."""
        reach = self._reach[self._row]
        short = np.flatnonzero(reach > self._margin - self._moved)
        if len(short) > (_FEW * len(center) if isinstance(self._space, CellList) else 0):
            self._detect(center)
            return
        if len(short):
            assert isinstance(self._space, CellList)
            self._margin[short] = self._moved[short] + self._needed(center)[short]
            self._space.grow(short, self._margin[short])
            self._pairs = self._space.find_more(short, self._pairs)
        self._leave(self._margin - self._moved)

    def _allowed(self) -> Pairs:
        """The pairs of the list that collision handlers let collide."""
        ignored = self.shapes.rules.ignored
        if not ignored:
            return self._pairs
        first, second = self._pairs.first, self._pairs.second
        low, high = np.minimum(first, second), np.maximum(first, second)
        barred = np.array([(i, j) in ignored for i, j in zip(low.tolist(), high.tolist(), strict=True)], bool)
        return self._pairs.take(np.flatnonzero(~barred))

    def _sweep(self, displacement: FloatArray, rows: IntArray, frame: FloatArray) -> FloatArray:
        """(m,) how far points of the bodies `rows` get at most, in a frame that moves by (2,)."""
        if displacement.shape[1] == 2:
            return length(displacement - frame)
        return length(displacement[:, :2] - frame) + self._lever[rows] * np.abs(displacement[:, 2])

    def covers(self, rows: IntArray, displacement: FloatArray, slack: FloatArray) -> bool:
        """Whether the list stays complete when the bodies `rows` (m,) take other paths in the step it was asked for.

        Args:
            displacement: (m, 2 or 3) of these bodies over the step.  slack: (m,) length, as in `candidates`.
        """
        reach = self._sweep(displacement, rows, self._drift) + slack
        self._reach[rows] = np.maximum(self._reach[rows], reach)
        return bool((reach <= self._room[rows]).all())

    def widen(self, position: FloatArray) -> Pairs:
        """The candidates of the step that starts at `position` (N, 2 or 3), for all that `covers` was asked."""
        self._complete(position.take(self._row, axis=0))
        return self._allowed()

    def _leave(self, room: FloatArray) -> None:
        """Note what the motion so far leaves of every margin (D,)."""
        if self._one_each:
            self._room[self._row] = room
        else:
            self._room[self._row] = np.inf
            np.minimum.at(self._room, self._row, room)

    def _wanted(self, reach: FloatArray) -> FloatArray:
        """(D,) margins: what the step needs, and more where some more makes the list last."""
        mean = math.sqrt(float(np.mean(reach * reach)))
        # Among few disks even wide margins make few pairs.
        few = max(1.0, _HASH_FROM / len(reach))
        if isinstance(self._space, CellList):
            ahead, most = self.steps_ahead_cells, self.most_struck_cells
        else:
            # Where pymunk's bodies no longer fit the processor's cache, lists that last are worth more pairs.
            ahead, most = self.steps_ahead, self.most_struck * (1.0 if len(reach) < _MANY else math.sqrt(2.0))
        own = np.minimum(min(few, 2.0) * ahead * reach, few * self.most_ahead * self._size)
        struck = np.minimum(self.steps_struck * mean, most * self._size)
        return np.maximum(np.maximum(reach, own), struck)

    def _needed(self, center: FloatArray) -> FloatArray:
        """(D,) margins, with a relative 1e-9 for pairs at its end and for the round-off of far-away positions."""
        floor = 1e-9 * (distance_from_axes(center) + self._size)
        return np.maximum(self._wanted(self._reach[self._row]) + floor, self._unit)

    def _detect(self, center: FloatArray) -> None:
        if len(center) == 0:
            return
        need = self._needed(center)
        level = self._unit * np.exp2(0.5 * np.ceil(2.0 * np.log2(need / self._unit)))
        if self._space.hashed and level.max() > _WIDEST * self._cell:
            # A hash would put a disk this fast into more cells than there is time for.
            self._cell = 0.0
            self._build(center)
        changed = np.flatnonzero((level > self._margin) | (level < 0.25 * self._margin))
        self._space.grow(changed, level[changed])
        self._margin[changed] = level[changed]
        drift = math.hypot(*self._drift)
        if not 4.0 * drift <= self._wall_margin <= 64.0 * drift:
            # Enough for some steps of the moving frame.
            self._wall_margin = 16.0 * drift
            self._space.grow_walls(self._wall_margin)
        self._pairs = self._space.find(center)
        self._center, self._moved = center.copy(), np.zeros(len(center))
        self._leave(self._margin)
        self.detections += 1
