"""PackedStepper: a step of a space as packed arrays.

| stage | method |
|---|---|
| have settings, shapes or bodies changed? | `World.current`; if so, `PackedSpace._update_world` |
| read all states | `World.gather` |
| move the arrays | `advance`, by the `Method` of the world |
| if sleeping bodies were touched, wake them and repeat the step | `_repeat_awake` |
| get the ledger's numbers | `_outcome` |
| write the states, and update pymunk's shapes | `write_end` |
| make the report | `_finish` |
| call post-step callbacks | `Sync.call_back` |

Other kinds of steps: `HookedStepper._hooked_step` calls functions of the program; `_silent_step` is that of a space
whose only functions are collision handlers, of which none would be called; `_sleeping_step` is around all of these
where bodies may sleep.
"""

from __future__ import annotations

from math import inf
from typing import TypeVar

from .arrays import AnyArray
from .compiled.records import as_integers
from .hooked_stepper import HookedStepper
from .layout import WRITTEN
from .model.parameters.rest import WAKE_ALL
from .model.step import EVENTS, FORCES, MOVED_STATIC, OTHER_BODIES
from .reentry import CALLING, STEPPING, enter, refuse_within
from .report import Details, StepReport
from .space.sleeping import Sleep
from .space.world import World
from .stepper import check_dt

Own = TypeVar("Own", bound="PackedStepper")


class PackedStepper(HookedStepper):
    """A stepper whose physics is a `Method` on the arrays of a `World`; subclasses make it in `make_method`.

    Args:
        space: any pymunk space.
        sync: update pymunk's own shapes and broad phase, when queries or drawing read them, and call its post-step
            callbacks. False skips both; `space.reindex_shapes_for_body(body)` updates the shapes of one body.
            In spaces with collision handlers the callbacks are called in any case.
        ignore: features to leave out instead of raising UnsupportedFeature; only "friction". Warns once.
    """

    def __enter__(self: Own) -> Own:
        """Within `with stepper:` the call `space.step(dt)` of this one space is `stepper.step(dt)`."""
        if "step" in vars(self.space):
            raise ValueError(f"{self.space} has a step of its own already: leave the other `with` first")
        self.space.step = self.step  # type: ignore[method-assign, assignment]
        return self

    def __exit__(self, *_: object) -> None:
        del self.space.step

    def step(self, dt: float) -> StepReport:
        if CALLING:
            refuse_within(self.space)
        outermost = enter(self.space)
        try:
            dt = float(dt)
            if not 0.0 < dt < inf and check_dt(dt) == 0.0:
                return StepReport.without_contacts(self.time)
            world = self._world
            if world is None or not world.current():
                world = self._update_world()
            return self._step(world, dt) if self._sleep is None else self._sleeping_step(self._sleep, world, dt)
        finally:
            if outermost:
                del STEPPING[self.space]

    def _sleeping_step(self, sleep: Sleep, world: World, dt: float) -> StepReport:
        """A step of a space in which bodies may sleep."""
        changed = sleep.changed()
        if not changed and sleep.nothing_moves():
            sleep.step(dt)
            if world.joints is not None:
                world.joints.go_on(dt)
            self.time += dt
            if self.sync:
                self._sync.call_back()
            return StepReport(self.time, world.without_contacts, book=self._idle_book)
        if other := changed or (sleep.any_asleep and sleep.wake_ahead(dt)):
            world = self._update_world(anew=True)
        report = self._step(world, dt, gathered=not (other or sleep.all_asleep))
        present = self._sleep  # another one if the world was read again
        if present is not None and present.world is self._world and present.rest(dt) and present.world.current():
            present.fall_asleep(report, dt)
        return report

    def rewound(self, world: World) -> list[AnyArray]:
        """The arrays that a step changes and that must be restored before it is repeated."""
        loop = self.event_loop
        left = world.STATES[WRITTEN]
        return [left] if loop is None or not loop.thin else [left, as_integers(loop.scene.SIDE)]

    def _rewound_copy(self, world: World) -> list[AnyArray]:
        """A copy of `rewound`, if the step may have to be repeated."""
        sleepers = self._sleep is not None and self._sleep.any_asleep
        return [array.copy() for array in self.rewound(world)] if sleepers else []

    def _allow(self, left: float) -> None:
        """Let the next attempt at a step spend what is `left` of the step's budgets; half of it while bodies sleep, as
        the step is repeated if these are touched."""
        if (loop := self.event_loop) is not None:
            loop.scene.PAR.share = 0.5 * left if self._sleep is not None and self._sleep.any_asleep else left

    def _repeat_awake(
        self, world: World, dt: float, half_damping: float, status: int, before: list[AnyArray]
    ) -> tuple[World, int]:
        """While the step has touched sleeping bodies, wake these and repeat it; returns the world and status of the
        last repetition. All attempts together spend the budgets of one step; after WAKE_ALL of them all bodies wake. A
        step that then calls functions of the program is left to the caller.

        `before`: a copy of the arrays of `rewound`, made before the step.
        """
        left, tries = 1.0, 0
        while self._sleep is not None and self._sleep.any_asleep and status >= 0 and status & EVENTS:
            if not self.may_touch_sleepers(self._sleep):
                break
            details = self.details(world, dt)
            touched = self._sleep.touched((details if isinstance(details, Details) else details()).contacts)
            if not touched:
                break
            loop, tries = self.event_loop, tries + 1
            left -= 0.0 if loop is None else float(loop.scene.PAR.spent)
            self._sleep.wake(touched if tries < WAKE_ALL else None)
            for array, old in zip(self.rewound(world), before, strict=True):
                array[:] = old
            world = self._update_world(anew=True)
            if self._calls(world):
                if self._sleep is not None and self._sleep.any_asleep and self._sleep.wake_ahead(dt):
                    world = self._update_world(anew=True)
                break
            world.gather()
            self._allow(left)
            before, status = self._rewound_copy(world), self.advance(world, dt, half_damping)
        return world, status

    def _calls(self, world: World) -> bool:
        """Whether a step of a world calls functions of the program."""
        return world.hooked_steps or (world.joints is not None and world.joints.calls_back())

    def _silent_step(self, world: World, dt: float, half_damping: float) -> StepReport:
        """A step that calls none of the functions of a space (`Rehearsal.is_silent_again`)."""
        left_out = world.rehearsal.left_out
        try:
            status = self.advance(world, dt, half_damping)
            if status < 0 and status != OTHER_BODIES:
                self._raise_failure(world, dt, status)
            if status >= 0:
                outcome = self._outcome(world, dt)
                stops = world.damping == 0.0
                bits, lost = self._alter_end(world, dt) if stops else (status if left_out else world.write_whole(), 0.0)
                if status & FORCES:
                    world.reset_forces()
                status = status & EVENTS | bits
                world.scatter(status)
        except BaseException:
            self._undo(world, world.state)  # a rehearsal that was not left out has moved the bodies
            raise
        if status < 0:
            self._undo(world, world.state)
            return self._hooked_step(self._update_world(anew=True), dt)
        report = self._finish(world, dt, status, outcome, lost)
        self._sync.finish_rehearsal(left_out)
        return report

    def _step(self, world: World, dt: float, gathered: bool = False) -> StepReport:
        """A step of the awake bodies, of the kind that the functions of the space require. `gathered`: whether the
        present states were read."""
        half_damping = world.half_damping(dt)
        if not world.plain and self._calls(world):
            known = self._sleep is None and not self.decisions.laws
            if known and world.only_handlers and world.rehearsal.is_silent_again(dt, half_damping, self._sync):
                return self._silent_step(world, dt, half_damping)
            return self._hooked_step(world, dt)
        if not gathered:
            world.gather()
        before = [] if self._sleep is None else self._rewound_copy(world)
        if before:
            self._allow(1.0)
        status = self.advance(world, dt, half_damping)
        if status < 0 and status in (OTHER_BODIES, MOVED_STATIC):
            world = self._update_world(anew=True)
            world.gather()
            before = self._rewound_copy(world)
            if before:
                self._allow(1.0)
            status = self.advance(world, dt, half_damping)
        if self._sleep is not None:
            world, status = self._repeat_awake(world, dt, half_damping, status, before)
            if self._calls(world):
                return self._hooked_step(world, dt)
        if status < 0:
            self._raise_failure(world, dt, status)
        outcome = self._outcome(world, dt)
        try:
            if status & FORCES:
                world.reset_forces()
            self.write_end(world, dt, status)
        except BaseException:
            self._undo(world, world.state)
            raise
        report = self._finish(world, dt, status, outcome)
        if self.sync or (world.joints is not None and world.joints.calls_any()):
            self._sync.call_back()
        return report
