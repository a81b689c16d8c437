"""The penetration correction is paid from the losses of contacts before it is work of what moves by itself."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.kernels import prepare

DT = 1 / 240
THROWS = 10 if not prepare().entries else 60  # kernels as plain Python


@pytest.mark.parametrize("unit", [1e-3, 1.0])
def test_a_plate_that_moves_does_no_more_than_its_impulses(unit: float) -> None:
    """Triangles that spin fall on a plate that creeps, and turn into it within an interval, as its rows are linear.
    What lifts them has been lost before. |J| |v| bounds the work of a plate that was in nobody at the start."""
    for throw in range(THROWS):
        rng = np.random.default_rng(throw)
        space = pymunk.Space()
        space.gravity = 0.0, -1e4 * unit  # 0.17 of the size in a step
        plate = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        plate.velocity = tuple(unit * rng.uniform(-1.0, 1.0, 2))
        wall = pymunk.Segment(plate, (-20.0 * unit, 0.0), (20.0 * unit, 0.0), 0.1 * unit)
        space.add(plate, wall)
        corners = [(0.55 * unit * math.cos(x), 0.55 * unit * math.sin(x)) for x in (0.0, 2.1, 4.2)]
        for k in range(2):
            body = pymunk.Body(1.0, 0.12 * unit**2)
            body.position, body.angle = (unit * rng.uniform(-0.2, 0.2), unit * (0.9 + 1.1 * k)), rng.uniform(-3.0, 3.0)
            body.velocity = unit * rng.uniform(-100.0, 100.0), unit * rng.uniform(-100.0, 0.0)
            body.angular_velocity = rng.uniform(-300.0, 300.0)
            space.add(body, pymunk.Poly(body, corners))
        for shape in space.shapes:
            shape.elasticity = 0.5
        stepper, overlap = ep.EECA(space), 0.0
        for _ in range(12):
            report = stepper.step(DT)
            assert report.ledger is not None
            most = np.abs(report.impulse).sum() * plate.velocity.length
            most += overlap * 2.0 * -space.gravity[1]  # what is deep already may be lifted
            assert report.ledger.external <= most * (1.0 + 1e-9)
            assert report.ledger.restitution >= -1e-7 * unit**2  # 1e-11 of the energy at the start
            overlap = max(0.0, -report.contacts.gap.min(initial=0.0))


Thrown = tuple[
    float, float, float, tuple[float, float], float, tuple[float, float]
]  # radius (0: brick), mass, moment, ...
AT_ROD: list[Thrown] = [
    (0.3, 3.2003714021509815, 0.14401671309679417, (2.2, 4.8), 1.1260643279593605,
     (301.1541302314233, -162.3560362279032)),
    (0.3, 2.0927832361025485, 0.09417524562461468, (2.2, 6.0), 1.8411445711282393,
     (322.81506573360696, 131.9045460456527)),
    (0.0, 30.038987442679808, 2.5032489535566507, (2.2, 7.199999999999999), 1.1429064436356497,
     (436.0122858199279, -148.58163926219507)),
]  # fmt: skip
AT_PLANK: list[Thrown] = [
    (0.3, 7.497266607722142, 0.3373769773474964, (2.2, 4.8), 0.05457646286932949,
     (468.7216646001452, -11.213659205824143)),
    (0.0, 49.66127147229267, 4.138439289357722, (2.2, 6.0), 1.850470760549258, (470.0411600334281, 18.518751550329682)),
]  # fmt: skip


@pytest.mark.parametrize(("width", "moment", "angle", "thrown"), [
    (0.0, 0.0675, 1.5588141026068278, AT_ROD), (0.01, 0.06750833333333334, 1.573073039648753, AT_PLANK),
])  # fmt: skip
def test_what_is_pressed_on_a_wall_is_not_lifted_through_it(
    width: float, moment: float, angle: float, thrown: list[Thrown]
) -> None:
    """Bodies thrown at 300 to 500 m/s come to overlap a rod or plank, which is near a wall, but does not touch it in
    the last interval of a step. Its correction, by up to a quarter of the smallest body, led its end through it, and it
    then lay on the other side for a second."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    for a, b in itertools.pairwise(((-4, 0), (4, 0), (4, 12), (-4, 12), (-4, 0))):
        space.add(pymunk.Segment(space.static_body, a, b, 0.0))
    rod = pymunk.Body(1.0, moment)
    rod.position, rod.angle, half = (3.95, 6.0), angle, 0.5 * width
    corners = [(0.45, -half), (0.45, half), (-0.45, half), (-0.45, -half)]
    space.add(rod, pymunk.Poly(rod, corners) if width > 0.0 else pymunk.Segment(rod, (-0.45, 0.0), (0.45, 0.0), 0.0))
    for radius, mass, inertia, place, turned, velocity in thrown:
        body = pymunk.Body(mass, inertia)
        body.position, body.angle, body.velocity = place, turned, velocity
        brick = pymunk.Poly(body, [(0.4, -0.3), (0.4, 0.3), (-0.4, 0.3), (-0.4, -0.3)])
        space.add(body, pymunk.Circle(body, radius) if radius > 0.0 else brick)
    for shape in space.shapes:
        shape.friction = 0.5
    stepper = ep.EECA(space)
    for _ in range(30):
        stepper.step(DT)
        assert rod.position.x <= 4.0 - half + 1e-3


def test_a_plank_between_a_wall_and_what_is_heavy_is_not_turned_through_the_wall() -> None:
    """As above, but the plank touches the wall with one corner, and the correction leads another one through it: half
    of the plank's width was outside for a step."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    for a, b in itertools.pairwise(((-4, 0), (4, 0), (4, 12), (-4, 12), (-4, 0))):
        space.add(pymunk.Segment(space.static_body, a, b, 0.0))

    def thrown(
        moment: float, place: tuple[float, float], angle: float, velocity: tuple[float, float], spin: float,
        mass: float, corners: list[tuple[float, float]], elasticity: float,
    ) -> pymunk.Body:  # fmt: skip
        body = pymunk.Body(mass, moment)
        body.position, body.angle, body.velocity, body.angular_velocity = place, angle, velocity, spin
        shape = pymunk.Poly(body, corners)
        shape.elasticity = elasticity
        space.add(body, shape)
        return body

    def ring(count: int, radius: float) -> list[tuple[float, float]]:
        turns = (2.0 * math.pi * k / count for k in range(count))
        return [(radius * math.cos(turn), radius * math.sin(turn)) for turn in turns]

    plank = thrown(
        0.06770833333333333, (3.9, 6.0), 1.5914947409862747, (5.0, 25.32971711245618), 0.0, 1.0,
        [(0.45, -0.025), (0.45, 0.025), (-0.45, 0.025), (-0.45, -0.025)], 0.0,
    )  # fmt: skip
    thrown(
        3.2078393094077975, (2.2, 4.5), 3.665542529631307, (170.71839278812092, 116.75708062473598), 6.61299085435552,
        51.325428950524774, ring(3, 0.5), 0.0,
    )  # fmt: skip
    thrown(
        8.735750091292918, (2.2, 5.9), 1.3754001009000274, (476.71074762580037, 173.31583362993632),
        -2.0312387513695853, 93.57660191827904, ring(9, 0.45), 0.5,
    )  # fmt: skip
    for shape in space.shapes:
        shape.friction = 0.5
    stepper = ep.EECA(space)
    for _ in range(10):
        stepper.step(DT)
        assert plank.position.x <= 4.0 - 0.02
