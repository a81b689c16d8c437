"""PackedStepper: a step of a space as packed arrays: settings, gather, move, scatter, sync, report."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from math import isfinite
from typing import TYPE_CHECKING, TypeVar

from .arrays import FloatArray
from .energy.ledger import AFTER, DAMPED
from .errors import NotFiniteError
from .packed_space import TOO_FAR, PackedSpace
from .reentry import BUSY, busy, refuse_within
from .report import Details, StepReport
from .space.bodies import ANGULAR_VELOCITY, VELOCITY
from .space.hooks import Hooks, Rehearsal
from .space.sleeping import Sleep
from .space.world import World
from .stepper import check_dt
from .transfer import EVENTS, FORCES, MOVED_STATIC, OTHER_BODIES, fly

if TYPE_CHECKING:
    pass

Own = TypeVar("Own", bound="PackedStepper")


class PackedStepper(PackedSpace):
    """A stepper whose physics is one compiled call on the arrays of a `World`; subclasses say which, in `advance`.

    Args:
        space: any pymunk space.
        sync: bring pymunk's own shapes and broad phase up to date after each step, for its queries and drawing, and
            run its post-step callbacks. False saves that time; `space.reindex_shapes_for_body(body)` does the first
            for one body. With collision handlers they are always called.
        ignore: what to step on without: "friction" is all there is to ignore. A warning says so once.
    """

    def __enter__(self: Own) -> Own:
        """Within `with stepper:` the call `space.step(dt)` of this one space is `stepper.step(dt)`."""
        if "step" in vars(self.space):
            raise ValueError(f"{self.space} has a step of its own already: leave the other `with` first")
        self.space.step = self.step  # type: ignore[method-assign, assignment]
        return self

    def __exit__(self, *_: object) -> None:
        del self.space.step

    @abstractmethod
    def advance(self, world: World, dt: float, left: float) -> int:
        """Move the bodies from `world.STATES` to `world.ENDS`; the space is not touched.

        Args:
            dt: time, > 0.  left: what half the step's damping leaves of velocities.

        Returns:
            the bits EVENTS and FORCES, or a negative code, of `transfer.py`.
        """

    @abstractmethod
    def details(self, world: World, dt: float) -> Details | Callable[[], Details]:
        """The arrays of the report of the step that has just answered EVENTS, or what makes them."""

    def outcome(self) -> tuple[float, bool, int]:
        """Scale of the energy lock of the last step that was farthest from 1, whether all tolerances were met, and the
        iterations of the solver."""
        return 1.0, True, 0

    def step(self, dt: float) -> StepReport:
        if BUSY:
            refuse_within(self.space)
        dt = check_dt(dt)
        if dt == 0.0:
            return StepReport.without_contacts(self.time)
        world = self._world
        if world is None or not world.current():
            world = self._look()
        return self._step(world, dt) if self._sleep is None else self._drowsy_step(self._sleep, world, dt)

    def _drowsy_step(self, sleep: Sleep, world: World, dt: float) -> StepReport:
        """A step of a space whose bodies may sleep."""
        changed = sleep.changed()
        if not changed and sleep.nothing_moves():
            sleep.step(dt)
            self.time += dt
            if self.sync:
                self._sync.call_back()
            return StepReport(self.time, world.empty, book=self._idle_book)
        if changed or (sleep.some and sleep.meet(dt)):
            world = self._look(anew=True)
        report = self._step(world, dt)
        now = self._sleep
        if now is not None and now.world is self._world:
            if now.some:
                now.wake(now.touched(report.contacts))  # by what functions have done
            if now.rest(dt) and now.world.current():
                now.fall_asleep(report.contacts)
        return report

    def _awake(self, world: World, dt: float, left: float, status: int) -> tuple[World, int]:
        """Take the step again, with those awake that it has touched asleep."""
        while self._sleep is not None and self._sleep.some and status >= 0 and status & EVENTS:
            details = self.details(world, dt)
            touched = self._sleep.touched((details if isinstance(details, Details) else details()).contacts)
            if not touched:
                break
            self._sleep.wake(touched)
            world = self._look(anew=True)
            world.gather()
            status = self.advance(world, dt, left)
        return world, status

    def _step(self, world: World, dt: float) -> StepReport:
        """A step of the bodies that are awake."""
        if not world.plain and (world.hooked or (world.joints is not None and world.joints.calls_back())):
            return self._hooked_step(world, dt)
        world.gather()
        left = world.left(dt)
        status = self.advance(world, dt, left)
        if status in (OTHER_BODIES, MOVED_STATIC):
            world = self._look(anew=True)
            world.gather()
            status = self.advance(world, dt, left)
        if self._sleep is not None:
            world, status = self._awake(world, dt, left, status)
        if status < 0:
            self._fail(world, dt, status)
        book = self._booked(dt)
        try:
            if status & FORCES:
                world.reset_forces()
            self.land(world, dt, status)
        except BaseException:
            self._undo(world, world.state)
            raise
        self.time += dt
        report = self._made(world, dt, status, book)
        if not world.plain:
            self._tell_joints(world)
        if self.sync:
            self._sync.call_back()
        return report

    def land(self, world: World, dt: float, status: int) -> None:
        """Write the end of a step to the space."""
        if not self.sync:
            world.scatter(status)
        elif self._sync.reindexes(dt, bool(status & EVENTS)):
            world.scatter(status)
            self._sync.reindex()
        else:
            self._sync.land(world, dt, status)

    def _hooked_step(self, world: World, dt: float) -> StepReport:
        """A step of a space in which functions of bodies or constraints, or collision handlers, are called."""
        with busy(self.space):
            world, report, rehearsal = self._take_hooked(world, dt)
        if rehearsal is not None:
            rehearsal.finish(world.bodies)
        elif self.sync or (world.joints is not None and world.joints.calling):
            self._sync.call_back()
        return report

    def _take_hooked(self, world: World, dt: float) -> tuple[World, StepReport, Rehearsal | None]:
        """All of it but what waits for its end."""
        world.gather()
        if not world.is_current():
            world = self._look(anew=True)
            world.gather()
        bodies, state = world.bodies, world.state.copy()
        bodies.check_finite(state)
        hooks, left = Hooks(self.space, bodies, world.joints), world.left(dt)
        rehearsal: Rehearsal | None = None
        given, lost = world.given(), 0.0
        book: FloatArray | None = None
        try:
            if world.joints is not None:
                world.joints.refresh()
                hooks.before(dt)
                world.gather()
            if len(hooks.velocity):
                world.push(hooks.change(dt), dt)
            if hooks.collisions:
                rehearsal = Rehearsal(self.space, hooks, world.state.copy())
                self._checked(world, dt, self._fly(world, dt, left))
                after = rehearsal.run(world.ended(), dt)
                world.state[:] = rehearsal.before
                world.rules = rehearsal.rules(world.shapes, world.SHAPE, world.smooth)
            world.void_forecasts()
            world.give(given)
            status = self._checked(world, dt, self.advance(world, dt, left))
            book = self._booked(dt)
            given, end = world.given(), world.ended()
            if world.damping == 0.0:
                lost = world.stop(end)
                given[:, VELOCITY], given[:, ANGULAR_VELOCITY] = end[:, VELOCITY], end[:, ANGULAR_VELOCITY]
            if rehearsal is not None:
                end += after
            if len(hooks.position):
                hooks.positions(world.state, end, dt)
            bodies.check_finite(end, TOO_FAR)
            status = status & EVENTS | world.put(end)
            world.reset_forces()
            if world.joints is not None and world.joints.calling:
                world.scatter(status)
                world.joints.write()
                hooks.after(dt)
                if self.sync and rehearsal is None:
                    with hooks.silent():
                        self._sync.settle(bodies, world.joints, dt, bool(status & EVENTS))
            elif not self.sync or rehearsal is not None:
                world.scatter(status)
            elif self._sync.reindexes(dt, bool(status & EVENTS)):
                world.scatter(status)
                self._sync.reindex()
            else:
                with hooks.silent():
                    self._sync.land(world, dt, status)
            # What functions have changed since the step is found next time.
            world.give(given)
        except BaseException:
            self._undo(world, state)
            raise
        self.time += dt
        report = self._made(world, dt, status, book, lost)
        self._tell_joints(world)
        return world, report, rehearsal

    def _booked(self, dt: float) -> FloatArray | None:
        """What the ledger of the step is made of. NotFiniteError, before the space is touched, if the energy is too
        large for a number though positions and velocities are not."""
        book = self.book()
        if book is not None and not isfinite(book[AFTER]):
            self._world = self._past = None
            raise NotFiniteError(f"the energy of the space would be {book[AFTER]} after dt = {dt}: {TOO_FAR}")
        return book

    def _checked(self, world: World, dt: float, status: int) -> int:
        if status < 0:
            self._fail(world, dt, status)
        return status

    @staticmethod
    def _fly(world: World, dt: float, left: float) -> int:
        gx, gy = world.gravity
        return fly(world.STATES, world.WALK, world.EXTRA, world.BODY, world.ENDS, dt, gx, gy, left)

    def _made(self, world: World, dt: float, status: int, book: FloatArray | None, lost: float = 0.0) -> StepReport:
        """The report of the step with this book; `lost` is the energy that damping has taken since."""
        if lost and book is not None:
            book[DAMPED] += lost
            book[AFTER] -= lost
        if not status & EVENTS:
            return StepReport(self.time, world.empty, book=book)
        lock, converged, iterations = self.outcome()
        return StepReport(self.time, self.details(world, dt), iterations, lock=lock, converged=converged, book=book)
