"""What the array steppers share: gather -> detect -> solve -> scatter over a pymunk space."""

from __future__ import annotations

import warnings
from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .arrays import FloatArray
from .closures.motion import Motion, Start
from .errors import NotFiniteError, UnsupportedFeature
from .report import StepReport
from .space.bodies import ANGLE, ANGULAR_VELOCITY, FORCE, POSITION, TORQUE, VELOCITY, Bodies
from .space.checks import check_ignored, check_space
from .space.hooks import Hooks, Rehearsal
from .space.shapes import Shapes
from .space.sync import rest_step
from .space.twin import MarginTwin
from .stepper import Stepper, check_dt

if TYPE_CHECKING:
    import pymunk

_OVERFLOW = "the step would overflow; take a smaller dt, or stop this run"


class ArrayStepper(Stepper):
    """A stepper that replaces pymunk's solver; subclasses say how bodies move, in `advance`.

    `centred_disks` tells whether nothing else may move.

    Args:
        space: any pymunk space.
        sync: bring pymunk's own shapes and broad phase up to date after each step, for its queries and drawing, and
            run its post-step callbacks. False saves that time; `space.reindex_shapes_for_body(body)` does the first
            for one body. With collision handlers they are always called.
        ignore: what to step on without: "friction" is all there is to ignore. A warning says so once.
    """

    centred_disks = True

    def __init__(self, space: pymunk.Space, *, sync: bool = True, ignore: Sequence[str] = ()) -> None:
        super().__init__(space)
        self.sync = sync
        self.ignore = check_ignored(ignore)
        self._warned = False
        self._twin: MarginTwin | None = None
        self._gather()

    def __getstate__(self) -> dict[str, object]:
        # Original and copy go on from the same: without what was remembered of earlier steps.
        self._twin = None
        return self.__dict__.copy()

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
        bodies, hooks = twin.bodies, Hooks(self.space, twin.bodies)
        rehearsal: Rehearsal | None = None
        try:
            start = self._start(bodies, state, dt, hooks)
            if not np.isfinite(start.free_displacement).all():
                raise NotFiniteError(f"a body would move an infinite distance within dt = {dt}: {_OVERFLOW}")
            if hooks.collisions:
                rehearsal = Rehearsal(self.space, hooks, state)
                after = rehearsal.run(self._moved(bodies, state, start, start.free_displacement), dt)
                start = self._start(bodies, rehearsal.before, dt, hooks)
                twin.shapes.rules = rehearsal.rules(twin.shapes.items, twin.shapes.elasticity)
            motion = self.advance(bodies, start, twin)
            began = state if rehearsal is None else rehearsal.before
            end = self._end(bodies, began, start, motion, dt, hooks)
            if rehearsal is not None:
                end += after
            bodies.check_finite(end, _OVERFLOW)
            self._scatter(bodies, end, dt, hooks)
        except BaseException:
            bodies.scatter(state)
            raise
        self.time = motion.report.time
        if rehearsal is not None:
            rehearsal.finish(bodies)
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
        shapes = Shapes(self.space, bodies, self.ignore)
        if not (shapes.smooth or self._warned):
            self._warned = True
            warnings.warn(f"{type(self).__name__} steps on without the friction of this space", stacklevel=4)
        if shapes.general and self.centred_disks:
            i = int(np.argmax(shapes.turning))
            raise UnsupportedFeature(
                f"{shapes.items[i]} of {bodies.items[shapes.row[i]]} moves and is not a disk about the centre of mass "
                f"of a dynamic body, which is all that {type(self).__name__} moves here; use ep.EECA(space)"
            )
        self._twin = MarginTwin(bodies, shapes, state)
        return self._twin, state

    @np.errstate(over="ignore", invalid="ignore")  # what overflows is refused before it is written
    def _start(self, bodies: Bodies, state: FloatArray, dt: float, hooks: Hooks | None = None) -> Start:
        general = self._twin is not None and self._twin.shapes.general
        gravity = self.space.gravity
        columns = slice(FORCE.start, TORQUE + 1) if general else FORCE
        acceleration = state[:, columns] * bodies.mobility(general)
        if any(gravity):
            acceleration[:, :2] += bodies.dynamic[:, None] * np.array(gravity)
        columns = slice(VELOCITY.start, ANGULAR_VELOCITY + 1) if general else VELOCITY
        velocity = state[:, columns] * ~bodies.static[:, None]
        if hooks is not None:
            velocity *= self._damping(bodies, hooks, dt)
            if len(hooks.velocity):
                # What the user's function makes of a velocity within the step, spread over it.
                acceleration[hooks.velocity] = hooks.change(dt)[:, : acceleration.shape[1]] / dt
        position = bodies.poses(state, general)
        return Start(self.time + dt, dt, position, velocity, acceleration, bool(acceleration.any()))

    def _damping(self, bodies: Bodies, hooks: Hooks, dt: float) -> FloatArray | float:
        """What is left of velocities (N, 1) after half a step: before and after the motion it is second order."""
        left = self.space.damping ** (0.5 * dt)
        return 1.0 if left == 1.0 else np.where(bodies.dynamic & ~hooks.steered, left, 1.0)[:, None]

    def _moved(self, bodies: Bodies, state: FloatArray, start: Start, displacement: FloatArray) -> FloatArray:
        """The (N, 9) state with its bodies displaced (N, d)."""
        end = state.copy()
        if start.position.shape[1] == 3:
            pose = start.position + displacement
            end[:, POSITION], end[:, ANGLE] = bodies.positions(pose), pose[:, 2]
        else:
            end[:, POSITION] += displacement
        return end

    def _end(
        self, bodies: Bodies, state: FloatArray, start: Start, motion: Motion, dt: float, hooks: Hooks
    ) -> FloatArray:
        """The (N, 9) state at the end of the step; forces are reset as pymunk does."""
        end = self._moved(bodies, state, start, motion.displacement)
        end[:, VELOCITY] = motion.velocity[:, :2]
        if start.position.shape[1] == 3:
            end[:, ANGULAR_VELOCITY] = motion.velocity[:, 2]
        elif _turns(state):
            turn(end, bodies, dt)
        end[:, VELOCITY.start : ANGULAR_VELOCITY + 1] *= self._damping(bodies, hooks, dt)
        if len(hooks.position):
            hooks.positions(state, end, dt)
        end[:, FORCE] = 0.0
        end[:, TORQUE] = 0.0
        end[bodies.static] = state[bodies.static]
        return end

    def _scatter(self, bodies: Bodies, end: FloatArray, dt: float, hooks: Hooks) -> None:
        """Write the end of the step, and bring pymunk's shapes there."""
        if hooks.collisions or not self.sync:
            bodies.scatter(end, unchanged=True)
            return
        still = end.copy()
        still[:, VELOCITY] = 0.0
        still[:, ANGULAR_VELOCITY] = 0.0
        bodies.scatter(still, unchanged=True)
        with hooks.silent():
            rest_step(self.space, dt)
        bodies.scatter(end)

    @property
    def model(self) -> str:
        twin, state = self._gather()
        shapes = twin.shapes
        walls = len(shapes.walls.start)
        start = self._start(twin.bodies, state, 0.0)
        others = int(np.count_nonzero(shapes.turning))
        parts = [
            f"{int(np.count_nonzero(shapes.is_disk))} disks" + (f", {others} other moving shapes" if others else ""),
            f"{walls} walls",
            "gravity or forces" if start.pulled else "no forces",
            "rotation with contact arms" if others else "free rotation" if _turns(state) else "no rotation",
            "loss" if shapes.lossy else "elastic",
        ]
        parts[:2] = [", ".join(parts[:2])]
        hooks = Hooks(self.space, twin.bodies)
        if self.space.damping != 1.0:
            parts.append("damping")
        if len(hooks.velocity) or len(hooks.position):
            parts.append("functions of bodies")
        if hooks.collisions:
            parts.append("collision handlers, by a rehearsal")
        return "; ".join(parts)


def _turns(state: FloatArray) -> bool:
    """Whether any body of an (N, 9) state turns or is made to."""
    return bool(state[:, ANGULAR_VELOCITY].any() or state[:, TORQUE].any())


def turn(end: FloatArray, bodies: Bodies, dt: float) -> None:
    """Advance angles and angular velocities of an (N, 9) state by dt; contacts of centred disks have no arm."""
    turning = dt * end[:, TORQUE] * bodies.inverse_moment
    end[:, ANGLE] += dt * (end[:, ANGULAR_VELOCITY] + 0.5 * turning)
    end[:, ANGULAR_VELOCITY] += turning
