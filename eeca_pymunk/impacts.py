"""Impacts: the impulses of lone contacts at the instants at which they close, and the record of all impulses."""

from __future__ import annotations

import math

import numpy as np

from .arrays import Start
from .bodies import Bodies, BoolArray, FloatArray, IntArray
from .contacts import ROUND_OFF, Contacts, Geometry, Pairs, distance_from_axes, length
from .paths import Paths
from .shapes import Shapes
from .stepper import StepReport

_SLOW = 0.05  # contacts slower than this part of |a| dt rest: they would bounce 1 / _SLOW times in a step


class Log:
    """The impulses of a step, which may be taken in parts, and how the closure came to them.

    Attributes:
        offset: start of the present part of the step, time.
        lock: the scale of an energy lock that was farthest from 1.
        rounds: of all parts.  windows: the step was taken in.  converged: whether nothing was left to do.
    """

    def __init__(self, bodies: Bodies, start: Start) -> None:
        self.bodies, self.start = bodies, start
        self.offset, self.lock = 0.0, 1.0
        self.rounds, self.windows, self.converged = 0, 0, True
        self._entries: list[tuple[IntArray, IntArray, FloatArray, FloatArray, FloatArray, FloatArray]] = []

    def __len__(self) -> int:
        return len(self._entries)

    def forget(self, length: int) -> None:
        """Drop what was kept after there were `length` entries."""
        del self._entries[length:]

    def locked(self, scale: float) -> None:
        """Note the scale of an energy lock."""
        if abs(scale - 1.0) > abs(self.lock - 1.0):
            self.lock = scale

    def keep(
        self,
        first: IntArray,
        second: IntArray,
        normal: FloatArray,
        point: FloatArray,
        time: FloatArray,
        lam: FloatArray,
    ) -> None:
        """Note impulses `lam` (m,) between shapes `first` and `second` at instants `time` (m,) of this part."""
        self._entries.append((first, second, normal, point, time + self.offset, lam))

    def report(self, shapes: Shapes) -> StepReport:
        """The report of the step, contacts in the order of time; Delta g is Eq. 20 with the impulse's own Delta p."""
        start, m_inv = self.start, self.bodies.inverse_mass
        if not self._entries:
            return StepReport.without_contacts(start.time, self.bodies.items, max(self.windows, 1))
        first, second, normal, point, time, lam = (np.concatenate(part) for part in zip(*self._entries, strict=True))
        # Pairs of two disks first, as `Pairs` wants it; the order of time after the gaps are known.
        kind = np.argsort(shapes.wall[second] >= 0, kind="stable")
        gap = np.empty(len(time))
        gap[kind] = Pairs(shapes, first[kind], second[kind]).at(start.position).gap
        order = np.lexsort((second, first, time))
        a, b, time, lam = shapes.row[first[order]], shapes.row[second[order]], time[order], lam[order]
        psi2 = 1.0 - 2.0 * time / start.dt
        increment = 0.5 * start.dt * psi2 * lam * (m_inv[a] + m_inv[b])
        contacts = Contacts(self.bodies.items, a, b, normal[order], point[order], gap[order], time)
        return StepReport(
            start.time, contacts, lam, np.full_like(lam, math.inf), psi2, increment,
            iterations=self.rounds, substeps=self.windows, lock=self.lock, converged=self.converged,
        )  # fmt: skip


class Impacts:
    """Applies the impulses of lone contacts to the paths of the bodies: u' = -e u at the time of impact (design 4)."""

    def __init__(self, bodies: Bodies, start: Start, paths: Paths, log: Log) -> None:
        self.bodies, self.start, self.paths, self.log = bodies, start, paths, log
        self.moves: BoolArray = bodies.dynamic
        # (N,) speed that round-off of a body's place is worth in a step.
        self.still: FloatArray = (ROUND_OFF / start.dt) * distance_from_axes(start.position)
        # (N,) and the speed that the body's acceleration takes back at once.
        self.slow = self.still + _SLOW * start.dt * length(start.acceleration) if paths.pulled else self.still

    def stays(self, pairs: Pairs, speed: FloatArray) -> BoolArray:
        """(m,) whether a contact that opens with `speed` (m,) is as good as closed."""
        result: BoolArray = speed <= np.maximum(self.slow[pairs.row_a], self.slow[pairs.row_b])
        return result

    def meet(self, pairs: Pairs, time: FloatArray) -> tuple[Geometry, FloatArray]:
        """Geometry of the pairs at their instants (m,), and the speed (m,) at which they close there."""
        a, b, paths = pairs.row_a, pairs.row_b, self.paths
        at = pairs.between(paths.position(a, time), paths.position(b, time))
        u = paths.rate(a, time) - paths.rate(b, time)
        return at, at.normal[:, 0] * u[:, 0] + at.normal[:, 1] * u[:, 1]

    def bounce(self, pairs: Pairs, at: Geometry, approach: FloatArray, time: FloatArray) -> None:
        """Reflect lone contacts, no moving body of which occurs twice: lam = (1 + e) |u| / (1/m_a + 1/m_b)."""
        a, b = pairs.row_a, pairs.row_b
        m_a, m_b = self.bodies.inverse_mass[a], self.bodies.inverse_mass[b]
        lam = (1.0 + pairs.elasticity) * np.maximum(approach, 0.0) / (m_a + m_b)
        impulse = lam[:, None] * at.normal
        self.paths.kick(a, time, -m_a[:, None] * impulse)
        moves = np.flatnonzero(self.moves[b])
        self.paths.kick(b[moves], time[moves], m_b[moves, None] * impulse[moves])
        self.log.keep(pairs.first, pairs.second, at.normal, at.point, time, lam)
