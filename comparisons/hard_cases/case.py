"""What a hard case is, and what the cases share."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import pymunk

import eeca_pymunk as ep
from comparisons import runs

DT, G = 1 / 60, 9.81
# Steps (or scenes) of the longest cases; tests take fewer.
LONG = {
    "crowd": 20_000, "720-gon": 15_000, "stick": 100_000, "pyramid": 600, "pyramid rows": 25, "random scenes": 200,
    "random impacts": 1000, "resting": 3000,
}  # fmt: skip
Measure = Callable[[runs.Make], float]


@dataclass(frozen=True)
class Case:
    """A kind of trouble: what its figure is, the largest that passes, and how to get it under a stepper."""

    name: str
    figure: str
    limit: float
    run: Measure


CASES: list[Case] = []


def case(name: str, figure: str, limit: float) -> Callable[[Measure], Measure]:
    """Make a function that runs a scene under a stepper, and returns its figure, a case."""

    def enter(run: Measure) -> Measure:
        CASES.append(Case(name, figure, limit, run))
        return run

    return enter


def go(space: pymunk.Space, make: runs.Make, steps: int, dt: float = DT) -> ep.Stepper:
    """Take so many steps."""
    stepper = make(space)
    for _ in range(steps):
        stepper.step(dt)
    return stepper


def heavy(gravity: float = G, slope: float = 0.0) -> pymunk.Space:
    """A space in which things fall; the floor is along x, and gravity is turned to pull down a slope (rad) to +x."""
    space = pymunk.Space()
    space.gravity = (gravity * math.sin(slope), -gravity * math.cos(slope))
    return space


def matter(space: pymunk.Space, friction: float, elasticity: float = 0.0) -> None:
    """Give all shapes what makes these the values of every pair of them: pymunk takes products."""
    for shape in space.shapes:
        shape.friction, shape.elasticity = math.sqrt(friction), math.sqrt(elasticity)
