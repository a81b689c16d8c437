"""Patching: edits in place put into the rows of a world whose bodies and shapes are otherwise what they were.

Rows are afterwards those that a new reading of the whole space would give, bit by bit: numbers and filters of shapes,
masses and moments of bodies, and static bodies that were put elsewhere. All else (outlines, kinds and functions of
bodies, sensors, joints, what is added and removed) makes other rows, and is left to a new reading.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pymunk

from ..arrays import IntArray
from ..layout import LEFT, NOW, PUSH_TWIST, PUSH_X
from ..transfer import MOVED_STATIC, OTHER_BODIES
from .noticed import clock
from .packing import pack, read

if TYPE_CHECKING:
    from .world import World

_NUMBERS = ("friction", "elasticity", "surface_velocity")
_MASSES = ("mass", "moment", "density")
_NONE: IntArray = np.zeros(0, np.intp)


def patch(world: World) -> bool | None:
    """Put all edits since the world was read into its rows, and have these be as if no step had been taken.

    Returns:
        whether near lists depend on what has changed; None, with nothing done, where rows must be made anew.

    Raises:
        ValueError, UnsupportedFeature, NotFiniteError: as a new reading would.
    """
    edits, now = world.edits(), clock()
    if edits is None or world.smooth or world.joints is not None or world.space.constraints:
        return None
    shapes: dict[pymunk.Shape, None] = {}
    masses: dict[pymunk.Body, None] = {}
    lists = False
    for thing, name in edits:
        if thing is None or name not in (*_NUMBERS, *_MASSES, "filter"):
            return None
        if name in _MASSES:
            body = thing.body if isinstance(thing, pymunk.Shape) else thing
            if body is not None:
                masses[body] = None
        elif thing in world.places:
            shapes[thing] = None
            lists |= name == "filter"
    world.gather()
    status = world.find()
    bodies, moved = world.bodies, _NONE
    if status == MOVED_STATIC:
        differs = (world.state[:, :3] != world.STATES[LEFT, :, :3]).any(axis=1)
        moved = np.flatnonzero(differs & bodies.static)
    if status == OTHER_BODIES or not (edits or len(moved)) or any(body not in bodies.row for body in masses):
        return None
    if status != 0:
        bodies.check_finite(world.state)
    records = {shape: read(shape) for shape in shapes}
    weighed = [bodies.row[body] for body in masses]
    centres = [list(body.center_of_gravity) for body in masses]
    if masses and bodies.center_of_gravity[weighed].tolist() != centres:
        return None
    bodies.weigh(weighed)
    world.records.update(records)
    if not _lay_again(world):
        return None
    world.read_at = now
    left, static = world.STATES[LEFT], bodies.static
    left[:] = np.nan
    left[static] = world.STATES[NOW, static]
    world.EXTRA[:, PUSH_X : PUSH_TWIST + 1] = 0.0
    return lists or len(moved) > 0


def _lay_again(world: World) -> bool:
    """Lay all rows anew, by what bodies and shapes say now, as if no step had been taken; False, with nothing done, if
    these are other rows."""
    solid = {shape: record for shape, record in world.records.items() if record is not None}
    packed = pack(world.bodies, world.state, list(solid), list(solid.values()))
    if packed.shapes != world.shapes or packed.disks != world.disks:
        return False
    if not np.array_equal(packed.LINK["vertices"], world.LINK["vertices"]):
        return False
    names: tuple[str, ...] = "BODY", "SHAPE", "LINK", "VERTEX"
    for name in names:
        # To copy records takes ten times as long.
        getattr(world, name).view(np.int64)[:] = getattr(packed, name).view(np.int64)
    return True
