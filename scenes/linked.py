"""Jointed bodies to look at: a double pendulum, a chain that is let go, a bridge that is loaded."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pymunk

from .bars import Bars, exact
from .scene import FloatArray, Scene, add_box

GRAVITY = 9.81
_NOBODY = pymunk.ShapeFilter(mask=0)


def double_pendulum(degrees: float = 120.0, dt: float = 1 / 60, duration: float = 10.0) -> Scene:
    """Two bars of 1 m and 1 kg that hang at 2 m, let go at rest, both `degrees` from the vertical."""
    space = _space()
    angle = math.radians(degrees - 90.0)
    bodies = _bars(space, (0.0, 2.0), [angle] * 2, 1.0)
    moment, half, whole = np.full(2, 1.0 / 12.0), np.full(2, 0.5), np.ones(2)
    swung = exact(lambda: Bars(whole, moment, half, whole, np.full(2, angle), GRAVITY))

    def places(t: float) -> FloatArray:
        found: FloatArray = swung(t) + np.array((0.0, 2.0))
        return found

    parameters = {"degrees": degrees, "dt": dt}
    return Scene("double_pendulum", space, bodies, dt, duration, 1e6, places, parameters)


def chain(count: int = 20, dt: float = 1 / 60, duration: float = 5.0) -> Scene:
    """`count` links of 3 m in all and 1 kg each, held at one end at 3 m, let go horizontally."""
    if count < 1:
        raise ValueError(f"count = {count}: give a number >= 1")
    space = _space()
    bodies = _bars(space, (0.0, 3.0), [0.0] * count, 3.0 / count)
    return Scene("chain", space, bodies, dt, duration, 1e6, parameters={"count": count, "dt": dt})


def bridge(
    planks: int = 12, load: float = 20.0, slack: float = 0.05, dt: float = 1 / 60, duration: float = 5.0
) -> Scene:
    """`planks` of .5 m and 1 kg on pivots hang between two banks; a box of `load` kg falls on them, off the middle.

    The banks are by `slack` of the planks' length nearer to each other than the planks are long; these start on an arc.
    """
    if planks < 2 or not load > 0.0 or not 0.0 < slack < 0.5:
        given = f"planks = {planks}, load = {load}, slack = {slack}"
        raise ValueError(f"{given}: give planks >= 2, load > 0, 0 < slack < .5")
    space = _space()
    span = 0.5 * planks * (1.0 - slack)
    order = np.arange(planks) - 0.5 * (planks - 1)
    low, high = 0.0, math.pi / planks
    for _ in range(60):  # the bend of a joint with which the planks end at the other bank
        bend = 0.5 * (low + high)
        low, high = (bend, high) if 0.5 * np.cos(order * bend).sum() > span else (low, bend)
    bodies = _bars(space, (0.0, 0.0), [float(k * low) for k in order], 0.5, deck=True)
    space.add(pymunk.PivotJoint(bodies[-1], space.static_body, (0.25, 0.0), (span, 0.0)))
    bodies.append(add_box(space, (0.4 * span, 1.0), 0.6, 0.6, load))
    for shape in space.shapes:
        shape.elasticity, shape.friction = 0.3, 0.8
    parameters = {"planks": planks, "load": load, "slack": slack, "dt": dt}
    return Scene("bridge", space, bodies, dt, duration, 1e6, parameters=parameters)


def _space() -> pymunk.Space:
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    return space


def _bars(
    space: pymunk.Space, start: tuple[float, float], angles: Sequence[float], length: float, deck: bool = False
) -> list[pymunk.Body]:
    """Bars of 1 kg on pivots, each at its angle, the first on the ground at `start`; those of a deck carry things."""
    bodies: list[pymunk.Body] = []
    before, anchor, end = space.static_body, start, pymunk.Vec2d(*start)
    for angle in angles:
        bar = pymunk.Body(1.0, length**2 / 12.0)
        half = pymunk.Vec2d(0.5 * length, 0.0).rotated(angle)
        bar.position, bar.angle = end + half, angle
        shape = pymunk.Segment(bar, (-0.5 * length, 0.0), (0.5 * length, 0.0), 0.04)
        shape.filter = pymunk.ShapeFilter(group=1) if deck else _NOBODY
        space.add(bar, shape, pymunk.PivotJoint(before, bar, anchor, (-0.5 * length, 0.0)))
        bodies.append(bar)
        before, anchor, end = bar, (0.5 * length, 0.0), end + 2.0 * half
    return bodies
