"""Lander and walker: a reset repeats the path, no joint comes apart, energy stays within what the motors put in."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
import scenes
from comparisons.robots import again, episode, gaps

# Seconds after which the lander stands still; the walker does not stop.
LANDED = 8.0


@pytest.mark.parametrize("name", ["lander", "walker"])
def test_reset_repeats_the_path_bit_by_bit(name: str) -> None:
    scene = scenes.build(name)
    stepper = ep.EECA(scene.space)
    runs = []
    for _ in range(2):
        runs.append(episode(scene, stepper, 200))
        again(scene, stepper)
    assert np.array_equal(runs[0].path, runs[1].path)
    assert np.ptp(runs[0].path[:, 0, 0]) > 0.1  # it moves


@pytest.mark.parametrize("dt", [1 / 50, 1 / 200])
@pytest.mark.parametrize("name", ["lander", "walker"])
def test_joints_hold_and_energy_is_within_what_motors_put_in(name: str, dt: float) -> None:
    """Each step: E <= E(0) + W, W of the lander its thrust times the way, of the walker its motors' largest torques
    times the angles that they turned. No loss of the ledger is negative, and what it says is the change of energy."""
    scene = scenes.build(name, dt=dt)
    stepper = ep.EECA(scene.space)
    start = before = ep.measure(scene.space).energy
    scale = abs(start)
    assert scene.driver is not None
    for _ in range(round(4.0 / dt)):
        ledger = stepper.step(dt).ledger
        energy = ep.measure(scene.space).energy
        assert gaps(scene.space) < 1e-12
        assert energy <= start + scene.driver.work() + 1e-9 * scale
        assert min(ledger.restitution, ledger.friction, ledger.damping) >= -1e-12 * scale
        assert abs(ledger.residual) <= 1e-12 * scale
        if name == "walker":  # the lander's springs have energy that `measure` does not count
            gain = ledger.external - ledger.restitution - ledger.friction - ledger.damping
            assert energy - before == pytest.approx(gain, abs=1e-11 * scale)
        before = energy


def test_the_ledger_of_the_lander_knows_the_work_of_its_engines() -> None:
    """The pilot's forces are constant within a step: their work is force times way, which no ledger has to be asked.
    In the steps in which the feet meet the ground, places within the step are known to its order alone."""
    scene = scenes.build("lander")
    stepper = ep.EECA(scene.space)
    booked = 0.0
    for _ in range(round(LANDED / scene.dt)):
        booked += stepper.step(scene.dt).ledger.external
    assert scene.driver is not None
    assert abs(scene.driver.work()) > 100.0
    assert booked == pytest.approx(scene.driver.work(), rel=1e-9)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_lander_comes_to_rest_upright_on_its_legs(seed: int) -> None:
    """At rest the ground carries the weight: two feet on the pad, impulses of m g dt upward."""
    scene = scenes.build("lander", seed=seed)
    stepper = ep.EECA(scene.space)
    for _ in range(round(LANDED / scene.dt)):
        report = stepper.step(scene.dt)
    hull = scene.bodies[0]
    assert abs(hull.position.x) < 1.0
    assert abs(hull.angle) < 0.05
    assert hull.velocity.length < 1e-3
    weight = sum(body.mass for body in scene.bodies) * 3.0
    up = float(np.abs(report.impulse * report.contacts.normal[:, 1]).sum())
    assert up == pytest.approx(weight * scene.dt, rel=1e-3)


def test_the_walker_walks_as_far_as_with_finer_steps() -> None:
    """Two solvers that share nothing agree where both are fine: .5 m in 4 s. Which foot grips when it lands depends on
    round-off, and moves the end of a walk by a tenth from dt to dt with both: means over dt count. pymunk's, at
    1/50 s, goes backwards."""

    def far(make: type[ep.Stepper], dt: float, iterations: int = 10) -> float:
        scene = scenes.build("walker", dt=dt)
        scene.space.iterations = iterations
        stepper = make(scene.space)
        for _ in range(round(4.0 / dt)):
            stepper.step(dt)
        assert abs(scene.bodies[0].angle) < 0.3
        return float(scene.bodies[0].position.x)

    rates = (250, 300, 400, 600, 800)
    fine = np.mean([far(ep.Native, 1 / rate, 200) for rate in rates])
    assert np.mean([far(ep.EECA, 1 / rate) for rate in rates]) == pytest.approx(fine, abs=0.05)
    native = far(ep.Native, 1 / 50)
    assert native < 0.0
    assert far(ep.EECA, 1 / 50) == pytest.approx(fine, abs=0.2 * abs(native - fine))


def test_motors_never_exceed_their_torque() -> None:
    scene = scenes.build("walker")
    stepper = ep.EECA(scene.space)
    motors = [c for c in scene.space.constraints if isinstance(c, pymunk.SimpleMotor)]
    assert len(motors) == 4
    for _ in range(100):
        stepper.step(scene.dt)
        assert all(abs(m.impulse) <= m.max_force * scene.dt * (1.0 + 1e-9) for m in motors)
    assert math.isfinite(scene.bodies[0].position.x)
