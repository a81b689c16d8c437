"""sample: a tiny space that every closure can step, in which bodies meet at once."""

from __future__ import annotations

import pymunk


def sample(turning: bool) -> pymunk.Space:
    """Two elastic disks that are about to meet above a floor; if `turning`, also lossy boxes with friction."""
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    floor = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0)
    floor.elasticity, floor.friction = 1.0, 1.0 if turning else 0.0
    space.add(floor)
    for x, speed in ((0.0, 2.0), (1.01, 0.0)):
        body = pymunk.Body(1.0, 0.125)
        body.position, body.velocity = (x, 2.0), (speed, 0.0)
        disk = pymunk.Circle(body, 0.5)
        disk.elasticity = 1.0
        space.add(body, disk)
    for height in (0.5, 1.5) if turning else ():
        body = pymunk.Body(1.0, 1.0 / 6.0)
        body.position = (3.0, height)
        box = pymunk.Poly.create_box(body, (1.0, 1.0))
        box.friction = 0.5
        space.add(body, box)
    return space
