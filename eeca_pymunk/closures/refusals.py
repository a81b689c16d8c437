"""Refusals: features that steps of single disks do not support, each with a remedy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import UnsupportedFeature

if TYPE_CHECKING:
    from ..space.world import World


def check_disks(world: World, moving: int, mover: str) -> None:
    """Raise UnsupportedFeature for joints, moving shapes that are no single disks, and friction.

    Args:
        moving: number of moving shapes, the first rows of SHAPE.  mover: name of the closure or stepper, for messages.
    """
    if world.joints is not None:
        raise UnsupportedFeature(
            f"{world.joints.items[0]}: constraints are not modelled by {mover}; remove it or use ep.EECA(space)"
        )
    owner = world.LINK["owner"][:moving]
    if moving > world.disks:
        other = np.flatnonzero(~(world.centred[:moving] & (world.BODY["inv_mass"][owner] > 0.0)))
        i = int(other[0]) if len(other) else world.disks
        raise UnsupportedFeature(
            f"{world.shapes[i]} of {world.bodies.items[world.owner[i]]} moves and is not a disk about the centre of "
            f"mass of a dynamic body with no other shape, which is all that {mover} moves; use ep.EECA(space)"
        )
    rough = np.flatnonzero(world.SHAPE["friction"] > 0.0)
    if len(rough) > 1 and rough[0] < moving:
        raise UnsupportedFeature(
            f"{world.shapes[rough[0]]} has friction {world.SHAPE['friction'][rough[0]]}, and so has a shape it may "
            f"touch: {mover} does not model it; use ep.EECA(space), or set shape.friction = 0"
        )
