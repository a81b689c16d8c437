"""`space.damping = 0`: what moves has lost its velocity when the step has ended. Top-down games push things by it."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep
from scenes.scene import add_disk, add_walls

from ..steppers import EECAS, Make

DT = 1 / 60


@pytest.mark.parametrize("make", [ep.Native, *EECAS.values()], ids=["native", *EECAS])
def test_a_velocity_lasts_for_one_step(make: Make) -> None:
    space = pymunk.Space()
    space.damping = 0.0
    body = add_disk(space, (0.0, 0.0), 0.1, velocity=(3.0, -2.0))
    body.angular_velocity = 1.5
    stepper = make(space)
    for _ in range(4):
        stepper.step(DT)
        assert body.velocity == (0.0, 0.0)
        assert body.angular_velocity == 0.0
        assert body.position == pytest.approx((3.0 * DT, -2.0 * DT))
        assert body.angle == pytest.approx(1.5 * DT)
    body.velocity = (0.0, 2.0)
    stepper.step(DT)
    assert body.position == pytest.approx((3.0 * DT, 0.0))


@pytest.mark.parametrize("make", [ep.Native, ep.EECA])
@pytest.mark.parametrize("kind", [pymunk.Body.KINEMATIC, pymunk.Body.DYNAMIC])
def test_a_player_whose_velocity_is_set_each_frame_pushes_a_crate(make: Make, kind: int) -> None:
    space = pymunk.Space()
    space.damping = 0.0
    space.collision_slop = 0.0
    player = pymunk.Body(10.0, math.inf, body_type=kind)
    shape = pymunk.Circle(player, 0.1)
    crate = pymunk.Body(1.0, 1.0)
    crate.position = (1.0, 0.0)
    box = pymunk.Poly.create_box(crate, (0.4, 0.4))
    shape.friction = box.friction = 0.5
    space.add(player, shape, crate, box)
    stepper = make(space)
    for _ in range(120):
        player.velocity = (1.0, 0.0)
        stepper.step(DT)
    # pymunk's dynamic player has velocity 0 when contacts are solved, and sinks into the crate.
    sinks = make is ep.Native and kind == pymunk.Body.DYNAMIC
    assert crate.position.x == pytest.approx(player.position.x + 0.3, abs=0.2 if sinks else 1e-6)
    assert crate.position.x > 1.5
    before = crate.position.x
    for _ in range(10):
        player.velocity = (-1.0, 0.0)
        stepper.step(DT)
    assert crate.position.x == pytest.approx(before, abs=0.1 if sinks else 0.02)


def test_a_bounce_goes_on_to_the_end_of_its_step_and_the_ledger_closes() -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    space.damping = 0.0
    body = add_disk(space, (0.0, 0.2), 0.1, 2.0)
    add_walls(space, [((-1.0, 0.0), (1.0, 0.0))])
    spinning = pymunk.Body(1.0, math.inf)
    spinning.angular_velocity = 1.0
    space.add(spinning)
    stepper = ep.EECA(space)
    body.velocity = (0.0, -20.0)
    ledger = stepper.step(0.01).ledger
    # Free fall to the floor, and up again with what it has: the energy of the start lies in the height and the bounce.
    tau = (-20.0 + math.sqrt(400.0 + 2.0)) / 10.0
    up = 20.0 + 10.0 * tau
    rest = 0.01 - tau
    assert body.position.y == pytest.approx(0.1 + up * rest - 5.0 * rest**2, rel=1e-12)
    assert body.velocity == (0.0, 0.0)
    assert ledger is not None
    assert ledger.damping == pytest.approx((up - 10.0 * rest) ** 2 + 0.5 * 0.1**2, rel=1e-12)
    height = 2.0 * (body.position.y - 0.2) + 1.0 * spinning.position.y
    assert ledger.change == pytest.approx(10.0 * height - 400.0, rel=1e-12)
    assert abs(ledger.residual) < 1e-10


def test_what_post_solve_and_velocity_functions_set_stays() -> None:
    space = pymunk.Space()
    space.damping = 0.0
    a = add_disk(space, (0.0, 0.0), 0.1, velocity=(1.0, 0.0))
    b = add_disk(space, (0.19, 0.0), 0.1)
    own = add_disk(space, (0.0, 9.0), 0.1)
    seen: list[float] = []

    def drive(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        seen.append(damping)
        body.velocity = (4.0, 0.0)

    def kick(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        b.velocity = (0.0, 7.0)

    own.velocity_func = drive
    space.on_collision(post_solve=kick)
    ep.EECA(space).step(DT)
    assert seen == [0.0]
    assert own.velocity == (4.0, 0.0)
    assert a.velocity == (0.0, 0.0)
    assert b.velocity.y == 7.0


def test_infinite_damping_is_refused() -> None:
    """pymunk itself ends the program at what is negative or NaN."""
    space = pymunk.Space()
    space.damping = math.inf
    with pytest.raises(ValueError, match=r"space\.damping = inf"):
        ep.EECA(space)
