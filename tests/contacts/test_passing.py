"""Bodies that slide and roll over the joints of flush shapes: as over one shape."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep

G, DT = 10.0, 1.0 / 60.0
Place = Callable[[float, float], tuple[float, float]]


def turned(angle: float, scale: float = 1.0, x0: float = 0.0, y0: float = 0.0) -> Place:
    """Coordinates along a floor and above it, in space."""
    c, s = math.cos(angle), math.sin(angle)
    return lambda x, y: (x0 + scale * (c * x - s * y), y0 + scale * (s * x + c * y))


def pave(space: pymunk.Space, kind: str, place: Place, scale: float = 1.0) -> list[pymunk.Shape]:
    """A floor of flush pieces, each of length 1, from -6 to 12."""
    found: list[pymunk.Shape] = []
    for k in range(-6, 12):
        if kind == "tiles":
            corners = [(k, -1.0), (k + 1, -1.0), (k + 1, 0.0), (k, 0.0)]
            found.append(pymunk.Poly(space.static_body, [place(x, y) for x, y in corners]))
        else:
            r = 0.1 if kind == "round segments" else 0.0
            ends = place(k, -r), place(k + 1, -r)
            found.append(pymunk.Segment(space.static_body, *ends, r * scale))
    space.add(*found)
    return found


def paved(kind: str, e: float, pull: float = 0.0) -> pymunk.Space:
    """A space with a level floor of pieces of elasticity e, and a horizontal acceleration."""
    space = pymunk.Space()
    space.gravity = pull, -G
    for one in pave(space, kind, turned(0.0)):
        one.elasticity = e
    return space


def mover(space: pymunk.Space, shape: str, size: float, e: float = 0.0) -> pymunk.Body:
    inertia = 0.5 * size * size if shape == "disk" else size * size / 6.0
    body = pymunk.Body(1.0, inertia)
    one = pymunk.Circle(body, size) if shape == "disk" else pymunk.Poly.create_box(body, (2.0 * size, 2.0 * size))
    one.elasticity = e
    space.add(body, one)
    return body


def check_velocities(space: pymunk.Space, bodies: list[pymunk.Body], speed: float, pull: float = 0.0) -> None:
    """Take a second in which these bodies must slide with this speed, to round-off, more by `pull` dt after each
    step."""
    stepper = ep.EECA(space)
    for k in range(60):
        stepper.step(DT)
        for body in bodies:
            assert body.velocity == pytest.approx((speed + pull * (k + 1) * DT, 0.0), abs=1e-9)


STARTS = [1.0 + 0.137 * k for k in range(8)]


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("kind", ["tiles", "segments", "round segments"])
@pytest.mark.parametrize("shape", ["disk", "box"])
@pytest.mark.parametrize("speed", [-5.0, 1.0, 5.0])
def test_what_slides_over_joints_keeps_its_velocity(shape: str, kind: str, e: float, speed: float) -> None:
    for start in STARTS:
        space = paved(kind, e)
        body = mover(space, shape, 0.3, e)
        body.position, body.velocity = (start, 0.3), (speed, 0.0)
        stepper = ep.EECA(space)
        for k in range(int(4.0 / abs(speed) / DT)):
            stepper.step(DT)
            assert body.velocity == pytest.approx((speed, 0.0), abs=1e-9)
            assert body.position == pytest.approx((start + speed * (k + 1) * DT, 0.3), abs=1e-9)


@pytest.mark.parametrize("friction", [0.0, 1.0])
@pytest.mark.parametrize("kind", ["tiles", "segments"])
@pytest.mark.parametrize(("shape", "scale", "x0"), [("disk", 1.0, 0.0), ("box", 1.0, 0.0), ("box", 1000.0, 5e5)])
def test_on_slopes_of_pieces_bodies_accelerate_as_on_planes(
    shape: str, scale: float, x0: float, kind: str, friction: float
) -> None:
    """Down a slope of angle -a: g sin a, 2/3 of it for disks that roll; boxes with friction 1 rest."""
    slope = -0.3
    space = pymunk.Space()
    space.gravity = 0.0, -G * scale
    place = turned(slope, scale, x0)
    for one in pave(space, kind, place, scale):
        one.friction = friction
    body = mover(space, shape, 0.3 * scale)
    next(iter(body.shapes)).friction = friction
    body.position, body.angle = place(0.4, 0.3), slope
    pull = G * scale * math.sin(-slope)
    if friction > 0.0:
        pull *= 2.0 / 3.0 if shape == "disk" else 0.0
    stepper = ep.EECA(space)
    for k in range(100):
        stepper.step(DT)
        speed = pull * (k + 1) * DT
        along = np.array([math.cos(slope), math.sin(slope)])
        assert along @ body.velocity == pytest.approx(speed, abs=1e-9 * G * scale)
        assert along @ body.velocity.perpendicular() == pytest.approx(0.0, abs=1e-9 * G * scale)


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize(("height", "stops"), [(1e-6, False), (1e-3, True)])
def test_ledges_stop_bodies_but_those_that_are_no_deeper_than_intervals_leave(
    height: float, stops: bool, e: float
) -> None:
    space = pymunk.Space()
    space.gravity = 0.0, -G
    low = pymunk.Poly(space.static_body, [(-5.0, -1.0), (1.0, -1.0), (1.0, 0.0), (-5.0, 0.0)])
    high = pymunk.Poly(space.static_body, [(1.0, -1.0), (6.0, -1.0), (6.0, height), (1.0, height)])
    space.add(low, high)
    body = mover(space, "box", 0.25)
    body.position, body.velocity = (0.0, 0.25), (2.0, 0.0)
    for one in space.shapes:
        one.elasticity = e
    stepper = ep.EECA(space)
    for _ in range(60):
        report = stepper.step(DT)
        assert report.ledger is not None
        assert abs(report.ledger.residual) < 1e-12
    if stops:
        assert body.velocity.x < 1.0
    else:
        assert body.velocity == pytest.approx((2.0, 0.0), abs=1e-6)


@pytest.mark.parametrize("shape", ["disk", "box"])
def test_free_bodies_that_are_passed_keep_momenta(shape: str) -> None:
    """Two flush planks in free space over which a third body slides, pressed on them by a small velocity."""
    space = pymunk.Space()
    bodies = []
    for x in (-2.0, 2.0):
        plank = pymunk.Body(5.0, 8.0)
        plank.position = x, -0.25
        space.add(plank, pymunk.Poly.create_box(plank, (4.0, 0.5)))
        bodies.append(plank)
    body = mover(space, shape, 0.3)
    body.position, body.velocity = (-1.0, 0.3), (4.0, -1e-5)
    bodies.append(body)
    stepper = ep.EECA(space)

    def momenta() -> list[float]:
        px = sum(b.mass * b.velocity.x for b in bodies)
        py = sum(b.mass * b.velocity.y for b in bodies)
        spin = sum(b.mass * b.position.cross(b.velocity) + b.moment * b.angular_velocity for b in bodies)
        return [px, py, spin]

    before = momenta()
    for _ in range(30):
        stepper.step(DT)
    assert momenta() == pytest.approx(before, abs=1e-13)
    assert body.velocity.x == pytest.approx(4.0, abs=2e-5)


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("kind", ["tiles", "segments"])
@pytest.mark.parametrize(("pull", "speed"), [(3.0, 0.0), (0.0, 1e-4), (0.0, 0.01)])
def test_a_crate_that_stands_on_a_grid_is_pushed(kind: str, e: float, pull: float, speed: float) -> None:
    """Its sides are where two pieces of the floor meet."""
    space = paved(kind, e, pull)
    body = mover(space, "box", 0.5, e)
    body.position, body.velocity = (2.5, 0.5), (speed, 0.0)
    check_velocities(space, [body], speed, pull)


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("upright", [True, False])
def test_capsules_slide_over_segments(e: float, upright: bool) -> None:
    """Thin shapes on thin shapes: a character that cannot turn, and a lying rod."""
    for start in STARTS:
        space = paved("segments", e)
        body = pymunk.Body(1.0, math.inf if upright else 0.05)
        end = (0.0, 0.5) if upright else (0.3, 0.0)
        rod = pymunk.Segment(body, (0.0 if upright else -0.3, 0.0), end, 0.1)
        rod.elasticity = e
        body.position, body.velocity = (start, 0.1), (3.0, 0.0)
        space.add(body, rod)
        check_velocities(space, [body], 3.0)


def test_what_lies_beside_a_wall_does_not_pass_it() -> None:
    """A crate that is pushed along tiles into a wall of tiles that stands on them."""
    space = paved("tiles", 0.0, 3.0)
    for y in range(3):
        space.add(pymunk.Poly(space.static_body, [(5.0, y), (6.0, y), (6.0, y + 1.0), (5.0, y + 1.0)]))
    body = mover(space, "box", 0.5)
    body.position = 2.5, 0.5
    stepper = ep.EECA(space)
    for _ in range(300):
        stepper.step(DT)
    assert body.position == pytest.approx((4.5, 0.5), abs=1e-6)
    assert body.velocity == pytest.approx((0.0, 0.0), abs=1e-6)


@pytest.mark.parametrize("apart", [0.0, 1e-6, 5e-5, 1e-3])
@pytest.mark.parametrize("e", [0.0, 0.5])
def test_rows_of_crates_on_a_grid_are_pushed(apart: float, e: float) -> None:
    """The corners of two crates and two tiles meet in one point."""
    space = paved("tiles", e, 3.0)
    crates = [mover(space, "box", 0.5, e) for _ in range(3)]
    for k, crate in enumerate(crates):
        crate.position = 0.5 + k * (1.0 + apart), 0.5
    check_velocities(space, crates, 0.0, 3.0)


@pytest.mark.parametrize("degrees", [20, 45, 60, 70, 80])
@pytest.mark.parametrize("e", [0.0, 0.5])
@pytest.mark.parametrize("kind", ["tiles", "segments"])
def test_bevelled_crates_slide_over_joints(kind: str, e: float, degrees: float) -> None:
    for start in STARTS:
        space = paved(kind, e)
        body, bevel = pymunk.Body(1.0, 0.1), 0.1
        up = bevel * math.tan(math.radians(degrees))
        corners = [(0.3, 0.3), (-0.3, 0.3), (-0.3, up - 0.3), (bevel - 0.3, -0.3), (0.3 - bevel, -0.3), (0.3, up - 0.3)]
        crate = pymunk.Poly(body, corners)
        crate.elasticity = e
        body.center_of_gravity = 0.0, -0.1
        body.position, body.velocity = (start, 0.3), (3.0, 0.0)
        space.add(body, crate)
        check_velocities(space, [body], 3.0)
