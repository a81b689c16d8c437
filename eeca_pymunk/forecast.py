"""Forecast: when the pairs of a step touch next if nothing else happens to their bodies."""

from __future__ import annotations

import numpy as np

from . import impact_times
from .bodies import BoolArray, FloatArray, IntArray
from .contacts import Pairs, length, nearest_feature, touching
from .paths import Paths


def next_impact(pairs: Pairs, paths: Paths, which: IntArray, dt: float) -> tuple[FloatArray, FloatArray]:
    """(m,) instants, from the start of the step, of the next impacts of the pairs `which` (m, increasing).

    Infinity where there is none, an instant after dt where that is known, NaN where only that it is after dt. Each
    pair is looked at from the later of its two bodies' latest kinks on; the second result is its gap (m,) there.
    """
    k = int(np.searchsorted(which, pairs.disks))
    if k == len(which):
        return _disk_disk(pairs, paths, which, dt)
    if k == 0:
        return _disk_wall(pairs, paths, which, dt)
    disks, walls = _disk_disk(pairs, paths, which[:k], dt), _disk_wall(pairs, paths, which[k:], dt)
    return np.concatenate((disks[0], walls[0])), np.concatenate((disks[1], walls[1]))


def missed(pairs: Pairs, paths: Paths, which: IntArray, changed: BoolArray) -> bool:
    """whether disks of the pairs `which` met before the later of their kinks, where it was not known yet.

    A round takes impacts far apart at different instants. When a body is changed (changed (N,) bool) at an instant
    before a neighbour's latest kink, it may meet the branch that this kink has ended.
    """
    which = which[: int(np.searchsorted(which, pairs.disks))]
    since, before = paths.since, paths.before
    a, b = pairs.row_a[which], pairs.row_b[which]
    swap = since[a] > since[b]
    early, late = np.where(swap, b, a), np.where(swap, a, b)
    back = np.flatnonzero(changed[early] & (since[early] < since[late]))
    if len(back) == 0:
        return False
    early, late = early[back], late[back]
    extent = pairs.extent[which[back]]
    t, kink = np.maximum(since[early], before.since[late]), since[late]
    d = before.position(late, t) - paths.position(early, t)
    u = before.rate(late, t) - paths.rate(early, t)
    meets = t + impact_times.disk_disk(d, u, extent)[0] < kink
    if paths.uneven:
        # Different pulls bend the relative path: look at its end too.
        d = before.position(late, kink) - paths.position(early, kink)
        meets |= length(d) - extent < -1e-9 * extent
    return bool(meets.any())


def _disk_disk(pairs: Pairs, paths: Paths, which: IntArray, dt: float) -> tuple[FloatArray, FloatArray]:
    a, b = pairs.row_a[which], pairs.row_b[which]
    t = np.maximum(paths.since[a], paths.since[b])
    u = paths.velocity[b] - paths.velocity[a]
    d = paths.origin[b] - paths.origin[a] + t[:, None] * u
    if not paths.uneven:
        time, gap = impact_times.disk_disk(d, u, pairs.extent[which])
        return t + time, gap
    pull = paths.acceleration[b] - paths.acceleration[a]
    d += (0.5 * t * t)[:, None] * pull
    u += t[:, None] * pull
    time, gap = impact_times.disk_disk(d, u, pairs.extent[which])
    time += t
    size = length(pull)
    left = dt - t
    bent = np.flatnonzero((size > 0.0) & (gap <= (length(u) + 0.5 * size * left) * left))
    if len(bent):
        time[bent] = _advance(pairs, paths, which[bent], t[bent], size[bent], dt)
    time[(size > 0.0) & (time >= dt)] = np.nan
    return time, gap


def _disk_wall(pairs: Pairs, paths: Paths, which: IntArray, dt: float) -> tuple[FloatArray, FloatArray]:
    """Flat while the centre stays beside one edge, where a root in closed form exists; round ends and corners else."""
    a = pairs.row_a[which]
    t = paths.since[a]
    v = paths.rate(a, t)
    near = nearest_feature(pairs.shapes.walls, pairs.wall[which], paths.position(a, t))
    gap = near.distance - pairs.extent[which]
    left = dt - t
    reach = length(v) * left
    alpha: FloatArray | float = 0.0
    size = np.zeros(len(a))
    if paths.pulled:
        pull = paths.acceleration[a]
        alpha = pull[:, 0] * near.away[:, 0] + pull[:, 1] * near.away[:, 1]
        size = length(pull)
        reach += 0.5 * size * left * left
    rate = v[:, 0] * near.away[:, 0] + v[:, 1] * near.away[:, 1]
    time = impact_times.flat(gap, rate, alpha)
    s = np.minimum(time, left)
    hit = time
    time = t + time
    walls = pairs.shapes.walls
    edge, squared = walls.flat_edge[near.edge], walls.flat_length_squared[near.edge]
    # Bounds of where on the edge the centre is until then, as a fraction of its length.
    along_rate = (v[:, 0] * edge[:, 0] + v[:, 1] * edge[:, 1]) / squared
    along = s * along_rate
    low, high = near.along + np.minimum(along, 0.0), near.along + np.maximum(along, 0.0)
    if paths.pulled:
        bow = (0.5 * s * s) * (pull[:, 0] * edge[:, 0] + pull[:, 1] * edge[:, 1]) / squared
        low, high = low + np.minimum(bow, 0.0), high + np.maximum(bow, 0.0)
    leaves = ~near.side | (low < 0.0) | (high > 1.0)
    if leaves.any():
        time[leaves] = np.inf
        bent = np.flatnonzero(leaves & (gap <= reach))
        if len(bent):
            time[bent] = _advance(pairs, paths, which[bent], t[bent], size[bent], dt)
    later = time >= dt
    if not paths.pulled:
        # Straight, it never comes back to a convex wall it goes away from, and the hit may lie on the same edge.
        at_hit = near.along + np.where(rate < 0.0, hit, 0.0) * along_rate
        later &= (rate < 0.0) & ~(near.side & (at_hit >= 0.0) & (at_hit <= 1.0))
    time[later] = np.nan
    return time, gap


def _advance(pairs: Pairs, paths: Paths, which: IntArray, t: FloatArray, pull: FloatArray, dt: float) -> FloatArray:
    chosen = pairs.take(which)

    def gap_and_rate(i: IntArray, s: FloatArray) -> tuple[FloatArray, FloatArray]:
        now, some = t[i] + s, chosen.take(i)
        at = some.between(paths.position(some.row_a, now), paths.position(some.row_b, now))
        u = paths.rate(some.row_b, now) - paths.rate(some.row_a, now)
        return at.gap, at.normal[:, 0] * u[:, 0] + at.normal[:, 1] * u[:, 1]

    tolerance = touching(chosen, paths.origin)
    result: FloatArray = t + impact_times.advance_to_contact(gap_and_rate, pull, dt - t, tolerance)
    return result
