"""Impacts: impulses at the instants at which contacts close, alone or in blocks, and the forces of contacts at rest."""

from __future__ import annotations

import math

import numpy as np

from . import balance
from .arrays import Start
from .bodies import Bodies, BoolArray, FloatArray, IntArray
from .complementarity import Delassus, components, restrict, solve
from .contacts import ROUND_OFF, Contacts, Geometry, Pairs, distance_from_axes, length, touching
from .paths import Paths
from .stepper import StepReport

_TOLERANCE = 1e-12  # of the complementarity problems, relative to the largest approach speed
_SLOW = 0.05  # contacts slower than this part of |a| dt rest: they would bounce 1 / _SLOW times in a step


class Impacts:
    """Applies the impulses of one step to the paths of its bodies, and keeps them for the report.

    Two laws (design sections 2, 4). A lone contact is reflected at its time of impact, u' = -e u. Contacts that act on
    one body at one instant, and those that touch there, are one block: 0 <= lam _|_ A lam + (1 + e) u >= 0.
    Contacts that touch without speed while forces press them rest on each other: over what is left of the step they
    exert a constant force, the rigid limit 0 <= lam _|_ A lam + e u_n + u* >= 0 with psi2 = 0 over that time.

    Attributes:
        lock: the scale of the energy lock that was farthest from 1.
    """

    def __init__(self, bodies: Bodies, start: Start, paths: Paths) -> None:
        self.bodies, self.start, self.paths = bodies, start, paths
        self.moves: BoolArray = bodies.dynamic
        self.lock = 1.0
        # (N,) speed below which a contact of the body does not leave: what round-off of its place is worth in a step,
        # and what the body's acceleration brings back at once.
        self.slow: FloatArray = (ROUND_OFF / start.dt) * distance_from_axes(start.position)
        if paths.pulled:
            self.slow = self.slow + _SLOW * start.dt * length(start.acceleration)
        self._log: list[tuple[IntArray, IntArray, FloatArray, FloatArray, FloatArray, FloatArray]] = []

    def stays(self, pairs: Pairs, speed: FloatArray) -> BoolArray:
        """(m,) whether a contact that opens with `speed` (m,) counts as touching on."""
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
        self._keep(pairs, at, time, lam)

    def strike(self, pairs: Pairs, seed: FloatArray, spent: BoolArray, resting: BoolArray) -> tuple[IntArray, IntArray]:
        """Solve blocks of contacts that share bodies, each at one instant, and let rest what stays in touch.

        Args:
            pairs: the m contacts of all blocks.
            seed: (m,) time of impact of the contacts that cause a block, infinity for those that merely touch.
            spent: (m,) whether the contact has bounced so often that it has to stop, if its elasticity is below 1.
            resting: (m,) whether the contact carries a force now.

        Returns:
            The contacts that touch on, and those of them that rest on a force (indices into `pairs`).
        """
        bodies, paths = self.bodies, self.paths
        rows, a, b = restrict(pairs.row_a, pairs.row_b, len(bodies))
        moves = self.moves[rows]
        label = components(a, b, moves)
        instant = np.full(len(rows), np.inf)
        np.minimum.at(instant, np.where(moves[a], label[a], label[b]), seed)
        t = np.where(moves, instant[label], 0.0)
        time = np.maximum(t[a], t[b])
        x, v = paths.position(rows, t), paths.rate(rows, t)
        at = pairs.between(x[a], x[b])
        touch = resting | (seed < np.inf) | (at.gap <= touching(pairs, paths.origin))
        A = Delassus(a, b, at.normal, bodies.inverse_mass[rows])
        u = A.relative(v)
        e = np.where((pairs.elasticity < 1.0) & (spent | self.stays(pairs, np.abs(u))), 0.0, pairs.elasticity)
        lam = self._solve(A, np.flatnonzero(touch), balance.restitution_target(u, e) + u)
        change = A.impulse(lam) * A.inverse_mass[:, None]
        v += change
        mine = np.flatnonzero(moves)
        paths.kick(rows[mine], t[mine], change[mine])
        hit = np.flatnonzero(lam > 0)
        self._keep(pairs.take(hit), at.take(hit), time[hit], lam[hit])
        on = np.flatnonzero(touch & self.stays(pairs, A.relative(v)))
        if not paths.pulled:
            return on, on[:0]
        return on, self._rest(pairs, on, rows, t, x, v)

    def _rest(
        self, pairs: Pairs, on: IntArray, rows: IntArray, t: FloatArray, x: FloatArray, v: FloatArray
    ) -> IntArray:
        """Give the contacts `on` the forces that keep them closed until the end of the step; those that have one."""
        chosen, number = pairs.take(on), np.zeros(len(self.bodies), np.intp)
        number[rows] = np.arange(len(rows))
        a, b = number[chosen.row_a], number[chosen.row_b]
        free = self.start.acceleration[rows]
        left = self.start.dt - t
        # The normal at the kink of the rigid limit, half-way, makes angular momentum exact.
        half = 0.5 * left[:, None]
        middle = x + half * v + (0.5 * half * half) * free
        at = chosen.between(middle[a], middle[b])
        A = Delassus(a, b, at.normal, self.bodies.inverse_mass[rows])
        span = np.where(self.moves[rows[a]], left[a], left[b])
        u = A.relative(v)
        # What rests and is not elastic does not bounce.
        e = np.where(chosen.elasticity < 1.0, 0.0, 1.0)
        lam = self._solve(A, np.arange(len(on)), balance.restitution_target(u, e) + u + span * A.relative(free))
        pressed = np.flatnonzero(lam > 0)
        mine = np.flatnonzero(self.moves[rows])
        force = np.divide(lam, span, out=np.zeros_like(lam), where=span > 0)
        pull = free + A.impulse(force) * A.inverse_mass[:, None]
        self.paths.pull(rows[mine], t[mine], pull[mine])
        self._keep(chosen.take(pressed), at.take(pressed), (self.start.dt - 0.5 * span)[pressed], lam[pressed])
        return on[pressed]

    def _solve(self, A: Delassus, which: IntArray, q: FloatArray) -> FloatArray:
        """(m,) impulses of the contacts `which`, 0 for the others, scaled by the energy lock of their block."""
        lam = np.zeros(A.size)
        part = A.take(which)
        result = solve(part, q[which], tolerance=_TOLERANCE)
        if not result.exact:
            island = np.unique(components(part.row_a, part.row_b, part.inverse_mass > 0), return_inverse=True)[1]
            of_contact = np.where(part.inverse_mass[part.row_a] > 0, island[part.row_a], island[part.row_b])
            zero = np.zeros(part.size)
            lock = balance.energy_lock(
                part, of_contact, result.lam, q[which], zero, np.zeros((len(part.inverse_mass), 2))
            )
            scale = np.where(lock.valid, lock.scale, 0.0)
            worst = float(scale[np.argmax(np.abs(scale - 1.0) * (result.lam > 0))])
            self.lock = worst if abs(worst - 1.0) > abs(self.lock - 1.0) else self.lock
            lam[which] = scale * result.lam
            return lam
        lam[which] = result.lam
        return lam

    def _keep(self, pairs: Pairs, at: Geometry, time: FloatArray, lam: FloatArray) -> None:
        self._log.append((pairs.first, pairs.second, at.normal, at.point, time, lam))

    def report(self, pairs: Pairs, rounds: int, converged: bool) -> StepReport:
        """The report of the step, contacts in the order of time; Delta g is Eq. 20 with the impulse's own Delta p."""
        start, m_inv = self.start, self.bodies.inverse_mass
        if not self._log:
            return StepReport.without_contacts(start.time, self.bodies.items)
        first, second, normal, point, time, lam = (np.concatenate(part) for part in zip(*self._log, strict=True))
        # Pairs of two disks first, as `Pairs` wants it; the order of time after the gaps are known.
        kind = np.argsort(pairs.shapes.wall[second] >= 0, kind="stable")
        chosen = Pairs(pairs.shapes, first[kind], second[kind])
        gap = chosen.at(start.position).gap
        by_time = np.lexsort((chosen.second, chosen.first, time[kind]))
        order = kind[by_time]
        a, b, time, lam = chosen.row_a[by_time], chosen.row_b[by_time], time[order], lam[order]
        psi2 = 1.0 - 2.0 * time / start.dt
        increment = 0.5 * start.dt * psi2 * lam * (m_inv[a] + m_inv[b])
        contacts = Contacts(self.bodies.items, a, b, normal[order], point[order], gap[by_time], time)
        return StepReport(
            start.time, contacts, lam, np.full_like(lam, math.inf), psi2, increment,
            iterations=rounds, lock=self.lock, converged=converged,
        )  # fmt: skip
