"""Forces between bodies act along one line; the work of those from outside is that along the path."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from scenes import linkages

from .driving import momenta


@pytest.mark.parametrize("dt", [1 / 240, 1 / 60, 0.1])
@pytest.mark.parametrize("force", [0.1, 1.0, 10.0])
def test_a_pivot_that_gives_way_keeps_angular_momentum(force: float, dt: float) -> None:
    """Its force acts at one point, halfway between the anchors, however far these are apart; its impulse stays within
    its bound, and its work is lost or comes from outside."""
    space = linkages.empty(0.0)
    bodies = [linkages.body(space, 1.0 + k, 0.3, (k, 0.1 * k), 0.4 * k) for k in range(3)]
    for k, body in enumerate(bodies):
        body.velocity, body.angular_velocity = (0.5 - k, 1.0 + k * k), 7.0 - 5.0 * k
    for a, b in itertools.pairwise(bodies):
        joint = pymunk.PivotJoint(a, b, (a.position + b.position) / 2)
        joint.max_force = force
        space.add(joint)
    stepper, start, apart = ep.EECA(space), momenta(space), 0.0
    for _ in range(200):
        before = ep.measure(space).energy
        report = stepper.step(dt)
        assert report.converged
        far = max(float(np.linalg.norm(momenta(space))), 1.0)
        np.testing.assert_allclose(momenta(space), start, atol=1e-12 * far * (1.0 + bodies[0].position.length))
        assert report.ledger is not None
        assert abs(report.ledger.residual) < 1e-11 * (1.0 + before)
        for joint in space.constraints:
            assert joint.impulse <= force * dt * (1.0 + 1e-14)
            ends = joint.a.local_to_world(joint.anchor_a), joint.b.local_to_world(joint.anchor_b)
            apart = max(apart, ends[0].get_distance(ends[1]))
    assert apart > 0.1 or force == 10.0


@pytest.mark.parametrize("twist", [0.0, 3.0])
@pytest.mark.parametrize("dt", [1 / 240, 1 / 30])
def test_external_is_the_work_of_forces_along_the_path(dt: float, twist: float) -> None:
    """F . x of forces and velocity functions; a torque T on a body that a joint holds off its centre acts along chi = 2
    tan(angle/2) of each part of a step: then dL = T h, and torques on two bodies that cancel keep angular momentum. A
    damped spring makes a step one part."""
    space = linkages.empty(9.81)
    bodies = [linkages.body(space, 1.0 + k, 0.3, (0.5 + k, 0.0), 0.2 * k) for k in range(3)]
    space.add(pymunk.PivotJoint(space.static_body, bodies[0], (0.0, 0.0)))
    for a, b in itertools.pairwise(bodies):
        space.add(pymunk.PivotJoint(a, b, (a.position + b.position) / 2))
    space.add(pymunk.DampedRotarySpring(bodies[0], bodies[1], 0.0, 1.0, 0.1))

    def steer(body: pymunk.Body, gravity: tuple[float, float], damping: float, h: float) -> None:
        pymunk.Body.update_velocity(body, (gravity[0] + 2.0, gravity[1] - 1.0), damping, h)

    bodies[2].velocity_func = steer
    stepper = ep.EECA(space)
    for k in range(100):
        push = pymunk.Vec2d(5.0, -2.0) * math.cos(3.0 * k * dt)
        bodies[0].force, bodies[1].torque = push, twist
        start = [(body.position, body.angle) for body in bodies]
        report = stepper.step(dt)
        assert report.converged
        way = [body.position - at for body, (at, _) in zip(bodies, start, strict=True)]
        turned = bodies[1].angle - start[1][1]
        work = push.dot(way[0]) + twist * 2.0 * math.tan(turned / 2.0)
        work += bodies[2].mass * pymunk.Vec2d(2.0, -1.0).dot(way[2])
        assert report.ledger is not None
        assert report.ledger.external == pytest.approx(work, abs=1e-11 * (1.0 + ep.measure(space).kinetic))
