"""Patching: edits in place put into the rows of a world whose bodies and shapes are otherwise what they were.

Rows are afterwards those that a new reading of the whole space would give, bit by bit: numbers and filters of shapes,
masses and moments of bodies, and static bodies that were put elsewhere. All else (outlines, kinds and functions of
bodies, sensors, joints, what is added and removed) makes other rows, and is left to a new reading.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pymunk

from ..arrays import FloatArray, IntArray
from ..layout import BODY_ROW, LEFT, NOW, PUSH_TWIST, PUSH_X
from ..transfer import MOVED_STATIC, OTHER_BODIES
from .packing import GIVEN, bound, outlines, read, with_normals

if TYPE_CHECKING:
    from .world import World

_NUMBERS = ("friction", "elasticity", "surface_velocity")
_MASSES = ("mass", "moment", "density")
_FILTER = ("group", "categories", "mask")
_NONE: IntArray = np.zeros(0, np.intp)


def patch(world: World) -> bool | None:
    """Put all edits since the world was read into its rows, and have these be as if no step had been taken.

    Returns:
        whether near lists depend on what has changed; None, with nothing done, where rows must be made anew.

    Raises:
        ValueError, UnsupportedFeature, NotFiniteError: as a new reading would.
    """
    edits = world.edits()
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
    if len(moved) and not _move(world, moved):
        return None
    if masses:
        bodies.weigh(weighed)
        rows = world.WALK[BODY_ROW, weighed]
        moving = rows >= 0
        world.fresh["inv_mass"][rows[moving]] = bodies.inverse_mass[weighed][moving]
        world.fresh["inv_inertia"][rows[moving]] = bodies.inverse_moment[weighed][moving]
    if shapes:
        at = np.array([world.places[shape] for shape in shapes])
        _number(world, at, np.array([record.numbers for record in records.values()]))
        if lists:
            filters = np.array([record.filter for record in records.values()], np.uint64).view(np.int64)
            for k, name in enumerate(_FILTER):
                world.LINK[name][at] = filters[:, k]
            world.look_at_filters()
        world.records.update(records)
    _unstep(world)
    return lists or len(moved) > 0


def _number(world: World, at: IntArray, numbers: FloatArray) -> None:
    """Give shapes, rows `at`, these elasticities, frictions and surface velocities."""
    for name in ("elasticity", "friction", "surface_x", "surface_y"):
        world.SHAPE[name][at] = numbers[:, GIVEN.index(name)]
    disks = at[at < world.disks]
    # Row k of a lone disk is that of its shape, too.
    for name in ("elasticity", "friction"):
        world.fresh[name][disks] = world.SHAPE[name][disks]


def _move(world: World, moved: IntArray) -> bool:
    """Put the shapes of static bodies, rows `moved` of STATES, where these are; False if they have other vertices."""
    hit = np.zeros(len(world.bodies), bool)
    hit[moved] = True
    at = np.flatnonzero(hit[world.owner])
    if len(at) == 0:
        return True
    found = [world.records[world.shapes[k]] for k in at.tolist()]
    records = [record for record in found if record is not None]
    vertex, of_shape = outlines(world.bodies, world.state, world.owner[at], records)
    LINK = world.LINK[at]
    count = LINK["vertices"]
    if not np.array_equal(np.bincount(of_shape, minlength=len(at)), count):
        return False
    into = np.concatenate([np.arange(a, a + n) for a, n in zip(LINK["first"].tolist(), count.tolist(), strict=True)])
    SHAPE = world.SHAPE[at]
    LINK["first"] = np.cumsum(count) - count
    placed = with_normals(vertex, LINK)
    bound(placed[:, :2], LINK, SHAPE)
    world.VERTEX[into], world.SHAPE[at] = placed, SHAPE
    ground = len(world.BODY) - 1
    of_ground = world.SHAPE["extent"][world.LINK["owner"] == ground]
    world.fresh["extent"][ground] = of_ground.max(initial=0.0)
    return True


def _unstep(world: World) -> None:
    """Have rows and states as if no step had been taken from where the bodies are."""
    left, static = world.STATES[LEFT], world.bodies.static
    left[:] = np.nan
    left[static] = world.STATES[NOW, static]
    world.EXTRA[:, PUSH_X : PUSH_TWIST + 1] = 0.0
    # To copy records takes ten times as long.
    world.BODY.view(np.int64)[:] = world.fresh.view(np.int64)
