"""Random bodies bound by random joints of all kinds, contradictory ones too: the ledger closes, losses are losses."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.model.joint_steps import EXACT, UNHELD
from eeca_pymunk.model.joints import CONDENSED
from scenes.linkages import body, empty

from ..jointed.measures import energy
from .driving import Driven


def mixture(seed: int, count: int = 8) -> pymunk.Space:
    """Bodies of masses .1 to 10, and more joints than bodies, a third of them with a finite max_force."""
    rng = np.random.default_rng(seed)
    space = empty()
    bodies = []
    for _ in range(count):
        one = body(space, 10 ** rng.uniform(-1, 1), 10 ** rng.uniform(-2, 0), tuple(rng.uniform(-2, 2, 2)))
        one.angle, one.velocity, one.angular_velocity = rng.uniform(-3, 3), tuple(rng.normal(size=2)), 3 * rng.normal()
        bodies.append(one)
    for _ in range(count + 2):
        i, j = rng.choice(count, 2, replace=False)
        a, b = bodies[i] if rng.random() > 0.25 else space.static_body, bodies[j]
        joint = any_joint(rng, a, b)
        spring = isinstance(joint, (pymunk.DampedSpring, pymunk.DampedRotarySpring))
        if rng.random() < 0.3 and not spring:
            joint.max_force = 10 ** rng.uniform(0, 3)
        space.add(joint)
    return space


def any_joint(rng: np.random.Generator, a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    """One of the ten, fitting where the bodies are."""
    p, q = tuple(rng.uniform(-0.5, 0.5, 2)), tuple(rng.uniform(-0.5, 0.5, 2))
    far, turned = (a.local_to_world(p) - b.local_to_world(q)).length, b.angle - a.angle
    at, along = a.world_to_local(b.local_to_world(q)), pymunk.Vec2d(1, 0).rotated(rng.uniform(0, 6))
    ratio, tooth = float(rng.choice([-2.0, 0.5, 1.5])), float(rng.choice([-0.5, 0.5]))
    stiffness, damping = 10 ** rng.uniform(0, 3), 10 ** rng.uniform(-1, 1)
    makers = [
        lambda: pymunk.PinJoint(a, b, p, q),
        lambda: pymunk.PivotJoint(a, b, tuple(rng.uniform(-2, 2, 2))),
        lambda: pymunk.SlideJoint(a, b, p, q, 0.7 * far, 1.2 * far),
        lambda: pymunk.GrooveJoint(a, b, tuple(at - 0.5 * along), tuple(at + 0.7 * along), q),
        lambda: pymunk.DampedSpring(a, b, p, q, 1.0, stiffness, damping),
        lambda: pymunk.DampedRotarySpring(a, b, 0.3, 0.1 * stiffness, damping),
        lambda: pymunk.RotaryLimitJoint(a, b, turned - 0.5, turned + 0.6),
        lambda: pymunk.RatchetJoint(a, b, 0.1, tooth),
        lambda: pymunk.GearJoint(a, b, b.angle * ratio - a.angle, ratio),
        lambda: pymunk.SimpleMotor(a, b, float(rng.normal())),
    ]
    return makers[rng.integers(10)]()


@pytest.mark.parametrize("seed", range(16))
def test_ledger_of_a_mixture(seed: int) -> None:
    stepper = Driven(mixture(seed))
    scale, lowest, worst = 1.0, 0.0, EXACT
    before = stepper.losses()
    for _ in range(60):
        stepper.step(1 / 60)
        scale = max(scale, abs(energy(stepper.space)))
        after = stepper.losses()
        lost = min(b - a for a, b in zip(before, after, strict=True))
        lowest, before, worst = min(lowest, lost), after, max(worst, stepper.status)
    assert all(np.isfinite((*b.position, b.angle, *b.velocity, b.angular_velocity)).all() for b in stepper.space.bodies)
    assert lowest >= -1e-12 * scale
    assert abs(stepper.unexplained()) < (1e-11 if worst < UNHELD else 1e-9) * scale


def test_pins_of_a_cloth_give_way_at_their_bounds() -> None:
    """The component is wide, so that its system has no unknowns of rows: a row at its bound acts on the right side. The
    others hold, and the energy that slipping takes is that of the ledger."""
    space, bodies = pymunk.Space(), {}
    space.gravity = 0.0, -10.0
    for i, j in np.ndindex(8, 8):
        one = bodies[i, j] = pymunk.Body(1.0, 0.05) if j else pymunk.Body(body_type=pymunk.Body.STATIC)
        one.position = 0.5 * i, -0.5 * j
        if j:
            one.velocity = 3.0 * np.sin(0.5 * j), 2.0 * np.cos(1.5 * i)
        space.add(one)
    for i, j in np.ndindex(8, 8):
        for other in (bodies.get((i + 1, j)), bodies.get((i, j + 1))):
            if other is not None and (j or other.body_type == pymunk.Body.DYNAMIC):
                pin = pymunk.PinJoint(bodies[i, j], other)
                pin.max_force = 10.0 if (i + 2 * j) % 3 == 0 else np.inf
                space.add(pin)
    stepper, dt, slipped = ep.EECA(space, sync=False), 1 / 120, 0
    for _ in range(10):
        report = stepper.step(dt)
        assert report.converged
        ledger, scale = report.ledger, abs(ep.measure(space).energy)
        assert abs(ledger.residual) <= 1e-13 * scale
        assert ledger.friction >= 0.0
        for pin in space.constraints:
            assert pin.impulse <= pin.max_force * dt * (1.0 + 1e-12)
            slipped += pin.impulse >= pin.max_force * dt * (1.0 - 1e-12)
            if pin.max_force == np.inf:
                far = (pin.a.position - pin.b.position).length
                assert far == pytest.approx(pin.distance, abs=1e-11)
    assert slipped > 100
    loop = stepper.event_loop
    assert loop is not None
    assert (loop.joints.COMPONENT["system"][0], loop.joints.TALLY.components) == (CONDENSED, 1)
