"""Energy of the bodies of a scene."""

from __future__ import annotations

from ..arrays import IntArray
from ..compiled import nonallocating
from ..layout import BODY_ROW, SPECIAL, STEERED
from ..model.scene import Scene
from .single import kinetic


@nonallocating
def total(A: Scene) -> float:
    """Kinetic energy of all bodies, and potential energy -m g.x in uniform gravity, without bodies that impulses do not
    move."""
    BODY, gx, gy, whole = A.BODY, A.PAR.gravity_x, A.PAR.gravity_y, 0.0
    for i in range(BODY.shape[0] - 1):
        if BODY[i].inv_mass != 0.0:
            whole += kinetic(BODY, i) - (gx * BODY[i].x + gy * BODY[i].y) / BODY[i].inv_mass
    return whole


@nonallocating
def unsteered(A: Scene, WALK: IntArray) -> float:
    """Kinetic energy of the bodies that the space's damping acts on: those without a velocity function of the
    program."""
    whole = 0.0
    for k in range(WALK.shape[1]):
        i = WALK[BODY_ROW, k]
        if i >= 0 and not WALK[SPECIAL, k] & STEERED:
            whole += kinetic(A.BODY, i)
    return whole
