"""Random bodies bound by random joints of all kinds, contradictory ones too: the ledger closes, losses are losses."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest

from eeca_pymunk.model.joint_steps import EXACT, LINEAR
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
    assert abs(stepper.unexplained()) < (1e-11 if worst < LINEAR else 1e-9) * scale
