"""Friction of one body on planes and on floors that move; friction as pymunk's callbacks and options set it."""

from __future__ import annotations

import math
from collections.abc import Callable

import pymunk
import pytest

import eeca_pymunk as ep
from comparisons.hard_cases import Case, friction, moving
from comparisons.hard_cases.case import DT, G, heavy, matter
from scenes.scene import add_box, add_walls

from .audit import Audit
from .running import check, of

SLOPE, MU = math.radians(30.0), 0.3


@pytest.mark.parametrize("one", of(friction, moving), ids=lambda one: one.name)
def test_case(one: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    check(one, monkeypatch)


def slope(mu: float = MU) -> friction.Plane:
    return friction.on_plane(SLOPE, mu, "box")


def slid(mu: float) -> float:
    """Way down in a second."""
    return 0.5 * G * (math.sin(SLOPE) - mu * math.cos(SLOPE))


@pytest.mark.parametrize(("mu", "tan"), [(0.3, 0.4), (0.45, 0.6), (0.6, 0.55), (0.6, 0.45)])
def test_a_block_slides_or_tips_whichever_is_first(mu: float, tan: float) -> None:
    """It slides iff tan > mu, and tips iff tan > width/height = .5: of both, what friction lets it."""
    space = heavy(slope=math.atan(tan))
    add_walls(space, friction.FLOOR)
    body = add_box(space, (0.0, 0.5), 0.5, 1.0)
    matter(space, mu)
    friction.go(space, ep.EECA, 60)
    if tan < min(mu, 0.5):
        assert tuple(body.position) == pytest.approx((0.0, 0.5), abs=1e-9)
    elif mu < 0.5:
        way = 0.5 * G * (tan - mu) / math.hypot(1.0, tan)
        assert tuple(body.position) == pytest.approx((way, 0.5), rel=1e-9)
        assert body.angle == pytest.approx(0.0, abs=1e-9)
    else:
        assert body.angle < -0.1
        assert body.position.x > 0.05


@pytest.mark.parametrize("beyond", [-1e-6, 0.0, 1e-6])
def test_the_angle_of_friction_is_told_to_a_part_in_a_million(beyond: float) -> None:
    """SCISim: at tan slope = mu = .3 itself it must stay."""
    slope = math.atan(0.3) * (1.0 + beyond)
    body = friction.after(friction.on_plane(slope, 0.3, "box"), ep.EECA, 10.0)
    way = 0.5 * G * (math.sin(slope) - 0.3 * math.cos(slope)) * 100.0 if beyond > 0.0 else 0.0
    assert body.position.x == pytest.approx(way, abs=1e-9)


def test_pre_solve_sets_friction() -> None:
    """arbiter.friction = 0 on a rough slope: smooth; and 0.5 for the shapes' .3."""
    for mu in (0.0, 0.5):
        space, body = slope()
        for shape in space.shapes:
            shape.collision_type = 1

        def pre_solve(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object, mu: float = mu) -> None:
            arbiter.friction = mu

        space.on_collision(1, 1, pre_solve=pre_solve)
        stepper = ep.EECA(space)
        for _ in range(60):
            stepper.step(DT)
        assert body.position.x == pytest.approx(slid(mu), rel=1e-9)


@pytest.mark.parametrize("fall", [-3.0, 0.0], ids=["hit", "rest"])
@pytest.mark.parametrize("make", [friction.add_disk, lambda space, at, r, m, v: add_box(space, at, 2 * r, 2 * r, m, v)])
def test_what_pre_solve_sets_is_what_shapes_could_have_had(make: Callable[..., pymunk.Body], fall: float) -> None:
    """Elasticity, friction and surface velocity, of an impact at its instant and of a contact that lasts."""
    ends, read = [], pymunk.Vec2d(0.0, 0.0)
    for told in (False, True):
        space = heavy()
        add_walls(space, friction.FLOOR)
        floor = next(iter(space.shapes))
        body = make(space, (0.0, 0.5 - 0.1 * fall), 0.5, 2.0, (1.0, fall))
        matter(space, 0.9, 0.9)

        def set_all(arbiter: pymunk.Arbiter, *_: object, v: pymunk.Vec2d = read) -> None:
            arbiter.restitution, arbiter.friction, arbiter.surface_velocity = 0.4, 0.3, v

        def note(arbiter: pymunk.Arbiter, *_: object) -> None:
            nonlocal read
            read = arbiter.surface_velocity

        if not told:
            matter(space, 0.3, 0.4)
            floor.surface_velocity = (-2.5, 0.0)
        space.on_collision(pre_solve=set_all if told else note)
        stepper = Audit(space)
        for _ in range(30):
            stepper.step(DT)
        assert stepper.residual <= 1e-12
        assert stepper.total["external"] > 1.0
        ends.append((*body.position, *body.velocity, body.angular_velocity))
    assert abs(read.x) == 2.5
    assert ends[1] == pytest.approx(ends[0], rel=1e-12, abs=1e-12)


def test_friction_can_be_ignored() -> None:
    space, body = slope()
    with pytest.warns(UserWarning, match="without the friction"):
        stepper = ep.EECA(space, ignore=("friction",))
    for _ in range(60):
        stepper.step(DT)
    assert body.position.x == pytest.approx(slid(0.0), rel=1e-12)


def test_pair_has_the_product_of_both_frictions() -> None:
    space, body = slope()
    for shape, mu in zip(space.shapes, (0.5, 0.6), strict=True):
        shape.friction = mu
    stepper = ep.EECA(space)
    for _ in range(60):
        stepper.step(DT)
    assert body.position.x == pytest.approx(slid(0.3), rel=1e-12)


@pytest.mark.parametrize("speed", [1.5, -0.7])
def test_belt_moves_things_as_native_does(speed: float) -> None:
    """Surface velocity of the floor, then of the box: the same sense as pymunk's own step."""
    for of_box in (False, True):
        ways = []
        for make in (ep.EECA, ep.Native):
            space = heavy()
            add_walls(space, [((-50.0, 0.0), (50.0, 0.0))])
            floor = next(iter(space.shapes))
            body = add_box(space, (0.0, 0.5), 1.0, 1.0)
            matter(space, 0.5)
            (next(iter(body.shapes)) if of_box else floor).surface_velocity = (speed, 0.0)
            stepper = make(space)
            for _ in range(60):
                stepper.step(DT)
            ways.append(body.velocity.x)
        assert abs(ways[0]) == pytest.approx(abs(speed), rel=1e-9)
        assert ways[0] == pytest.approx(ways[1], rel=1e-2)


def test_belt_works() -> None:
    """External work m V^2, half of it friction's heat: V times the momentum that the block gets."""
    space, _ = moving.belt(1.5, 0.25)
    stepper = Audit(space)
    for _ in range(90):
        stepper.step(DT)
    assert stepper.total["external"] == pytest.approx(1.5**2, rel=1e-12)
    assert stepper.total["friction"] == pytest.approx(0.5 * 1.5**2, rel=1e-12)


def test_turning_shapes_carry_no_loss_when_rolling() -> None:
    space, body = friction.on_plane(SLOPE, 0.3, "disk")
    stepper = Audit(space)
    for _ in range(60):
        stepper.step(DT)
    assert abs(body.angular_velocity) > 1.0
    assert max(abs(stepper.total["friction"]), abs(stepper.total["restitution"])) <= 1e-12 * G
