"""EECA for spaces with joints: the one place that says which stepper takes them."""

from __future__ import annotations

import functools

import pymunk

import eeca_pymunk as ep
from eeca_pymunk.space.jointed import JointedSpace
from scenes import pendulum


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
