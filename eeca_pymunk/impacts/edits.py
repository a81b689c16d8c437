"""Edits in place that keep the results of earlier steps: values of shapes and bodies are written into the rows, and the
islands at rest that they concern are solved again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ..arrays import FloatArray
from ..compiled import Table, nonallocating
from ..compiled.records import columns
from ..model.bodies import AT_REST, CHANGED, MOBILITY
from ..model.scene import Scene, scene_of
from ..model.shapes import SURFACE


class Edits(NamedTuple):
    """Values that were edited in place.

    Attributes:
        surfaces: by row of SHAPE: elasticity, friction, surface velocity (2; length/time).
        masses: by row of BODY: 1/mass, 1/moment.
    """

    surfaces: Mapping[int, tuple[float, ...]]
    masses: Mapping[int, tuple[float, ...]]


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
    for c in range(A.COUNT.pushes):
        touching = A.PUSHED_BY[c]
        if touching.root >= 0 and (touching.a == s or touching.b == s):
            A.MEMBER[touching.root].rest = CHANGED


@nonallocating
def edit_mass(table: Table, i: int, inv_mass: float, inv_inertia: float) -> None:
    """Write 1/mass and 1/moment of body i."""
    A = scene_of(table)
    A.BODY[i].inv_mass, A.BODY[i].inv_inertia = inv_mass, inv_inertia
    if A.MEMBER[i].rest == AT_REST:
        A.MEMBER[A.STATE[i].island].rest = CHANGED


def write_edits(table: Table, edits: Edits) -> None:
    """Write edited values into the rows of a scene, which goes on with the results of earlier steps."""
    for kernel, found in ((edit_surface, edits.surfaces), (edit_mass, edits.masses)):
        if found:
            write = kernel.bind(table)
            for row, numbers in found.items():
                write(row, *numbers)


def values_of(scene: Scene) -> tuple[FloatArray, FloatArray]:
    """(k, 4) and (n, 2) the values of all shapes and bodies that `Edits` may have."""
    return columns(scene.SHAPE, *SURFACE), columns(scene.BODY, *MOBILITY)


def edits_since(scene: Scene, *then: FloatArray) -> Edits:
    """The present values of a scene that differ from those `then`, a result of `values_of`."""
    surfaces, masses = (
        {int(row): tuple(now[row].tolist()) for row in (now != old).any(axis=1).nonzero()[0]}
        for now, old in zip(values_of(scene), then, strict=True)
    )
    return Edits(surfaces, masses)
