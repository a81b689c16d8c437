"""The energy of impacts on jointed bodies, whose response to impulses is known with an error."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.records import zeros
from eeca_pymunk.impacts.joint_impact import account_impact
from eeca_pymunk.impacts.simultaneous import Block
from eeca_pymunk.model.contacts import SOLVED, Row
from scenes import build


@pytest.mark.parametrize("error", [-1e-3, 0.0, 1e-3])
@pytest.mark.parametrize("elastic", [False, True])
def test_an_error_of_the_response_is_no_work_from_outside(error: float, elastic: bool) -> None:
    """A body of mass 2 hits a wall at speed 3; joints are to answer by (1 + error) of the velocity."""
    scene = ep.EECA(build("gas", count=2).space).event_loop.scene
    rows, out = zeros(1, Row.TYPE), zeros(1, SOLVED)
    rows[0].a, rows[0].nx, rows[0].elasticity = 1, 1.0, 1.0
    impulse = 2.0 * 3.0 * (2.0 if elastic else 1.0)
    before = np.array([[0.0, 0.0, 0.0], [-3.0, 0.0, 0.0]])[::-1].copy()
    after = before.copy()
    after[0, 0] += (1.0 + error) * impulse / 2.0
    block = Block(before, after, np.array([0.5, 0.0]), np.zeros(2), rows, np.zeros((1, 2)))
    impulses = np.array([[impulse, 0.0]])
    account_impact(scene, block, 1, impulses, before, before, False, 0.0, elastic, out)
    left = 0.5 * 2.0 * after[0, 0] ** 2
    assert scene.PAR.external == 0.0
    assert out[0].restitution == pytest.approx(9.0 - left, abs=1e-12)
    assert out[0].restitution == pytest.approx(0.0, abs=1e-12) if elastic else out[0].restitution > 8.9
    assert impulses[0, 0] / impulse == pytest.approx((after[0, 0] + 3.0) / (1.0 + error) / impulse * 2.0, rel=1e-12)


def door_and_ball(elasticity: float, above: bool) -> tuple[pymunk.Body, pymunk.Body]:
    """A door on a hinge, on the lower bound of its angle, after a ball has met it 1.6 from the hinge with speed 2."""
    space = pymunk.Space()
    door, ball = pymunk.Body(2.0, 0.7), pymunk.Body(0.5, 0.02)
    door.position, ball.position, ball.velocity = (1.0, 0.0), (1.6, 0.35 if above else -0.35), (0, -2 if above else 2)
    leaf, round_ = pymunk.Segment(door, (-1, 0), (1, 0), 0.1), pymunk.Circle(ball, 0.2)
    leaf.elasticity, round_.elasticity = elasticity, 1.0
    space.add(door, ball, leaf, round_, pymunk.PivotJoint(space.static_body, door, (0, 0), (-1, 0)))
    space.add(pymunk.RotaryLimitJoint(space.static_body, door, 0.0, 3.0))
    stepper = ep.EECA(space)
    for _ in range(6):
        stepper.step(1 / 60)
    return door, ball


@pytest.mark.parametrize("elasticity", [0.0, 0.5, 1.0])
def test_a_door_at_its_stop_is_a_wall(elasticity: float) -> None:
    """The limit takes part in the impact: v+ = -e v-, and the door does not move."""
    door, ball = door_and_ball(elasticity, True)
    assert ball.velocity.y == pytest.approx(2.0 * elasticity, abs=1e-12)
    assert abs(door.angular_velocity) < 1e-14


@pytest.mark.parametrize("elasticity", [0.5, 1.0])
def test_a_door_is_hit_away_from_its_stop(elasticity: float) -> None:
    """(1 + e) v = J (1/m + r^2/I), I about the hinge."""
    door, ball = door_and_ball(elasticity, False)
    impulse = (1.0 + elasticity) * 2.0 / (1.0 / 0.5 + 1.6**2 / 2.7)
    assert ball.velocity.y == pytest.approx(2.0 - impulse / 0.5, abs=1e-12)
    assert door.angular_velocity == pytest.approx(1.6 * impulse / 2.7, abs=1e-12)


@pytest.mark.parametrize("turn", [0.3, 0.7, 1.1, 1.9])
def test_a_small_impact_on_what_moves_fast_is_not_round_off(turn: float) -> None:
    """A body closes at 1e-9 of its other speeds: the energy of that is less than the last digit of all."""
    scene = ep.EECA(build("gas", count=2).space).event_loop.scene
    rows, out = zeros(1, Row.TYPE), zeros(1, SOLVED)
    normal, along = np.array([math.cos(turn), math.sin(turn)]), np.array([-math.sin(turn), math.cos(turn)])
    rows[0].a, rows[0].nx, rows[0].ny, rows[0].elasticity = 1, normal[0], normal[1], 1.0
    before, after = np.zeros((2, 3)), np.zeros((2, 3))
    before[0, :2], after[0, :2] = along - 1e-9 * normal, along + 1e-9 * normal
    block = Block(before, after, np.array([0.5, 0.0]), np.array([0.5, 0.0]), rows, np.zeros((1, 2)))
    impulses = np.array([[4e-9, 0.0]])
    account_impact(scene, block, 1, impulses, before, before.copy(), False, 0.0, True, out)
    assert after[0, :2] @ normal == pytest.approx(1e-9, rel=1e-6)
    assert impulses[0, 0] == pytest.approx(4e-9, rel=1e-6)
