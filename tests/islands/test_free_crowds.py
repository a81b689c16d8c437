"""Bodies in flight that meet, press on each other and are lifted apart keep linear and angular momentum."""

from __future__ import annotations

import math
from itertools import pairwise
from random import Random

import pymunk
import pytest

import eeca_pymunk as ep


def crowd(seed: int, joined: bool) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """Up to 14 disks and boxes that come together, the first three on pivots if `joined`."""
    R, space, bodies = Random(seed), pymunk.Space(), []
    for _ in range(14):
        body = pymunk.Body(10.0 ** R.uniform(0.0, 2.0), R.uniform(0.1, 1.0))
        x, y = R.uniform(-3.0, 3.0), R.uniform(-3.0, 3.0)
        body.position, body.angle, body.angular_velocity = (x, y), R.uniform(-3.0, 3.0), R.uniform(-2.0, 2.0)
        body.velocity = -x * R.uniform(0.3, 1.0), -y * R.uniform(0.3, 1.0)
        shape = pymunk.Circle(body, 0.5) if R.random() < 0.4 else pymunk.Poly.create_box(body, (1.2, 0.7))
        shape.friction, shape.elasticity = 0.5, R.choice((0.0, 0.0, 0.5))
        if space.point_query_nearest((x, y), 0.75, pymunk.ShapeFilter()) is None:
            space.add(body, shape)
            bodies.append(body)
    for a, b in pairwise(bodies[:3]) if joined else ():
        space.add(pymunk.PivotJoint(a, b, tuple((a.position + b.position) / 2.0)))
    return space, bodies


def momenta(bodies: list[pymunk.Body]) -> tuple[float, float, float, float]:
    """Linear momentum, angular momentum about the origin, and the sum of the sizes of its terms."""
    x = math.fsum(b.mass * b.velocity.x for b in bodies)
    y = math.fsum(b.mass * b.velocity.y for b in bodies)
    turning = [t for b in bodies for t in (b.mass * b.position.cross(b.velocity), b.moment * b.angular_velocity)]
    return x, y, math.fsum(turning), math.fsum(map(abs, turning))


@pytest.mark.parametrize("dt", [0.1, 10.0])
@pytest.mark.parametrize("joined", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_free_crowds_keep_their_momenta(seed: int, joined: bool, dt: float) -> None:
    """To round-off in each step, in which impacts cut intervals and overlaps are corrected."""
    space, bodies = crowd(seed, joined)
    stepper = ep.EECA(space)
    for _ in range(15):
        before = momenta(bodies)
        stepper.step(dt)
        after = momenta(bodies)
        size = max(before[3], after[3])
        assert after[:2] == pytest.approx(before[:2], abs=1e-12 * size)
        assert after[2] == pytest.approx(before[2], abs=1e-12 * size)
