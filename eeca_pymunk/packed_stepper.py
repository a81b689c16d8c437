"""PackedStepper: a step of a space as packed arrays: settings, gather, move, scatter, sync, report."""

from __future__ import annotations

import warnings
from abc import abstractmethod
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from .arrays import FloatArray
from .errors import NotFiniteError
from .layout import ELASTICITY
from .report import StepReport, of_events
from .space.checks import check_ignored
from .space.hooks import Hooks, Rehearsal
from .space.sync import Sync
from .space.world import World
from .stepper import Stepper, check_dt
from .transfer import EVENTS, FORCES, MOVED_STATIC, NOT_FINITE, OTHER_BODIES, OVERFLOW, fly

if TYPE_CHECKING:
    import pymunk

_OVERFLOW = "the step would overflow; take a smaller dt, or stop this run"


class PackedStepper(Stepper):
    """A stepper whose physics is one compiled call on the arrays of a `World`; subclasses say which, in `advance`.

    Args:
        space: any pymunk space.
        sync: bring pymunk's own shapes and broad phase up to date after each step, for its queries and drawing, and
            run its post-step callbacks. False saves that time; `space.reindex_shapes_for_body(body)` does the first
            for one body. With collision handlers they are always called.
        ignore: what to step on without: "friction" is all there is to ignore. A warning says so once.
    """

    def __init__(self, space: pymunk.Space, *, sync: bool = True, ignore: Sequence[str] = ()) -> None:
        super().__init__(space)
        self.sync = sync
        self.ignore = check_ignored(ignore)
        self._warned = False
        self._world: World | None = None
        self._look()

    def __getstate__(self) -> dict[str, object]:
        # Original and copy go on from the same: without what was remembered of earlier steps.
        self._world = None
        state = self.__dict__.copy()
        state.pop("_sync", None)
        return state

    def refresh(self) -> None:
        self._world = None

    def prepare(self, world: World) -> None:
        """Make what the stepper keeps about a world that was read anew."""

    @abstractmethod
    def advance(self, world: World, dt: float, left: float) -> int:
        """Move the bodies from `world.STATES` to `world.ENDS`; the space is not touched.

        Args:
            dt: time, > 0.  left: what half the step's damping leaves of velocities.

        Returns:
            the bits EVENTS and FORCES, or a negative code, of `transfer.py`.
        """

    def events(self, world: World) -> FloatArray:
        """(m, 10) EVENT rows of the step that has just answered EVENTS, a copy."""
        raise NotImplementedError

    def step(self, dt: float) -> StepReport:
        dt = check_dt(dt)
        if dt == 0.0:
            return StepReport.without_contacts(self.time)
        world = self._world
        if world is None or not world.current():
            world = self._look()
        if world.hooked:
            return self._hooked_step(world, dt)
        world.gather()
        left = 1.0 if world.damping == 1.0 else world.damping ** (0.5 * dt)
        status = self.advance(world, dt, left)
        if status in (OTHER_BODIES, MOVED_STATIC):
            self._world = None
            world = self._look()
            world.gather()
            status = self.advance(world, dt, left)
        if status < 0:
            self._fail(world, dt, status)
        try:
            if status & FORCES:
                world.reset_forces()
            if not self.sync:
                world.scatter(status)
            elif self._sync.reindexes(dt):
                world.scatter(status)
                self._sync.reindex()
            else:
                self._rest(world, dt, status)
        except BaseException:
            self._undo(world, world.state)
            raise
        self.time += dt
        if status & EVENTS:
            return self._report(world, dt)
        return StepReport(self.time, world.empty)

    def _rest(self, world: World, dt: float, status: int) -> None:
        """Write the end of the step with a rest step at it."""
        world.scatter_still(status)
        end = world.ended() if self._sync.calls_back() else None
        self._sync.rest(dt)
        if end is not None:
            # Callbacks may have added or removed bodies, so that rows are not theirs any more.
            world.bodies.scatter(end)
        else:
            world.scatter_speed(status)

    def _undo(self, world: World, state: FloatArray) -> None:
        """Put the space back where it was."""
        self._world = None
        world.bodies.scatter(state)

    def _hooked_step(self, world: World, dt: float) -> StepReport:
        """A step of a space in which functions of bodies or collision handlers are called."""
        world.gather()
        if not world.is_current():
            self._world = None
            world = self._look()
            world.gather()
        bodies, state = world.bodies, world.state.copy()
        bodies.check_finite(state)
        hooks, left = Hooks(self.space, bodies), world.damping ** (0.5 * dt)
        rehearsal: Rehearsal | None = None
        try:
            if len(hooks.velocity):
                world.push(hooks.change(dt), dt)
            if hooks.collisions:
                rehearsal = Rehearsal(self.space, hooks, state)
                self._checked(world, dt, self._fly(world, dt, left))
                after = rehearsal.run(world.ended(), dt)
                world.state[:] = rehearsal.before
                world.rules = rehearsal.rules(world.shapes, world.SHAPE[:, ELASTICITY])
            world.forget()
            status = self._checked(world, dt, self.advance(world, dt, left))
            end = world.ended()
            if rehearsal is not None:
                end += after
            if len(hooks.position):
                hooks.positions(world.state, end, dt)
            bodies.check_finite(end, _OVERFLOW)
            status = status & EVENTS | world.put(end)
            world.forget()
            world.reset_forces()
            if not self.sync or rehearsal is not None:
                world.scatter(status)
            elif self._sync.reindexes(dt):
                world.scatter(status)
                self._sync.reindex()
            else:
                with hooks.silent():
                    self._rest(world, dt, status)
        except BaseException:
            self._undo(world, state)
            raise
        self.time += dt
        report = self._report(world, dt) if status & EVENTS else StepReport(self.time, world.empty)
        if rehearsal is not None:
            rehearsal.finish(bodies)
        return report

    def _checked(self, world: World, dt: float, status: int) -> int:
        if status < 0:
            self._fail(world, dt, status)
        return status

    @staticmethod
    def _fly(world: World, dt: float, left: float) -> int:
        gx, gy = world.gravity
        return fly(world.STATES, world.WALK, world.EXTRA, world.BODY, world.ENDS, dt, gx, gy, left)

    def _report(self, world: World, dt: float) -> StepReport:
        details = partial(of_events, self.events(world), dt, world.bodies.items, world.owner)
        return StepReport(self.time, details)

    def _look(self) -> World:
        """The space as it is now, checked."""
        world = self._world
        if world is not None and world.same_contents():
            world.read_settings()
            return world
        self._world = None
        world = World(self.space, self.ignore)
        if not (world.smooth or self._warned):
            self._warned = True
            warnings.warn(f"{type(self).__name__} steps on without the friction of this space", stacklevel=4)
        self._sync = Sync(self.space, world.bodies)
        self.prepare(world)
        self._world = world
        return world

    def _fail(self, world: World, dt: float, status: int) -> None:
        """Raise what a negative answer means."""
        self._world = None
        if status == NOT_FINITE:
            world.bodies.check_finite(world.state)
        if status == OVERFLOW:
            world.bodies.check_finite(world.ended(), _OVERFLOW)
        raise NotFiniteError(f"a body would move an infinite distance within dt = {dt}: {_OVERFLOW}")
