"""Blocks: contacts that act at one instant because they share bodies or touch, and contacts that rest on forces."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from . import balance
from .bodies import BoolArray, FloatArray, IntArray
from .complementarity import Delassus, components, restrict, solve
from .contacts import Geometry, Pairs, touching
from .impacts import Impacts

_TOLERANCE = 1e-12  # of the complementarity problems, relative to the largest approach speed
_TURN = 0.1  # rad by which the normal of a resting contact may turn before its force is found anew
_SHORTEST = 1 / 64  # part of the rest of the step for which a force is kept at least


@dataclass
class Resting:
    """The k contacts that rest on forces now; each lasts from `since` until `until` unless an impact ends it.

    Attributes:
        key: (k,) of the pair, increasing.  first, second: (k,) shapes.
        since, until: (k,) instants in the step.  force: (k,) mass length/time².
        normal: (k, 2) its direction.  point: (k, 2).  apart: (k, 2) from a to b, at `since`.
    """

    key: IntArray
    first: IntArray
    second: IntArray
    since: FloatArray
    until: FloatArray
    force: FloatArray
    normal: FloatArray
    point: FloatArray
    apart: FloatArray

    @staticmethod
    def none() -> Resting:
        """No contact."""
        i, x, v = np.zeros(0, np.intp), np.zeros(0), np.zeros((0, 2))
        return Resting(i, i, i, x, x, x, v, v, v)

    def take(self, which: IntArray) -> Resting:
        """The contacts number `which`."""
        return Resting(*(getattr(self, f.name)[which] for f in fields(self)))

    def joined(self, other: Resting) -> Resting:
        """Both, ordered by key."""
        both = Resting(*(np.concatenate((getattr(self, f.name), getattr(other, f.name))) for f in fields(self)))
        return both.take(np.argsort(both.key))


class Blocks:
    """Simultaneous impacts and rest within a step that follows times of impact (design sections 2, 4).

    Contacts that act on one body at one instant, and those that touch there, are one block:
    0 <= lam _|_ A lam + (1 + e) u >= 0. Contacts that touch without speed while forces press them rest: over a span of
    the step they exert constant forces, the rigid limit 0 <= lam _|_ A lam + e u_n + u* >= 0 with psi2 = 0 over that
    span. It ends with the step, when the normals have turned, or with an impact; then the energy lock of the block that
    ends it takes out what the forces have put in until then.
    """

    def __init__(self, impacts: Impacts) -> None:
        self.impacts = impacts
        self.resting = Resting.none()

    def strike(self, pairs: Pairs, seed: FloatArray, spent: BoolArray) -> IntArray:
        """Solve blocks, each at one instant, and let rest what stays in touch.

        Args:
            pairs: the m contacts of all blocks, ordered by key.
            seed: (m,) time of impact of the contacts that cause a block, infinity for those that merely touch.
            spent: (m,) whether the contact has bounced so often that it has to stop, if its elasticity is below 1.

        Returns:
            The contacts that touch on (indices into `pairs`).
        """
        impacts, paths = self.impacts, self.impacts.paths
        rows, a, b = restrict(pairs.row_a, pairs.row_b, len(impacts.moves))
        moves = impacts.moves[rows]
        label = components(a, b, moves)
        instant = np.full(len(rows), np.inf)
        np.minimum.at(instant, np.where(moves[a], label[a], label[b]), seed)
        t = np.where(moves, instant[label], 0.0)
        x, v = paths.position(rows, t), paths.rate(rows, t)
        at = pairs.between(x[a], x[b])
        surplus, rested = self._end(pairs.key, x[b] - x[a], np.maximum(t[a], t[b]), pairs.elasticity)
        touch = np.flatnonzero(rested | (seed < np.inf) | (at.gap <= touching(pairs, paths.origin)))
        chosen, at, a, b = pairs.take(touch), at.take(touch), a[touch], b[touch]
        A = Delassus(a, b, at.normal, impacts.bodies.inverse_mass[rows])
        u = A.relative(v)
        lossy = chosen.elasticity < 1.0
        e = np.where(lossy & (spent[touch] | impacts.stays(chosen, chosen.elasticity * -u)), 0.0, chosen.elasticity)
        lam = self._solve(A, balance.restitution_target(u, e) + u, surplus[touch] if rested.any() else None)
        change = A.impulse(lam) * A.inverse_mass[:, None]
        v += change
        mine = np.flatnonzero(moves)
        paths.kick(rows[mine], t[mine], change[mine])
        hit = np.flatnonzero(lam > 0)
        time, point = np.maximum(t[a], t[b]), at.point
        impacts.log.keep(chosen.first[hit], chosen.second[hit], at.normal[hit], point[hit], time[hit], lam[hit])
        on = np.flatnonzero(impacts.stays(chosen, np.abs(A.relative(v))))
        if paths.pulled and len(on):
            self._rest(chosen.take(on), at.take(on), rows, (a[on], b[on]), label, t, x, v)
        return touch[on]

    def _end(
        self, key: IntArray, apart: FloatArray, t: FloatArray, elasticity: FloatArray
    ) -> tuple[FloatArray, BoolArray]:
        """End the rest of the contacts `key` at instants t: the energy their forces gave (m,), and which did rest."""
        surplus, rested = np.zeros(len(key)), np.isin(key, self.resting.key)
        if not rested.any():
            return surplus, rested
        ends = np.isin(self.resting.key, key)
        now = self.resting.take(np.flatnonzero(ends))
        way = apart[rested] - now.apart
        work = now.force * (now.normal[:, 0] * way[:, 0] + now.normal[:, 1] * way[:, 1])
        # What is not elastic may lose energy, but not gain it.
        surplus[rested] = np.where(elasticity[rested] < 1.0, np.maximum(work, 0.0), work)
        self._keep(now, t[rested])
        self.resting = self.resting.take(np.flatnonzero(~ends))
        return surplus, rested

    def _rest(
        self, pairs: Pairs, at: Geometry, rows: IntArray, ab: tuple[IntArray, IntArray], label: IntArray,
        t: FloatArray, x: FloatArray, v: FloatArray,
    ) -> None:  # fmt: skip
        """Give contacts that touch the forces that keep them closed; all bodies of their blocks get new ones."""
        impacts, (a, b) = self.impacts, ab
        start, m_inv, moves = impacts.start, impacts.bodies.inverse_mass[rows], impacts.moves[rows]
        free = start.acceleration[rows]
        span = start.dt - t

        def half_way() -> Geometry:
            # The normal at the kink of the rigid limit makes angular momentum exact.
            half = 0.5 * span[:, None]
            middle = x + half * v + (0.5 * half * half) * free
            return pairs.between(middle[a], middle[b])

        of = np.where(moves[a], label[a], label[b])
        middle = half_way()
        turn = 2.0 * np.abs(at.normal[:, 0] * middle.normal[:, 1] - at.normal[:, 1] * middle.normal[:, 0])
        turn[(at.normal * middle.normal).sum(axis=1) < 0.0] = np.pi
        part = np.ones(len(rows))
        np.minimum.at(part, of, np.clip(_TURN / np.maximum(turn, _TURN), _SHORTEST, 1.0))
        if part.min() < 1.0:
            span = span * part[label]
            middle = half_way()
        A = Delassus(a, b, middle.normal, m_inv)
        u, lasts = A.relative(v), span[np.where(moves[a], a, b)]
        e = np.where(pairs.elasticity < 1.0, 0.0, 1.0)
        lam = self._solve(A, balance.restitution_target(u, e) + u + lasts * A.relative(free))
        pressed = np.flatnonzero((lam > 0) & (lasts > 0))
        force = np.divide(lam, lasts, out=np.zeros_like(lam), where=lasts > 0)
        pull = free + A.impulse(force) * m_inv[:, None]
        mine = np.flatnonzero(moves)
        impacts.paths.pull(rows[mine], t[mine], pull[mine])
        since = t[np.where(moves[a], a, b)]
        # What lasts as long as the step does not end within it.
        until = np.where(part[of] < 1.0, since + lasts, np.inf)
        new = Resting(
            pairs.key, pairs.first, pairs.second, since, until, force, middle.normal, middle.point, x[b] - x[a]
        )
        self.resting = self.resting.joined(new.take(pressed))

    def _solve(self, A: Delassus, q: FloatArray, surplus: FloatArray | None = None) -> FloatArray:
        """(m,) impulses of blocks, scaled by their energy locks, which also take out a surplus of energy (m,)."""
        result = solve(A, q, tolerance=_TOLERANCE)
        if result.exact and (surplus is None or not surplus.any()):
            return result.lam
        body = np.unique(components(A.row_a, A.row_b, A.inverse_mass > 0), return_inverse=True)[1]
        island = np.where(A.inverse_mass[A.row_a] > 0, body[A.row_a], body[A.row_b])
        zero = np.zeros(A.size)
        lock = balance.energy_lock(A, island, result.lam, q, zero, np.zeros((len(A.inverse_mass), 2)), surplus)
        scale = np.where(lock.valid, lock.scale, 1.0 if result.exact else 0.0)
        self.impacts.log.locked(float(scale[np.argmax(np.abs(scale - 1.0) * (result.lam > 0))]))
        return scale * result.lam

    def finish(self) -> None:
        """The end of the step: note the forces that last until then."""
        self._keep(self.resting, np.full(len(self.resting.key), self.impacts.start.dt))

    def _keep(self, ended: Resting, t: FloatArray) -> None:
        lasted = t - ended.since
        self.impacts.log.keep(
            ended.first, ended.second, ended.normal, ended.point, ended.since + 0.5 * lasted, ended.force * lasted
        )
