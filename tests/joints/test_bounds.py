"""Several limits at once: velocities that fit them, and limits that stop one another."""

from __future__ import annotations

import itertools

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from scenes.linkages import body, empty


def rods(count: int, rng: np.random.Generator, gravity: float) -> pymunk.Space:
    """A straight chain of rods of length 1 on pivots, of random masses; joint i + count limits rod i to -0.3 to 0.3."""
    space, before = empty(gravity), None
    for i in range(count):
        rod = body(space, float(rng.uniform(0.5, 2.0)), float(rng.uniform(0.05, 0.3)), (i + 0.5, 0.0))
        space.add(pymunk.PivotJoint(before or space.static_body, rod, (float(i), 0.0)))
        before = rod
    for a, b in itertools.pairwise([space.static_body, *space.bodies]):
        space.add(pymunk.RotaryLimitJoint(a, b, -0.3, 0.3))
    return space


def nearest_velocities(space: pymunk.Space, outwards: np.ndarray) -> np.ndarray:
    """By trying all sets of limits: v+ = v + M^-1 J^T lam with pivots at rest and, of limits on their bounds (the signs
    `outwards` of their angles), rates >= 0, lam >= 0, and one of them 0."""
    n = len(space.bodies)
    inertia = np.diag([x for b in space.bodies for x in (b.mass, b.mass, b.moment)])
    v = np.array([x for b in space.bodies for x in (*b.velocity, b.angular_velocity)])
    pivots, limits = np.zeros((2 * n, 3 * n)), np.zeros((n, 3 * n))
    for i in range(n):
        for j, sign in ((i, 1.0), (i - 1, -1.0))[: 1 if i == 0 else 2]:
            pivots[2 * i, 3 * j] = pivots[2 * i + 1, 3 * j + 1] = sign
            pivots[2 * i + 1, 3 * j + 2] = -0.5
            limits[i, 3 * j + 2] = -sign * outwards[i]
    for size in range(n + 1):
        for held in itertools.combinations(range(n), size):
            rows = np.vstack([pivots, limits[list(held)]])
            spread = np.linalg.solve(inertia, rows.T)
            impulses = -np.linalg.solve(rows @ spread, rows @ v)
            after = v + spread @ impulses
            if (impulses[2 * n :] >= -1e-12).all() and (limits @ after >= -1e-12).all():
                return after
    raise AssertionError("there is always one")


@pytest.mark.parametrize("seed", range(60))
def test_velocities_fit_all_limits_on_their_bounds(seed: int) -> None:
    """A limit that has been let go is held again if others, let go after it, leave it closing."""
    rng = np.random.default_rng(seed)
    space = rods(int(rng.integers(2, 6)), rng, 0.0)
    outwards = rng.choice([-1.0, 1.0], len(space.bodies))
    for joint, sign in zip(list(space.constraints)[len(space.bodies) :], outwards, strict=True):
        assert isinstance(joint, pymunk.RotaryLimitJoint)
        joint.min, joint.max = (-0.3, 0.0) if sign > 0 else (0.0, 0.3)
    for rod in space.bodies:
        rod.velocity, rod.angular_velocity = tuple(rng.standard_normal(2)), float(rng.standard_normal())
    expected = nearest_velocities(space, outwards)
    ep.EECA(space).step(1e-9)
    found = [x for b in space.bodies for x in (*b.velocity, b.angular_velocity)]
    np.testing.assert_allclose(found, expected, atol=1e-7)


def test_limits_that_stop_one_another_do_so_a_few_times() -> None:
    """Each opens the other by a hundredth of the rate before: without end, if both had to be met each time."""
    most = []
    for seed in (0, 6):
        space = rods(4, np.random.default_rng(seed), 9.81)
        stepper, efforts = ep.EECA(space), []
        for _ in range(60):
            stepper.step(1 / 60)
            assert stepper.event_loop is not None
            assert stepper.event_loop.joints is not None
            efforts.append(float(stepper.event_loop.joints.PROGRESS.effort))
        most.append(max(efforts))
        assert max(b.velocity.length for b in space.bodies) < 1e-9
    assert sum(most) < 1.1e6  # operations, of the dearest steps; 7e3 each if no limit is met
