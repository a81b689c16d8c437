"""Patching: after edits in place the rows of a world are updated without reading the whole space.

Only edited objects are read again, and all rows are written again in place: afterwards they are those that a new
reading would give, bit by bit. Which edits can be patched:

| space | edits |
|---|---|
| without joints and sleeping | numbers and filters of shapes, masses and moments of bodies, moved static bodies |
| with joints, or where bodies may sleep | filters of shapes, and their numbers but the radius |

All others (of vertices, kinds and functions of bodies, sensors; additions and removals) need a new reading.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import pymunk

from ..transfer import MOVED_STATIC, OTHER_BODIES
from .edits import clock, edited_since
from .packing import ShapeRecord, read, read_surface

if TYPE_CHECKING:
    from .world import World


class Patched(NamedTuple):
    """What a patch has changed."""

    elasticity: bool  # of a shape from below 1 to 1 or more, or back
    reach: bool  # filters or radii
    moved: bool  # static bodies


def patch(world: World, surfaces: bool) -> Patched | None:
    """Write all edits since the world was read into its rows, as if no step had been taken since. Where there are
    joints, bodies keep the results of earlier steps. No shapes were added or removed.

    Args:
        surfaces: whether only edits may be patched that leave sizes, masses and places unchanged.

    Returns:
        what was changed; None if a new reading is needed: the rows are then invalid.

    Raises:
        ValueError, UnsupportedFeature, NotFiniteError: as a new reading would.
    """
    now, edited, joints = clock(), edited_since(world.read_at), world.joints
    constraints = [] if joints is None else joints.items
    if edited is None or world.frictionless or list(world.space.constraints) != constraints:
        return None
    (stale, reshaped), elasticity, reach, bodies = edited, False, False, world.bodies
    records: dict[pymunk.Shape, ShapeRecord] = {}
    for shape in [thing for thing in stale if thing in world.records]:
        record = world.records[shape]
        if record is None or record.outside or shape.sensor:
            return None
        records[shape] = new = read(shape) if shape in reshaped else read_surface(shape, record)
        if (new.body, new.points) != (record.body, record.points):
            return None
        resized = new.numbers[0] != record.numbers[0]
        if resized and surfaces:
            return None
        reach |= resized or new.filter != record.filter
        elasticity |= (new.numbers[1] < 1.0) != (record.numbers[1] < 1.0)
    masses: dict[int, bytes] = {}
    for i in [bodies.row[thing] for thing in stale if thing in bodies.row]:
        values, others_changed = bodies.changed(i)
        if others_changed:
            return None
        if values is not None:
            masses[i] = values
    world.gather()
    status = world.copy_start()
    moved = status == MOVED_STATIC
    if status == OTHER_BODIES or not (stale or moved) or (surfaces and (masses or moved)):
        return None
    if status != 0:
        bodies.check_finite(world.state)
    bodies.set_masses(masses)
    world.records.update(records)
    if not world.packed.write_again(world.records, records, moved):
        return None
    world.read_at, world.objects_read = now, world.objects_read + len(records) + len(masses)
    if joints is None:
        world.forget_last_end()
    else:
        joints.refresh()
    return Patched(elasticity, reach, moved)
