"""Every stepper and closure, for the tests that all of them must pass; and small spaces."""

from __future__ import annotations

from collections.abc import Callable

import pymunk

import eeca_pymunk as ep
from eeca_pymunk.impacts.scene_memory import SceneMemory
from eeca_pymunk.space.world import World
from scenes.scene import add_disk, add_walls

Make = Callable[[pymunk.Space], ep.Stepper]

CLOSURES: dict[str, ep.Closure] = {
    "time_of_impact": ep.TimeOfImpact(),
    "midstep": ep.Midstep(),
    "dashpot_0": ep.Dashpot(1e6, 0.0),
    "dashpot_1": ep.Dashpot(1e6, 1.0),
    "dashpot_200": ep.Dashpot(1e6, 200.0),
}
EECAS: dict[str, Make] = {
    name: (lambda space, closure=closure: ep.EECA(space, closure)) for name, closure in CLOSURES.items()
}
PENALTIES: dict[str, Make] = {
    "energy_momentum": lambda space: ep.PenaltyEnergyMomentum(space, 1e6),
    "trapezoidal": lambda space: ep.Newmark.trapezoidal(space, 1e6),
    "max_dissipation": lambda space: ep.Newmark.max_dissipation(space, 1e6),
}
ARRAYS = EECAS | PENALTIES
ALL = ARRAYS | {"native": ep.Native}


def one_disk(velocity: tuple[float, float] = (1.0, 2.0), gravity: float = 0.0) -> tuple[pymunk.Space, pymunk.Body]:
    """A unit disk of radius .1 at (0, 1) above a floor y = 0."""
    space = pymunk.Space()
    space.gravity = (0.0, -gravity)
    body = add_disk(space, (0.0, 1.0), 0.1, velocity=velocity)
    add_walls(space, [((-10.0, 0.0), (10.0, 0.0))])
    return space, body


def two_disks(offset: float = 0.12) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """Two disks of masses 1 and 2 that meet obliquely, off the origin; radius .1, closing at 3 m/s."""
    space = pymunk.Space()
    a = add_disk(space, (1.0, 2.0), 0.1, 1.0, (2.0, 0.3))
    b = add_disk(space, (1.25, 2.0 + offset), 0.1, 2.0, (-1.0, 0.1))
    return space, [a, b]


def state(space: pymunk.Space) -> list[tuple[float, ...]]:
    """All that a step may change, and the settings it may not."""
    settings = (
        space.iterations, *space.gravity, space.damping, space.collision_slop, space.collision_bias,
        space.collision_persistence, space.idle_speed_threshold,
    )  # fmt: skip
    bodies = [(*b.position, b.angle, *b.velocity, b.angular_velocity, *b.force, b.torque) for b in space.bodies]
    return [settings, *bodies]


LONG_AGO = -(1 << 60)  # a clock from which on all edits are more than are kept


class Forgetful(ep.EECA):
    """Knows no object from earlier readings, only results of earlier steps."""

    def patch(self, world: World, moved: bool) -> bool:
        return False

    def _update_world(self, anew: bool = False) -> World:
        world = self._world
        if world is not None:
            world.read_at, world.memory = LONG_AGO, SceneMemory()
        return super()._update_world(anew)
