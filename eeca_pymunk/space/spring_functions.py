"""`force_func` and `torque_func`: forces of the user's own, as linear laws that have their mean over the step.

Over a step from length l0 to l1 a spring pushes with the mean of f over [l0, l1] (Gauss, 5 points), so that its work is
what the integral of f says and energy is kept whatever f is. Since l1 is not known before, the step is repeated with
f's mean and secant until that no longer changes; functions are called outside the kernels.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pymunk

from ..arrays import FloatArray
from ..joints.layout import LENGTH_0, LENGTH_1, PUSH, REST, STIFFNESS

MOST_REPEATS = 12
_TOLERANCE = 1e-14
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)


def own_function(item: Any) -> Callable[[Any, float], float] | None:
    """The spring's force or torque function if it is the user's own."""
    if isinstance(item, pymunk.DampedSpring) and item.force_func is not pymunk.DampedSpring.spring_force:
        return item.force_func
    if isinstance(item, pymunk.DampedRotarySpring) and item.torque_func is not pymunk.DampedRotarySpring.spring_torque:
        return item.torque_func
    return None


class Laws:
    """The linear laws of the springs with functions of their own, during one step.

    `joint` (j, JOINT_COLUMNS) are their rows, `rows` which of them, `begin` their lengths or angles at the start.
    """

    def __init__(self, items: list[Any], rows: list[int], joint: FloatArray, begin: list[float]) -> None:
        self._items, self._rows, self._joint = items, rows, joint
        self._sign = [1.0 if isinstance(items[j], pymunk.DampedSpring) else -1.0 for j in rows]
        self._last: list[tuple[float, float]] = []
        for j, at in zip(rows, begin, strict=True):
            mean = self._mean(j, at, at)
            joint[j, PUSH], joint[j, STIFFNESS], joint[j, REST] = mean, 0.0, at
            self._last.append((at, mean))

    def _mean(self, j: int, start: float, end: float) -> float:
        function = own_function(self._items[j])
        assert function is not None
        if start == end:
            return float(function(self._items[j], start))
        half, middle = 0.5 * (end - start), 0.5 * (end + start)
        values = [function(self._items[j], float(middle + half * x)) for x in _POINTS]
        return float(0.5 * np.dot(_WEIGHTS, values))

    def settled(self) -> bool:
        """Whether the step just taken used the means over its lengths; else the laws are corrected."""
        done = True
        for n, j in enumerate(self._rows):
            row = self._joint[j]
            start, end = float(row[LENGTH_0]), float(row[LENGTH_1])
            middle, mean = 0.5 * (start + end), self._mean(j, start, end)
            used = row[PUSH] - self._sign[n] * row[STIFFNESS] * (middle - row[REST])
            if abs(mean - used) > _TOLERANCE * max(abs(mean), abs(used)):
                done = False
            else:
                continue
            before, force = self._last[n]
            if abs(middle - before) > 1e-9 * abs(end - start):
                row[STIFFNESS] = max(0.0, self._sign[n] * (force - mean) / (middle - before))
            row[PUSH], row[REST] = mean, middle
            self._last[n] = middle, mean
        return done
