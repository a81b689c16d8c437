"""Pendulums with exact solutions: one on a rod, and a cradle of two balls on threads that meet at the bottom."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from .scene import FloatArray, Scene, add_disk

GRAVITY = 9.81


def build(length: float = 1.0, degrees: float = 90.0, dt: float = 1 / 60, duration: float = 10.0) -> Scene:
    """A point mass of 1 kg on a massless rod of `length` (m), let go at rest `degrees` to the left of the vertical."""
    _check(length, degrees)
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    bob = pymunk.Body(1.0, 1.0)
    bob.position = _place(-math.radians(degrees), length)
    space.add(bob, pymunk.PinJoint(space.static_body, bob, (0.0, 0.0), (0.0, 0.0)))

    def exact(t: float) -> FloatArray:
        return np.array([_place(-swing(math.radians(degrees), length, t), length)])

    return Scene("pendulum", space, [bob], dt, duration, 1e6, exact, {"degrees": degrees, "dt": dt})


def cradle(
    length: float = 1.0, degrees: float = 30.0, radius: float = 0.1, dt: float = 1 / 60, duration: float = 10.0
) -> Scene:
    """Two elastic balls of 1 kg on threads side by side, touching at rest; the left one is let go `degrees` away.

    Equal masses exchange their velocities, and they meet at the bottom: one of them swings while the other hangs.
    """
    _check(length, degrees)
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    amplitude, hung = math.radians(degrees), (-radius, radius)
    bodies = []
    for x, angle in zip(hung, (-amplitude, 0.0), strict=True):
        dx, y = _place(angle, length)
        bodies.append(add_disk(space, (x + dx, y), radius))
        space.add(pymunk.PinJoint(space.static_body, bodies[-1], (x, 0.0), (0.0, 0.0)))
    quarter = 0.25 * period(amplitude, length)

    def exact(t: float) -> FloatArray:
        # The left one swings for a quarter, then each in turn for half a period.
        right = int((t + quarter) // (2.0 * quarter)) % 2
        angle = -swing(amplitude, length, t)
        places = [_place(angle if i == right else 0.0, length) for i in range(2)]
        return np.array([(x + dx, y) for x, (dx, y) in zip(hung, places, strict=True)])

    return Scene("hung_cradle", space, bodies, dt, duration, 1e6, exact, {"degrees": degrees, "dt": dt})


def swing(amplitude: float, length: float, t: float, gravity: float = GRAVITY) -> float:
    """Angle (rad) at time t of a pendulum let go at rest: sin(angle/2) = k cd(t sqrt(g/l), k), k = sin(amplitude/2)."""
    k = math.sin(0.5 * amplitude)
    sn, cn = _jacobi(t * math.sqrt(gravity / length), k * k)
    return 2.0 * math.asin(k * cn / math.sqrt(1.0 - (k * sn) ** 2))


def period(amplitude: float, length: float, gravity: float = GRAVITY) -> float:
    """Period (s): 2 pi sqrt(l/g) / agm(1, cos(amplitude/2))."""
    a, b = 1.0, math.cos(0.5 * amplitude)
    while abs(a - b) > 1e-15:
        a, b = 0.5 * (a + b), math.sqrt(a * b)
    return 2.0 * math.pi * math.sqrt(length / gravity) / a


def _jacobi(u: float, m: float) -> tuple[float, float]:
    """sn and cn of u at the parameter m < 1, by arithmetic-geometric means (Abramowitz and Stegun 16.4)."""
    a, c, b = [1.0], [math.sqrt(m)], math.sqrt(1.0 - m)
    while abs(c[-1]) > 1e-17 and len(a) < 12:
        a.append(0.5 * (a[-1] + b))
        c.append(0.5 * (a[-2] - b))
        b = math.sqrt(a[-2] * b)
    phi = 2.0 ** (len(a) - 1) * a[-1] * u
    for n in range(len(a) - 1, 0, -1):
        phi = 0.5 * (phi + math.asin(c[n] / a[n] * math.sin(phi)))
    return math.sin(phi), math.cos(phi)


def _place(angle: float, length: float) -> tuple[float, float]:
    return length * math.sin(angle), -length * math.cos(angle)


def _check(length: float, degrees: float) -> None:
    if not (length > 0.0 and 0.0 < degrees < 180.0):
        raise ValueError(f"length = {length}, degrees = {degrees}: give length > 0 and 0 < degrees < 180")
