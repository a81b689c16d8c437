"""Kernels of edits in place that keep the results of earlier steps: each writes the values of a shape or body, and lets
the islands at rest that they concern be solved again."""

from __future__ import annotations

from ..compiled import Table, nonallocating
from ..model.bodies import AT_REST, CHANGED
from ..model.scene import scene_of


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
