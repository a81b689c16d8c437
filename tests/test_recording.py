"""Recording a run, saving and loading it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
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


def test_measure_counts_rotation_gravity_and_offset_mass() -> None:
    import pymunk

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
