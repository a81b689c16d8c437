"""Which rows of a world are those of an earlier one, so that results of earlier steps hold for them."""

from __future__ import annotations

from itertools import repeat
from operator import is_
from typing import TYPE_CHECKING

from ..impacts.edits import FILTER, MASS, OUTLINE, SURFACE, Changes
from ..impacts.taking_over import Kept
from ..layout import BODY_ROW, READ, WRITTEN
from .packing import ShapeRecord

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
