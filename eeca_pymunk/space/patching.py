"""Patching: after edits in place the rows of a world are updated without reading the whole space.

Rows are afterwards those that a new reading of the whole space would give, bit by bit: only edited objects are read
again, and all rows are written again in place. This suffices for numbers and filters of shapes, masses and moments of
bodies, and static bodies that were put elsewhere; where there are joints, or bodies may sleep, for numbers and filters
of shapes apart from radii. All else (vertices, kinds and functions of bodies, sensors, what is added and removed) makes
other rows, and is left to a new reading.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import pymunk

from ..transfer import MOVED_STATIC, OTHER_BODIES
from .edits import clock, edited_since
from .packing import Record, read, read_surface

if TYPE_CHECKING:
    from .world import World


class Patched(NamedTuple):
    """Whether a shape has become elastic (e = 1) or is so no more, whether filters or radii have changed, and whether
    static bodies were moved."""

    elasticity: bool
    reach: bool
    moved: bool


def patch(world: World, surfaces: bool) -> Patched | None:
    """Write all edits since the world was read into its rows, as if no step had been taken; joints keep what bodies of
    earlier steps have left. No shapes were added or removed.

    Args:
        surfaces: whether only edits may be patched that leave sizes, masses and places as they were.

    Returns:
        what was changed; None if a new reading is due: the rows are then invalid.

    Raises:
        ValueError, UnsupportedFeature, NotFiniteError: as a new reading would.
    """
    now, edited, joints = clock(), edited_since(world.read_at), world.joints
    constraints = [] if joints is None else joints.items
    if edited is None or world.frictionless or list(world.space.constraints) != constraints:
        return None
    (stale, reshaped), elasticity, reach, bodies = edited, False, False, world.bodies
    records: dict[pymunk.Shape, Record] = {}
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
    weighed: dict[int, bytes] = {}
    for i in [bodies.row[thing] for thing in stale if thing in bodies.row]:
        masses, more = bodies.changed(i)
        if more:
            return None
        if masses is not None:
            weighed[i] = masses
    world.gather()
    status = world.check_start()
    moved = status == MOVED_STATIC
    if status == OTHER_BODIES or not (stale or moved) or (surfaces and (weighed or moved)):
        return None
    if status != 0:
        bodies.check_finite(world.state)
    bodies.set_masses(weighed)
    world.records.update(records)
    if not world.packed.write_again(world.records, records, moved):
        return None
    world.read_at, world.objects_read = now, world.objects_read + len(records) + len(weighed)
    if joints is None:
        world.start_afresh()
    else:
        joints.refresh()
    return Patched(elasticity, reach, moved)
