"""Systems in the rows of joints alone."""

import math

import pymunk

import eeca_pymunk as ep


def star(limits: str) -> list[tuple[float, float, float]]:
    """Where five limbs on pivots of a torso are after 60 steps: without limits, with limits that all, or that every
    other joint, never reaches, these between joints that have none."""
    space = pymunk.Space()
    space.gravity = (0.0, -9.0)
    torso = pymunk.Body(2.0, 0.5)
    space.add(torso)
    for k in range(5):
        angle = 2.0 * math.pi * k / 5.0
        limb = pymunk.Body(0.5 + 0.1 * k, 0.05)
        limb.position = 0.8 * math.cos(angle), 0.8 * math.sin(angle)
        limb.angular_velocity = 1.0 + k
        at = 0.5 * math.cos(angle), 0.5 * math.sin(angle)
        # A velocity that fits the pivot.
        arm = at[0] - limb.position.x, at[1] - limb.position.y
        limb.velocity = limb.angular_velocity * arm[1], -limb.angular_velocity * arm[0]
        space.add(limb, pymunk.PivotJoint(torso, limb, at))
        if limits == "all" or (limits == "some" and k % 2 == 0):
            space.add(pymunk.RotaryLimitJoint(torso, limb, -1000.0, 1000.0))
    stepper = ep.EECA(space)
    for _ in range(60):
        assert stepper.step(1.0 / 60.0).converged
    return [(b.position.x, b.position.y, b.angle) for b in space.bodies]


def test_limits_on_which_no_joint_stands_have_no_place() -> None:
    """They change nothing, wherever their rows are among those of other joints."""
    free = star("none")
    for limits in ("some", "all"):
        for one, other in zip(star(limits), free, strict=True):
            assert max(abs(a - b) for a, b in zip(one, other, strict=True)) < 1e-11
