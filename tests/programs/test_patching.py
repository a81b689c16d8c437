"""Edits in place that are patched into the rows: paths are those of a stepper that reads the whole space anew."""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random

import pymunk
import pytest

import eeca_pymunk as ep

from ..steppers import state

DT = 1 / 60


class Rereading(ep.EECA):
    """Reads the whole space anew after every edit."""

    def patch(self, world: object, moved: bool) -> bool:
        return False


def scene(seed: int, count: int, walls: int) -> pymunk.Space:
    """Disks, boxes, bodies of two shapes and a kinematic bar that fall on walls, some of static bodies of their own."""
    random, space = Random(seed), pymunk.Space()
    space.gravity, space.damping = (0.0, -10.0), 1.0 if seed % 2 else 0.9
    width = 0.6 * math.sqrt(count)
    for a, b in (((-width, 0), (width, 0)), ((-width, 0), (-width, 9)), ((width, 0), (width, 9))):
        space.add(pymunk.Segment(space.static_body, a, b, 0.1))
    for _ in range(walls):
        wall = pymunk.Body(body_type=pymunk.Body.STATIC)
        wall.position, wall.angle = (random.uniform(-width, width), random.uniform(0.5, 2.0)), random.uniform(0, 3)
        shapes: list[pymunk.Shape] = [
            pymunk.Poly.create_box(wall, (0.3, 0.2)),
            pymunk.Segment(wall, (0, 0), (0.3, 0), 0.05),
        ]
        space.add(wall, *shapes[: random.randint(1, 2)])
    for k in range(count):
        body = pymunk.Body(1.0, 0.05, pymunk.Body.KINEMATIC if k == 1 else pymunk.Body.DYNAMIC)
        body.position = (random.uniform(-width + 0.3, width - 0.3), 1.0 + 0.4 * k)
        body.angle, body.velocity = random.uniform(0, 3), (random.uniform(-1, 1), 0.0)
        space.add(body, pymunk.Circle(body, 0.2) if k % 2 else pymunk.Poly.create_box(body, (0.4, 0.3)))
        if k % 5 == 4:
            space.add(pymunk.Circle(body, 0.1, (0.25, 0.0)))
    for shape in space.shapes:
        shape.friction, shape.elasticity = random.choice((0.0, 0.5)), random.choice((0.2, 0.8))
    return space


def put(body: pymunk.Body, random: Random) -> None:
    body.position = (body.position.x + random.uniform(-0.2, 0.2), body.position.y + random.uniform(-0.1, 0.1))
    body.angle += random.uniform(-0.5, 0.5)


Edit = Callable[[pymunk.Space, Random], object]


def one(space: pymunk.Space, random: Random) -> pymunk.Shape:
    return random.choice(list(space.shapes))


def mover(space: pymunk.Space, random: Random) -> pymunk.Body:
    return random.choice([b for b in space.bodies if b.body_type == pymunk.Body.DYNAMIC])


def still(space: pymunk.Space, random: Random) -> pymunk.Body:
    return random.choice([b for b in space.bodies if b.body_type == pymunk.Body.STATIC])


def ball(space: pymunk.Space, random: Random) -> None:
    body = pymunk.Body(1.0, 0.02)
    body.position = (random.uniform(-0.5, 0.5), 8.0)
    space.add(body, pymunk.Circle(body, 0.15))


EDITS: dict[str, Edit] = {
    "friction": lambda s, r: setattr(one(s, r), "friction", r.uniform(0, 1)),
    "elasticity": lambda s, r: setattr(one(s, r), "elasticity", r.uniform(0, 0.9)),
    "surface": lambda s, r: setattr(one(s, r), "surface_velocity", (r.uniform(-1, 1), 0.0)),
    "filter": lambda s, r: setattr(one(s, r), "filter", pymunk.ShapeFilter(group=r.randint(0, 2))),
    "mass": lambda s, r: setattr(mover(s, r), "mass", r.uniform(0.5, 2)),
    "moment": lambda s, r: setattr(mover(s, r), "moment", r.choice((0.02, 0.1, math.inf))),
    "static": lambda s, r: put(still(s, r), r),
    "velocity": lambda s, r: setattr(mover(s, r), "velocity", (r.uniform(-2, 2), r.uniform(-2, 2))),
    "gravity": lambda s, r: setattr(s, "gravity", (r.uniform(-1, 1), -10.0)),
    "radius": lambda s, r: next(x for x in s.shapes if isinstance(x, pymunk.Circle)).unsafe_set_radius(
        r.uniform(0.1, 0.2)
    ),
    "ball": ball,
}
# Edits after which results of earlier steps are forgotten, as by a new reading; and those after which they are kept.
PATCHED = ("filter", "static", "radius", "gravity", "velocity")
KEPT = ("friction", "elasticity", "surface", "mass", "moment")


def played(
    make: type[ep.EECA], seed: int, count: int, names: tuple[str, ...], handler: bool
) -> tuple[list[object], int]:
    """Every state on the way of a random program of edits, and how often the whole space was read."""
    space, random = scene(seed, count, 4 if seed % 3 else 20), Random(seed)
    if handler:
        space.on_collision(0, 0, pre_solve=lambda arbiter, space, data: setattr(arbiter, "friction", 0.3))
    stepper, path = make(space), list[object]()
    for _ in range(40):
        for _ in range(random.choice((0, 0, 1, 1, 3))):
            EDITS[random.choice(names)](space, random)
        report = stepper.step(DT)
        path.append((state(space), report.impulse.tobytes(), report.converged))
    return path, stepper.reads


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("count", [3, 12, 30])
def test_patches_lead_where_new_readings_do(seed: int, count: int) -> None:
    patched, few = played(ep.EECA, seed, count, PATCHED, False)
    anew, many = played(Rereading, seed, count, PATCHED, False)
    assert patched == anew
    assert few <= 3 < many


@pytest.mark.parametrize("seed", range(12))
def test_patches_among_other_edits(seed: int) -> None:
    names = (*PATCHED, "ball")
    assert played(ep.EECA, seed, 8, names, False)[0] == played(Rereading, seed, 8, names, False)[0]


@pytest.mark.parametrize("seed", range(6))
def test_patches_where_handlers_decide(seed: int) -> None:
    assert played(ep.EECA, seed, 8, PATCHED, True)[0] == played(Rereading, seed, 8, PATCHED, True)[0]


@pytest.mark.parametrize("seed", range(6))
def test_corners_of_moved_walls_are_those_of_a_new_reading(seed: int) -> None:
    """Static segments of one body each, put end to end and apart again, under capsules that slide over their joints."""

    def path(make: type[ep.EECA]) -> list[object]:
        random, space = Random(seed), pymunk.Space()
        space.gravity = (0.0, -10.0)
        walls = []
        for k in range(4):
            wall = pymunk.Body(body_type=pymunk.Body.STATIC)
            wall.position = (float(k), 0.0)
            space.add(wall, pymunk.Segment(wall, (0, 0), (1, 0), 0.0))
            walls.append(wall)
        for k in range(3):
            body = pymunk.Body(1.0, 0.05)
            body.position, body.velocity = (0.4 + k, 0.3 + 0.2 * k), (1.0, 0.0)
            space.add(body, pymunk.Segment(body, (-0.2, 0), (0.2, 0), 0.02))
        stepper, found = make(space), list[object]()
        for k in range(60):
            if k % 3 == 2:
                moved = random.choice(walls)
                moved.position = (moved.position.x, random.choice((0.0, -0.05)))
            report = stepper.step(DT)
            loop = stepper.event_loop
            assert loop is not None
            found.append((state(space), report.impulse.tobytes(), loop.scene.CORNER.tobytes()))
        return found

    assert path(ep.EECA) == path(Rereading)
