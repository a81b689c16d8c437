"""Edits in place, after which a scene goes on with the results of earlier steps: values are written into the rows, and
the islands at rest that they concern are solved again."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain
from typing import NamedTuple, TypeAlias

import numpy as np

from ..arrays import AnyArray, FloatArray, IntArray
from ..compiled import Table, kernel, nonallocating
from ..compiled.kernels import Kernel
from ..compiled.records import columns
from ..geometry.corners import find_corners
from ..geometry.sides import shapes_of_pair
from ..islands.accounting import flag_pairs
from ..islands.at_rest import disturb
from ..layout import PLACED, SHIFTED
from ..model.bodies import MOBILITY
from ..model.scene import Scene, scene_of
from ..model.shapes import SURFACE_FIELDS
from ..pairs.grid import relist
from ..pairs.rules import allowed, far_apart, may_collide

# Kinds of changes: none; another mass or moment of a body; another elasticity, friction or surface velocity of a shape,
# another filter, or another outline or place, by which results of earlier steps are lost.
SAME, MASS, SURFACE, FILTER, OUTLINE = -1, 0, 1, 2, 3

Changes: TypeAlias = list[tuple[int, int]]  # kind, and row of BODY or SHAPE


def change_words(changes: Changes) -> list[int]:
    """Changes as kernels take them: how many, then kind and row of each."""
    return [len(changes), *chain.from_iterable(changes)]


class Edits(NamedTuple):
    """Values that were edited in place.

    Attributes:
        surfaces: by row of SHAPE: elasticity, friction, surface velocity (2; length/time).
        masses: by row of BODY: 1/mass, 1/moment.
        filters: by row of SHAPE: group, categories, mask. `renew` has to follow.
    """

    surfaces: dict[int, tuple[float, ...]]
    masses: dict[int, tuple[float, ...]]
    filters: dict[int, tuple[int, ...]]


@nonallocating
def disturb_shape(A: Scene, s: int) -> None:
    """Let the islands at rest that shape s touches be solved again."""
    for c in range(A.COUNT.pushes):
        touching = A.PUSHED_BY[c]
        if touching.root >= 0 and (touching.a == s or touching.b == s):
            disturb(A, touching.root)


@nonallocating
def edit_surface(
    table: Table, s: int, elasticity: float, friction: float, surface_x: float, surface_y: float
) -> None:  # fmt: skip
    """Write elasticity, friction and surface velocity (length/time) of shape s."""
    A = scene_of(table)
    shape = A.SHAPE[s]
    shape.elasticity, shape.friction, shape.surface_x, shape.surface_y = elasticity, friction, surface_x, surface_y
    if s < A.COUNT.disks:
        A.BODY[s].elasticity, A.BODY[s].friction = elasticity, friction
    disturb_shape(A, s)


@nonallocating
def edit_mass(table: Table, i: int, inv_mass: float, inv_inertia: float) -> None:
    """Write 1/mass and 1/moment of body i."""
    A = scene_of(table)
    A.BODY[i].inv_mass, A.BODY[i].inv_inertia = inv_mass, inv_inertia
    disturb(A, i)


@nonallocating
def edit_filter(table: Table, s: int, group: int, categories: int, mask: int) -> None:
    """Write the filter of shape s."""
    link = scene_of(table).LINK[s]
    link.group, link.categories, link.mask = group, categories, mask


@nonallocating
def place_beside(A: Scene, STATUS: IntArray) -> None:
    """Let bodies with shapes whose STATUS (k,) is FILTER or OUTLINE, and those that such shapes of bodies without
    mobility may overlap, count as placed by the program; the sides of their other shapes are kept."""
    others = False
    for s in range(A.SHAPE.shape[0]):
        if STATUS[s] != SAME:
            i = A.LINK[s].owner
            others = others or A.BODY[i].inv_mass == 0.0
            if i < A.BODY.shape[0] - 1:
                A.BODY[i].due = min(A.BODY[i].due, PLACED if STATUS[s] == FILTER else SHIFTED)
                disturb(A, i)
    for s in range(A.LIST.shape[0] if others else 0):
        i = A.LINK[s].owner
        for w in range(A.LIST[s].start, A.LIST[s].start + A.LIST[s].number):
            o = int(A.POOL[w])
            changed = STATUS[o] != SAME and A.BODY[A.LINK[o].owner].inv_mass == 0.0
            if changed and not far_apart(A, s, o, A.BODY[i].since, 0.0):
                A.BODY[i].due = min(A.BODY[i].due, PLACED)
                disturb(A, i)


@nonallocating
def disturb_changed(A: Scene, CHANGES: IntArray) -> None:
    """Let the islands at rest be solved again that bodies with another mass belong to, and shapes with another surface
    touch. CHANGES: see `change_words`."""
    for c in range(CHANGES[0]):
        kind, row = CHANGES[1 + 2 * c], CHANGES[2 + 2 * c]
        if kind == MASS:
            disturb(A, row)
        elif kind == SURFACE:
            disturb_shape(A, row)


@nonallocating
def drop_changed(A: Scene, STATUS: IntArray) -> None:
    """Drop the contacts, forces and sides of shapes whose STATUS is OUTLINE, and contacts and sides of pairs that
    filters no longer allow. Islands at rest that lose one are CHANGED."""
    k, pushes = A.SHAPE.shape[0], 0
    for c in range(A.COUNT.pushes):
        a, b, root = A.PUSHED_BY[c].a, A.PUSHED_BY[c].b, A.PUSHED_BY[c].root
        if STATUS[a] != OUTLINE and STATUS[b] != OUTLINE and may_collide(A, a, b):
            A.PUSHED_BY[pushes] = A.PUSHED_BY[c]
            A.PUSHED[pushes] = A.PUSHED[c]
            pushes += 1
            continue
        if root >= 0:
            disturb(A, root)
        disturb(A, A.LINK[a].owner)
        disturb(A, A.LINK[b].owner)
    A.COUNT.pushes = pushes
    for row in range(A.KEYS.shape[0]):
        if A.KEYS[row] >= 0 and A.FORCES[row].stamp >= A.PAR.stamp:
            a, b = shapes_of_pair(k, A.KEYS[row] >> 1)
            if STATUS[a] == OUTLINE or STATUS[b] == OUTLINE:
                A.FORCES[row].stamp = -1.0
    drop_sides(A, STATUS)


@nonallocating
def drop_sides(A: Scene, STATUS: IntArray) -> None:
    """Forget the sides of shapes whose STATUS (k,) is OUTLINE, and of pairs that filters do not allow."""
    for row in range(A.SIDE.shape[0]):
        if A.SIDE[row].key > 0:
            a, b = shapes_of_pair(A.SHAPE.shape[0], A.SIDE[row].key - 1)
            if STATUS[a] == OUTLINE or STATUS[b] == OUTLINE or not allowed(A.LINK, a, b):
                A.SIDE[row].key = -1


@kernel
def renew(TABLE: Table, CHANGES: IntArray) -> bool:
    """Let a scene go on whose rows were changed in place, as another one would that takes over the results of this one.
    False if another one is needed: this one has margin circles, a grid of static shapes, or too small a pool.

    Args:
        CHANGES: see `change_words`; other numbers may follow.
    """
    A = scene_of(TABLE)
    STATUS = np.full(A.SHAPE.shape[0], SAME)
    shaped = False
    for c in range(CHANGES[0]):
        kind, row = CHANGES[1 + 2 * c], CHANGES[2 + 2 * c]
        if kind >= FILTER:
            shaped = shaped or kind == OUTLINE
            STATUS[row] = max(STATUS[row], kind)
    if not relist(A, A.BODY[0].since, shaped):
        return False
    if shaped and A.CORNER.shape[0] > 0:
        find_corners(A.LINK, A.VERTEX, A.CORNER)
    A.FLAG[:] = 0
    A.COUNT.unmet = 0
    A.COUNT.any_placed = 2
    for i in range(A.BODY.shape[0] - 1):
        A.BODY[i].due, A.RESTING[i].rest_due = -1.0, 0.0
    drop_changed(A, STATUS)
    place_beside(A, STATUS)
    disturb_changed(A, CHANGES)
    flag_pairs(A)
    return True


def write_edits(table: Table, edits: Edits) -> None:
    """Write edited values into the rows of a scene, which goes on with the results of earlier steps."""
    found: tuple[tuple[Kernel[..., None], Mapping[int, tuple[float, ...]]], ...]
    found = (edit_surface, edits.surfaces), (edit_mass, edits.masses), (edit_filter, edits.filters)
    for edit, values in found:
        if values:
            write = edit.bind(table)
            for row, numbers in values.items():
                write(row, *numbers)


def values_of(scene: Scene) -> tuple[FloatArray, FloatArray]:
    """(k, 4) and (n, 2) the surfaces of all shapes and the mobilities of all bodies, as in `Edits`."""
    return columns(scene.SHAPE, *SURFACE_FIELDS), columns(scene.BODY, *MOBILITY)


def listed_by(scene: Scene) -> tuple[AnyArray, ...]:
    """What near lists depend on besides places of bodies: filters, radii, and places of static shapes."""
    return columns(scene.LINK, "group", "categories", "mask"), scene.SHAPE["rounding"], scene.BOX


def edits_since(scene: Scene, *then: FloatArray) -> Edits:
    """The present values of a scene that differ from those `then`, a result of `values_of`."""
    surfaces, masses = (
        {int(row): tuple(now[row].tolist()) for row in (now != old).any(axis=1).nonzero()[0]}
        for now, old in zip(values_of(scene), then, strict=True)
    )
    return Edits(surfaces, masses, {})
