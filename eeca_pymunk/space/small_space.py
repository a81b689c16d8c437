"""A small space with what programs have most often, to be stepped once before those of a program (`..warming`)."""

from __future__ import annotations

from collections.abc import Iterator

import pymunk

from .private import versions as private_versions

_ROUNDS = 10  # Python 3.11 specialises the code of a function at its eighth call


def small_space() -> pymunk.Space:
    """A floor, and a collision handler."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    floor = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.1)
    floor.friction = 0.5
    space.add(floor)
    private_versions.add_handler(space, 1, 2).pre_solve = lambda *_: True
    return space


def changes(space: pymunk.Space) -> Iterator[None]:
    """Add and remove bodies and joints, edit shapes, ask for shapes and arbiters; a step is to be taken after each."""
    last: pymunk.Body | None = None
    for k in range(_ROUNDS):
        body = pymunk.Body(1.0, 1.0)
        body.position = k - 5.0, 0.6 + 0.1 * k
        shape = pymunk.Poly.create_box(body, (0.5, 0.5)) if k % 2 else pymunk.Circle(body, 0.5)
        shape.friction, shape.elasticity, shape.collision_type = 0.5, 0.5, 1 + k % 2
        space.add(body, shape)
        if last is not None:
            joint = pymunk.PinJoint(last, body)
            space.add(joint)
            yield
            space.remove(joint)
        yield
        space.point_query_nearest((0.0, 0.0), 1.0, pymunk.ShapeFilter())
        shape.friction = 0.6
        yield
        body.each_arbiter(lambda arbiter: None)
        yield
        if k > _ROUNDS // 2 and last is not None:
            space.remove(last, *last.shapes)
        last = body
