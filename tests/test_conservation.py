"""What the steppers conserve, and what the baselines do not, in the paper's problems and in random ones."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eeca_pymunk as ep
import scenes
from comparisons import runs
from comparisons.carom import Track
from comparisons.hopper import numerical_damping
from comparisons.piles import pile
from comparisons.pool_break import Watch
from scenes.scene import add_disk, add_walls

from .steppers import CLOSURES, EECAS, Make, one_disk, two_disks

every_closure = pytest.mark.parametrize("closure", CLOSURES.values(), ids=CLOSURES.keys())


@every_closure
@pytest.mark.parametrize("dt", [0.0025, 0.0017])
def test_carom_keeps_energy_and_angles_for_ten_seconds(closure: ep.Closure, dt: float) -> None:
    track = Track()
    result = runs.run(scenes.build("carom", dt=dt), runs.eeca(closure), observe=track)
    assert result.failed is None
    assert result.energy_drift <= 1e-13
    assert track.turned <= 1e-12  # degrees


@pytest.mark.parametrize("dt", [0.0025])
def test_carom_newmark_gains_and_loses(dt: float) -> None:
    # A trapezoidal impact gains or loses with the gap of its release; over many the gain wins, without a bound.
    for name, change in (("trapezoidal", 1.0), ("max_dissipation", -0.9)):
        scene = scenes.build("carom", dt=dt)
        energy = ep.record(getattr(ep.Newmark, name)(scene.space, scene.stiffness), scene.duration, dt).energy
        assert change * (energy[-1] / energy[0] - 1.0) > change**2
        if change < 0:
            assert energy.max() <= energy[0] * (1 + 1e-12)


def test_carom_exact_solution_folds_back() -> None:
    scene = scenes.build("carom")
    exact = scene.exact(0.06)
    assert exact is not None
    np.testing.assert_allclose(exact, [(0.49, 0.01)], atol=1e-14)
    np.testing.assert_allclose(scene.exact(0.12), [(0.73, 0.25)], atol=1e-14)


@pytest.mark.parametrize("position", [(0.25, 0.25), (0.3, 0.61)])
def test_carom_error_is_first_order(position: tuple[float, float]) -> None:
    # The bounce is taken at the middle of its step: off by at most v dt, however many bounces follow each wall.
    errors = []
    steps = np.array([4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4]) * 1.0137
    for dt in steps:
        worst = 0.0
        for angle in np.linspace(0.2, 1.3, 4):
            velocity = (5 * np.cos(angle), 5 * np.sin(angle))
            scene = scenes.build("carom", dt=dt, position=position, velocity=velocity)
            worst = max(worst, runs.run(scene, runs.eeca(ep.Midstep()), duration=1.0).error)
        errors.append(worst)
    assert runs.slope(steps, np.array(errors)) == pytest.approx(1.0, abs=0.25)
    assert errors[-1] < 0.02


@pytest.mark.parametrize("case", ["i", "ii", "iii"])
@pytest.mark.parametrize("closure", [ep.Midstep(), ep.Dashpot(1e6, 200.0)], ids=["midstep", "dashpot_200"])
def test_pool_break(case: str, closure: ep.Closure) -> None:
    watch = Watch(case)
    result = runs.run(scenes.build("pool_break", case=case), runs.eeca(closure), observe=watch)
    assert result.failed is None
    assert result.energy_drift <= 1e-12
    assert result.momentum_drift <= 1e-12
    assert watch.end is not None
    assert watch.end.energy == pytest.approx(7.5, rel=1e-12)
    assert watch.end.linear_momentum == pytest.approx((0.0, 1.5), abs=1e-12)
    if case == "iii":
        assert watch.asymmetry > 1e-4
    elif isinstance(closure, ep.Dashpot):
        assert watch.asymmetry <= 1e-6


@every_closure
@pytest.mark.parametrize("dt", [2.5e-3, 5e-4])
def test_small_hopper_keeps_energy(closure: ep.Closure, dt: float) -> None:
    scene = scenes.build("hopper", dt=dt, columns=8, layers=5)
    result = runs.run(scene, runs.eeca(closure), duration=0.5)
    assert result.failed is None
    assert result.energy_drift <= 1e-11


def test_full_hopper_crowd_keeps_energy() -> None:
    scene = scenes.build("hopper")
    result = runs.run(scene, runs.eeca(ep.Midstep()), duration=0.4)
    assert result.failed is None
    assert result.energy_drift <= 1e-11


def test_energy_momentum_scheme_keeps_bodies_and_springs_together() -> None:
    K = 1e5
    space, bodies = two_disks()
    stepper = ep.PenaltyEnergyMomentum(space, K)
    start, least = ep.measure(space), np.inf
    for _ in range(100):
        stepper.step(1e-3)
        now = ep.measure(space)
        gap = min((bodies[1].position - bodies[0].position).length - 0.2, 0.0)
        assert now.energy + 0.5 * K * gap**2 == pytest.approx(start.energy, rel=1e-12)
        assert now.angular_momentum == pytest.approx(start.angular_momentum, abs=1e-13)
        least = min(least, now.energy)
    assert least < 0.9 * start.energy  # the dip of Fig. 1
    assert now.energy == pytest.approx(start.energy, rel=1e-12)


def test_newmark_on_a_closed_spring_is_the_linear_rule() -> None:
    # Deep in a wall the spring never opens: the step must be the textbook Newmark step of q'' = -K q.
    K, dt, beta, gamma = 1e4, 0.01, 0.3, 0.6
    scene = scenes.build("signorini", dt=dt, height=-0.05)
    body = scene.bodies[0]
    ep.Newmark(scene.space, K, beta, gamma).step(dt)
    q, v, a = -0.05, -1.0, K * 0.05
    q1 = (q + dt * v + dt**2 * (0.5 - beta) * a) / (1 + beta * dt**2 * K)
    v1 = v + dt * ((1 - gamma) * a - gamma * K * q1)
    assert body.position.y - 0.1 == pytest.approx(q1, abs=1e-14)
    assert body.velocity.y == pytest.approx(v1, rel=1e-12)


def test_newmark_damping_of_fig_15() -> None:
    frequency = np.array([0.0, 1.0, 2.5, 8.0])
    np.testing.assert_allclose(numerical_damping(frequency, 0.25, 0.5), 0.0, atol=1e-12)
    damping = numerical_damping(np.array([1e-3, 1.0, 2.5]), 0.49, 1.0)
    assert damping[0] == pytest.approx(0.25e-3, rel=1e-2)  # (gamma - 1/2) omega dt / 2 for small steps
    assert (np.diff(damping) > 0).all()


@pytest.mark.parametrize("elasticity", [0.0, 0.3, 0.8])
def test_restitution_loses_exactly_its_share(elasticity: float) -> None:
    space, bodies = two_disks(offset=0.0)
    for body in bodies:
        body.velocity = (body.velocity.x, 0.2)
    for shape in space.shapes:
        shape.elasticity = elasticity**0.5
    stepper = ep.EECA(space)
    before = ep.measure(space)
    for _ in range(60):
        stepper.step(2.5e-3)
    reduced_mass = 2.0 / 3.0
    loss = 0.5 * reduced_mass * (1 - elasticity**2) * 3.0**2
    assert ep.measure(space).energy == pytest.approx(before.energy - loss, rel=1e-12)
    assert bodies[1].velocity.x - bodies[0].velocity.x == pytest.approx(3.0 * elasticity, abs=1e-12)


@pytest.mark.parametrize("make", EECAS.values(), ids=EECAS.keys())
def test_ball_resting_on_the_floor_stays(make: Make) -> None:
    space, ball = one_disk(velocity=(0.0, 0.0), gravity=9.81)
    ball.position = (0.0, 0.1)
    stepper = make(space)
    for _ in range(200):
        stepper.step(1 / 60)
    assert abs(ball.velocity.y) <= 1e-3
    assert ball.position.y == pytest.approx(0.1, abs=1e-3)


random_disk = st.tuples(
    st.floats(0.2, 3.0), st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(0.05, 0.19)
)  # mass, velocity, radius


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    st.lists(random_disk, min_size=2, max_size=9),
    st.sampled_from([1e-3, 5e-3, 1 / 60]),
    st.sampled_from([0.0, 9.81]),
    st.sampled_from([ep.Midstep(), ep.Dashpot(1e5, 1.0), ep.Dashpot(1e5, 200.0)]),
    st.floats(0.0, 1.0),
)
def test_random_scenes(disks, dt: float, gravity: float, closure: ep.Closure, elasticity: float) -> None:
    """Elastic: energy is constant; inelastic: it never rises; a report's impulses explain the momentum of walls."""
    space = pymunk.Space()
    space.gravity = (0.0, -gravity)
    for i, (mass, vx, vy, radius) in enumerate(disks):
        add_disk(space, (0.5 + 0.4 * (i % 3), 0.5 + 0.4 * (i // 3)), radius, mass, (vx, vy))
    add_walls(space, [((0, 0), (2, 0)), ((2, 0), (2, 2)), ((2, 2), (0, 2)), ((0, 2), (0, 0))])
    elastic = elasticity > 0.5
    for shape in space.shapes:
        shape.elasticity = 1.0 if elastic else elasticity
    stepper = ep.EECA(space, closure)
    start = now = ep.measure(space)
    scale = start.kinetic + abs(start.potential) + 1e-6
    for _ in range(60):
        before, weight = now, np.array(space.gravity) * sum(b.mass for b in space.bodies)
        report = stepper.step(dt)
        now = ep.measure(space)
        assert np.isfinite(now.energy)
        if elastic:
            assert abs(now.energy - start.energy) <= 1e-12 * scale
        else:
            assert now.energy - before.energy <= 1e-12 * scale
        contacts = report.contacts
        at_wall = np.array([contacts.bodies[b].body_type != pymunk.Body.DYNAMIC for b in contacts.body_b], bool)
        from_walls = -(report.impulse[at_wall, None] * contacts.normal[at_wall]).sum(axis=0)
        expected = before.linear_momentum + dt * weight + from_walls
        np.testing.assert_allclose(now.linear_momentum, expected, atol=1e-10 * (1 + np.abs(expected).max()))


@pytest.mark.parametrize("kind", ["disks", "boxes", "mixed"])
@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("elasticity", [0.0, 0.3, 0.5])
def test_the_ledger_of_a_pile_closes_in_every_step(kind: str, friction: float, elasticity: float) -> None:
    space = pile(kind, 100, elasticity, friction)
    stepper = ep.EECA(space, sync=False)
    scale = sum(b.mass * (0.5 * b.velocity.dot(b.velocity) - space.gravity.dot(b.position)) for b in space.bodies)
    for _ in range(100):
        ledger = stepper.step(1 / 60).ledger
        assert ledger is not None
        assert abs(ledger.residual) <= 1e-13 * abs(scale)
        assert min(ledger.restitution, ledger.friction) >= -1e-13 * abs(scale)
