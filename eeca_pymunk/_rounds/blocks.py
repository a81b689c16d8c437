"""Blocks: contacts that act at one instant because they share bodies or touch, and contacts that rest on forces."""

from __future__ import annotations

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..energy import balance
from ..energy.complementarity import solve
from ..energy.delassus import Delassus
from ..energy.graph import components, restrict
from .contacts import Pairs, touching
from .impacts import Impacts
from .islands import Island
from .touching import Resting, Touching

_TOLERANCE = 1e-12  # of the complementarity problems, relative to the largest approach speed
_TURN = 0.1  # rad by which the normal of a resting contact may turn before its force is found anew
_SHORTEST = 1 / 64  # part of the rest of the step for which a force is kept at least


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
        self.resting = Resting.none(impacts.start.position.shape[1])

    def strike(self, pairs: Pairs, seed: FloatArray, spent: BoolArray) -> IntArray:
        """Solve blocks, each at one instant, and let rest what stays in touch.

        Args:
            pairs: the m pairs of all blocks, ordered by key.
            seed: (m,) time of impact of the pairs that cause a block, infinity for those that merely touch.
            spent: (m,) whether the pair has bounced so often that it has to stop, if its elasticity is below 1.

        Returns:
            The pairs that touch on (indices into `pairs`).
        """
        impacts, paths = self.impacts, self.impacts.paths
        rows, a, b = restrict(pairs.row_a, pairs.row_b, len(impacts.moves))
        moves = impacts.moves[rows]
        label = components(a, b, moves)
        instant = np.full(len(rows), np.inf)
        np.minimum.at(instant, np.where(moves[a], label[a], label[b]), seed)
        # Bodies that are not moved by impulses, but move, are where they are at the instant of each of their blocks.
        rows, a, b, label, moves = _own_walls(rows, a, b, label, moves, impacts.kinematic)
        t = np.where(np.isfinite(instant[label]), instant[label], 0.0)
        x, v = paths.position(rows, t), paths.rate(rows, t)
        surplus, rested = self._end(pairs, x[a], x[b], np.maximum(t[a], t[b]))
        at = pairs.between(x[a], x[b])
        touch = np.flatnonzero(rested | (seed < np.inf) | (at.gap <= touching(pairs, paths.origin)))
        now = Touching.of(pairs.take(touch), at.take(touch), touch, (a[touch], b[touch]), x)
        chosen, mobility = now.pairs, impacts.mobility[rows]
        A = now.operator(mobility)
        u = A.relative(v)
        elasticity = chosen.elasticity
        stops = (elasticity < 1.0) & (spent[now.pair] | impacts.stays(chosen, elasticity * -u))
        lam = self._solve(
            A,
            balance.restitution_target(u, np.where(stops, 0.0, elasticity)) + u,
            _shared(surplus, now.pair) if rested.any() else None,
        )
        change = A.change(lam)
        if rested.any():
            # What of that energy the impulses could not take out.
            island = Island.of_bodies(rows, a, b, moves, pairs.elasticity < 1.0, label)
            kinetic = [island.kinetic(w, mobility) for w in (v, v + change)]
            left = island.sum(surplus) - (kinetic[0] - kinetic[1])
            left = np.where(island.sum(rested) > 0, island.given(left), 0.0)
            change = island.without(v + change, left, impacts.bodies.mass, impacts.mobility) - v
        v += change
        mine = np.flatnonzero(moves)
        paths.kick(rows[mine], t[mine], change[mine])
        hit = np.flatnonzero(lam > 0)
        time, point = np.maximum(t[now.row_a], t[now.row_b])[hit], now.at.point[hit]
        impacts.log.keep(
            chosen.first[hit], chosen.second[hit], now.at.normal[hit], point, time, lam[hit],
            (lam * A.diagonal())[hit],
        )  # fmt: skip
        on = np.flatnonzero(impacts.stays(chosen, np.abs(A.relative(v))))
        if paths.pulled and len(on):
            self._rest(now.take(on), rows, label, moves, t, x, v)
        elif rested.any():
            # Who has left flies freely.
            paths.pull(rows[mine], t[mine], impacts.start.acceleration[rows[mine]])
        touches: IntArray = np.unique(now.pair[on])
        return touches

    def _end(self, pairs: Pairs, pose_a: FloatArray, pose_b: FloatArray, t: FloatArray) -> tuple[FloatArray, BoolArray]:
        """End the rest of the pairs at instants t: the energy their forces gave (m,), and which did rest."""
        key = pairs.key
        surplus, rested = np.zeros(len(key)), np.isin(key, self.resting.key)
        if not rested.any():
            return surplus, rested
        ends = np.isin(self.resting.key, key)
        now = self.resting.take(np.flatnonzero(ends))
        pair = np.searchsorted(key, now.key)
        np.add.at(surplus, pair, now.work(pose_a[pair], pose_b[pair]))
        # What is not elastic may lose energy, but not gain it.
        surplus = np.where(pairs.elasticity < 1.0, np.maximum(surplus, 0.0), surplus)
        self._keep(now, t[pair])
        self.resting = self.resting.take(np.flatnonzero(~ends))
        return surplus, rested

    def _rest(
        self, now: Touching, rows: IntArray, label: IntArray, moves: BoolArray, t: FloatArray, x: FloatArray,
        v: FloatArray,
    ) -> None:  # fmt: skip
        """Give contacts that touch the forces that keep them closed; all bodies of their blocks get new ones."""
        impacts, a, b, pairs = self.impacts, now.row_a, now.row_b, now.pairs
        start, mobility = impacts.start, impacts.mobility[rows]
        free = start.acceleration[rows]
        span = start.dt - t

        def half_way() -> Touching:
            # The normal at the kink of the rigid limit makes angular momentum exact.
            half = 0.5 * span[:, None]
            middle = x + half * v + (0.5 * half * half) * free
            return now.moved(x, middle)

        of = np.where(moves[a], label[a], label[b])
        middle = half_way()
        n, m = now.at.normal, middle.at.normal
        turn = 2.0 * np.abs(n[:, 0] * m[:, 1] - n[:, 1] * m[:, 0])
        turn[(n * m).sum(axis=1) < 0.0] = np.pi
        if x.shape[1] == 3:
            # Arms turn with their bodies.
            spin = np.abs(v[:, 2] * span)
            turn = np.maximum(turn, np.where(np.arange(len(pairs)) >= pairs.flat, np.maximum(spin[a], spin[b]), 0.0))
        part = np.ones(len(rows))
        np.minimum.at(part, of, np.clip(_TURN / np.maximum(turn, _TURN), _SHORTEST, 1.0))
        if part.min() < 1.0:
            span = span * part[label]
            middle = half_way()
        A = middle.operator(mobility)
        u, lasts = A.relative(v), span[np.where(moves[a], a, b)]
        e = np.where(pairs.elasticity < 1.0, 0.0, 1.0)
        lam = self._solve(A, balance.restitution_target(u, e) + u + lasts * A.relative(free))
        pressed = np.flatnonzero((lam > 0) & (lasts > 0))
        force = np.divide(lam, lasts, out=np.zeros_like(lam), where=lasts > 0)
        mine = np.flatnonzero(moves)
        impacts.paths.pull(rows[mine], t[mine], (free + A.change(force))[mine])
        since = t[np.where(moves[a], a, b)]
        # What lasts as long as the step does not end within it.
        until = np.where(part[of] < 1.0, since + lasts, np.inf)
        new = Resting(
            pairs.key, pairs.first, pairs.second, since, until, force, middle.at.normal, middle.at.point, A.diagonal(),
            middle.direction_a, middle.direction_b, x[a], x[b],
        )  # fmt: skip
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
        """The end of the step: note the forces that last until then, and lock the energy of who rests on them.

        Where shapes turn or slide on curves, constant forces do some work. The velocities of connected bodies, of
        free ones about their common motion, are scaled so that it is gone; who dissipates may keep a loss.
        """
        resting, impacts, paths = self.resting, self.impacts, self.impacts.paths
        dt, shapes = impacts.start.dt, impacts.shapes
        self._keep(resting, np.full(len(resting.key), dt))
        if len(resting.key) == 0:
            return
        a, b = shapes.row[resting.first], shapes.row[resting.second]
        rows, a, b = restrict(a, b, len(impacts.moves))
        moves = impacts.moves[rows]
        t = np.full(len(rows), dt)
        x, v = paths.position(rows, t), paths.rate(rows, t)
        lossy = shapes.elasticity[resting.first] * shapes.elasticity[resting.second] < 1.0
        island = Island.of_bodies(rows, a, b, moves, lossy, components(a, b, moves))
        work = island.given(island.sum(resting.work(x[a], x[b])))
        mine = np.flatnonzero(moves & (work[island.label] != 0.0))
        paths.kick(rows[mine], t[mine], (island.without(v, work, impacts.bodies.mass, impacts.mobility) - v)[mine])

    def _keep(self, ended: Resting, t: FloatArray) -> None:
        lasted = t - ended.since
        self.impacts.log.keep(
            ended.first, ended.second, ended.normal, ended.point, ended.since + 0.5 * lasted, ended.force * lasted,
            ended.change * ended.force * lasted,
        )  # fmt: skip


def _shared(surplus: FloatArray, pair: IntArray) -> FloatArray:
    """(k,) the surplus (m,) of pairs, divided among their contacts; `pair` (k,) does not decrease."""
    result: FloatArray = surplus[pair] / np.bincount(pair, minlength=len(surplus))[pair]
    return result


def _own_walls(
    rows: IntArray, a: IntArray, b: IntArray, label: IntArray, moves: BoolArray, kinematic: BoolArray
) -> tuple[IntArray, IntArray, IntArray, IntArray, BoolArray]:
    """Give every block a row of its own for each kinematic body it touches: the block's instant tells where that is."""
    touched = np.flatnonzero(kinematic[rows[b]])
    if len(touched) == 0:
        return rows, a, b, label, moves
    each, number = np.unique(label[a[touched]] * len(rows) + b[touched], return_inverse=True)
    b = b.copy()
    b[touched] = len(rows) + number
    return (
        np.concatenate((rows, rows[each % len(rows)])), a, b, np.concatenate((label, each // len(rows))),
        np.concatenate((moves, np.zeros(len(each), bool))),
    )  # fmt: skip
