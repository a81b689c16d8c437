"""`force_func` and `torque_func`: force functions f of the program, replaced by a linear law for one step.

At the start of a step of length h a spring has the length l0 and the rate of length r0; at the start of the step
before, of length h', it had the rate r. Its predicted length at the end is

    l1 = l0 + h r0 + h^2 (r0 - r) / 2h'.

With the middle m = (l0 + l1) / 2 its law is F(l) = F + k (l - m). F is the mean of f over [l0, l1] by Gauss quadrature
with 2 points, k the secant of f through these, or 0 if that force would not restore m. The law is of second order in h,
its energy of fourth. The ledger has no energy store for such springs: their work is external. For rotary springs l is
the angle of a minus that of b.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pymunk

from ..errors import NotFiniteError
from ..model.joints import Joint
from .private import joints as private_joints

_POINT = 0.5 / math.sqrt(3.0)  # distance of a Gauss point from the middle, over the length of the interval
_NEAR = 1e-6  # below this ratio of the interval [l0, l1] to the length, round-off spoils the secant: k = 0

# Position of the body's origin (2), angle, velocity of its centre of mass (2), spin.
BodyMotion = tuple[float, float, float, float, float, float]
Rate = tuple[float, float]  # r0 and h of a step


def own_function(item: Any) -> Callable[[Any, float], float] | None:
    """The force or torque function of a spring that the program has set; None for pymunk's and for other joints."""
    function = private_joints.law_of(item)
    return None if function in (pymunk.DampedSpring.spring_force, pymunk.DampedRotarySpring.spring_torque) else function


def write_law(item: Any, a: BodyMotion, b: BodyMotion, dt: float, row: Joint, past: Rate | None) -> Rate:
    """Write the law of a spring with a function into its row of JOINT: F to `push`, |k| to `stiffness`, m to `rest`.

    Args:
        a, b: motions of its bodies.  past: the result of the last step (r and h'), None before the first.

    Returns:
        r0 and h. NotFiniteError if the function does not return finite numbers.
    """
    function = own_function(item)
    assert function is not None
    start, rate, scale = _length(item, a, b)
    end = start + dt * rate
    if past is not None:
        end += 0.5 * dt * dt * (rate - past[0]) / past[1]
    if isinstance(item, pymunk.DampedSpring):
        end = abs(end)
    middle, change = 0.5 * (start + end), end - start
    if abs(change) <= _NEAR * scale:
        force, slope = float(function(item, middle)), 0.0
    else:
        first = float(function(item, middle - _POINT * change))
        last = float(function(item, middle + _POINT * change))
        force, slope = 0.5 * (first + last), (last - first) / (2.0 * _POINT * change)
    if not (math.isfinite(force) and math.isfinite(slope)):
        raise NotFiniteError(f"the function of {item} returns {force} at {middle}: make it return a finite number")
    # A force that does not restore m is taken as constant: with its slope the solve need not converge. In pymunk a
    # positive force of a spring increases its length, a positive torque of a rotary spring decreases its angle.
    sign = 1.0 if isinstance(item, pymunk.DampedSpring) else -1.0
    row.push, row.stiffness, row.rest = force, max(0.0, -sign * slope), middle
    return rate, dt


def force_function(item: Any, row: Joint) -> Callable[[Any, float], float]:
    """The law in a spring's row of JOINT as a force function of pymunk."""
    slope = -row.stiffness if isinstance(item, pymunk.DampedSpring) else row.stiffness
    return lambda spring, length: float(row.push + slope * (length - row.rest))


def _length(item: Any, a: BodyMotion, b: BodyMotion) -> tuple[float, float, float]:
    """The length of a spring, its rate, and the scale of lengths (at least the rest length); of a rotary spring its
    angle, the rate of this, and 1."""
    if isinstance(item, pymunk.DampedRotarySpring):
        return a[2] - b[2], a[5] - b[5], 1.0
    (ax, ay, avx, avy), (bx, by, bvx, bvy) = _anchor(item.anchor_a, item.a, a), _anchor(item.anchor_b, item.b, b)
    dx, dy = bx - ax, by - ay
    length = math.hypot(dx, dy)
    speed = math.hypot(bvx - avx, bvy - avy)
    rate = (dx * (bvx - avx) + dy * (bvy - avy)) / length if length > 0.0 else speed
    return length, rate, max(length, item.rest_length)


def _anchor(anchor: tuple[float, float], body: pymunk.Body, motion: BodyMotion) -> tuple[float, float, float, float]:
    """Position (2) and velocity (2) of an anchor, given in coordinates of its body."""
    x, y, angle, vx, vy, spin = motion
    c, s = math.cos(angle), math.sin(angle)
    (px, py), (kx, ky) = anchor, body.center_of_gravity
    rx, ry = c * (px - kx) - s * (py - ky), s * (px - kx) + c * (py - ky)
    return x + c * px - s * py, y + s * px + c * py, vx - spin * ry, vy + spin * rx
