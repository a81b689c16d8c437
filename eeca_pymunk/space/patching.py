"""Patching: after edits in place the rows of a world are updated without reading the whole space.

Only edited objects are read again, and their rows, or all, are written in place: afterwards these are those that a new
reading would give, bit by bit. Which edits can be patched, by which function:

| function | space | edits | results of earlier steps |
|---|---|---|---|
| `patch_values` | any | elasticity, friction, surface velocity | kept |
| | without joints | masses and moments of bodies | kept |
| `patch_rows` | without joints and sleeping | also filters, radii, moved static bodies | forgotten |
| | with joints, or where bodies may sleep | also filters | forgotten, but those of joints |

Where results are kept, the islands at rest that touch what was edited are solved again, and all else goes on as if
nothing had been edited. An edit that gives a shape losses, or takes them away (elasticity 1), is one for `patch_rows`;
so is, where there are joints, one of friction from or to 0: pivots hold disks that have none where they are.

All others (of vertices, kinds and functions of bodies, sensors; additions and removals) need a new reading.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import pymunk

from ..impacts.edits import Edits
from ..layout import BODY_ROW
from ..model.step import MOVED_STATIC, OTHER_BODIES
from .body_values import masses as masses_in
from .edits import Edited, clock, edited_since
from .packing import ShapeRecord, read, read_surface

if TYPE_CHECKING:
    from .world import World


class Patched(NamedTuple):
    """What a patch has changed."""

    elasticity: bool  # of a shape from below 1 to 1 or more, or back
    reach: bool  # filters or radii
    moved: bool  # static bodies


def _edited(world: World) -> Edited | None:
    """The result of `edited_since`; None if there was an edit that cannot be patched."""
    constraints = world.space.constraints
    if world.frictionless or (constraints if world.joints is None else list(constraints) != world.joints.items):
        return None
    return edited_since(world.read_at)


def _is_kept(new: ShapeRecord, old: ShapeRecord, jointed: bool) -> bool:
    """Whether results of earlier steps hold, apart from those at rest, for a shape with this other surface."""
    (_, e, mu, *_), (_, e0, mu0, *_) = new.numbers, old.numbers
    return (e < 1.0) == (e0 < 1.0) and not (jointed and (mu > 0.0) != (mu0 > 0.0))


def patch_values(world: World) -> Edits | None:
    """Read edited surfaces and masses again.

    Returns:
        what the event loop must write into the rows; None, with nothing changed, if there were other edits.

    Raises:
        ValueError: as a new reading would.
    """
    now, edited, bodies, jointed = clock(), _edited(world), world.bodies, world.joints is not None
    if edited is None or not edited.values:
        return None
    records: dict[pymunk.Shape, ShapeRecord] = {}
    masses: dict[int, bytes] = {}
    for thing in edited.things:
        if (record := world.records.get(thing)) is not None:
            if record.outside or thing in edited.reshaped:
                return None
            records[thing] = new = read_surface(thing, record)
            if not _is_kept(new, record, jointed):
                return None
        elif thing in world.records:  # a sensor
            return None
        elif thing in bodies.row:
            values, others_changed = bodies.changed(bodies.row[thing])
            if others_changed or jointed:
                return None
            if values is not None:
                masses[bodies.row[thing]] = values
    places = world.places
    surfaces = {places[shape]: record.numbers[1:] for shape, record in records.items()}
    world.records.update(records)
    world.packed.note_edited(records)
    bodies.set_masses(masses)
    mobilities = {int(world.IDS[BODY_ROW, i]): masses_in(values)[2:] for i, values in masses.items()}
    world.read_at, world.objects_read = now, world.objects_read + len(records) + len(masses)
    return Edits(surfaces, mobilities)


def patch_rows(world: World, surfaces: bool) -> Patched | None:
    """Write all edits since the world was read into its rows, as if no step had been taken since. Where there are
    joints, bodies keep the results of earlier steps. No shapes were added or removed.

    Args:
        surfaces: whether only edits may be patched that leave sizes, masses and places unchanged.

    Returns:
        what was changed; None if a new reading is needed: the rows are then invalid.

    Raises:
        ValueError, UnsupportedFeature, NotFiniteError: as a new reading would.
    """
    now, edited, joints = clock(), _edited(world), world.joints
    if edited is None:
        return None
    (stale, reshaped, _), elasticity, reach, bodies = edited, False, False, world.bodies
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
