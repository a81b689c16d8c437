"""`pymunk.Space.step` replaced by ours, for programs that were not written for this package."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pymunk

import eeca_pymunk as ep

Make = Callable[[pymunk.Space], ep.Stepper]


@contextmanager
def replaced(make: Make = ep.EECA) -> Iterator[dict[int, ep.Stepper]]:
    """Within, every space is stepped by a stepper of its own, made at its first step; by id of the space."""
    steppers: dict[int, ep.Stepper] = {}
    native = pymunk.Space.step

    def step(self: pymunk.Space, dt: float) -> None:
        if id(self) not in steppers:
            steppers[id(self)] = make(self)  # which holds the space, so that no other has its id
        steppers[id(self)].step(dt)

    pymunk.Space.step = step  # type: ignore[method-assign]
    try:
        yield steppers
    finally:
        pymunk.Space.step = native  # type: ignore[method-assign]
