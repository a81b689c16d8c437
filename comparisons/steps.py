"""The steps that are compared: EECA's, and pymunk's as shipped and tuned."""

from __future__ import annotations

from collections.abc import Callable

import pymunk

import eeca_pymunk as ep
from eeca_pymunk.baselines.native import tune

Step = Callable[[float], object]


def eeca_step(space: pymunk.Space) -> Step:
    """The step of EECA as it is by default: pymunk's shapes are brought up to date in it."""
    return ep.EECA(space).step


def pymunk_step(space: pymunk.Space) -> Step:
    """pymunk's own step as shipped; the checks of `ep.Native` would take longer than it does in a small scene."""
    return space.step


def tuned_step(space: pymunk.Space) -> Step:
    """The same with no slop, no contact memory, 50 iterations."""
    tune(space, 50)
    return space.step


STEPS: dict[str, Callable[[pymunk.Space], Step]] = {
    "EECA": eeca_step, "pymunk": pymunk_step, "pymunk tuned": tuned_step,
}  # fmt: skip
