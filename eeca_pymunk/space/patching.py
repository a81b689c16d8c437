"""Patching: after edits in place the rows of a world are updated without reading the whole space.

Only edited objects are read again (`patch`), and their rows, or all, are written in place: afterwards these are those
that a new reading would give, bit by bit. Which edits can be patched:

| space | edits | what is written |
|---|---|---|
| any | elasticity, friction, surface velocity, filter | the rows edited |
| without joints | masses and moments of bodies | the rows edited |
| without joints and sleeping | also radii, moved static bodies | all rows |

All others (of vertices, kinds and functions of bodies, sensors; additions and removals) need a new reading. In either
case results of earlier steps are kept for all that has not changed (`..impacts.taking_over`). Where only rows edited
are written there is not even a new scene; only the islands at rest that touch what was edited are solved again.
"""

from __future__ import annotations

from itertools import repeat
from operator import is_
from typing import TYPE_CHECKING

import pymunk

from ..impacts.edits import FILTER, MASS, OUTLINE, SURFACE, Changes, Edits
from ..impacts.taking_over import Kept
from ..layout import BODY_ROW, FLAGS, MOVED, READ, WRITTEN
from ..model.parameters.intervals import INTERVAL_DEPTH_LEAST
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
            way = [abs(x - x0) for x, x0 in zip(now[i, :3].tolist(), then[j, :3].tolist(), strict=True)]
            there[j] = row[i] >= 0 or not any(way)
            alike[j] = there[j] and row[i] < 0 and old_row[j] < 0
            if not there[j] and old_row[j] >= 0:  # asleep, where its function has placed it: see `forget_sides`
                extent = past.BODY[old_row[j]].extent
                there[j] = way[0] + way[1] + way[2] * extent <= INTERVAL_DEPTH_LEAST * extent
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


def patch(world: World, in_values: bool, surfaces: bool) -> Edits | Changes | None:
    """Read what was edited since the world was read. No shapes were added or removed.

    Args:
        in_values: whether no static body may have moved, so that it may be enough to edit values.
        surfaces: whether only edits may be patched that leave sizes, masses and places unchanged.

    Returns:
        the values that the event loop must write into the rows, which are those before; or the changes, after all edits
        were written into the rows; None if a new reading is needed.

    Raises:
        ValueError, UnsupportedFeature, NotFiniteError: as a new reading would.
    """
    now, edited, joints, bodies = clock(), _edited(world), world.joints, world.bodies
    if edited is None:
        return None
    found: dict[pymunk.Shape, tuple[ShapeRecord, ShapeRecord]] = {}  # the records now and before
    masses: dict[int, bytes] = {}
    in_values = in_values and edited.values
    for thing in edited.things:
        if thing in world.records:
            old = world.records[thing]
            if old is None or old.outside or thing.sensor:
                return None
            reshaped = thing in edited.reshaped
            new = read(thing) if reshaped else read_surface(thing, old)
            if (new.body, new.points) != (old.body, old.points):
                return None
            found[thing] = new, old
            in_values = in_values and not reshaped and _is_kept(new, old, joints is not None)
        elif thing in bodies.row:
            values, others_changed = bodies.changed(bodies.row[thing])
            if others_changed:
                return None
            in_values = in_values and joints is None
            if values is not None:
                masses[bodies.row[thing]] = values
    moved = False
    if not in_values:
        if surfaces and (masses or any(new.numbers[0] != old.numbers[0] for new, old in found.values())):
            return None
        world.gather()
        status = world.copy_start()
        moved = status == MOVED_STATIC
        if status == OTHER_BODIES or not (edited.things or moved) or (surfaces and moved):
            return None
        if status != 0:
            bodies.check_finite(world.state)
    edits = Edits({}, {int(world.IDS[BODY_ROW, i]): masses_in(values)[2:] for i, values in masses.items()}, {})
    changes: Changes = [(MASS, row) for row in edits.masses]
    for shape, (new, old) in found.items():
        s = world.places[shape]
        changes += changes_of(s, new, old)
        if new.filter != old.filter:  # 64 bits without sign become an integer with one
            edits.filters[s] = tuple([word - (word >> 63 << 64) for word in new.filter])
        if new.numbers != old.numbers:
            edits.surfaces[s] = new.numbers[1:]
    records = {shape: new for shape, (new, _) in found.items()}
    bodies.set_masses(masses)
    world.records.update(records)
    world.packed.write_edited(records)
    if not (in_values or world.packed.write_again(moved)):
        world.void = True
        return None
    world.read_at, world.objects_read = now, world.objects_read + len(records) + len(masses)
    if in_values:
        return edits
    if moved:
        world.accept_static()
        # The rows before these have the shapes of other bodies.
        flags, first = world.IDS[FLAGS].tolist(), world.packed.totals[CARRIED]
        changes += [(OUTLINE, first + k) for k, i in enumerate(world.owner[first:].tolist()) if flags[i] == MOVED]
    if joints is not None:
        joints.refresh()
    return changes
