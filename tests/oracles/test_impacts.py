"""Impacts with friction and of bodies that turn; invariances of scenes with friction."""

from __future__ import annotations

import math

import numpy as np
import pytest

import eeca_pymunk as ep
from comparisons.hard_cases import Case, invariances, oblique
from comparisons.hard_cases.case import DT, G, go, heavy, matter
from scenes.scene import add_box, add_disk, add_walls

from .audit import Audit
from .running import check, of


@pytest.mark.parametrize("one", of(oblique, invariances), ids=lambda one: one.name)
def test_case(one: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    check(one, monkeypatch)


@pytest.mark.parametrize("e", [0.0, 0.5, 0.8, 0.9])
def test_all_the_energy_of_a_ball_that_comes_to_rest_is_booked(e: float) -> None:
    space = heavy()
    add_walls(space, [((-9.0, 0.0), (9.0, 0.0))])
    ball = add_disk(space, (0.0, 1.5), 0.5)
    matter(space, 0.0, e)
    stepper = Audit(space)
    for _ in range(600):
        stepper.step(DT)
    assert ball.position.y == pytest.approx(0.5, abs=1e-9)
    assert stepper.total["restitution"] == pytest.approx(G, rel=1e-9)
    assert stepper.total["change"] == pytest.approx(-G, rel=1e-9)


@pytest.mark.parametrize(("e", "height"), [(0.5, 1.0), (0.8, 1.0), (0.9, 0.9)])
@pytest.mark.parametrize("dt", [DT, 1 / 240])
def test_path_of_a_ball_that_comes_to_rest(e: float, height: float, dt: float) -> None:
    """h (1 + e²)/(1 - e²): each bounce is e² as high as the last one, until one would be back within the step."""
    space = heavy()
    add_walls(space, [((-9.0, 0.0), (9.0, 0.0))])
    add_disk(space, (0.0, 0.5 + height), 0.5)
    matter(space, 0.0, e)
    stepper, rises = ep.EECA(space), []
    while stepper.time < math.sqrt(2.0 * height / G) * (1.0 + e) / (1.0 - e):
        # (1 + e) u, above what the weight alone makes in a step.
        rises += [0.5 * (e * p / (1.0 + e)) ** 2 / G for p in stepper.step(dt).impulse if p > 1.01 * G * dt]
    assert len(rises) >= 5
    assert rises == pytest.approx([height * e ** (2 * k) for k in range(1, len(rises) + 1)], rel=1e-9)
    # The tail: bounces slower than g dt/2, of which the first rises by g dt²/8 at most.
    left = height * (1.0 + e * e) / (1.0 - e * e) - height - 2.0 * sum(rises)
    assert 0.0 < left <= 0.3 * G * dt * dt / (1.0 - e * e)


@pytest.mark.parametrize("dt", [1 / 480, 1 / 3840])
def test_rate_of_a_rocking_block_falls_to_31_of_34_at_an_impact(dt: float) -> None:
    """Housner: 1 - (3/2) sin² alpha. The second corner of a pair that touches already lands at the middle of its step:
    first order, g dt over the corner's speed."""
    for shift in (0.0, 0.2, 0.4, 0.6, 0.8):
        alpha = math.atan(0.25)
        theta, size = 0.5 * alpha, math.hypot(0.25, 1.0)
        space = heavy()
        add_walls(space, oblique.FLOOR)
        body = add_box(space, (-size * math.sin(alpha - theta), size * math.cos(alpha - theta)), 0.5, 2.0)
        body.angle = -theta
        matter(space, 5.0)
        stepper, start = ep.EECA(space), ep.measure(space).energy - G
        stepper.step(shift * dt)
        while stepper.time < 0.45 or body.angle < 0.0:
            stepper.step(dt)
        go(space, ep.EECA, 3, dt)
        rate = math.sqrt((ep.measure(space).energy - G) / start)
        assert rate == pytest.approx(31.0 / 34.0, abs=4.0 * dt)


@pytest.mark.parametrize(("e", "mu"), [(1.0, 0.1), (0.9, 0.05), (0.8, 0.5)])
@pytest.mark.parametrize("steps", [1, 3, 4000])
def test_bounces_with_spin_in_one_step_and_in_thousands(e: float, mu: float, steps: int) -> None:
    space = heavy()
    add_walls(space, oblique.FLOOR)
    disk = add_disk(space, (0.0, 1.3), 0.5, 1.0, (0.2, 0.0))
    disk.angular_velocity = 10.0
    matter(space, mu, e)
    go(space, ep.EECA, steps, 2.0 / steps)
    assert (disk.position.x, disk.angular_velocity) == pytest.approx(oblique.spinning_bounces(e, mu, 2.0), abs=1e-11)


def test_billiard_break_with_spin_is_the_same_at_any_dt() -> None:
    ends = []
    for dt in (1 / 1000, 1 / 240, 1 / 60, 1 / 5):
        space = invariances.rack(1.0, 0.06)
        go(space, ep.EECA, round(0.2 / dt), dt)
        ends.append(np.array([(*body.position, body.angle) for body in space.bodies]))
    for end in ends[1:]:
        np.testing.assert_allclose(end, ends[0], atol=1e-11)
