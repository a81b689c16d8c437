"""Recording a run, saving and loading it."""

from __future__ import annotations

import math
from dataclasses import fields
from pathlib import Path

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
import scenes

from .steppers import ALL, Make


@pytest.mark.parametrize("make", ALL.values(), ids=ALL.keys())
def test_recording_is_the_run(make: Make, tmp_path: Path) -> None:
    scene = scenes.build("cradle", hypothesis="ii")
    recording = ep.record(make(scene.space), 20 * scene.dt, scene.dt, every=4)
    assert recording.position.shape == (6, 3, 2)
    assert recording.angle.shape == (6, 3)
    np.testing.assert_allclose(recording.time, 4 * scene.dt * np.arange(6))
    np.testing.assert_array_equal(recording.position[-1], [b.position for b in scene.bodies])
    np.testing.assert_array_equal(recording.velocity[-1], [b.velocity for b in scene.bodies])
    assert recording.energy[0] == 0.5
    np.testing.assert_allclose(recording.momentum, np.tile((1.0, 0.0), (6, 1)), atol=1e-14)
    recording.save(tmp_path / "run.npz")
    again = ep.Recording.load(tmp_path / "run.npz")
    np.testing.assert_array_equal(again.velocity, recording.velocity)
    assert again.parameters == recording.parameters
    assert {"pymunk", "numpy", "dt", "stepper"} <= set(again.parameters)


@pytest.mark.parametrize(("duration", "dt", "every"), [(0.0, 0.1, 1), (1.0, 0.0, 1), (1.0, math.nan, 1), (1.0, 0.1, 0)])
def test_bad_arguments(duration: float, dt: float, every: int) -> None:
    scene = scenes.build("carom")
    with pytest.raises(ValueError, match="give"):
        ep.record(ep.EECA(scene.space), duration, dt, every)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"duration": -1.0}, r"duration = -1\.0: give a finite number > 0"),
        ({"duration": math.inf}, "duration = inf"),
        ({"duration": None}, "duration = None: give"),
        ({"dt": -0.1}, r"dt = -0\.1: give"),
        ({"duration": 1e300, "dt": 1e-300}, r"inf steps, give 1e\+15 at most"),
        ({"every": 1.5}, r"every = 1\.5: give a whole number >= 1"),
        ({"every": -1}, "every = -1"),
        ({"memory": 0}, "memory = 0: give"),
        ({"memory": math.nan}, "memory = nan: give"),
        ({"memory": 1e-300}, "memory = 1e-300: give more"),
        ({"memory": 1000.0}, r"give every >= 2, or more"),
    ],
)
def test_bad_arguments_are_named(arguments: dict[str, float], said: str) -> None:
    scene = scenes.build("carom")
    before = [(b.position, b.velocity) for b in scene.bodies]
    given = {"duration": 1.0, "dt": 0.1, **arguments}
    with pytest.raises((ValueError, TypeError), match=said):
        ep.record(ep.EECA(scene.space), **given)  # type: ignore[arg-type]
    assert [(b.position, b.velocity) for b in scene.bodies] == before


def test_measure_counts_rotation_gravity_and_offset_mass() -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    body = pymunk.Body(2.0, 3.0)
    body.center_of_gravity = (0.5, 0.0)
    body.angle, body.position, body.velocity, body.angular_velocity = math.pi / 2, (1.0, 1.0), (3.0, 0.0), 2.0
    space.add(body)
    found = ep.measure(space)
    assert found.kinetic == pytest.approx(0.5 * 2 * 9 + 0.5 * 3 * 4)
    assert found.potential == pytest.approx(2 * 10 * 1.5)
    assert found.linear_momentum == pytest.approx((6.0, 0.0))
    assert found.angular_momentum == pytest.approx(-1.5 * 6 + 3 * 2)


def lossy() -> pymunk.Space:
    """A disk thrown onto a floor that runs like a belt: bounces, friction, external work."""
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    floor = pymunk.Segment(space.static_body, (-50.0, 0.0), (50.0, 0.0), 0.0)
    floor.elasticity, floor.friction, floor.surface_velocity = 0.5, 1.0, (3.0, 0.0)
    body = pymunk.Body(1.0, 0.125)
    body.position = (0.0, 1.5)
    disk = pymunk.Circle(body, 0.5)
    disk.elasticity, disk.friction = 1.0, 0.3
    space.add(floor, body, disk)
    return space


def test_ledger_of_a_recording_is_the_sum_of_the_steps(tmp_path: Path) -> None:
    recording = ep.record(ep.EECA(lossy()), 2.0, 1 / 60, every=3)
    stepper = ep.EECA(lossy())
    ledgers = [stepper.step(1 / 60).ledger for _ in range(120)]
    assert recording.ledger.kept
    for f in fields(ep.Ledger):
        sums = np.cumsum([0.0] + [getattr(one, f.name) for one in ledgers])[::3]
        np.testing.assert_allclose(getattr(recording.ledger, f.name), sums, rtol=0.0, atol=1e-14)
    held = recording.ledger
    np.testing.assert_allclose(held.change, recording.energy - recording.energy[0], rtol=0.0, atol=1e-12)
    given = held.external - held.restitution - held.friction - held.damping
    np.testing.assert_allclose(held.change, given + held.residual, rtol=0.0, atol=1e-13)
    assert held.restitution[-1] > 1.0
    assert held.friction[-1] > 0.1
    assert held.external[-1] != 0.0
    np.testing.assert_allclose(
        recording.kinetic, recording.energy - 10.0 * recording.position[:, 0, 1], rtol=0.0, atol=1e-12
    )
    recording.save(tmp_path / "run.npz")
    again = ep.Recording.load(tmp_path / "run.npz")
    for f in fields(ep.Ledger):
        np.testing.assert_array_equal(getattr(again.ledger, f.name), getattr(held, f.name))
    np.testing.assert_array_equal(again.kinetic, recording.kinetic)


def test_a_stepper_without_ledger_has_none(tmp_path: Path) -> None:
    assert ep.EECA(scenes.build("carom").space, ep.Dashpot(1e6, 1.0)).step(0.01).ledger is None
    recording = ep.record(ep.Native(lossy()), 0.1, 1 / 60)
    assert not recording.ledger.kept
    assert recording.ledger.friction.shape == recording.time.shape
    assert np.isnan(recording.ledger.friction[1:]).all()
    recording.save(tmp_path / "run.npz")
    assert np.isnan(ep.Recording.load(tmp_path / "run.npz").ledger.change[1:]).all()


def test_files_of_older_versions_have_no_ledger(tmp_path: Path) -> None:
    ep.record(ep.EECA(lossy()), 0.1, 1 / 60).save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as data:
        lacking = ("kinetic", "sha256")
        old = {name: data[name] for name in data.files if name not in lacking and not name.startswith("ledger.")}
    np.savez(tmp_path / "old.npz", **old)
    again = ep.Recording.load(tmp_path / "old.npz")
    assert not again.ledger.kept
    assert again.kinetic.shape == again.time.shape
