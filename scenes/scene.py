"""Scene: a pymunk space with the numbers that belong to it, and the helpers the builders share."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt
import pymunk

FloatArray = npt.NDArray[np.float64]
Point = tuple[float, float]


def _unknown(t: float) -> FloatArray | None:
    return None


def _nothing() -> None:
    pass


class Driver(Protocol):
    """What steers a scene from within its steps."""

    def work(self) -> float:
        """The most that it has put in so far (J)."""


@dataclass
class Scene:
    """A space, its N moving bodies in order, the time step and duration to run it with (s), and its exact solution.

    `exact(t)` gives (N, 2) positions in metres, or None where no closed form is known. `stiffness` is the penalty K
    (N/m) the paper uses, `parameters` what the scene was built with. `reset` puts a scene that has a `driver` back to
    its start.
    """

    name: str
    space: pymunk.Space
    bodies: list[pymunk.Body]
    dt: float
    duration: float
    stiffness: float
    exact: Callable[[float], FloatArray | None] = _unknown
    parameters: dict[str, Any] = field(default_factory=dict)
    driver: Driver | None = None
    reset: Callable[[], None] = _nothing


def add_disk(
    space: pymunk.Space, position: Point, radius: float, mass: float = 1.0, velocity: Point = (0.0, 0.0)
) -> pymunk.Body:
    """Add an elastic, frictionless disk and return its body."""
    body = pymunk.Body(mass, pymunk.moment_for_circle(mass, 0.0, radius))
    body.position, body.velocity = position, velocity
    shape = pymunk.Circle(body, radius)
    shape.elasticity, shape.friction = 1.0, 0.0
    space.add(body, shape)
    return body


def add_walls(space: pymunk.Space, lines: Iterable[tuple[Point, Point]]) -> None:
    """Add elastic, frictionless static segments of zero radius."""
    for a, b in lines:
        shape = pymunk.Segment(space.static_body, a, b, 0.0)
        shape.elasticity, shape.friction = 1.0, 0.0
        space.add(shape)


def add_box(
    space: pymunk.Space, position: Point, width: float, height: float, mass: float = 1.0, velocity: Point = (0.0, 0.0)
) -> pymunk.Body:
    """Add an inelastic box with friction 1 and return its body."""
    body = pymunk.Body(mass, pymunk.moment_for_box(mass, (width, height)))
    body.position, body.velocity = position, velocity
    shape = pymunk.Poly.create_box(body, (width, height))
    shape.elasticity, shape.friction = 0.0, 1.0
    space.add(body, shape)
    return body
