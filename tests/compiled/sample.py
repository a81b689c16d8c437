"""sample: tiny spaces in which all that compiled code does happens at once."""

from __future__ import annotations

import pymunk

_WALLS = 20  # more than are looked at one by one
_LINKS = 3
_BOXES = 140  # more contacts than there is room for at first


def sample(kind: str) -> pymunk.Space:
    """Elastic disks that hit each other, of which one also bounces in a slit, a hundred times within 20 ms ("disks");
    boxes with friction on a floor ("boxes"); boxes held together by pivots, that land ("joints");
    disks under collision handlers ("hooked")."""
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    _wall(space, (-9.0, 0.0), (999.0, 0.0))
    for x, speed in ((0.0, 2.0), (1.01, 0.0)):
        _disk(space, (x, 2.0), (speed, 0.0), 0.5)
    if kind == "disks":
        _disk(space, (-4.0, 0.2), (0.0, 600.0), 0.15)
        _wall(space, (-5.0, 0.4), (-3.0, 0.4))
        for i in range(_WALLS):
            _wall(space, (-8.0, 5.0 + i), (-7.0, 5.0 + i))
    elif kind == "boxes":
        for i in range(_BOXES):
            body = pymunk.Body(1.0, 1.0 / 6.0)
            body.position = (3.0 + 1.5 * i, 0.5)
            box = pymunk.Poly.create_box(body, (1.0, 1.0))
            box.friction = 0.5
            space.add(body, box)
    elif kind == "joints":
        last = None
        for i in range(_LINKS):
            body = pymunk.Body(1.0, 1.0 / 6.0)
            body.position, body.velocity = (3.0 + i, 0.5 + 0.01 * (i % 2)), (0.0, -1.0)
            box = pymunk.Poly.create_box(body, (0.8, 0.8))
            box.friction = 0.5
            space.add(body, box)
            if last is not None:
                space.add(pymunk.PivotJoint(last, body, (2.5 + i, 0.5)))
            last = body
    elif kind == "hooked":
        space.on_collision(pre_solve=lambda arbiter, space, data: None)
    return space


def _disk(space: pymunk.Space, place: tuple[float, float], velocity: tuple[float, float], radius: float) -> None:
    body = pymunk.Body(1.0, 0.5 * radius * radius)
    body.position, body.velocity = place, velocity
    disk = pymunk.Circle(body, radius)
    disk.elasticity = 1.0
    space.add(body, disk)


def _wall(space: pymunk.Space, a: tuple[float, float], b: tuple[float, float]) -> None:
    wall = pymunk.Segment(space.static_body, a, b, 0.0)
    wall.elasticity = wall.friction = 1.0
    space.add(wall)
