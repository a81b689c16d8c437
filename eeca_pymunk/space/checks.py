"""Checks of a space for steppers that work on arrays (`PackedStepper`): errors for what they cannot step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import pymunk


def shape_body(shape: pymunk.Shape) -> pymunk.Body:
    """The body of a shape; ValueError if it has none."""
    if (body := shape.body) is None:
        raise ValueError(f"{shape} has no body: create it with its body, or remove it from the space")
    return body


def settings(space: pymunk.Space) -> tuple[tuple[float, float], float]:
    """Gravity (length/time²) and damping of a space; ValueError for values that cannot be stepped."""
    (x, y), damping = space.gravity, space.damping
    if not 0.0 <= damping < math.inf:
        raise ValueError(f"space.damping = {damping}: set a finite value >= 0; 1 is none")
    if not (math.isfinite(x) and math.isfinite(y)):
        raise ValueError(f"space.gravity = {space.gravity}: set a finite gravity before stepping")
    return (x, y), damping


def check_ignored(ignore: Sequence[str]) -> tuple[str, ...]:
    """`ignore` as a tuple; ValueError for other names than "friction"."""
    names = (ignore,) if isinstance(ignore, str) else tuple(ignore)
    for name in names:
        if name != "friction":
            raise ValueError(f"ignore = {name!r}: only 'friction' can be ignored")
    return names


def check_shape(shape: Any) -> None:
    """ValueError for invalid values of a shape."""
    surface = shape.surface_velocity
    if not (math.isfinite(surface.x) and math.isfinite(surface.y)):
        raise ValueError(f"{shape} has surface velocity {surface}: set a finite one")
    if not 0.0 <= shape.friction < math.inf:
        raise ValueError(f"{shape} has friction {shape.friction}: set a finite value >= 0")
    if not 0.0 <= shape.elasticity < math.inf:
        raise ValueError(f"{shape} has elasticity {shape.elasticity}: set a finite value >= 0")
    if not 0.0 <= shape.radius < math.inf:
        raise ValueError(f"{shape} has radius {shape.radius}: set a finite radius >= 0")


def has_friction(shapes: Sequence[pymunk.Shape]) -> bool:
    """Whether a contact of these shapes can have friction: the product of two shapes of different bodies, one of them
    dynamic, is not 0."""
    rough = {shape_body(shape) for shape in shapes if shape.friction > 0}
    return len(rough) > 1 and any(body.body_type == pymunk.Body.DYNAMIC for body in rough)
