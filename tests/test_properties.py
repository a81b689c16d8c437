"""Random scenes: energy never rises, momentum of closed systems stays, nobody escapes, reports agree with measures."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eeca_pymunk as ep
import scenes
from scenes.scene import add_disk, add_walls

SIDE = 4.0
KINDS = st.lists(st.sampled_from(["disk", "box", "segment", "triangle"]), min_size=1, max_size=6)


def random_scene(kinds: list[str], seed: int, elasticity: float, gravity: float, walls: bool) -> pymunk.Space:
    """Bodies on a grid, clear of each other, in a box of side 4 m or free."""
    rng = np.random.default_rng(seed)
    space = pymunk.Space()
    space.gravity = (0.0, -gravity)
    for k, kind in enumerate(kinds):
        mass = float(10.0 ** rng.uniform(-1.0, 1.0))
        body = pymunk.Body(mass, 0.05 * mass)
        body.position = (0.7 + 1.3 * (k % 3), 0.7 + 1.3 * (k // 3))
        body.angle = float(rng.uniform(0.0, 6.0))
        u, v, w = (float(x) for x in rng.normal(size=3))
        body.velocity, body.angular_velocity = (u, v), w
        shape: pymunk.Shape
        if kind == "disk":
            shape = pymunk.Circle(body, 0.4)
        elif kind == "box":
            shape = pymunk.Poly.create_box(body, (0.6, 0.4), radius=0.02)
        elif kind == "segment":
            shape = pymunk.Segment(body, (-0.35, 0.0), (0.35, 0.0), 0.08)
        else:
            shape = pymunk.Poly(body, [(-0.3, -0.2), (0.3, -0.2), (0.0, 0.4)])
        shape.elasticity = elasticity
        space.add(body, shape)
    if walls:
        corners = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)]
        add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
    return space


@settings(max_examples=30, deadline=None)
@given(
    kinds=KINDS, seed=st.integers(0, 10**6), elasticity=st.sampled_from([0.5, 0.9, 1.0]),
    gravity=st.sampled_from([0.0, 9.81]), dt=st.sampled_from([1e-3, 1 / 60, 1 / 15]),
)  # fmt: skip
def test_energy_never_rises_and_nobody_escapes(
    kinds: list[str], seed: int, elasticity: float, gravity: float, dt: float
) -> None:
    space = random_scene(kinds, seed, elasticity, gravity, walls=True)
    stepper, before = ep.EECA(space, sync=False), ep.measure(space).energy
    scale = before + 1.0
    for _ in range(25):
        stepper.step(dt)
        now = ep.measure(space).energy
        if elasticity == 1.0:
            assert now == pytest.approx(before, abs=1e-12 * scale)
        assert now <= before + 1e-12 * scale
        before = min(before, now) if elasticity < 1.0 else before
    x = np.array([b.position for b in space.bodies])
    assert np.isfinite(x).all()
    assert ((x > 0.0) & (x < SIDE)).all()


@settings(max_examples=30, deadline=None, derandomize=True)
@given(kinds=KINDS, seed=st.integers(0, 10**6), elasticity=st.sampled_from([0.0, 0.6, 1.0]), dt=st.floats(1e-3, 0.1))
def test_momenta_of_free_bodies_stay_and_reports_agree(
    kinds: list[str], seed: int, elasticity: float, dt: float
) -> None:
    space = random_scene(kinds, seed, elasticity, 0.0, walls=False)
    for body in space.bodies:
        # Towards each other, so that they meet.
        body.velocity = tuple(0.5 * (np.array((2.0, 1.4)) - body.position))
    stepper, start = ep.EECA(space, sync=False), ep.measure(space)
    for _ in range(20):
        before = {b: b.velocity for b in space.bodies}
        report = stepper.step(dt)
        pushed = {b: np.zeros(2) for b in space.bodies}
        at = report.contacts
        for a, b, n, lam in zip(at.body_a, at.body_b, at.normal, report.impulse, strict=True):
            pushed[at.bodies[a]] -= lam * n
            pushed[at.bodies[b]] += lam * n
        for body, push in pushed.items() if elasticity == 1.0 else ():  # lifting, which losses pay, moves bodies too
            np.testing.assert_allclose(body.mass * np.array(body.velocity - before[body]), push, atol=1e-10)
        assert ((report.psi2 >= -1.0 - 1e-12) & (report.psi2 <= 1.0 + 1e-12)).all()
    end = ep.measure(space)
    np.testing.assert_allclose(end.linear_momentum, start.linear_momentum, atol=1e-11)
    assert end.angular_momentum == pytest.approx(start.angular_momentum, abs=1e-11)
    assert end.energy <= start.energy * (1.0 + 1e-12)


def test_elastic_disks_run_back_to_where_they_came_from() -> None:
    scene = scenes.build("gas", seed=2)
    first = np.array([b.position for b in scene.bodies])
    stepper, impacts = ep.EECA(scene.space), 0
    for _ in range(15):
        impacts += len(stepper.step(0.01).impulse)
    for body in scene.bodies:
        body.velocity = -body.velocity
    for _ in range(15):
        stepper.step(0.01)
    assert impacts > 5
    np.testing.assert_allclose([b.position for b in scene.bodies], first, atol=1e-10)


@pytest.mark.parametrize("what", ["empty", "bare body", "huge", "no shapes left"])
def test_odd_spaces_take_a_step(what: str) -> None:
    space = pymunk.Space()
    if what == "bare body":
        body = pymunk.Body(1.0, 1.0)
        body.velocity = (1.0, 0.0)
        space.add(body)
    elif what == "huge":
        a = add_disk(space, (1e9, 1e9), 1.0, velocity=(1.0, 0.0))
        b = add_disk(space, (1e9 + 3.0, 1e9), 1.0)
    elif what == "no shapes left":
        ball = add_disk(space, (0.0, 0.0), 1.0)
    stepper = ep.EECA(space)
    stepper.step(0.5)
    if what == "bare body":
        assert body.position.x == 0.5
    elif what == "huge":
        for _ in range(3):
            stepper.step(0.5)
        assert a.velocity.x == pytest.approx(0.0, abs=1e-9)
        assert b.velocity.x == pytest.approx(1.0)
    elif what == "no shapes left":
        space.remove(*ball.shapes, ball)
        stepper.step(0.5)
        assert stepper.time == 1.0


def test_a_polygon_without_area_is_a_wall() -> None:
    line = pymunk.Poly(pymunk.Space().static_body, [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)])
    other = pymunk.Space()
    thin = pymunk.Poly(other.static_body, [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)])
    add_disk(other, (1.0, 2.0), 0.5, velocity=(0.0, -1.0))
    other.add(thin)
    thin.elasticity = 1.0
    assert line.area == 0.0
    stepper = ep.EECA(other)
    for _ in range(3):
        stepper.step(1.0)
    assert next(iter(other.bodies)).velocity == pytest.approx((0.0, 1.0))
    assert math.isfinite(stepper.time)
