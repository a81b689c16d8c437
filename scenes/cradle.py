"""Newton's cradle (paper section 6.3, Table III, Fig. 11): disk a hits the resting disks b and c in a line."""

from __future__ import annotations

import numpy as np
import pymunk

from .scene import FloatArray, Scene, add_disk

RADIUS, SPEED = 0.05, 1.0
# Velocities after the impact of a (paper section 6.3, from its reference [11]).
EXACT_VELOCITY = {"i": (-1 / 3, 2 / 3, 2 / 3), "ii": (0.0, 0.0, 1.0)}


def build(hypothesis: str = "i", dt: float = 0.00025, separation: float = 0.002) -> Scene:
    """Unit masses, diameter 10 cm, v_a = 1 m/s, K = 1e7 N/m.

    Hypothesis i: b and c touch, and a touches b at t = 0, so that the impact is simultaneous. Hypothesis ii: b and c
    are `separation` (m) apart, a twice that from b, so that the impacts follow each other.
    """
    if hypothesis not in EXACT_VELOCITY:
        raise ValueError(f"hypothesis = {hypothesis!r}: choose 'i' (b and c touch) or 'ii' (separated)")
    if hypothesis == "ii" and not separation > 0:
        raise ValueError(f"separation = {separation}: give a length > 0")
    gap = separation if hypothesis == "ii" else 0.0
    x = np.array([-2 * RADIUS - 2 * gap, 0.0, 2 * RADIUS + gap])
    space = pymunk.Space()
    bodies = [
        add_disk(space, (float(xi), 0.0), RADIUS, velocity=(SPEED if i == 0 else 0.0, 0.0)) for i, xi in enumerate(x)
    ]

    def exact(t: float) -> FloatArray:
        moved = np.zeros(3)
        if hypothesis == "i":
            moved[:] = np.array(EXACT_VELOCITY["i"]) * SPEED * t
        else:
            # The disk that moves carries the speed of a: a until 2 gap, b for one gap more, then c.
            s = SPEED * t
            moved[:] = min(s, 2 * gap), np.clip(s - 2 * gap, 0.0, gap), max(s - 3 * gap, 0.0)
        return np.stack((x + moved, np.zeros(3)), axis=1)

    parameters = {"hypothesis": hypothesis, "dt": dt, "separation": gap}
    return Scene("cradle", space, bodies, dt, 0.01, 1e7, exact, parameters)
