"""HookedStepper: the parts of a step that use the method, and steps that call functions of the program."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import isfinite

from .energy.ledger import BOOK_AFTER, BOOK_DAMPING
from .layout import CHANGES_AFTER, WRITTEN
from .model.step import ENERGY, EVENTS, FORCES, MOVED_STATIC, OTHER_BODIES
from .packed_space import TOO_FAR, PackedSpace
from .reentry import FunctionsCalled
from .report import Details, Outcome, StepReport
from .space.joints import JointRows
from .space.private import spaces as private
from .space.sleeping import Sleep
from .space.world import World
from .unmet import Unmet, of_missed


class HookedStepper(PackedSpace):
    """A stepper that moves its arrays by a method, in steps that may call functions of the program; arguments as of
    `PackedStepper`."""

    def adjust(self, world: World, dt: float) -> None:
        """Update the method before a step of a world that is not plain: added, removed and edited joints, and the laws
        of pairs by joints and collision handlers."""
        parted = False
        joints = world.joints
        if joints is not None:
            joints.update(world.state, world.bodies.row, dt)
            self._rejoin(world, joints)
            parted = world.find_parted()
        if parted or world.rules is not self._ruled:
            self._ruled = world.rules
            self._method.rule(world.laws())

    def _rejoin(self, world: World, joints: JointRows) -> None:
        """Plan the components of the joints anew, if these have changed."""
        if joints.replan or joints.ends_moved:
            loop = self.event_loop
            assert loop is not None  # other methods refuse joints
            world.read_states(0.0, 0.0, 1.0)
            loop.rejoin(joints.linkage, joints.replan)
            joints.planned(loop.held)

    def advance(self, world: World, dt: float, half_damping: float) -> int:
        """Move the bodies from `world.STATES` to `world.ENDS`; the space is not touched.

        Args:
            dt: time, > 0.  half_damping: factor of half a step's damping.

        Returns:
            status bits or a negative code of `model/step.py`.
        """
        gx, gy = world.gravity
        joints = world.joints
        if world.rules is not self._ruled or not (joints is None or joints.unchanged(world.state)):
            self.adjust(world, dt)
        return self._method.step(world.reading, dt, gx, gy, half_damping)

    def details(self, world: World, dt: float) -> Details | Callable[[], Details]:
        """The arrays of the report of the last step, whose status had the bit EVENTS, or a function that makes them."""
        return self._method.details(dt, world.bodies.items, world.owner)

    def _hooked_step(self, world: World, dt: float) -> StepReport:
        """A step of a space in which functions of bodies or constraints, or collision handlers, are called."""
        with FunctionsCalled(self.space):
            world, report = self._take_hooked(world, dt)
        if world.collisions:
            self._sync.finish_rehearsal(world.rehearsal.left_out)
        elif self.sync or world.hooks.any_body or (world.joints is not None and world.joints.calls_any()):
            self._sync.call_back()
        sleep = self._sleep
        if sleep is not None and sleep.any_asleep and sleep.world is self._world and self.may_touch_sleepers(sleep):
            sleep.wake(sleep.touched(report.contacts))  # `wake_ahead` does not know what functions change
        return report

    def may_touch_sleepers(self, sleep: Sleep) -> bool:
        """Whether a sleeping body may have been touched in the last step; if False, its report need not be made."""
        loop = self.event_loop
        return loop is None or sleep.is_touched(loop.log, loop.impulses)

    def _start_hooked(self, world: World) -> World:
        """Read and check the state of all bodies; returns their world, a new one if bodies were exchanged or static
        bodies moved."""
        world.gather()
        status = world.copy_start()
        if status in (OTHER_BODIES, MOVED_STATIC):
            world = self._update_world(anew=True)
            world.gather()
            status = world.copy_start()
        if status < 0:
            world.bodies.check_finite(world.state)
        return world

    def _take_hooked(self, world: World, dt: float) -> tuple[World, StepReport]:
        """The step without post-step callbacks; returns its world, which may be new, and its report.

        | stage | method |
        |---|---|
        | read and check all states, and keep a copy of them | `_start_hooked` |
        | call `pre_solve` of constraints, then velocity functions | `Hooks.before`, `Hooks.velocity_changes` |
        | call collision handlers; their decisions are the rules of this step | `Rehearsal.run`, `Rehearsal.rules` |
        | move the arrays | `advance` |
        | change the end: by damping 0, post_solve and separate of handlers, position functions | `_alter_end` |
        | write the states, and call `post_solve` of constraints | `_write_hooked_end` |
        """
        world, waiting = self._start_hooked(world), private.waiting(self.space)
        half_damping, moved = world.half_damping(dt), False
        try:
            if world.joints is not None:
                world.joints.refresh()
                if world.joints.before:
                    world.hooks.before(dt)
                    moved = world.gather_changes()
            if world.hooks.steered:
                world.set_accelerations(world.hooks.velocity_changes(dt), dt)
                if self._sleep is not None and self._sleep.woken():
                    world = self._reread_awoken(world)
                moved = world.gather_changes() or moved
            if world.collisions:
                known = self._sleep is None and not self.decisions.laws
                if (status := world.rehearsal.run(dt, half_damping, self._sync, known)) < 0:
                    self._raise_failure(world, dt, status)
                if self._sleep is not None and self._sleep.woken():
                    world = self._reread_awoken(world)
                world.rules = world.rehearsal.rules(self.decisions)
            status = self.advance(world, dt, half_damping)
            if status < 0:
                self._raise_failure(world, dt, status)
            outcome = self._outcome(world, dt)
            hooks = world.hooks
            changed = moved or hooks.moved > 0 or (world.collisions and world.rehearsal.after)
            alters = changed or world.damping == 0.0
            bits, lost = self._alter_end(world, dt) if alters else (world.write_whole(), 0.0)
            if changed or status & FORCES or hooks.any_body or world.joints is not None:
                world.reset_forces()
                hooks.push()
            status = status & EVENTS | bits
            self._write_hooked_end(world, dt, status)
            if changed:
                # Changes by functions count as edits in the next step.
                world.keep_unaltered()
        except BaseException:
            private.let_wait(self.space, waiting)  # the step will be repeated, and ask for the same again
            self._undo(world, world.start)
            raise
        return world, self._finish(world, dt, status, outcome, lost)

    def _alter_end(self, world: World, dt: float) -> tuple[int, float]:
        """Change the end of the step in the arrays; returns its status bits, and the energy lost by damping 0."""
        bits, lost = world.alter_end(world.damping == 0.0)
        if bits < 0:
            self._raise_failure(world, dt, bits)
        hooks, end = world.hooks, world.STATES[WRITTEN]
        if world.collisions and world.rehearsal.after:
            hooks.note_forces(end)
        if hooks.moved:
            start, changes = world.state.copy(), world.HOOKED[CHANGES_AFTER]
            hooks.prepare_positions()
            world.before_call()
            hooks.positions(start, end, dt)
            world.after_call(late=True)
            changes[world.bodies.position_hooks, :6] = 0.0  # which `positions` has written
            end[:, :6] += changes[:, :6]
            hooks.note_forces(changes)
            changes[:], world.state[:] = 0.0, start
            world.bodies.check_finite(end[:, :6], TOO_FAR)
            bits = world.write_whole()
        return bits, lost

    def _reread_awoken(self, world: World) -> World:
        """The world read again after a rehearsal in which pymunk has woken bodies, as it does if they touch a kinematic
        body. What functions have done in this step is kept."""
        for body, slept in zip(world.bodies.items, world.bodies.asleep.tolist(), strict=True):
            if slept and not body.is_sleeping:
                body.velocity, body.angular_velocity = (0.0, 0.0), 0.0
        world.bodies.scatter(world.state)
        world.HOOKED, world.EXTRA = world.HOOKED.copy(), world.EXTRA.copy()
        now = self._update_world(anew=True)
        now.gather()
        now.copy_start()
        rows = [world.bodies.row[body] for body in now.bodies.items]
        now.EXTRA[:], now.HOOKED[:] = world.EXTRA[rows], world.HOOKED[:, rows]
        now.HOOKED[CHANGES_AFTER, now.bodies.static] = 0.0  # its rows have their new places
        now.hooks.late = world.hooks.late
        return now

    def _write_hooked_end(self, world: World, dt: float, status: int) -> None:
        """Write the end of a step to the space, and call `post_solve` of constraints."""
        world.scatter(status)
        if world.joints is not None and world.joints.calling:
            world.joints.write()
            world.hooks.after(dt)
        if not world.collisions:  # else the rehearsal has updated pymunk's shapes
            self.update_shapes(dt)

    def write_end(self, world: World, dt: float, status: int) -> None:
        """Write the end of a step to the space."""
        world.scatter(status)
        self.update_shapes(dt)

    def update_shapes(self, dt: float) -> None:
        """Update pymunk's shapes, with `sync`, to the end of a step that was written to the bodies."""
        if self.sync:
            self._sync.end(dt)
        else:
            self._sync.accept()

    def _outcome(self, world: World, dt: float) -> Outcome:
        """The outcome of the step. NotFiniteError, before the space is changed, if the energy is not finite, though all
        positions and velocities are."""
        outcome = self._method.outcome()
        book = outcome[0]
        if book is not None and not isfinite(book[BOOK_AFTER]):
            self._raise_failure(world, dt, ENERGY)
        return outcome

    def _finish(self, world: World, dt: float, status: int, outcome: Outcome, lost: float = 0.0) -> StepReport:
        """After the end of the step was written: update `time`, make the report, and let the program read impulses of
        joints. `lost`: energy lost by damping 0 at the end."""
        self.time += dt
        book, lock, converged, iterations = outcome
        if lost and book is not None:
            book[BOOK_DAMPING] += lost
            book[BOOK_AFTER] -= lost
        if world.joints is not None:
            world.show_joints(world.joints)
        unmet: Callable[[], tuple[Unmet, ...]] | tuple[Unmet, ...] = ()
        if not converged and (loop := self.event_loop) is not None:
            unmet = partial(of_missed, loop.missed, world.bodies.items, world.owner)
        if not status & EVENTS:
            return StepReport(self.time, world.without_contacts, 0, 1.0, converged, book, unmet)
        return StepReport(self.time, self.details(world, dt), iterations, lock, converged, book, unmet)
