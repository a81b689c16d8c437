"""Spaces that public programs make of pymunk, and what these do before each step: for `programs`."""

from __future__ import annotations

import math
from collections.abc import Callable

import pymunk
from pymunk import Vec2d

from .program_joints import (
    Program,
    bridge,
    car,
    rag_dolls,
    rings_of_planks,
    six_legs,
    soft_rings,
    walker,
    walls,
)


def push_t() -> Program:
    """gym-pusht: a kinematic tip that a PD law drives through a T of two boxes; damping 0; contacts are counted."""
    space, dt = pymunk.Space(), 0.01
    space.damping = 0.0
    walls(space, 512.0, 512.0, 2.0)
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
    lifts: list[pymunk.Body] = []

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
    lifts.append(slide)

    def bounded(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        pymunk.Body.update_velocity(body, gravity, 0.4**dt, dt)
        x, y = body.velocity
        body.velocity = (max(-450.0, min(450.0, x)), max(-1600.0, min(1600.0, y)))

    hero.velocity_func = bounded
    hits = []
    space.on_collision(3, 2, post_solve=lambda *_: hits.append(1))

    def play(k: int) -> None:
        lifts[0].velocity = (60 if (k // 100) % 2 == 0 else -60, 0)
        normals: list[float] = []
        hero.each_arbiter(lambda arbiter: normals.append(arbiter.contact_point_set.normal.y))
        for shape in hero.shapes:
            shape.friction = 0.0 if k % 50 < 40 else 1.0
        hero.apply_force_at_local_point((8000 if k < 200 else -8000, 0))
        if k % 90 == 60 and any(n < -0.3 for n in normals):
            hero.apply_impulse_at_local_point((0, 1800))

    return Program(space, dt, play)


def many_corners() -> Program:
    """Sixty polygons of a hundred corners each fall into a box."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    for a, b in (((-5.0, 30.0), (-5.0, 0.0)), ((-5.0, 0.0), (5.0, 0.0)), ((5.0, 0.0), (5.0, 30.0))):
        wall = pymunk.Segment(space.static_body, a, b, 0.0)
        wall.friction = 0.5
        space.add(wall)
    corners = [pymunk.Vec2d(0.5, 0.0).rotated(2.0 * math.pi * k / 100) for k in range(100)]
    for i in range(60):
        row, place = divmod(i, 8)
        body = pymunk.Body(1.0, pymunk.moment_for_poly(1.0, corners))
        body.position = -4.0 + 1.1 * place + 0.05 * (row % 2), 1.0 + 1.1 * row
        shape = pymunk.Poly(body, corners)
        shape.friction, shape.elasticity = 0.4, 0.1
        space.add(body, shape)
    return Program(space, 1 / 60, lambda k: None)


PROGRAMS: dict[str, Callable[[], Program]] = {
    "Push-T": push_t, "pistonball": piston_ball, "arcade": arcade, "walker": walker, "car": car, "bridge": bridge,
    "soft rings": soft_rings, "ragdolls": rag_dolls, "six legs": six_legs, "rings of planks": rings_of_planks,
    "a hundred corners": many_corners,
}  # fmt: skip
