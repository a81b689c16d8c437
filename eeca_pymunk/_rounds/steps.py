"""A step of `TimeOfImpact` in rounds, split into parts where its list of pairs would get too long."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..arrays import FloatArray
from ..closures.motion import Motion, Start
from ..space.bodies import Bodies
from ..space.twin import MarginTwin
from .contacts import ROUND_OFF
from .features import distance_from_axes, length
from .impacts import Log
from .rounds import Rounds

_CROWD, _MEETINGS, _PARTS = 200, 60.0, 10_000  # moving bodies from which a step is split, by what, and at most


def advance(bodies: Bodies, start: Start, twin: MarginTwin, max_rounds: int) -> Motion:
    log = Log(bodies, start)
    parts = _parts(bodies, start, twin)
    if parts == 1:
        velocity, displacement = _part(bodies, start, twin, log, max_rounds)
    else:
        position, velocity = start.position, start.velocity
        dt = start.dt / parts
        for _ in range(parts):
            now = replace(start, dt=dt, position=position, velocity=velocity)
            velocity, moved = _part(bodies, now, twin, log, max_rounds)
            position = position + moved
            log.offset += dt
        displacement = position - start.position
    return Motion(velocity, displacement, log.report(twin.shapes))


def _part(bodies: Bodies, start: Start, twin: MarginTwin, log: Log, max_rounds: int) -> tuple[FloatArray, FloatArray]:
    """Velocities and displacements (N, 2) of a step or a part of one."""
    displacement = start.free_displacement
    slack = ROUND_OFF * distance_from_axes(start.position)
    if start.pulled:
        # The path of a thrown body leaves its chord.
        slack += (0.125 * start.dt**2) * length(start.acceleration)
    pairs = twin.candidates(start.position, displacement, slack)
    if len(pairs) == 0:
        log.windows += 1
        return start.free_velocity, displacement
    return Rounds(bodies, start, twin, pairs, slack, log).run(max_rounds)


def _parts(bodies: Bodies, start: Start, twin: MarginTwin) -> int:
    """How many parts the step is taken in: so many that the list of pairs stays affordable.

    Of N disks spread over an area S every one can meet about N pi (2 r + 2 m)^2 / S others, m the mean way of a step.
    """
    moving = np.flatnonzero(bodies.dynamic)
    if len(moving) < _CROWD:
        return 1
    way = float(length(start.free_displacement)[moving].mean())
    box = (float(np.ptp(start.position[:, k][moving])) + 2.0 * way for k in (0, 1))
    area = math.prod(box)
    # The way at which a disk can meet as many others as are worth one look.
    most = math.sqrt(_MEETINGS * area / (math.pi * len(moving)))
    return max(1, min(math.ceil(2.0 * way / most), _PARTS)) if most > 0.0 else 1
