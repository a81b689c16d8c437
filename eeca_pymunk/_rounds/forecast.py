"""Forecast: when the pairs of a step touch next if nothing else happens to their bodies."""

from __future__ import annotations

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from . import impact_times
from .contacts import Pairs, touching
from .features import length, nearest_feature
from .geometry import Axis
from .paths import Paths


def next_impact(
    pairs: Pairs, paths: Paths, which: IntArray, dt: float, held: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """(m,) instants, from the start of the step, of the next impacts of the pairs `which` (m, increasing).

    Infinity where there is none, an instant after dt where that is known, NaN where only that it is after dt. Each
    pair is looked at from the later of its two bodies' latest kinks on; the second result is its gap (m,) there.
    Of general shapes points that touch and move no faster than `held` (number of pairs,) are left out.
    """
    k, n = (int(i) for i in np.searchsorted(which, (pairs.disks, pairs.flat)))
    if k == len(which):
        return _disk_disk(pairs, paths, which, dt)
    if k == 0 and n == len(which):
        return _disk_wall(pairs, paths, which, dt)
    parts = [_disk_disk(pairs, paths, which[:k], dt), _disk_wall(pairs, paths, which[k:n], dt)]
    if n < len(which):
        parts.append(_general(pairs, paths, which[n:], dt, None if held is None else held[which[n:]]))
    return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])


def missed(pairs: Pairs, paths: Paths, which: IntArray, changed: BoolArray) -> bool:
    """Whether shapes of the pairs `which` met before the later of their kinks, where it was not known yet.

    A round takes impacts far apart at different instants. When a body is changed (changed (N,) bool) at an instant
    before a neighbour's latest kink, it may meet the branch that this kink has ended.
    """
    if pairs.flat < len(pairs) and _general_missed(pairs, paths, which[np.searchsorted(which, pairs.flat) :], changed):
        return True
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
    u = paths.velocity.take(b, axis=0) - paths.velocity.take(a, axis=0)
    d = paths.origin.take(b, axis=0) - paths.origin.take(a, axis=0) + t[:, None] * u
    if not paths.uneven:
        time, gap = impact_times.disk_disk(d, u, pairs.extent[which])
        return t + time, gap
    pull = paths.acceleration.take(b, axis=0) - paths.acceleration.take(a, axis=0)
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
    near = nearest_feature(pairs.shapes.walls, pairs.wall[which], paths.position(a, t)[:, :2])
    gap = near.distance - pairs.extent[which]
    left = dt - t
    reach = length(v) * left
    alpha: FloatArray | float = 0.0
    size = np.zeros(len(a))
    if paths.pulled:
        pull = paths.acceleration.take(a, axis=0)
        alpha = pull[:, 0] * near.away[:, 0] + pull[:, 1] * near.away[:, 1]
        size = length(pull)
        reach += 0.5 * size * left * left
    rate = v[:, 0] * near.away[:, 0] + v[:, 1] * near.away[:, 1]
    time = impact_times.flat(gap, rate, alpha)
    s = np.minimum(time, left)
    hit = time
    time = t + time
    walls = pairs.shapes.walls
    edge, squared = walls.flat_edge.take(near.edge, axis=0), walls.flat_length_squared[near.edge]
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


def _general(
    pairs: Pairs, paths: Paths, which: IntArray, dt: float, held: FloatArray | None
) -> tuple[FloatArray, FloatArray]:
    """Shapes that turn, or are carried: from the motion of their vertices."""
    a, b = pairs.row_a[which], pairs.row_b[which]
    t = np.maximum(paths.since[a], paths.since[b])
    gap = pairs.take(which).between(paths.position(a, t), paths.position(b, t)).gap
    time = np.full(len(which), np.nan)  # after dt, if ever
    sweep = gap - _sweep(pairs, paths, which, t, dt - t)
    near = np.flatnonzero(sweep <= 0.0)
    if len(near):
        held = np.full(len(near), -np.inf) if held is None else held[near]
        met = _meet(pairs, paths, paths, which[near], t[near], np.full(len(near), dt), held)
        time[near] = np.where(met < dt, met, np.nan)
    return time, gap


def _sweep(pairs: Pairs, paths: Paths, which: IntArray, t: FloatArray, left: FloatArray) -> FloatArray:
    """(m,) by how much a gap can fall within `left` (m,) from the instants t (m,) on."""
    a, b = pairs.row_a[which], pairs.row_b[which]
    u = paths.rate(b, t) - paths.rate(a, t)
    way = length(u) * left
    if paths.pulled:
        way += (0.5 * left * left) * length(paths.acceleration[b] - paths.acceleration[a])
    for row, shape in ((a, pairs.first[which]), (b, pairs.second[which])):
        turn = np.abs(paths.rate(row, t)[:, 2]) * left + (0.5 * left * left) * np.abs(paths.acceleration[row, 2])
        way += 2.0 * np.sin(np.minimum(0.5 * turn, 0.5 * np.pi)) * pairs.shapes.size[shape]
    return way


def _general_missed(pairs: Pairs, paths: Paths, which: IntArray, changed: BoolArray) -> bool:
    """`missed` of the pairs `which` of general shapes."""
    since, before = paths.since, paths.before
    a, b = pairs.row_a[which], pairs.row_b[which]
    found = False
    for early, late, first in ((a, b, True), (b, a, False)):
        back = np.flatnonzero(changed[early] & (since[early] < since[late]))
        if len(back) == 0:
            continue
        t = np.maximum(since[early[back]], before.since[late[back]])
        end = since[late[back]]
        on = (paths, before) if first else (before, paths)
        # At the kink itself the late body meets whom its own impact was with.
        met = _meet(pairs, on[0], on[1], which[back], t, end, np.full(len(back), -np.inf))
        found |= bool((met < end - 1e-9 * np.maximum(end - t, 0.0)).any())
    return found


def _meet(
    pairs: Pairs, paths_a: Paths, paths_b: Paths, which: IntArray, t: FloatArray, end: FloatArray, held: FloatArray
) -> FloatArray:
    """(m,) instants at which general pairs meet, from t (m,) until `end` (m,), on the paths of a and of b."""
    chosen, left = pairs.take(which), np.maximum(end - t, 0.0)
    a, b = chosen.row_a, chosen.row_b
    pull = length(paths_b.acceleration[b] - paths_a.acceleration[a])
    # Bounds until `end`: spin, and the distance of the centres of mass and its rate.
    alpha = [np.abs(paths.acceleration[row, 2]) for paths, row in ((paths_a, a), (paths_b, b))]
    spin = [
        np.abs(paths.rate(row, t)[:, 2]) + size * left
        for paths, row, size in ((paths_a, a, alpha[0]), (paths_b, b, alpha[1]))
    ]
    size = [pairs.shapes.size[chosen.first], pairs.shapes.size[chosen.second]]
    speed = length(paths_b.rate(b, t) - paths_a.rate(a, t)) + pull * left
    away = length(paths_b.position(b, t) - paths_a.position(a, t)) + speed * left
    around = [r * (w * w + q) for r, w, q in zip(size, spin, alpha, strict=True)]
    bends = [pull + around[0] + around[1]]
    for own, other in ((0, 1), (1, 0)):
        # Seen along an axis that turns with the one body, points of the other one bend by Coriolis and so on.
        w, q = spin[own], alpha[own]
        point = 2.0 * w * (speed + spin[other] * size[other]) + (w * w + q) * (away + size[other])
        bends.append(pull + around[other] + point)
    tolerance = touching(chosen, paths_a.origin)

    def axes(i: IntArray, s: FloatArray) -> list[Axis]:
        now, some = t[i] + s, chosen.take(i)
        pose_a, pose_b = paths_a.position(some.row_a, now), paths_b.position(some.row_b, now)
        return some.axes(pose_a, pose_b, paths_a.rate(some.row_a, now), paths_b.rate(some.row_b, now), tolerance[i])

    result: FloatArray = t + impact_times.advance_along_axes(axes, np.stack(bends, axis=1), left, tolerance, held)
    return result
