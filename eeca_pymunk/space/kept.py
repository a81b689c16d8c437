"""Which rows of a world are those of an earlier one, so that results of earlier steps hold for them."""

from __future__ import annotations

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
    for i, j, unedited in world.same_as_before:
        if old_row[j] >= 0:
            bodies[old_row[j]] = row[i]
            if not unedited:
                changes.append((MASS, row[i]))
    bodies[-1] = len(world.BODY) - 1  # the ground
    places, records, before = world.places, world.records, past.records
    now, then = world.STATES[READ, :, :3].tolist(), past.STATES[WRITTEN, :, :3].tolist()
    owner, old_owner = world.owner.tolist(), past.owner.tolist()
    shapes, outlines = [-1] * len(past.shapes), [-1] * len(past.shapes)
    unmoved: dict[int, bool] = {}  # of static bodies
    for s, shape in enumerate(past.shapes):
        if (place := places.get(shape, -1)) < 0:
            continue
        new, old = records[shape], before[shape]
        if new is not old and not same_outline(new, old):
            continue
        # Both are on the same body, row i here and j before.
        i, j = owner[place], old_owner[s]
        here, there = row[i], old_row[j]
        if here < 0 and i not in unmoved:
            unmoved[i] = now[i] == then[j]
        if here < 0 and not unmoved[i]:
            continue
        outlines[s] = place
        if bodies[there] == here if here >= 0 and there >= 0 else here == there:
            shapes[s] = place
            if new is not old and new is not None and old is not None:
                changes += changes_of(place, new, old)
    return Kept(bodies, shapes, outlines, changes)
