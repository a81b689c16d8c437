"""TimeOfImpact against exact solutions: where bodies land, at steps that hold many impacts."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
import scenes
from comparisons.exact import Gas
from comparisons.hopper import crossed, deepest_overlap
from scenes.ball import bounce
from scenes.scene import add_disk, add_walls


def positions(bodies: list[pymunk.Body]) -> np.ndarray:
    return np.array([b.position for b in bodies])


def exact_gas(scene: scenes.Scene, duration: float) -> Gas:
    radius = np.array([next(iter(b.shapes)).radius for b in scene.bodies])  # type: ignore[attr-defined]
    gas = Gas(positions(scene.bodies), np.array([b.velocity for b in scene.bodies]), radius, np.ones(len(radius)))
    gas.run(duration)
    return gas


@pytest.mark.parametrize("dt", [1e-2, 5e-3])
def test_gas_of_twenty_disks_is_exact_for_twenty_seeds(dt: float) -> None:
    errors = []
    for seed in range(20):
        scene = scenes.build("gas", count=20, radius=0.03, seed=seed)
        exact = exact_gas(scene, 0.4)
        stepper, energy, impacts = ep.EECA(scene.space), ep.measure(scene.space).energy, 0
        for _ in range(round(0.4 / dt)):
            impacts += len(stepper.step(dt).contacts)
        assert impacts == exact.events
        assert ep.measure(scene.space).energy == pytest.approx(energy, rel=1e-13)
        errors.append(np.abs(positions(scene.bodies) - exact.position).max())
    assert max(errors) <= 1e-10
    assert np.median(errors) <= 1e-11


@pytest.mark.parametrize(("count", "dt"), [(20, 0.2), (100, 0.08), (400, 0.05)])
def test_steps_with_many_impacts_each_keep_their_order(count: int, dt: float) -> None:
    # Each disk is hit several times in a step: impacts taken out of order would end elsewhere.
    scene = scenes.build("gas", count=count, packing=0.3, seed=1)
    exact = exact_gas(scene, dt)
    report = ep.EECA(scene.space).step(dt)
    assert len(report.contacts) == exact.events
    assert exact.events > count
    np.testing.assert_allclose(positions(scene.bodies), exact.position, atol=1e-6)


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.3])
def test_two_hits_on_one_disk_at_one_instant_are_one_block(angle: float) -> None:
    # In any frame: two disks, apart, are hit at the same time up to round-off. With n at angles t and -t to the motion,
    # u' = -u for both at once is lam (1 + 2 cos^2 t) = 2 v cos t for equal masses.
    c, s = math.cos(angle), math.sin(angle)

    def turned(x: float, y: float) -> tuple[float, float]:
        return (3.0 + c * x - s * y, -2.0 + s * x + c * y)

    space = pymunk.Space()
    a = add_disk(space, turned(-1.0, 0.0), 0.5, velocity=(2.0 * c, 2.0 * s))
    b, d = add_disk(space, turned(0.3, 0.6), 0.5), add_disk(space, turned(0.3, -0.6), 0.5)
    ep.EECA(space).step(1.0)
    cos = 0.8  # of the angle of n: centres are .6 apart across, 1 in all
    lam = 2.0 * 2.0 * cos / (1.0 + 2.0 * cos * cos)
    np.testing.assert_allclose(a.velocity, np.array([c, s]) * (2.0 - 2.0 * lam * cos), atol=1e-12)
    assert b.velocity.length == pytest.approx(lam, rel=1e-12)
    assert d.velocity.length == pytest.approx(lam, rel=1e-12)


@pytest.mark.parametrize("dt", [0.0017, 0.01, 0.05])
def test_carom_after_ten_seconds(dt: float) -> None:
    scene = scenes.build("carom", dt=dt)
    stepper, steps = ep.EECA(scene.space), round(10.0 / dt)
    for _ in range(steps):
        stepper.step(dt)
    exact = scene.exact(steps * dt)
    assert exact is not None
    np.testing.assert_allclose(positions(scene.bodies), exact, atol=1e-11)


@pytest.mark.parametrize("dt", [1 / 60, 1 / 15])
def test_ball_reaches_its_apex_after_a_hundred_bounces(dt: float) -> None:
    scene = scenes.build("ball", dt=dt)
    stepper, (ball,), bounces = ep.EECA(scene.space), scene.bodies, 0
    while bounces < 100:
        bounces += len(stepper.step(dt).contacts)
    apex = ball.position.y + 0.5 * ball.velocity.y**2 / 9.81
    assert apex == pytest.approx(0.2 + 2.0, abs=1e-10)
    assert ball.position.y - 0.2 == pytest.approx(bounce(2.0, 0.0, 9.81, stepper.time), abs=1e-10)


@pytest.mark.parametrize("e", [0.3, 0.5, 0.8, 0.95])
def test_inelastic_bounce_loses_exactly_its_part(e: float) -> None:
    scene = scenes.build("ball")
    (ball,) = scene.bodies
    next(iter(ball.shapes)).elasticity = e
    stepper = ep.EECA(scene.space)
    while len(stepper.step(1 / 60).contacts) == 0:
        pass
    apex = ball.position.y - 0.2 + 0.5 * ball.velocity.y**2 / 9.81
    assert apex == pytest.approx(2.0 * e * e, rel=1e-12)


@pytest.mark.parametrize("speed", [5.0, 23.0, 50.0, 400.0, 1000.0])
def test_fast_disk_meets_a_thin_wall(speed: float) -> None:
    space = pymunk.Space()
    disk = add_disk(space, (0.0, 1.0), 0.2, velocity=(0.0, -speed))
    add_walls(space, [((-5.0, 0.0), (5.0, 0.0))])
    stepper = ep.EECA(space)
    for _ in range(12):
        stepper.step(1 / 60)
    assert disk.position.y == pytest.approx(0.2 + abs(speed * 12 / 60 - 0.8), rel=1e-13)


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9])
def test_grazing_hit(depth: float) -> None:
    # Two disks of radius .5 pass with their centres 1 - depth apart: n is turned by acos(1 - depth) from the motion.
    space = pymunk.Space()
    a = add_disk(space, (-1.0, 1.0 - depth), 0.5, velocity=(3.0, 0.0))
    b = add_disk(space, (0.0, 0.0), 0.5)
    ep.EECA(space).step(1.0)
    n = np.array([math.sqrt(depth * (2.0 - depth)), depth - 1.0])
    np.testing.assert_allclose(b.velocity, 3.0 * n[0] * n, rtol=1e-6)
    assert a.velocity.x + b.velocity.x == pytest.approx(3.0, rel=1e-15)


@pytest.mark.parametrize("steps", [1, 7, 200])
@pytest.mark.parametrize("kind", ["segment end", "capsule end", "box corner", "rounded box", "circle"])
def test_round_features_are_hit_where_the_line_of_motion_meets_them(kind: str, steps: int) -> None:
    # Each has its feature at the origin, or rounds it by .2: a vertex acts as a fixed disk of that radius.
    space, rounding = pymunk.Space(), 0.2 if kind in ("capsule end", "rounded box", "circle") else 0.0
    static = space.static_body
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, -1.0), (0.0, -1.0)]
    shape: pymunk.Shape = {
        "segment end": lambda: pymunk.Segment(static, (0.0, 0.0), (1.0, -1.0), 0.0),
        "capsule end": lambda: pymunk.Segment(static, (0.0, 0.0), (1.0, -1.0), rounding),
        "box corner": lambda: pymunk.Poly(static, square),
        "rounded box": lambda: pymunk.Poly(static, square, radius=rounding),
        "circle": lambda: pymunk.Circle(static, rounding),
    }[kind]()
    shape.elasticity = 1.0
    space.add(shape)
    v = np.array([3.0, -1.0])
    x0 = np.array([-2.0, 0.75])
    disk = add_disk(space, tuple(x0), 0.1, velocity=tuple(v))
    stepper = ep.EECA(space)
    for _ in range(steps):
        stepper.step(1.0 / steps)
    R = 0.1 + rounding
    roots = np.roots([v @ v, 2.0 * x0 @ v, x0 @ x0 - R * R])
    assert np.isreal(roots).all()
    tau = min(roots.real)
    n = (x0 + tau * v) / R
    reflected = v - 2.0 * (v @ n) * n
    np.testing.assert_allclose(disk.velocity, reflected, atol=1e-13)
    np.testing.assert_allclose(disk.position, x0 + tau * v + (1.0 - tau) * reflected, atol=1e-13)


def first_root(coefficients: list[float]) -> float:
    roots = np.roots(coefficients)
    return float(min(r.real for r in roots if abs(r.imag) < 1e-9 and r.real > 1e-9))


@pytest.mark.parametrize("steps", [1, 100])
def test_thrown_disk_meets_a_vertex_at_the_root_of_a_quartic(steps: int) -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    add_walls(space, [((0.0, 0.0), (0.3, -5.0))])
    x0, v0, g = np.array([-1.0, -0.2]), np.array([1.4, 4.0]), np.array([0.0, -9.81])
    disk = add_disk(space, tuple(x0), 0.25, velocity=tuple(v0))
    stepper = ep.EECA(space)
    for _ in range(steps):
        stepper.step(0.8 / steps)
    # |x0 + v0 t + g t^2 / 2|^2 = R^2
    tau = first_root([0.25 * g @ g, v0 @ g, v0 @ v0 + x0 @ g, 2.0 * x0 @ v0, x0 @ x0 - 0.25**2])
    assert tau < 0.8
    n = (x0 + v0 * tau + 0.5 * g * tau**2) / 0.25
    v = v0 + g * tau
    v = v - 2.0 * (v @ n) * n
    left = 0.8 - tau
    np.testing.assert_allclose(disk.velocity, v + g * left, atol=1e-11)
    np.testing.assert_allclose(disk.position, 0.25 * n + left * v + 0.5 * g * left**2, atol=1e-11)


def test_disks_under_different_forces_meet_at_the_root_of_a_quartic() -> None:
    space = pymunk.Space()
    a, b = add_disk(space, (0.0, 0.0), 0.1), add_disk(space, (1.0, 0.3), 0.1, 2.0, velocity=(-0.2, 0.0))
    a.force, b.force = (3.0, 0.0), (-1.0, -2.0)
    ep.EECA(space).step(1.0)
    d, u, A = np.array([1.0, 0.3]), np.array([-0.2, 0.0]), np.array([-0.5, -1.0]) - np.array([3.0, 0.0])
    tau = first_root([0.25 * A @ A, u @ A, u @ u + d @ A, 2.0 * d @ u, d @ d - 0.04])
    assert tau < 1.0
    n = (d + u * tau + 0.5 * A * tau**2) / 0.2
    lam = -2.0 * n @ (u + A * tau) / (1.0 + 0.5)
    v_a = np.array([3.0, 0.0]) - lam * n
    np.testing.assert_allclose(a.velocity, v_a, atol=1e-11)
    np.testing.assert_allclose(a.position, np.array([1.5, 0.0]) - lam * n * (1.0 - tau), atol=1e-11)


def test_disk_made_fast_by_a_hit_meets_the_next_one_in_the_same_step() -> None:
    # A heavy disk sends a resting one twice as far as anything was going to move: beyond every margin.
    space = pymunk.Space()
    add_disk(space, (0.0, 0.0), 0.1, 1e6, velocity=(10.0, 0.0))
    add_disk(space, (1.0, 0.0), 0.1)
    last = add_disk(space, (14.0, 0.0), 0.1, 1e3)
    ep.EECA(space).step(1.0)
    # It starts at .08 s with 20 m/s and has 12.8 m to go.
    assert last.velocity.x == pytest.approx(2.0 * 20.0 / 1001.0, rel=1e-4)


@pytest.mark.parametrize("mass", [1e2, 1e4])
def test_pi_is_counted(mass: float) -> None:
    space = pymunk.Space()
    add_walls(space, [((0.0, -5.0), (0.0, 5.0))])
    add_disk(space, (2.0, 0.0), 0.1)
    add_disk(space, (4.0, 0.0), 0.5, mass, velocity=(-1.0, 0.0))
    stepper, hits = ep.EECA(space), 0
    for _ in range(200):
        hits += len(stepper.step(1.0).contacts)
    assert hits == math.floor(math.pi * math.sqrt(mass))


def test_bernoulli_two_touching_disks_are_hit_at_once_and_alike() -> None:
    space = pymunk.Space()
    a = add_disk(space, (-2.0, 0.0), 0.5, velocity=(2.0, 0.0))
    b, c = add_disk(space, (0.0, 0.5), 0.5), add_disk(space, (0.0, -0.5), 0.5)
    stepper = ep.EECA(space)
    for _ in range(120):
        stepper.step(1 / 60)
    np.testing.assert_allclose(a.velocity, (-0.4, 0.0), atol=1e-12)
    np.testing.assert_allclose(b.velocity, (1.2, 0.4 * math.sqrt(3.0)), atol=1e-12)
    np.testing.assert_allclose(c.velocity, (1.2, -0.4 * math.sqrt(3.0)), atol=1e-12)


@pytest.mark.parametrize("offset", [0.0, 1e-9, 1e-3])
def test_right_angle_corner_reverses(offset: float) -> None:
    space = pymunk.Space()
    s = math.sqrt(0.5)
    add_walls(space, [((0.0, 0.0), (5.0 * s, 5.0 * s)), ((0.0, 0.0), (-5.0 * s, 5.0 * s))])
    disk = add_disk(space, (offset, 2.5), 0.2, velocity=(0.0, -1.0))
    stepper = ep.EECA(space)
    for _ in range(40):
        stepper.step(0.1)
    np.testing.assert_allclose(disk.velocity, (0.0, 1.0), atol=1e-12)


def test_polygon_of_nearly_parallel_walls_gives_no_energy() -> None:
    space = pymunk.Space()
    disk = add_disk(space, (0.0, 0.5), 1.0, velocity=(1.0, 0.3))
    corners = [(4.0 * math.cos(2 * math.pi * i / 720), 4.0 * math.sin(2 * math.pi * i / 720)) for i in range(720)]
    add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
    stepper = ep.EECA(space)
    for _ in range(1500):
        stepper.step(0.1)
    assert disk.velocity.length == pytest.approx(math.hypot(1.0, 0.3), rel=1e-12)
    assert disk.position.length < 3.0


def test_resting_stack_stays_and_a_hit_on_it_keeps_energy() -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    stack = [add_disk(space, (0.0, 0.2 + 0.4 * i), 0.2) for i in range(4)]
    add_walls(space, [((-5.0, 0.0), (5.0, 0.0))])
    stepper, start = ep.EECA(space), positions(stack)
    for _ in range(200):
        report = stepper.step(1 / 60)
    np.testing.assert_allclose(positions(stack), start, atol=1e-12)
    # The floor carries four weights over the step.
    np.testing.assert_allclose(report.impulse.max(), 4.0 * 9.81 / 60, rtol=1e-9)
    add_disk(space, (0.0, 3.0), 0.2)
    energy = ep.measure(space).energy
    for _ in range(200):
        stepper.step(1 / 60)
        assert ep.measure(space).energy == pytest.approx(energy, rel=1e-12)


def test_hit_on_a_ball_that_rests_with_some_speed_keeps_energy() -> None:
    # The lower ball would bounce many times in a step: it rests on a force, which the hit from above interrupts.
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    add_disk(space, (0.0, 0.2), 0.2, velocity=(0.0, 3e-3))
    above = add_disk(space, (0.0, 0.6 + 0.02), 0.2, velocity=(0.0, -2.0))
    add_walls(space, [((-5.0, 0.0), (5.0, 0.0))])
    stepper, energy = ep.EECA(space), ep.measure(space).energy
    stepper.step(1 / 60)
    assert above.velocity.y > 0.0
    assert ep.measure(space).energy == pytest.approx(energy, rel=1e-13)


def test_ball_slides_off_a_rounded_floor_without_bouncing() -> None:
    # Not elastic, on a fixed disk: it leaves where cos = 2/3 of the start's height, v^2 = 2 g R (1 - cos) = g R cos.
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    hill = pymunk.Circle(space.static_body, 1.0)
    space.add(hill)
    ball = add_disk(space, (1.1 * math.sin(0.2), 1.1 * math.cos(0.2)), 0.1)
    ball_shape = next(iter(ball.shapes))
    ball_shape.elasticity = 0.0
    stepper = ep.EECA(space)
    while len(stepper.step(2e-3).contacts):
        last = ball.position
    assert last.y / 1.1 == pytest.approx(2.0 / 3.0 * math.cos(0.2), abs=1e-2)


def test_inelastic_collapse_ends() -> None:
    space = pymunk.Space()
    add_walls(space, [((0.0, -1.0), (0.0, 1.0))])
    disks = [add_disk(space, (1.0 + 0.5 * i, 0.0), 0.2, velocity=(-1.0, 0.0)) for i in range(5)]
    for disk in disks:
        next(iter(disk.shapes)).elasticity = 0.1
    stepper = ep.EECA(space)
    for _ in range(200):
        stepper.step(1 / 60)
    x = positions(disks)[:, 0]
    assert x[0] >= 0.2 - 1e-9
    assert np.diff(x).min() >= 0.4 - 1e-9
    assert max(disk.velocity.length for disk in disks) < 0.1


@pytest.mark.parametrize("dt", [2.5e-3, 1e-3])
def test_hopper_neither_overlaps_nor_leaks(dt: float) -> None:
    scene = scenes.build("hopper", dt=dt)
    stepper, energy = ep.EECA(scene.space), ep.measure(scene.space).energy
    before = positions(scene.bodies)
    for _ in range(round(0.5 / dt)):
        stepper.step(dt)
        after = positions(scene.bodies)
        assert not crossed(before, after).any()
        assert deepest_overlap(after) <= 1e-9
        before = after
    assert ep.measure(scene.space).energy == pytest.approx(energy, rel=1e-11)


def test_time_reversal_of_a_gas() -> None:
    scene = scenes.build("gas", count=20, radius=0.03, seed=3)
    stepper, start = ep.EECA(scene.space), positions(scene.bodies)
    for sign in (1, -1):
        for body in scene.bodies:
            body.velocity = sign * body.velocity
        for _ in range(20):
            stepper.step(0.015)
    np.testing.assert_allclose(positions(scene.bodies), start, atol=1e-9)


def test_report_of_a_lone_impact() -> None:
    # Eqs. 20, 28: psi2 = 1 - 2 tau / dt, and the gap changes by psi2 dt |u| over the step.
    scene = scenes.build("signorini", height=0.5e-3)
    report = ep.EECA(scene.space).step(2e-3)
    assert report.contacts.time[0] == pytest.approx(0.5e-3)
    assert report.psi2[0] == pytest.approx(0.5)
    assert report.gap_increment[0] == pytest.approx(scene.bodies[0].position.y - 0.1 - 0.5e-3)
    assert report.impulse[0] == pytest.approx(2.0)


def test_what_the_user_changes_between_steps_is_seen() -> None:
    # The disk would meet the floor in the fourth step; it is thrown up, moved, then pushed by a force instead.
    space = pymunk.Space()
    disk = add_disk(space, (0.0, 0.45), 0.1, velocity=(0.0, -1.0))
    add_walls(space, [((-5.0, 0.0), (5.0, 0.0)), ((-5.0, 1.0), (5.0, 1.0))])
    stepper = ep.EECA(space)
    stepper.step(0.1)
    disk.velocity = (0.0, 2.0)
    for _ in range(3):
        stepper.step(0.1)
    assert disk.position.y == pytest.approx(0.9 - (0.6 - 0.55))
    disk.position = (0.0, 0.25)
    stepper.step(0.1)
    assert disk.position.y == pytest.approx(0.1 + (0.2 - 0.15))
    disk.force = (0.0, -100.0)
    stepper.step(0.1)
    # Constant force: v^2 / 2 + 100 y stays what it was, 2 + 100 * .15, through all bounces.
    assert 0.5 * disk.velocity.y**2 + 100.0 * disk.position.y == pytest.approx(17.0, rel=1e-12)
    assert disk.position.y >= 0.1


def test_touching_pairs_that_part_slowly_are_hit_again() -> None:
    # b and c touch, part at 1e-9 m/s for a while, and are then hit one after the other.
    space = pymunk.Space()
    a = add_disk(space, (-1.0, 0.0), 0.1, velocity=(1.0, 0.0))
    b, c = add_disk(space, (0.0, 0.0), 0.1), add_disk(space, (0.2, 0.0), 0.1, velocity=(1e-9, 0.0))
    stepper = ep.EECA(space)
    for _ in range(20):
        stepper.step(0.1)
    np.testing.assert_allclose([a.velocity.x, b.velocity.x, c.velocity.x], [0.0, 1e-9, 1.0], atol=1e-8)


def test_step_that_takes_a_crowd_across_the_box() -> None:
    scene = scenes.build("gas", count=300, packing=0.2, seed=2)
    stepper, energy = ep.EECA(scene.space), ep.measure(scene.space).energy
    report = stepper.step(1.0)
    assert report.converged
    assert (np.diff(report.contacts.time) >= 0.0).all()
    assert 0.9 < report.contacts.time.max() < 1.0
    assert ep.measure(scene.space).energy == pytest.approx(energy, rel=1e-12)
    x, radius = positions(scene.bodies), scene.parameters["radius"]
    assert (x >= radius - 1e-9).all()
    assert (x <= 1.0 - radius + 1e-9).all()


def test_resting_contact_on_a_curved_shape_is_second_order_in_dt() -> None:
    def end(dt: float) -> np.ndarray:
        space = pymunk.Space()
        space.gravity = (0.0, -9.81)
        space.add(pymunk.Circle(space.static_body, 1.0))
        ball = add_disk(space, (1.1 * math.sin(0.2), 1.1 * math.cos(0.2)), 0.1)
        next(iter(ball.shapes)).elasticity = 0.0
        stepper = ep.EECA(space)
        for _ in range(round(0.32 / dt)):
            stepper.step(dt)
        return np.array(ball.position)

    coarse, middle, fine = end(8e-3), end(4e-3), end(2e-3)
    order = math.log2(float(np.linalg.norm(coarse - middle) / np.linalg.norm(middle - fine)))
    assert order == pytest.approx(2.0, abs=0.1)


def test_normal_that_turns_far_within_a_step_splits_the_rest() -> None:
    # Sliding over the top at 2 m/s the normal turns by .18 rad in a step of .1 s.
    def end(dt: float) -> np.ndarray:
        space = pymunk.Space()
        space.gravity = (0.0, -9.81)
        space.add(pymunk.Circle(space.static_body, 1.0))
        ball = add_disk(space, (0.0, 1.1), 0.1, velocity=(2.0, 0.0))
        next(iter(ball.shapes)).elasticity = 0.0
        stepper = ep.EECA(space)
        for _ in range(round(0.2 / dt)):
            report = stepper.step(dt)
            if dt == 0.1:
                assert len(report.contacts) > 1
        return np.array(ball.position)

    assert np.linalg.norm(end(0.1) - end(1e-3)) < 1e-3
