"""`force_func` and `torque_func`: force functions of the program, as one linear law for the step.

A spring has the length l0, with the rate r0, and r a step of length h' before. Its predicted length at the end is

    l1 = l0 + h r0 + h^2 (r0 - r) / 2h'.

Its law is f(m) + k (l - m): f(m) the mean of f over [l0, l1] (Gauss, 2 points) at the middle m, k the secant of f there
if it restores, else 0. This is of second order, its energy of fourth. The ledger has no energy store for such springs:
their work is external. Rotary springs likewise, with the angle of a less that of b.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pymunk

from ..errors import NotFiniteError
from ..model.joints import Joint
from .private import joints as private_joints

_POINT = 0.5 / math.sqrt(3.0)  # of Gauss, from the middle, over the length of the interval
_NEAR = 1e-6  # an interval shorter than this, over the length it is at, has no secant

# Position of the body's origin, angle, velocity of its centre of mass, spin.
Motion = tuple[float, float, float, float, float, float]
Rate = tuple[float, float]


def own_function(item: Any) -> Callable[[Any, float], float] | None:
    """The force or torque function of a spring if it is one of the program; else None."""
    usual: Any
    if isinstance(item, pymunk.DampedSpring):
        usual = pymunk.DampedSpring.spring_force
    elif isinstance(item, pymunk.DampedRotarySpring):
        usual = pymunk.DampedRotarySpring.spring_torque
    else:
        return None
    law = private_joints.law_of(item)
    return None if law is usual else law


def put_law(item: Any, a: Motion, b: Motion, dt: float, row: Joint, past: Rate | None) -> Rate:
    """Write the law of a spring with a function into its row of JOINT; a, b: motions of its bodies.

    `past`: the result of the last step, r and h'. Returns those of this step. NotFiniteError if the function does not
    return finite numbers.
    """
    function = own_function(item)
    assert function is not None
    at, rate, size = _stretch(item, a, b)
    end = at + dt * rate
    if past is not None:
        end += 0.5 * dt * dt * (rate - past[0]) / past[1]
    if isinstance(item, pymunk.DampedSpring):
        end = abs(end)
    middle, way = 0.5 * (at + end), end - at
    if abs(way) <= _NEAR * size:
        push, slope = float(function(item, middle)), 0.0
    else:
        first = float(function(item, middle - _POINT * way))
        last = float(function(item, middle + _POINT * way))
        push, slope = 0.5 * (first + last), (last - first) / (2.0 * _POINT * way)
    if not (math.isfinite(push) and math.isfinite(slope)):
        raise NotFiniteError(f"the function of {item} answers {push} at {middle}: let it answer a finite number")
    # An increasing force is taken as constant: with its slope the step need not converge.
    sign = 1.0 if isinstance(item, pymunk.DampedSpring) else -1.0
    row.push, row.stiffness, row.rest = push, max(0.0, -sign * slope), middle
    return rate, dt


def law(item: Any, row: Joint) -> Callable[[Any, float], float]:
    """The law in a spring's row of JOINT as a force function."""
    slope = -row.stiffness if isinstance(item, pymunk.DampedSpring) else row.stiffness
    return lambda spring, at: float(row.push + slope * (at - row.rest))


def _stretch(item: Any, a: Motion, b: Motion) -> tuple[float, float, float]:
    """The length of a spring, its rate, and a length to compare with; of a rotary one angles."""
    if isinstance(item, pymunk.DampedRotarySpring):
        return a[2] - b[2], a[5] - b[5], 1.0
    (ax, ay, avx, avy), (bx, by, bvx, bvy) = _anchor(item.anchor_a, item.a, a), _anchor(item.anchor_b, item.b, b)
    dx, dy = bx - ax, by - ay
    length = math.hypot(dx, dy)
    speed = math.hypot(bvx - avx, bvy - avy)
    rate = (dx * (bvx - avx) + dy * (bvy - avy)) / length if length > 0.0 else speed
    return length, rate, max(length, item.rest_length)


def _anchor(anchor: tuple[float, float], body: pymunk.Body, motion: Motion) -> tuple[float, float, float, float]:
    """Position and velocity of an anchor."""
    x, y, angle, vx, vy, spin = motion
    c, s = math.cos(angle), math.sin(angle)
    (px, py), (kx, ky) = anchor, body.center_of_gravity
    rx, ry = c * (px - kx) - s * (py - ky), s * (px - kx) + c * (py - ky)
    return x + c * px - s * py, y + s * px + c * py, vx - spin * ry, vy + spin * rx
