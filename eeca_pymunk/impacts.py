"""Impacts: the impulses of lone contacts at the instants at which they close, and the record of all impulses."""

from __future__ import annotations

import math

import numpy as np

from .arrays import Start
from .bodies import Bodies, BoolArray, FloatArray, IntArray
from .contacts import ROUND_OFF, Contacts, Geometry, Pairs, distance_from_axes, length
from .paths import Paths
from .stepper import StepReport

_SLOW = 0.05  # contacts slower than this part of |a| dt rest: they would bounce 1 / _SLOW times in a step


class Impacts:
    """Applies the impulses of one step to the paths of its bodies, and keeps them for the report.

    A lone contact is reflected at its time of impact, u' = -e u (design section 4).

    Attributes:
        lock: the scale of an energy lock that was farthest from 1.
    """

    def __init__(self, bodies: Bodies, start: Start, paths: Paths) -> None:
        self.bodies, self.start, self.paths = bodies, start, paths
        self.moves: BoolArray = bodies.dynamic
        self.lock = 1.0
        # (N,) speed that round-off of a body's place is worth in a step.
        self.still: FloatArray = (ROUND_OFF / start.dt) * distance_from_axes(start.position)
        # (N,) and the speed that the body's acceleration takes back at once.
        self.slow = self.still + _SLOW * start.dt * length(start.acceleration) if paths.pulled else self.still
        self.log: list[tuple[IntArray, IntArray, FloatArray, FloatArray, FloatArray, FloatArray]] = []

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
        self.keep(pairs.first, pairs.second, at.normal, at.point, time, lam)

    def keep(
        self,
        first: IntArray,
        second: IntArray,
        normal: FloatArray,
        point: FloatArray,
        time: FloatArray,
        lam: FloatArray,
    ) -> None:
        """Note impulses `lam` (m,) between shapes `first` and `second` at instants `time` (m,)."""
        self.log.append((first, second, normal, point, time, lam))

    def report(self, pairs: Pairs, rounds: int, windows: int, converged: bool) -> StepReport:
        """The report of the step, contacts in the order of time; Delta g is Eq. 20 with the impulse's own Delta p."""
        start, m_inv = self.start, self.bodies.inverse_mass
        if not self.log:
            return StepReport.without_contacts(start.time, self.bodies.items, windows)
        first, second, normal, point, time, lam = (np.concatenate(part) for part in zip(*self.log, strict=True))
        shapes = pairs.shapes
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
            iterations=rounds, substeps=windows, lock=self.lock, converged=converged,
        )  # fmt: skip
