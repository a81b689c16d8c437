"""Patching: after edits in place the rows of a world are updated without reading the whole space.

Only edited objects are read again, and their rows, or all, are written in place: afterwards these are those that a new
reading would give, bit by bit. Which edits can be patched, by which function:

| function | space | edits | rows |
|---|---|---|---|
| `patch_values` | any | elasticity, friction, surface velocity, filter | those edited |
| | without joints | masses and moments of bodies | those edited |
| `patch_rows` | without joints and sleeping | also radii, moved static bodies | all |

All others (of vertices, kinds and functions of bodies, sensors; additions and removals) need a new reading. In either
case results of earlier steps are kept for all that has not changed (`..impacts.taking_over`). `patch_values` does not
even make a new scene; only the islands at rest that touch what was edited are solved again.
"""

from __future__ import annotations

from itertools import repeat
from operator import is_
from typing import TYPE_CHECKING

import pymunk

from ..impacts.edits import FILTER, MASS, OUTLINE, SURFACE, Changes, Edits
from ..impacts.taking_over import Kept
from ..layout import BODY_ROW, FLAGS, MOVED, READ, WRITTEN
from ..model.step import MOVED_STATIC, OTHER_BODIES
from ..model.values import CARRIED
from .body_values import masses as masses_in
from .edits import Edited, clock, edited_since
from .packing import ShapeRecord, read, read_surface

if TYPE_CHECKING:
    from .world import World


def same_outline(new: ShapeRecord | None, old: ShapeRecord | None) -> bool:
    """Whether two records of a shape have the same vertices and radius on the same body."""
    if new is None or old is None:
        return False
    return (new.body, new.points, new.numbers[0]) == (old.body, old.points, old.numbers[0])


def changes_of(row: int, new: ShapeRecord, old: ShapeRecord) -> Changes:
    """The changes of the shape in this row of SHAPE."""
    kinds = (
        (OUTLINE, not same_outline(new, old)),
        (FILTER, new.filter != old.filter),
        (SURFACE, new.numbers != old.numbers),
    )
    return [(kind, row) for kind, changed in kinds if changed]


def kept_rows(world: World, past: World) -> Kept:
    """What a world that was just read has kept of the one before, `past`."""
    row, old_row = world.IDS[BODY_ROW].tolist(), past.IDS[BODY_ROW].tolist()
    bodies, changes = [-1] * len(past.BODY), list[tuple[int, int]]()
    # Of each body before: whether its shapes are where they were on it, and whether in the same role, moving or ground.
    there, alike = [False] * len(old_row), [False] * len(old_row)
    for i, j, unedited in world.same_as_before:
        there[j] = True
        if old_row[j] >= 0:
            bodies[old_row[j]], alike[j] = row[i], True
            if not unedited:
                changes.append((MASS, row[i]))
    bodies[-1] = len(world.BODY) - 1  # the ground
    now, then, place_of = world.STATES[READ], past.STATES[WRITTEN], world.bodies.row
    for j, body in enumerate(past.bodies.items):
        if not there[j] and (i := place_of.get(body, -1)) >= 0:
            there[j] = row[i] >= 0 or now[i, :3].tolist() == then[j, :3].tolist()
            alike[j] = there[j] and row[i] < 0 and old_row[j] < 0
    new, old = list(map(world.records.get, past.shapes)), list(map(past.records.get, past.shapes))
    places, owner = map(world.places.get, past.shapes, repeat(-1)), past.owner.tolist()
    outlines = [place if there[j] else -1 for place, j in zip(places, owner, strict=True)]
    edited = [s for s, same in enumerate(map(is_, new, old)) if not same and outlines[s] >= 0]
    for s in edited:
        if not same_outline(new[s], old[s]):
            outlines[s] = -1
    shapes = [place if alike[j] else -1 for place, j in zip(outlines, owner, strict=True)]
    for s in edited:
        if shapes[s] >= 0 and (one := new[s]) is not None and (other := old[s]) is not None:
            changes += changes_of(shapes[s], one, other)
    return Kept(bodies, shapes, outlines, changes)


def _edited(world: World) -> Edited | None:
    """The result of `edited_since`; None if there was an edit that cannot be patched."""
    constraints = world.space.constraints
    if world.frictionless or (constraints if world.joints is None else list(constraints) != world.joints.items):
        return None
    return edited_since(world.read_at)


def _is_kept(new: ShapeRecord, old: ShapeRecord, jointed: bool) -> bool:
    """Whether a scene may go on with this other record of a shape. A new one is needed if the shape has losses now and
    had none (elasticity 1), or the reverse; and, where there are joints, if friction was or is 0: pivots hold disks
    that have none where they are."""
    now, then = new.numbers, old.numbers
    return (now[1] < 1.0) == (then[1] < 1.0) and not (jointed and (now[2] > 0.0) != (then[2] > 0.0))


def _signed(word: int) -> int:
    """The integer with the bits of 64 that are read as one without sign."""
    return word - (word >> 63 << 64)


def patch_values(world: World) -> Edits | None:
    """Read edited surfaces, filters and masses again.

    Returns:
        what the event loop must write into the rows; None, with nothing changed, if there were other edits.

    Raises:
        ValueError: as a new reading would.
    """
    now, edited, bodies, jointed = clock(), _edited(world), world.bodies, world.joints is not None
    if edited is None or not edited.values:
        return None
    places = world.places
    records: dict[pymunk.Shape, ShapeRecord] = {}
    masses: dict[int, bytes] = {}
    surfaces, filters = {}, {}
    for thing in edited.things:
        if (record := world.records.get(thing)) is not None:
            if record.outside or thing in edited.reshaped:
                return None
            records[thing] = new = read_surface(thing, record)
            if not _is_kept(new, record, jointed):
                return None
            if new.filter != record.filter:
                filters[places[thing]] = tuple([_signed(word) for word in new.filter])
            if new.numbers != record.numbers:
                surfaces[places[thing]] = new.numbers[1:]
        elif thing in world.records:  # a sensor
            return None
        elif thing in bodies.row:
            values, others_changed = bodies.changed(bodies.row[thing])
            if others_changed or jointed:
                return None
            if values is not None:
                masses[bodies.row[thing]] = values
    world.records.update(records)
    world.packed.write_edited(records)
    bodies.set_masses(masses)
    mobilities = {int(world.IDS[BODY_ROW, i]): masses_in(values)[2:] for i, values in masses.items()}
    world.read_at, world.objects_read = now, world.objects_read + len(records) + len(masses)
    return Edits(surfaces, mobilities, filters)


def patch_rows(world: World, surfaces: bool) -> Changes | None:
    """Write all edits since the world was read into its rows. No shapes were added or removed.

    Args:
        surfaces: whether only edits may be patched that leave sizes, masses and places unchanged.

    Returns:
        the changes; None if a new reading is needed.

    Raises:
        ValueError, UnsupportedFeature, NotFiniteError: as a new reading would.
    """
    now, edited, joints, bodies = clock(), _edited(world), world.joints, world.bodies
    if edited is None:
        return None
    stale, reshaped, _ = edited
    records: dict[pymunk.Shape, ShapeRecord] = {}
    for shape in [thing for thing in stale if thing in world.records]:
        record = world.records[shape]
        if record is None or record.outside or shape.sensor:
            return None
        records[shape] = new = read(shape) if shape in reshaped else read_surface(shape, record)
        if (new.body, new.points) != (record.body, record.points):
            return None
        if surfaces and new.numbers[0] != record.numbers[0]:
            return None
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
    places = world.places
    changes = [(MASS, int(world.IDS[BODY_ROW, i])) for i in masses]
    for shape, new in records.items():
        if (old := world.records[shape]) is not None:
            changes += changes_of(places[shape], new, old)
    bodies.set_masses(masses)
    world.records.update(records)
    world.packed.write_edited(records)
    if not world.packed.write_again(moved):
        world.void = True
        return None
    world.read_at, world.objects_read = now, world.objects_read + len(records) + len(masses)
    if moved:
        world.accept_static()
        changes += _moved_shapes(world)
    if joints is not None:
        joints.refresh()
    return changes


def _moved_shapes(world: World) -> Changes:
    """The changes of the shapes of static bodies that were moved, after `accept_static`."""
    flags, first = world.IDS[FLAGS].tolist(), world.packed.totals[CARRIED]  # the rows before have the shapes of others
    return [(OUTLINE, first + k) for k, i in enumerate(world.owner[first:].tolist()) if flags[i] == MOVED]
