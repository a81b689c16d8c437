"""Sync: update pymunk's own shapes and broad phase for queries and drawing.

There are two ways. A *rest step*, pymunk's own step with all velocities 0, moves nothing; it renews broad phase and
arbiters, and forgets old contacts and impulses. *Reindexing* moves the shapes of one body after the other and changes
nothing else; it can wait until shapes are read (`late_shapes.py`), and costs less, but for many shapes in a spatial
hash. There it leaves unused handles, which a rest step clears: there is one after `REINDEXINGS` of them. In spaces with
collision handlers a rehearsal (`rehearsal.py`) is taken or left out instead. Post-step callbacks are called afterwards,
when bodies have their velocities. After an EECA step pymunk is in one of these states:

| state | entered by | arbiters are | before they are read |
|---|---|---|---|
| `ARBITERS_CURRENT` | a rest step, or a rehearsal | those of the step | nothing is done |
| `NO_REST_STEP` | reindexing | older | a rest step is taken: `ARBITERS_CURRENT` |
| `NO_REHEARSAL` | a step whose rehearsal was left out | older | it is taken: `ARBITERS_CURRENT` |

A step of pymunk's own is found by its counter of steps (`Sync.is_ours`); the next EECA step ends with a rest step.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from functools import cached_property, partial
from typing import TYPE_CHECKING
from weakref import WeakMethod, ref

from ..reentry import CALLING
from .arbiters import ReadTouches, show_contacts
from .late_shapes import MOST_READ, late_shapes
from .private import arbiters as private_arbiters
from .private import batch as private_batch
from .private import rest as private_rest
from .private import shapes as private_shapes
from .private import sleep as private_sleep
from .private import spaces as private
from .watched import stop_joints

if TYPE_CHECKING:
    from .world import World

ARBITERS_CURRENT, NO_REST_STEP, NO_REHEARSAL = 0, 1, 2


class Sync:
    """Updates pymunk's shapes after each step, in one of the two ways.

    Attributes:
        waits: function that returns whether post-step callbacks, additions or removals wait for the end of a step.
        state: of pymunk after the last EECA step: `ARBITERS_CURRENT`, `NO_REST_STEP` or `NO_REHEARSAL`.
        stamp: number of steps that pymunk had taken after the last EECA step, -1 before the first.
        arbiters_read: whether arbiters were read since they were made; the next step then makes them, to be read again.
        touches: a weak reference to the method that returns the pairs of the last step (`arbiters.py`).
    """

    def __init__(self, world: World, touches: WeakMethod[ReadTouches], past: Sync | None = None) -> None:
        """`past`: the `Sync` of the last world of this space; pymunk itself indexes shapes that were added since."""
        self.space, self.touches, bodies = world.space, touches, world.bodies
        self._asleep = bodies.reached is not None
        sleepers = [bodies.items[i] for i in bodies.asleep.nonzero()[0]] if self._asleep else []
        self._stop_woken = private_sleep.stop_woken(sleepers)
        self._world, self._timestamp = world, private.timestamp(self.space)
        self.waits = partial(private.waits, self.space)
        self.arbiters_read, self.state, self.stamp = False, ARBITERS_CURRENT, -1
        self._shapes, self._reference = late_shapes(self.space), ref(self)
        show_contacts()
        # Number of pymunk's steps after the last rest step, and pymunk's dt. `_first`: no rest step in this reading;
        # new bodies and joints may have corrections and impulses.
        self._rested, self._dt, self._first = -1, 0.0, True
        if past is not None and not (self._asleep or past._asleep):
            self._rested, self._dt, self.arbiters_read = past._rested, past._dt, past.arbiters_read
        self._past_stamp = past.stamp if past is not None and world.undecided else -1

    def reindexes(self) -> bool:
        """Whether this step may leave the shapes late, to be reindexed when they are read. Not if pymunk has taken a
        step since the last rest step, nor if arbiters were read after the last step, other than for a picture, nor, in
        a spatial hash, after `REINDEXINGS` of them or if more than MOST_READ shapes are read after each step."""
        shapes = self._shapes
        if self.arbiters_read or self._timestamp() != self._rested:
            return False
        if not shapes.hashed:
            return True
        return shapes.reindexings > 0 and not (shapes.read and self._world.moving_shapes > MOST_READ)

    def leave_late(self, dt: float) -> None:
        """End a step that `reindexes`: the shapes are late."""
        if dt != self._dt:
            self._dt = dt
            private.set_time_step(self.space, dt)
        private.forget_removed(self.space)
        self.state, shapes = NO_REST_STEP, self._shapes
        self.stamp = shapes.stamp = self._rested
        shapes.read, shapes.late, shapes.sync = False, True, self._reference

    def renew(self, read: bool = True) -> None:
        """Make the arbiters of the last EECA step. `read`: whether the program reads them, so that the next step makes
        them too; what else needs them, see `make_arbiters`, costs more than making them."""
        if self.state != ARBITERS_CURRENT and self.space not in CALLING and self.is_ours():
            if self.state == NO_REHEARSAL:
                go_on = stop_joints(self.space, True)
                try:
                    with private_rest.without_handlers(self.space):
                        self._world.rehearsal.take_left_out_step()
                finally:
                    go_on()
                self.state, self.stamp = ARBITERS_CURRENT, self._timestamp()
            else:
                self.rest(self._dt)
        self.arbiters_read |= read

    def call_back(self) -> None:
        """Do waiting additions and removals, and call post-step callbacks."""
        if self.waits():
            private.finish_step(self.space)

    def accept(self) -> None:
        """Count the steps that pymunk has taken until now as parts of EECA steps."""
        private.forget_removed(self.space)
        self.stamp, self._shapes.sync = self._timestamp(), self._reference

    def finish_rehearsal(self, left_out: int) -> None:
        """The end of a step with handlers, whose rehearsal was taken or left out (`Rehearsal.left_out`): shapes are
        late, then `call_back`."""
        shapes = self._shapes
        self.stamp = shapes.stamp = self._timestamp()
        if left_out:
            private.forget_removed(self.space)
            self.state = NO_REHEARSAL
        else:
            self.state, self.arbiters_read = ARBITERS_CURRENT, False
            shapes.reindexings = private_shapes.REINDEXINGS
            private_shapes.forget_corrections(self._world.movers)
        shapes.read, shapes.late, shapes.sync = False, True, self._reference
        self.call_back()

    def is_ours(self) -> bool:
        """Whether pymunk has taken no step of its own since the last EECA step."""
        return self._timestamp() == self.stamp

    def continues(self) -> bool:
        """As `is_ours`; also true if the space was read anew since the last EECA step and no decision applies."""
        return self._timestamp() in (self.stamp, self._past_stamp)

    def rest(self, dt: float) -> None:
        """Take a rest step: bodies keep their velocities and forces, and no functions of bodies and constraints are
        called."""
        world = self._world
        if self._first or self._timestamp() != self._rested:
            # pymunk may have corrections and impulses, also of new bodies, which it would apply.
            private_shapes.forget_corrections(world.movers)
            for arbiter in private.raw_arbiters(self.space):
                private_arbiters.set_impulse(arbiter, None)
        slept = self._asleep and world.bodies.in_order()
        # Writing all bodies would wake those that sleep; those that came since the last reading have no room.
        all_known = not self._asleep and world.same_things() and len(self.space.bodies) == len(world.bodies) - 1
        stop, go_on = self._stopper if all_known else private_rest.stopper(self.space)
        stop()
        then = [go_on]
        try:
            if self.space.constraints:
                then.append(stop_joints(self.space, False))
            with world.hooks.silent if world.hooks.any_body else nullcontext():
                private_rest.rest(self.space, dt, self._asleep)
        finally:
            for again in reversed(then):
                again()
        if slept and not world.bodies.in_order():
            self._stop_woken()  # gravity has accelerated the bodies that pymunk has woken
        self._rested, self._dt = self._timestamp(), dt
        self._shapes.late, self._shapes.read, self._shapes.reindexings = False, False, private_shapes.REINDEXINGS
        self.state, self.stamp, self.arbiters_read, self._first = ARBITERS_CURRENT, self._rested, False, False
        self._shapes.sync = self._reference

    @cached_property
    def _stopper(self) -> tuple[Callable[[], None], Callable[[], None]]:
        """See `private_batch.stopper`."""
        return private_batch.stopper(self.space, len(self._world.bodies))

    def end(self, dt: float) -> None:
        """Update pymunk's shapes to the end of a step, which was written to the bodies: by reindexing, or by a rest
        step."""
        if self.reindexes():
            self.leave_late(dt)
        else:
            self.rest(dt)
