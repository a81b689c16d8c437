"""A block or a disk on a slope with Coulomb friction: rests, slides or rolls as the closed forms say."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from .scene import FloatArray, Scene, add_box, add_disk, add_walls

GRAVITY = 9.81


def build(
    kind: str = "box", degrees: float = 30.0, friction: float = 0.3, dt: float = 1 / 60, duration: float = 1.0
) -> Scene:
    """A cube of side 1 m or a disk of radius .5 m, 1 kg, let go on a slope through the origin that falls to the right.

    s = ½ g (sin − mu cos) t² where it slides; disks roll with ⅔ g sin while tan <= 3 mu.
    """
    if kind not in ("box", "disk"):
        raise ValueError(f"kind = {kind!r}: choose 'box' or 'disk'")
    if not (0.0 <= degrees < 90.0 and friction >= 0.0):
        raise ValueError(f"degrees = {degrees}, friction = {friction}: give 0 <= degrees < 90 and friction >= 0")
    space, angle = pymunk.Space(), math.radians(degrees)
    space.gravity = (0.0, -GRAVITY)
    down, up = (math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))
    add_walls(space, [((-9.0 * down[0], -9.0 * down[1]), (90.0 * down[0], 90.0 * down[1]))])
    start = (0.5 * up[0], 0.5 * up[1])
    body = add_box(space, start, 1.0, 1.0) if kind == "box" else add_disk(space, start, 0.5)
    body.angle = -angle
    for shape in space.shapes:
        shape.friction, shape.elasticity = math.sqrt(friction), 0.0
    sliding = math.sin(angle) - friction * math.cos(angle)
    part = max(sliding, 0.0) if kind == "box" else max(sliding, 2.0 / 3.0 * math.sin(angle))

    def exact(t: float) -> FloatArray:
        return np.array([start]) + 0.5 * GRAVITY * part * t * t * np.array([down])

    parameters = {"kind": kind, "degrees": degrees, "friction": friction, "dt": dt}
    return Scene("slope", space, [body], dt, duration, 1e6, exact, parameters)
