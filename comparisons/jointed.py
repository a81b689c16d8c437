"""The steps that are compared, EECA's for spaces with joints too: the one place that says which stepper takes them."""

from __future__ import annotations

import functools
from collections.abc import Callable

import pymunk

import eeca_pymunk as ep
from eeca_pymunk.baselines.native import tune
from eeca_pymunk.space.jointed import JointedSpace
from scenes import pendulum

Step = Callable[[float], object]


class Jointed(ep.Stepper):
    """Joints without contacts, by the driver of their own kernels."""

    def __init__(self, space: pymunk.Space) -> None:
        super().__init__(space)
        self._joints = JointedSpace(space)

    def step(self, dt: float) -> ep.StepReport:
        self._joints.step(dt)
        self.time += dt
        return ep.StepReport.without_contacts(self.time)

    @property
    def model(self) -> str:
        return "joints, no contacts"


@functools.cache
def wired() -> bool:
    """Whether `ep.EECA` itself takes joints."""
    try:
        ep.EECA(pendulum.build().space).step(1e-3)
    except ep.UnsupportedFeature:
        return False
    return True


def eeca(space: pymunk.Space) -> ep.Stepper:
    """EECA, whatever the space holds."""
    return Jointed(space) if space.constraints and not wired() else ep.EECA(space, sync=False)


def eeca_step(space: pymunk.Space) -> Step:
    """The step of EECA."""
    return eeca(space).step


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
