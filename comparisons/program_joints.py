"""Spaces with joints, as public programs make them: for `program_scenes`."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import NamedTuple

import pymunk

import scenes


class Program(NamedTuple):
    """A space, its dt, and what the program does before step k."""

    space: pymunk.Space
    dt: float
    before: Callable[[int], object]


def _nothing(k: int) -> None:
    pass


def walls(space: pymunk.Space, width: float, height: float, radius: float) -> None:
    """Four, with friction."""
    corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
    for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
        wall = pymunk.Segment(space.static_body, a, b, radius)
        wall.friction = 1.0
        space.add(wall)


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
    walls(space, 400.0, 600.0, 3.0)
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


def six_legs() -> Program:
    """A crank with a motor of bounded torque moves six legs, of two bars each: 14 bodies."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    floor = pymunk.Segment(space.static_body, (-100.0, 0.0), (100.0, 0.0), 0.0)
    floor.friction = 1.5
    trunk = pymunk.Body(5.0, pymunk.moment_for_box(5.0, (3.0, 0.5)))
    crank = pymunk.Body(1.0, pymunk.moment_for_circle(1.0, 0.0, 0.6))
    trunk.position = crank.position = 0.0, 3.0
    motor = pymunk.SimpleMotor(crank, trunk, 4.0)
    motor.max_force = 400.0
    space.add(floor, trunk, pymunk.Poly.create_box(trunk, (3.0, 0.5)), crank, pymunk.Circle(crank, 0.6))
    space.add(pymunk.PivotJoint(trunk, crank, (0.0, 3.0)), motor)
    for k, side in itertools.product(range(3), (-1.0, 1.0)):
        arm = pymunk.Vec2d(0.6, 0.0).rotated(2.0 * math.pi * k / 3.0)
        thigh, leg = pymunk.Body(0.5, 0.2), pymunk.Body(0.5, 0.4)
        hip, knee, foot = (2.0 * side, 3.0), (2.2 * side, 4.2), (2.6 * side, 0.3)
        thigh.position, leg.position = (2.1 * side, 3.6), (2.3 * side, 1.65)
        to = leg.world_to_local
        shapes = pymunk.Circle(leg, 0.2, to(foot)), pymunk.Segment(leg, to(hip), to(foot), 0.05)
        shapes[0].friction, shapes[1].friction = 1.5, 1.0
        space.add(
            thigh, leg, *shapes,
            pymunk.PinJoint(crank, leg, arm, to((1.2 * side, 2.2))),
            pymunk.PinJoint(crank, thigh, arm, thigh.world_to_local(knee)),
            pymunk.PivotJoint(trunk, thigh, hip),
            pymunk.PinJoint(thigh, leg, thigh.world_to_local(hip), to((2.1 * side, 1.8))),
        )  # fmt: skip
    for shape in space.shapes:
        if shape.body is not None and shape.body.body_type == pymunk.Body.DYNAMIC:
            shape.filter = pymunk.ShapeFilter(group=1)
    return Program(space, 1 / 60, _nothing)


def rings_of_planks() -> Program:
    """Three rings of sixteen planks each, on pivots and damped springs that bend them round, fall on a floor."""
    space, count = pymunk.Space(), 16
    space.gravity = 0.0, -9.81
    floor = pymunk.Segment(space.static_body, (-1000.0, 0.0), (1000.0, 0.0), 0.0)
    floor.friction = 0.7
    space.add(floor)
    for ring in range(3):
        centre, planks = pymunk.Vec2d(0.0, 3.0 + 5.0 * ring), list[pymunk.Body]()
        for i in range(count):
            plank = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (0.5, 0.7)))
            angle = 2.0 * math.pi * i / count
            plank.position, plank.angle = centre + pymunk.Vec2d(2.0, 0.0).rotated(angle), angle + 0.5 * math.pi
            shape = pymunk.Poly.create_box(plank, (0.5, 0.7))
            shape.friction, shape.filter = 0.6, pymunk.ShapeFilter(group=ring + 1)
            space.add(plank, shape)
            planks.append(plank)
        for i, plank in enumerate(planks):
            other, bend = planks[(i + 1) % count], 2.0 * math.pi / count
            at = centre + pymunk.Vec2d(2.0, 0.0).rotated((i + 0.5) * bend)
            rest = -bend if i < count - 1 else 2.0 * math.pi - bend
            space.add(pymunk.PivotJoint(plank, other, at), pymunk.DampedRotarySpring(plank, other, rest, 150.0, 5.0))
    return Program(space, 1 / 60, _nothing)


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


def rag_dolls(count: int = 4) -> Program:
    """Figures of bodies on pivots with limits, which fall on the ground and in fours on one another."""
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    ground = pymunk.Segment(space.static_body, (-20.0, 0.0), (20.0, 0.0), 0.2)
    ground.friction = 0.8
    space.add(ground)
    for i in range(count):
        four, k = divmod(i, 4)
        _figure(space, 0.5 * k - 0.7 + 3.0 * four, 2.5 + 2.2 * k, i + 1)
    return Program(space, 1 / 120, _nothing)
