"""Checks: what a space must be for the array steppers, and the refusal of what they do not model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import pymunk

from ..errors import UnsupportedFeature


def shape_body(shape: pymunk.Shape) -> pymunk.Body:
    """The body of a shape; ValueError if it has none."""
    if shape.body is None:
        raise ValueError(f"{shape} has no body: create it with its body, or remove it from the space")
    return shape.body


def shape_radius(shape: Any) -> float:
    """The radius that every kind of pymunk shape has."""
    return float(shape.radius)


def settings(space: pymunk.Space) -> tuple[tuple[float, float], float]:
    """Gravity and damping of a space; ValueError for what the array steppers do not model."""
    (x, y), damping = space.gravity, space.damping
    if not 0.0 <= damping < math.inf:
        raise ValueError(f"space.damping = {damping}: set a finite value >= 0; 1 is none")
    if not (math.isfinite(x) and math.isfinite(y)):
        raise ValueError(f"space.gravity = {space.gravity}: set a finite gravity before stepping")
    return (x, y), damping


def check_ignored(ignore: Sequence[str]) -> tuple[str, ...]:
    """`ignore` as a tuple; ValueError for what cannot be ignored."""
    names = (ignore,) if isinstance(ignore, str) else tuple(ignore)
    for name in names:
        if name != "friction":
            raise ValueError(f"ignore = {name!r}: only 'friction' can be ignored")
    return names


def check_shape(shape: pymunk.Shape) -> None:
    """Refuse numbers that no shape can have, and a shape without a body."""
    shape_body(shape)
    surface = shape.surface_velocity
    if not (math.isfinite(surface.x) and math.isfinite(surface.y)):
        raise ValueError(f"{shape} has surface velocity {surface}: set a finite one")
    if not 0.0 <= shape.friction < math.inf:
        raise ValueError(f"{shape} has friction {shape.friction}: set a finite value >= 0")
    if not isinstance(shape, (pymunk.Circle, pymunk.Segment, pymunk.Poly)):
        raise UnsupportedFeature(f"{shape} is neither a Circle, a Segment nor a Poly; replace it by one of them")
    if not 0.0 <= shape.elasticity < math.inf:
        raise ValueError(f"{shape} has elasticity {shape.elasticity}: set a finite value >= 0")
    if not math.isfinite(shape_radius(shape)):
        raise ValueError(f"{shape} has radius {shape_radius(shape)}: set a finite radius")


def rough_pair(shapes: Sequence[pymunk.Shape]) -> pymunk.Shape | None:
    """A moving shape with friction that may touch one of another body with friction (pymunk multiplies the two)."""
    rough = [s for s in shapes if s.friction > 0]
    for shape in rough:
        body = shape_body(shape)
        if body.body_type == pymunk.Body.DYNAMIC and any(other.body is not body for other in rough):
            return shape
    return None
