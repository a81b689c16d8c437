"""A pymunk space as JSON, for drivers of engines that take any scene of it: `box2d_3.py`."""

from __future__ import annotations

from typing import Any

import pymunk


def space(source: pymunk.Space, bodies: list[pymunk.Body]) -> dict[str, Any]:
    """Gravity (m/s^2), bodies and joints of a space, the `bodies` first; their states are those of now.

    A body has its kind, mass (kg), moment (kg m^2), state (x, y, angle and their rates) and shapes in its own frame. A
    shape has friction, elasticity and group, and a centre and radius, or vertices (m). Materials are those of contacts
    between equal shapes: pymunk multiplies, so that each is the square. Joints: pivots, with the limits of the angle
    that a RotaryLimitJoint of the same bodies sets (rad), and pins with their length (m).
    """
    every = [*bodies, *(b for b in source.bodies if b not in set(bodies)), source.static_body]
    number = {body: k for k, body in enumerate(every)}
    limits = {(c.a, c.b): (c.min, c.max) for c in source.constraints if isinstance(c, pymunk.RotaryLimitJoint)}
    joints = []
    for c in source.constraints:
        if isinstance(c, pymunk.PivotJoint | pymunk.PinJoint):
            joints.append({
                "bodies": [number[c.a], number[c.b]], "anchors": [list(c.anchor_a), list(c.anchor_b)],
                "limits": limits.get((c.a, c.b)), "length": c.distance if isinstance(c, pymunk.PinJoint) else None,
                "collide": bool(c.collide_bodies),
            })  # fmt: skip
        elif not isinstance(c, pymunk.RotaryLimitJoint):
            raise ValueError(f"{type(c).__name__} has no counterpart here: use pivots, limits and pins")
    return {"gravity": list(source.gravity), "bodies": [_body(b, source) for b in every], "joints": joints}


def _body(body: pymunk.Body, source: pymunk.Space) -> dict[str, Any]:
    kinds = {pymunk.Body.DYNAMIC: "DYNAMIC", pymunk.Body.KINEMATIC: "KINEMATIC", pymunk.Body.STATIC: "STATIC"}
    moving = body.body_type == pymunk.Body.DYNAMIC
    return {
        "kind": kinds[body.body_type], "mass": body.mass if moving else 0.0, "moment": body.moment if moving else 0.0,
        "state": [*body.position, body.angle, *body.velocity, body.angular_velocity],
        "shapes": [_shape(s) for s in body.shapes if s in source.shapes],
    }  # fmt: skip


def _shape(shape: pymunk.Shape) -> dict[str, Any]:
    told: dict[str, Any] = {
        "friction": shape.friction**2, "elasticity": shape.elasticity**2, "group": shape.filter.group,
    }  # fmt: skip
    if isinstance(shape, pymunk.Circle):
        return {**told, "centre": list(shape.offset), "radius": shape.radius}
    if isinstance(shape, pymunk.Segment):
        return {**told, "vertices": [list(shape.a), list(shape.b)], "radius": shape.radius}
    assert isinstance(shape, pymunk.Poly)
    return {**told, "vertices": [list(v) for v in shape.get_vertices()], "radius": shape.radius}
