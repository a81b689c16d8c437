"""The scenes of the comparison with other engines, told without any of them.

Bodies are disks and boxes; walls are segments with everything on their left. Lengths suit engines that are made for
things of about a metre: the gas and the hopper of `scenes` are enlarged, accelerations with them, so that instants are
the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pymunk

import scenes
from comparisons import tour_problems
from scenes import pendulum

FloatArray = npt.NDArray[np.float64]
Exact = Callable[[float], FloatArray | None]


@dataclass(frozen=True)
class Problem:
    """N bodies of mass 1 with their exact solution.

    Attributes:
        gravity: downwards, m/s².  friction, elasticity: of every contact.
        start: (N, 6) x, y, angle and their rates.  radius: (N,) of disks, 0 for unit boxes.  moment: (N,).
        walls: (W, 4) from (x, y) to (x, y).  rod: whether body 0 hangs on a rod from the origin.
        size: m, of a body.  scale: J, of energies.  energy_change: exact, J, since the start.
    """

    name: str
    dt: float
    duration: float
    gravity: float
    friction: float
    elasticity: float
    start: FloatArray
    radius: FloatArray
    moment: FloatArray
    walls: FloatArray
    size: float
    scale: float
    exact: Exact
    rod: bool = False
    energy_change: Callable[[float], float] = lambda t: 0.0

    def energy(self, state: FloatArray) -> float:
        """J, kinetic and potential."""
        kinetic = 0.5 * (state[:, 3] ** 2 + state[:, 4] ** 2 + self.moment * state[:, 5] ** 2)
        return float((kinetic + self.gravity * state[:, 1]).sum())

    def described(self) -> dict[str, Any]:
        """What a driver is told, for JSON."""
        return {
            "gravity": self.gravity, "friction": self.friction, "elasticity": self.elasticity,
            "start": self.start.tolist(), "radius": self.radius.tolist(), "moment": self.moment.tolist(),
            "walls": self.walls.tolist(), "rod": self.rod,
        }  # fmt: skip

    def space(self) -> tuple[pymunk.Space, list[pymunk.Body]]:
        """For pymunk."""
        space = pymunk.Space()
        space.gravity = (0.0, -self.gravity)
        bodies = []
        shapes: list[pymunk.Shape] = [
            pymunk.Segment(space.static_body, (x, y), (u, v), 0.0) for x, y, u, v in self.walls.tolist()
        ]
        for (x, y, angle, vx, vy, spin), radius, moment in zip(
            self.start.tolist(), self.radius.tolist(), self.moment.tolist(), strict=True
        ):
            body = pymunk.Body(1.0, moment)
            body.position, body.angle, body.velocity, body.angular_velocity = (x, y), angle, (vx, vy), spin
            bodies.append(body)
            space.add(body)
            if not self.rod:
                shapes.append(pymunk.Circle(body, radius) if radius else pymunk.Poly.create_box(body, (1.0, 1.0)))
        for shape in shapes:
            shape.friction, shape.elasticity = math.sqrt(self.friction), math.sqrt(self.elasticity)
        space.add(*shapes)
        if self.rod:
            space.add(pymunk.PinJoint(space.static_body, bodies[0], (0.0, 0.0), (0.0, 0.0)))
        return space, bodies


def problems() -> list[Problem]:
    """Gas, hopper, pendulum, stack, slope."""
    return [gas(), hopper(), rod(), stack(), slope()]


def gas(enlarged: float = 30.0) -> Problem:
    """20 disks of radius .9 m in a box of 30 m."""
    scene = tour_problems.gas()
    start = _states(scene.bodies, enlarged)
    side = enlarged
    walls = np.array([[0, 0, side, 0], [side, 0, side, side], [side, side, 0, side], [0, side, 0, 0]], dtype=float)
    radius = np.full(20, 0.03 * enlarged)

    def exact(t: float) -> FloatArray | None:
        found = scene.exact(t)
        return None if found is None else enlarged * found

    energy = 0.5 * float((start[:, 3:5] ** 2).sum())
    return Problem("gas", 0.01, 0.2, 0.0, 0.0, 1.0, start, radius, 0.5 * radius**2, walls, 0.9, energy, exact)


def hopper(enlarged: float = 100.0) -> Problem:
    """117 elastic disks of radius .4 m that fall into a V; nobody knows where they end."""
    scene = scenes.build("hopper", columns=13, layers=9)
    start = _states(scene.bodies, enlarged)
    (o, a), (_, b) = scenes.hopper.walls()
    walls = enlarged * np.array([[*a, *o], [*o, *b]])
    radius = np.full(len(start), 0.004 * enlarged)
    gravity = 9.81 * enlarged
    scale = gravity * float(start[:, 1].sum())
    return Problem(
        "hopper", 0.0025, 1.0, gravity, 0.0, 1.0, start, radius, 0.5 * radius**2, walls, 0.4, scale, lambda t: None
    )


def rod() -> Problem:
    """A pendulum let go horizontally."""
    scene = pendulum.build()
    none = np.zeros((0, 4))
    return Problem(
        "pendulum", 1 / 60, 10.0, 9.81, 0.0, 0.0, _states(scene.bodies), np.full(1, 0.1), np.ones(1), none, 1.0, 9.81,
        scene.exact, rod=True,
    )  # fmt: skip


def stack() -> Problem:
    """Ten unit boxes that stand."""
    scene = scenes.build("pyramid", rows=10, columns=1)
    floor = np.array([[-9.0, 0.0, 11.0, 0.0]])
    return Problem(
        "stack", 1 / 60, 5.0, 9.81, 0.5, 0.0, _states(scene.bodies), np.zeros(10), np.full(10, 1 / 6), floor, 1.0,
        50.0 * 9.81, scene.exact,
    )  # fmt: skip


def slope(degrees: float = 20.0, friction: float = 0.2) -> Problem:
    """A unit box that slides down."""
    scene = scenes.build("slope", degrees=degrees, friction=friction)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    pull = 9.81 * (s - friction * c)
    return Problem(
        "slope", 1 / 60, 1.0, 9.81, friction, 0.0, _states(scene.bodies), np.zeros(1), np.full(1, 1 / 6),
        np.array([[-9.0 * c, 9.0 * s, 90.0 * c, -90.0 * s]]), 1.0, 9.81, scene.exact,
        energy_change=lambda t: -friction * 9.81 * c * 0.5 * pull * t * t,
    )  # fmt: skip


def _states(bodies: list[pymunk.Body], enlarged: float = 1.0) -> FloatArray:
    found = np.array([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in bodies])
    found[:, [0, 1, 3, 4]] *= enlarged
    return found
