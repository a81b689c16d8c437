"""Patching: edits in place put into the rows of a world whose bodies and shapes are otherwise what they were.

Rows are afterwards those that a new reading of the whole space would give, bit by bit: numbers and filters of shapes,
masses and moments of bodies, and static bodies that were put elsewhere. All else (outlines, kinds and functions of
bodies, sensors, joints, what is added and removed) makes other rows, and is left to a new reading.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pymunk

from ..compiled.records import Rows
from ..layout import BODY_ROW, LEFT, NOW, PUSH_TWIST, PUSH_X
from ..model.bodies import Body
from ..transfer import MOVED_STATIC, OTHER_BODIES
from .noticed import clock
from .packing import Record, pack, read

if TYPE_CHECKING:
    from .world import World


def patch(world: World) -> bool | None:
    """Put all edits since the world was read into its rows, and have these be as if no step had been taken.

    Returns:
        whether near lists depend on what has changed; None, with nothing done, where rows must be made anew.

    Raises:
        ValueError, UnsupportedFeature, NotFiniteError: as a new reading would.
    """
    now, stale = clock(), world.stale()
    if stale is None or not world.same_things() or world.smooth or world.joints is not None or world.space.constraints:
        return None
    lists, bodies, records = False, world.bodies, {}
    for shape, record in world.records.items():
        if shape not in stale:
            continue
        if record is None or record.outside or shape.sensor:
            return None
        records[shape] = new = read(shape)
        if (new.body, new.vertices, new.numbers[0]) != (record.body, record.vertices, record.numbers[0]):
            return None
        lists |= new.filter != record.filter
    changes = {i: bodies.changed(i) for i, body in enumerate(bodies.items) if body in stale}
    masses = [i for i, (changed, _) in changes.items() if changed]
    if any(more for _, more in changes.values()):
        return None
    world.gather()
    status, moved = world.find(), False
    if status == MOVED_STATIC:
        moved = bool((world.state[:, :3] != world.STATES[LEFT, :, :3])[bodies.static].any())
    if status == OTHER_BODIES or not (stale or moved):
        return None
    if status != 0:
        bodies.check_finite(world.state)
    if masses:
        bodies.weigh(masses)
    world.records.update(records)
    if moved or world.fresh is None:
        if not _lay_again(world):
            return None
    else:
        _number(world, world.fresh, records, masses)
    world.read_at = now
    left, static = world.STATES[LEFT], bodies.static
    left[:] = np.nan
    left[static] = world.STATES[NOW, static]
    world.EXTRA[:, PUSH_X : PUSH_TWIST + 1] = 0.0
    return lists or moved


def _number(world: World, fresh: Rows[Body], records: dict[pymunk.Shape, Record], masses: list[int]) -> None:
    """Give shapes the numbers and filters of these records, bodies their masses, and BODY its `fresh` rows."""
    for shape, record in records.items():
        k = world.places[shape]
        row, link = world.SHAPE[k], world.LINK[k]
        row.elasticity, row.friction, row.surface_x, row.surface_y = record.numbers[1:]
        link.group, link.categories, link.mask = (word - (word >> 63 << 64) for word in record.filter)
        if k < world.disks:
            # Row k of a lone disk is that of its shape, too.
            fresh[k].elasticity, fresh[k].friction = row.elasticity, row.friction
    for i in masses:
        if (at := world.WALK[BODY_ROW, i]) >= 0:
            fresh[at].inv_mass, fresh[at].inv_inertia = world.bodies.inverse_mass[i], world.bodies.inverse_moment[i]
    world.BODY.view(np.int64)[:] = fresh.view(np.int64)


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
    world.fresh = packed.BODY
    for name in names:
        # To copy records takes ten times as long.
        getattr(world, name).view(np.int64)[:] = getattr(packed, name).view(np.int64)
    return True
