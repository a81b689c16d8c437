"""The problems of the tour: small scenes whose exact solutions are known."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

import scenes
from comparisons.exact import Gas
from scenes import Scene, pendulum

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Problem:
    """A scene with its exact solution.

    `dt` is the step that the table shows; `duration` in s; `energy(t)` the exact energy relative to the one at the
    start, counted in units of `scale` (J).
    """

    name: str
    build: Callable[[], Scene]
    dt: float
    duration: float
    scale: float
    energy: Callable[[float], float] = lambda t: 0.0


def problems() -> list[Problem]:
    """Gas, pendulum, stack, slope, cradle."""
    gravity, angle, friction = 9.81, math.radians(20.0), 0.2
    lost = friction * gravity * math.cos(angle)  # J/m: what friction takes of the block
    pull = gravity * (math.sin(angle) - friction * math.cos(angle))
    cradle = Problem("cradle", pendulum.cradle, 1 / 60, 2.0, gravity * (1.0 - math.cos(math.radians(30.0))))
    return [
        Problem("gas", gas, 1e-2, 0.2, gas_energy()),
        Problem("pendulum", pendulum.build, 1 / 60, 10.0, gravity),
        Problem("stack", lambda: scenes.build("pyramid", rows=10, columns=1), 1 / 60, 5.0, 50.0 * gravity),
        Problem(
            "slope", lambda: scenes.build("slope", degrees=20.0, friction=friction), 1 / 60, 1.0,
            gravity, lambda t: -lost * 0.5 * pull * t * t,
        ),
        cradle,
    ]  # fmt: skip


def gas(seed: int = 3) -> Scene:
    """20 disks that start anywhere in any direction, with the exact solution by events."""
    scene = scenes.build("gas", count=20, radius=0.03, seed=seed)
    x, v = np.array([b.position for b in scene.bodies]), np.array([b.velocity for b in scene.bodies])

    def exact(t: float) -> FloatArray:
        held = Gas(x.copy(), v.copy(), np.full(len(x), 0.03), np.ones(len(x)))
        held.run(t)
        return held.position

    return replace(scene, exact=exact)


def gas_energy() -> float:
    """J, of the gas."""
    return sum(0.5 * b.velocity.length**2 for b in gas().bodies)
