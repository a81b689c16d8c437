"""Spaces that public programs make of pymunk, and what these do before each step: for `programs`."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import NamedTuple

import pymunk
from pymunk import Vec2d

import scenes


class Program(NamedTuple):
    """A space, its dt, and what the program does before step k."""

    space: pymunk.Space
    dt: float
    before: Callable[[int], object]


def _nothing(k: int) -> None:
    pass


def _walls(space: pymunk.Space, width: float, height: float, radius: float) -> None:
    corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
    for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
        wall = pymunk.Segment(space.static_body, a, b, radius)
        wall.friction = 1.0
        space.add(wall)


def push_t() -> Program:
    """gym-pusht: a kinematic tip that a PD law drives through a T of two boxes; damping 0; contacts are counted."""
    space, dt = pymunk.Space(), 0.01
    space.damping = 0.0
    _walls(space, 512.0, 512.0, 2.0)
    tip = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    tip.position = (320.0, 60.0)
    boxes = [[(-60, 30), (60, 30), (60, 0), (-60, 0)], [(-15, 30), (-15, 120), (15, 120), (15, 30)]]
    tee = pymunk.Body(1.0, sum(pymunk.moment_for_poly(1.0, box) for box in boxes))
    parts = [pymunk.Poly(tee, box) for box in boxes]
    tee.center_of_gravity = (parts[0].center_of_gravity + parts[1].center_of_gravity) / 2
    tee.position = (290.0, 200.0)
    tee.friction = 1.0
    space.add(tip, pymunk.Circle(tip, 15.0), tee, *parts)
    counted = [0]

    def count(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        counted[0] += len(arbiter.contact_point_set.points)

    space.on_collision(0, 0, post_solve=count)

    def drive(k: int) -> None:
        goal = Vec2d(320.0 + 60.0 * math.sin(0.01 * k), min(300.0, 100.0 + 0.4 * k))
        tip.velocity += (100.0 * (goal - tip.position) - 20.0 * tip.velocity) * dt

    return Program(space, dt, drive)


def piston_ball() -> Program:
    """PettingZoo's pistonball: a ball on twenty pistons, kinematic bodies that are put where they are to be."""
    space = pymunk.Space()
    space.gravity = (0.0, 750.0)
    space.iterations, space.collision_bias = 10, 1e-4
    for a, b in (((80, 80), (880, 80)), ((80, 80), (80, 480)), ((880, 80), (880, 480))):
        wall = pymunk.Segment(space.static_body, a, b, 1.0)
        wall.friction = 0.64
        space.add(wall)
    pistons = []
    for i in range(20):
        piston = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        piston.position = (100.0 + 40.0 * i, 460.0)
        shape = pymunk.Segment(piston, (-20, 0), (20, 0), 5.0)
        shape.friction = 0.64
        space.add(piston, shape)
        pistons.append(piston)
    ball = pymunk.Body(0.75, pymunk.moment_for_circle(0.75, 0.0, 40.0))
    ball.position = (790.0, 380.0)
    disk = pymunk.Circle(ball, 40.0)
    disk.friction, disk.elasticity = 0.3, 1.5 / 2
    space.add(ball, disk)

    def lift(k: int) -> None:
        for i, piston in enumerate(pistons):
            y = piston.position.y - 16.0 * math.sin(0.15 * k + 0.4 * i)
            piston.position = (piston.position.x, min(max(y, 396.0), 460.0))

    return Program(space, 1 / 20, lift)


def arcade() -> Program:
    """arcade's engine: a hero with a velocity function, on tiles among crates; its friction is set in each frame."""
    space, dt = pymunk.Space(), 1 / 60
    space.gravity, space.damping, space.iterations = (0.0, -1500.0), 0.9, 15
    walls: list[pymunk.Body] = []

    def box(
        size: float, x: float, y: float, kind: int, group: int, mass: float = 0.0, moment: float = 0.0
    ) -> pymunk.Poly:
        body = pymunk.Body(mass, moment, kind)
        body.position = (x, y)
        shape = pymunk.Poly.create_box(body, (size, size))
        shape.friction, shape.collision_type = 0.7, group
        space.add(body, shape)
        return shape

    for k in range(16):
        box(64, 32 + 64 * k, 32, pymunk.Body.STATIC, 1)
    for k in range(9):
        box(
            48,
            420 + 60 * (k % 3),
            88 + 48 * (k // 3),
            pymunk.Body.DYNAMIC,
            2,
            2.0,
            pymunk.moment_for_box(2.0, (48, 48)),
        )
    foot = box(48, 100, 88, pymunk.Body.DYNAMIC, 3, 2.0, math.inf)
    slide = box(64, 100, 260, pymunk.Body.KINEMATIC, 1).body
    hero = foot.body
    assert hero is not None
    assert slide is not None
    walls.append(slide)

    def bounded(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        pymunk.Body.update_velocity(body, gravity, 0.4**dt, dt)
        x, y = body.velocity
        body.velocity = (max(-450.0, min(450.0, x)), max(-1600.0, min(1600.0, y)))

    hero.velocity_func = bounded
    hits = []
    space.on_collision(3, 2, post_solve=lambda *_: hits.append(1))

    def play(k: int) -> None:
        walls[0].velocity = (60 if (k // 100) % 2 == 0 else -60, 0)
        normals: list[float] = []
        hero.each_arbiter(lambda arbiter: normals.append(arbiter.contact_point_set.normal.y))
        for shape in hero.shapes:
            shape.friction = 0.0 if k % 50 < 40 else 1.0
        hero.apply_force_at_local_point((8000 if k < 200 else -8000, 0))
        if k % 90 == 60 and any(n < -0.3 for n in normals):
            hero.apply_impulse_at_local_point((0, 1800))

    return Program(space, dt, play)


def walker() -> Program:
    """Two legs with motors of bounded torque, whose rates a function gives."""
    scene = scenes.build("walker")
    return Program(scene.space, scene.dt, _nothing)


def car() -> Program:
    """A chassis on two wheels with grooves, damped springs and motors of bounded torque, on a bumpy road."""
    space = pymunk.Space()
    space.gravity = (0.0, -900.0)
    points = [(60.0 * i, 12.0 * math.sin(0.9 * i) * math.sin(0.17 * i)) for i in range(60)]
    for a, b in itertools.pairwise(points):
        road = pymunk.Segment(space.static_body, a, b, 2.0)
        road.friction = 1.0
        space.add(road)
    chassis = pymunk.Body(5.0, pymunk.moment_for_box(5.0, (100, 20)))
    chassis.position = (120.0, 60.0)
    hull = pymunk.Poly.create_box(chassis, (100, 20))
    hull.filter = pymunk.ShapeFilter(group=1)
    space.add(chassis, hull)
    for side in (-35, 35):
        wheel = pymunk.Body(1.0, pymunk.moment_for_circle(1.0, 0, 16))
        wheel.position = (120.0 + side, 35.0)
        tyre = pymunk.Circle(wheel, 16.0)
        tyre.friction, tyre.filter = 1.2, pymunk.ShapeFilter(group=1)
        groove = pymunk.GrooveJoint(chassis, wheel, (side, -10), (side, -40), (0, 0))
        spring = pymunk.DampedSpring(chassis, wheel, (side, 0), (0, 0), 40.0, 500.0, 25.0)
        motor = pymunk.SimpleMotor(chassis, wheel, 12.0)
        motor.max_force = 6e4
        for joint in (groove, spring, motor):
            joint.collide_bodies = False
        space.add(wheel, tyre, groove, spring, motor)
    return Program(space, 1 / 60, _nothing)


def bridge() -> Program:
    """Twenty planks on pivots between two posts, with boxes on them."""
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    before = space.static_body
    for i in range(20):
        plank = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (1.0, 0.2)))
        plank.position = (i + 0.5, 0.0)
        shape = pymunk.Poly.create_box(plank, (0.9, 0.2))
        shape.friction, shape.filter = 0.6, pymunk.ShapeFilter(group=1)
        space.add(plank, shape, pymunk.PivotJoint(before, plank, (float(i), 0.0)))
        before = plank
    space.add(pymunk.PivotJoint(before, space.static_body, (20.0, 0.0)))
    for i in range(5):
        load = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (0.8, 0.8)))
        load.position = (4.0 + 3.0 * i, 1.5)
        shape = pymunk.Poly.create_box(load, (0.8, 0.8))
        shape.friction = 0.6
        space.add(load, shape)
    return Program(space, 1 / 60, _nothing)


def soft_rings() -> Program:
    """Three rings of twelve disks each, on damped springs between neighbours and through the middle."""
    space = pymunk.Space()
    space.gravity = (0.0, -300.0)
    _walls(space, 400.0, 600.0, 3.0)
    for ring in range(3):
        bodies = []
        for i in range(12):
            body = pymunk.Body(1.0, pymunk.moment_for_circle(1.0, 0, 8))
            angle = 2.0 * math.pi * i / 12
            body.position = (120 + 70 * ring + 40 * math.cos(angle), 80 + 110 * ring + 40 * math.sin(angle))
            shape = pymunk.Circle(body, 8.0)
            shape.friction = 0.5
            space.add(body, shape)
            bodies.append(body)
        for i, body in enumerate(bodies):
            for other in (bodies[(i + 1) % 12], bodies[(i + 6) % 12]):
                length = body.position.get_distance(other.position)
                space.add(pymunk.DampedSpring(body, other, (0, 0), (0, 0), length, 800.0, 6.0))
    return Program(space, 1 / 120, _nothing)


def _figure(space: pymunk.Space, x: float, y: float, group: int) -> None:
    """Six parts on pivots with limits; they pass through one another."""

    def part(dx: float, dy: float, width: float, height: float, mass: float) -> pymunk.Body:
        body = pymunk.Body(mass, pymunk.moment_for_box(mass, (width, height)))
        body.position = (x + dx, y + dy)
        shape = pymunk.Poly.create_box(body, (width, height))
        shape.friction, shape.filter = 0.6, pymunk.ShapeFilter(group=group)
        space.add(body, shape)
        return body

    def joined(a: pymunk.Body, b: pymunk.Body, dx: float, dy: float, low: float, high: float) -> None:
        space.add(pymunk.PivotJoint(a, b, (x + dx, y + dy)), pymunk.RotaryLimitJoint(a, b, low, high))

    torso = part(0.0, 0.0, 0.5, 1.0, 4.0)
    joined(torso, part(0.0, 0.7, 0.4, 0.4, 1.0), 0.0, 0.5, -0.5, 0.5)
    for side in (-1.0, 1.0):
        joined(torso, part(0.32 * side, 0.1, 0.15, 0.7, 0.8), 0.32 * side, 0.4, -1.5, 1.5)
        joined(torso, part(0.15 * side, -0.9, 0.2, 0.8, 1.2), 0.15 * side, -0.5, -0.8, 1.2)


def rag_dolls() -> Program:
    """Four figures of bodies on pivots with limits, which fall on the ground and on one another."""
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    ground = pymunk.Segment(space.static_body, (-20.0, 0.0), (20.0, 0.0), 0.2)
    ground.friction = 0.8
    space.add(ground)
    for i in range(4):
        _figure(space, 0.5 * i - 0.7, 2.5 + 2.2 * i, i + 1)
    return Program(space, 1 / 120, _nothing)


PROGRAMS: dict[str, Callable[[], Program]] = {
    "Push-T": push_t, "pistonball": piston_ball, "arcade": arcade, "walker": walker, "car": car, "bridge": bridge,
    "soft rings": soft_rings, "ragdolls": rag_dolls,
}  # fmt: skip
