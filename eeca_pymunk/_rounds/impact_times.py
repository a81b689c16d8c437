"""Times of impact as pure array kernels: when the gap of two shapes closes along their motion (design section 4).

Times are counted from an instant the caller chooses; infinity where the gap does not close.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray

_ADVANCES = 200  # of `advance_to_contact`; a double root halves its error in each, a single root squares it
_STRIDE = 1 / 16  # least part of the horizon between looks at shapes that touch: what bounces faster rests


def disk_disk(d: FloatArray, u: FloatArray, extent: FloatArray) -> tuple[FloatArray, FloatArray]:
    """First root (m,) of |d + u s| = extent in s >= 0 with the distance falling, and the gap (m,) at s = 0.

    With b = d . u < 0 the root is s = c / (-b + sqrt(D)), c = |d|^2 - extent^2 and D = b^2 - |u|^2 c. The discriminant
    D = |u|^2 extent^2 - (d x u)^2, taken as a product of a sum and a difference, keeps its digits for grazing hits.
    Disks that overlap and approach meet at 0.

    Args:
        d: (m, 2) from centre a to centre b, length.
        u: (m, 2) relative velocity, constant: a gravity common to both cancels.
        extent: (m,) sum of the radii, length.
    """
    x, y, u_x, u_y = d[:, 0], d[:, 1], u[:, 0], u[:, 1]
    b = x * u_x + y * u_y
    distance = np.sqrt(x * x + y * y)
    gap = distance - extent
    reach = np.sqrt(u_x * u_x + u_y * u_y) * extent
    cross = np.abs(x * u_y - y * u_x)
    hits = np.flatnonzero((b < 0.0) & (cross < reach))
    time = np.full(len(b), np.inf)
    reach, cross = reach[hits], cross[hits]
    c = gap[hits] * (distance[hits] + extent[hits])
    time[hits] = np.maximum(c / (np.sqrt((reach - cross) * (reach + cross)) - b[hits]), 0.0)
    return time, gap


def flat(h: FloatArray, w: FloatArray, alpha: FloatArray | float) -> FloatArray:
    """First root (m,) of h + w s + alpha s^2 / 2 = 0 in s >= 0 with the gap falling; 0 in overlap that deepens.

    The falling root is 2 h / (-w + sqrt(D)) with D = w^2 - 2 alpha h for w < 0, and (w + sqrt(D)) / (-alpha) for
    w >= 0, alpha < 0: the gap opens first, and the pull closes it again.

    Args:
        h: (m,) gap, length.  w: (m,) its rate.  alpha: (m,) or scalar, its constant second derivative.
    """
    if isinstance(alpha, float) and alpha == 0.0:
        straight = np.full(len(h), np.inf)
        falling = np.flatnonzero(w < 0.0)
        straight[falling] = np.maximum(h[falling] / -w[falling], 0.0)
        return straight
    D = w * w - 2.0 * alpha * h
    # In overlap a gap that never opens closes again when it is back where it was.
    D = np.where((h <= 0.0) & (D < 0.0), w * w, D)
    root = np.sqrt(np.maximum(D, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        opens_first = np.where(np.less(alpha, 0.0), (w + root) / np.negative(alpha), np.inf)
        time = np.where(w < 0.0, 2.0 * h / (root - w), opens_first)
    time[(D < 0.0) | np.isnan(time)] = np.inf
    return np.maximum(time, 0.0)


def advance_to_contact(
    gap_and_rate: Callable[[IntArray, FloatArray], tuple[FloatArray, FloatArray]],
    pull: FloatArray,
    horizon: FloatArray,
    tolerance: FloatArray,
) -> FloatArray:
    """First root (m,) in 0 <= s <= horizon of gaps without a closed form, found from below: none is jumped over.

    The distance between convex shapes in straight relative motion is a convex function of time, so g(s) + g'(s) t
    bounds it from below, and with a relative acceleration of size `pull` so does g + g' t - pull t^2 / 2. The iteration
    goes to the root of that bound, which converges quadratically: Newton's method from the safe side.

    Args:
        gap_and_rate: (indices, times) to gap, length, and its rate there.
        pull: (m,) length/time².  horizon: (m,) time.  tolerance: (m,) gap, length, that counts as closed.
    """

    def one_axis(i: IntArray, s: FloatArray) -> list[tuple[FloatArray, FloatArray, BoolArray]]:
        gap, rate = gap_and_rate(i, s)
        return [(gap[:, None], rate[:, None], np.ones(len(i), bool))]

    return advance_along_axes(one_axis, pull[:, None], horizon, tolerance, np.full(len(pull), -np.inf))


def advance_along_axes(
    axes: Callable[[IntArray, FloatArray], Sequence[tuple[FloatArray, FloatArray, BoolArray]]],
    bends: FloatArray,
    horizon: FloatArray,
    tolerance: FloatArray,
    held: FloatArray,
) -> FloatArray:
    """`advance_to_contact` for shapes that turn: along each axis, which may turn too, the least of some points' gaps
    bounds that of the shapes. A point's gap g with rate g' stays above g + g' t - bend t^2 / 2. The latest of the axes'
    first roots is safe; shapes have met where points close along all axes on which they touch.

    Args:
        axes: (indices (k,), times) to, for each axis, gaps (k, q) and rates of points, and where it is valid (k,).
        bends: (m, number of axes) length/time².  horizon: (m,) time.  tolerance: (m,) gap, length, that is closed.
        held: (m,) speed up to which points that touch stay where they are, as forces hold them; -inf for none.
    """
    result = np.full(len(bends), np.inf)
    which = np.arange(len(bends))
    s = np.zeros(len(bends))
    for _ in range(_ADVANCES):
        met, safe, near = np.ones(len(which), bool), np.zeros(len(which)), np.full(len(which), -np.inf)
        for (g, rate, valid), bend in zip(axes(which, s), bends[which].T[:, :, None], strict=True):
            root = np.sqrt(np.maximum(rate * rate + 2.0 * bend * np.maximum(g, 0.0), 0.0))
            with np.errstate(divide="ignore", invalid="ignore"):
                advance = np.where(rate < 0.0, 2.0 * g / (root - rate), (rate + root) / bend)
            touches = g <= tolerance[which][:, None]
            stays = touches & (np.abs(rate) <= held[which][:, None])
            # A point at rest on the other shape, without a bend, stays there: 0 / 0.
            advance = np.where(stays | np.isnan(advance), np.inf, advance).min(axis=1)
            met &= (touches & ~stays & (rate < 0.0)).any(axis=1) | ~valid
            safe = np.maximum(safe, np.where(valid, advance, 0.0))
            near = np.maximum(near, np.where(valid, g.min(axis=1), -np.inf))
        # Shapes that touch without closing would be followed in steps that shrink with their rate.
        safe = np.where(~met & (near <= tolerance[which]), np.maximum(safe, _STRIDE * horizon[which]), safe)
        s = s + safe
        result[which[met]] = s[met]
        going = ~met & (s <= horizon[which])
        if not going.any():
            break
        which, s = which[going], s[going]
    return result
