"""What the array steppers share: gather -> detect -> solve -> scatter over a pymunk space."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np
import pymunk

from .bodies import ANGLE, ANGULAR_VELOCITY, FORCE, POSITION, TORQUE, VELOCITY, Bodies, FloatArray
from .checks import check_bodies, check_space
from .contacts import ROUND_OFF, Geometry, Pairs, distance_from_axes, length
from .detection import MarginTwin
from .errors import NotFiniteError, UnsupportedFeature
from .shapes import Shapes
from .stepper import Stepper, StepReport, check_dt

_OVERFLOW = "the step would overflow; take a smaller dt, or stop this run"


@dataclass(frozen=True)
class Start:
    """The N bodies at the start of a step: position, velocity and acceleration (N, d), the last with gravity.

    d = 2 where bodies are centred disks and contacts have no arms. d = 3 otherwise: centres of mass, and the angle with
    its derivatives.

    `time` is that of the end of the step; `pulled` tells whether anything accelerates.
    """

    time: float
    dt: float
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    pulled: bool

    def at(self, time: float) -> FloatArray:
        """(N, d) positions on the free flight at one instant."""
        way = self.position + time * self.velocity
        return way + (0.5 * time * time) * self.acceleration if self.pulled else way

    @property
    def free_velocity(self) -> FloatArray:
        """(N, d) velocity at the end of the free flight."""
        return self.velocity + self.dt * self.acceleration if self.pulled else self.velocity.copy()

    @property
    def free_displacement(self) -> FloatArray:
        """(N, d) displacement of the free flight over the step."""
        with np.errstate(over="ignore", invalid="ignore"):  # refused before anything is made of it
            way = self.dt * self.velocity
            return way + (0.5 * self.dt**2) * self.acceleration if self.pulled else way


@dataclass(frozen=True)
class Motion:
    """Velocity and displacement (N, d) of all bodies over a step, and its report."""

    velocity: FloatArray
    displacement: FloatArray
    report: StepReport


class ArrayStepper(Stepper):
    """A stepper that replaces pymunk's solver; subclasses say how bodies move, in `advance`.

    `centred_disks` tells whether nothing else may move.

    Args:
        space: any pymunk space of disks and static walls.
        sync: bring pymunk's own shapes and broad phase up to date after each step, for its queries and drawing, and
            run its post-step callbacks. False saves that time; `space.reindex_shapes_for_body(body)` does the first
            for one body.
    """

    centred_disks = True

    def __init__(self, space: pymunk.Space, *, sync: bool = True) -> None:
        super().__init__(space)
        self.sync = sync
        self._twin: MarginTwin | None = None
        self._gather()

    def refresh(self) -> None:
        self._twin = None

    @abstractmethod
    def advance(self, bodies: Bodies, start: Start, twin: MarginTwin) -> Motion:
        """Move the bodies over one step; pure arrays, the space is not touched."""

    def step(self, dt: float) -> StepReport:
        dt = check_dt(dt)
        if dt == 0.0:
            return StepReport.without_contacts(self.time)
        twin, state = self._gather()
        start = self._start(twin.bodies, state, dt)
        if not np.isfinite(start.free_displacement).all():
            raise NotFiniteError(f"a body would move an infinite distance within dt = {dt}: {_OVERFLOW}")
        motion = self.advance(twin.bodies, start, twin)
        self._scatter(twin.bodies, state, start, motion, dt)
        self.time = motion.report.time
        return motion.report

    def _gather(self) -> tuple[MarginTwin, FloatArray]:
        """The space's state, checked, and the twin that belongs to it."""
        check_space(self.space)
        twin = self._twin
        if twin is not None and twin.shapes.key == list(self.space.shapes):
            state = twin.bodies.gather()
            if state is not None and twin.is_current(state):
                twin.bodies.check_finite(state)
                return twin, state
        bodies = Bodies(self.space)
        state = bodies.gather()
        assert state is not None  # read from these very bodies
        bodies.check_finite(state)
        check_bodies(bodies)
        shapes = Shapes(self.space, bodies)
        if shapes.general and self.centred_disks:
            i = int(np.argmax((shapes.rank == 1) | (shapes.rank == 2)))
            raise UnsupportedFeature(
                f"{shapes.items[i]} of {bodies.items[shapes.row[i]]} moves and is not a disk about the centre of mass "
                f"of a dynamic body, which is all that {type(self).__name__} moves here; use ep.EECA(space)"
            )
        self._twin = MarginTwin(bodies, shapes, state)
        return self._twin, state

    @np.errstate(over="ignore", invalid="ignore")  # what overflows is refused before it is written
    def _start(self, bodies: Bodies, state: FloatArray, dt: float) -> Start:
        general = self._twin is not None and self._twin.shapes.general
        gravity = self.space.gravity
        columns = slice(FORCE.start, TORQUE + 1) if general else FORCE
        acceleration = state[:, columns] * bodies.mobility(general)
        if any(gravity):
            acceleration[:, :2] += bodies.dynamic[:, None] * np.array(gravity)
        columns = slice(VELOCITY.start, ANGULAR_VELOCITY + 1) if general else VELOCITY
        velocity = state[:, columns] * ~bodies.static[:, None]
        position = bodies.poses(state, general)
        return Start(self.time + dt, dt, position, velocity, acceleration, bool(acceleration.any()))

    def _scatter(self, bodies: Bodies, state: FloatArray, start: Start, motion: Motion, dt: float) -> None:
        """Write the end of the step; forces are reset as pymunk does. Restores the state if pymunk refuses."""
        end = state.copy()
        if start.position.shape[1] == 3:
            pose = start.position + motion.displacement
            end[:, POSITION], end[:, ANGLE] = bodies.positions(pose), pose[:, 2]
            end[:, VELOCITY], end[:, ANGULAR_VELOCITY] = motion.velocity[:, :2], motion.velocity[:, 2]
        else:
            end[:, POSITION] += motion.displacement
            end[:, VELOCITY] = motion.velocity
            if _turns(state):
                turn(end, bodies, dt)
        end[:, FORCE] = 0.0
        end[:, TORQUE] = 0.0
        end[bodies.static] = state[bodies.static]
        bodies.check_finite(end, _OVERFLOW)
        try:
            if self.sync:
                still = end.copy()
                still[:, VELOCITY] = 0.0
                still[:, ANGULAR_VELOCITY] = 0.0
                bodies.scatter(still, unchanged=True)
                self._sync(dt)
            bodies.scatter(end, unchanged=not self.sync)
        except BaseException:
            bodies.scatter(state)
            raise

    @property
    def model(self) -> str:
        twin, state = self._gather()
        shapes = twin.shapes
        walls = len(shapes.walls.start)
        start = self._start(twin.bodies, state, 0.0)
        others = int(np.count_nonzero((shapes.rank == 1) | (shapes.rank == 2)))
        parts = [
            f"{int(np.count_nonzero(shapes.is_disk))} disks" + (f", {others} other moving shapes" if others else ""),
            f"{walls} walls",
            "gravity or forces" if start.pulled else "no forces",
            "rotation with contact arms" if others else "free rotation" if _turns(state) else "no rotation",
            "loss" if shapes.lossy else "elastic",
        ]
        parts[:2] = [", ".join(parts[:2])]
        return "; ".join(parts)

    def _sync(self, dt: float) -> None:
        """Let pymunk see the new positions: its own step with everything at rest moves nothing.

        With the real dt, so that `space.current_time_step` is right and a native step may follow: at rest pymunk
        caches no impulse that it would scale by the ratio of the two steps.
        """
        space = self.space
        gravity, iterations, bias = space.gravity, space.iterations, space.collision_bias
        try:
            space.gravity, space.iterations, space.collision_bias = (0.0, 0.0), 1, 1.0
            space.step(dt)
        finally:
            space.gravity, space.iterations, space.collision_bias = gravity, iterations, bias


def _turns(state: FloatArray) -> bool:
    """Whether any body of an (N, 9) state turns or is made to."""
    return bool(state[:, ANGULAR_VELOCITY].any() or state[:, TORQUE].any())


def turn(end: FloatArray, bodies: Bodies, dt: float) -> None:
    """Advance angles and angular velocities of an (N, 9) state by dt; contacts of centred disks have no arm."""
    turning = dt * end[:, TORQUE] * bodies.inverse_moment
    end[:, ANGLE] += dt * (end[:, ANGULAR_VELOCITY] + 0.5 * turning)
    end[:, ANGULAR_VELOCITY] += turning


def flight(start: Start, pairs: Pairs, time: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(m, 2) centres of a and of b on the free flight, every pair at its own (m,) instant."""
    t = time[:, None]
    a, b = (
        start.position[r] + t * start.velocity[r] + (0.5 * t * t) * start.acceleration[r]
        for r in (pairs.row_a, pairs.row_b)
    )
    return a, b


def near_pairs(
    twin: MarginTwin, start: Start, displacement: FloatArray, extra: FloatArray | float = 0.0
) -> tuple[Pairs, Geometry]:
    """The pairs that can meet within the step, and their geometry at its start.

    A body's reach is the length of its free flight and `extra` (N,). Impulses can send it twice as far (an elastic
    hit by a heavier body), which the factor 2 covers for the contacts that impulses close.
    """
    # The path of a thrown body leaves its chord.
    bow = (0.125 * start.dt**2) * length(start.acceleration)
    slack = bow + ROUND_OFF * distance_from_axes(start.position) + extra
    reach = length(displacement) + slack
    pairs = twin.candidates(start.position, displacement, slack)
    before = pairs.at(start.position)
    near = np.flatnonzero(before.gap <= 2.0 * (reach[pairs.row_a] + reach[pairs.row_b]))
    return pairs.take(near), before.take(near)
