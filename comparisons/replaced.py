"""`pymunk.Space.step` replaced by ours, for programs that were not written for this package."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pymunk

import eeca_pymunk as ep

Make = Callable[[pymunk.Space], ep.Stepper]


@contextmanager
def replaced(make: Make = ep.EECA) -> Iterator[None]:
    """Within, every space is stepped by a stepper of its own, made at its first step, which lives as long as it."""
    native = pymunk.Space.step

    def step(self: pymunk.Space, dt: float) -> None:
        stepper = vars(self).get("_stepper")
        if stepper is None:
            stepper = vars(self)["_stepper"] = make(self)
        stepper.step(dt)

    pymunk.Space.step = step  # type: ignore[method-assign]
    try:
        yield
    finally:
        pymunk.Space.step = native  # type: ignore[method-assign]
