"""A rehearsal: pymunk's own step, from the same start to the end of free flight, which calls the collision handlers.

So begin, pre_solve, post_solve and separate are called in pymunk's order and with pymunk's numbers. What they decide
(collisions to ignore, restitution, friction, surface velocities) and change (velocities) applies to the EECA step,
which overwrites the motion of the rehearsal.

| step | rehearsal |
|---|---|
| a handler may be called | pymunk's step, with handlers that record what they change (`Rehearsal.run`) |
| *silent*: none would be called | left out |
| silent, but arbiters were read since the last step, or `REINDEXINGS` in a row were left out | pymunk's step |
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import IntArray
from ..compiled.records import Rows, rows
from ..layout import CHANGES_BEFORE, READ, REHEARSAL_START
from ..model.shapes import HandledShape
from ..model.step import TURNS
from ..rehearsing import place_for_rehearsal
from .decisions import NO_RULES, Decisions, Rules
from .edits import type_changes
from .handled_pairs import HandledPairs
from .private import shapes as private_shapes
from .private import spaces as private
from .private import versions as private_versions
from .watched import Watched, silent_joints

if TYPE_CHECKING:
    from .sync import Sync
    from .world import World

_BETWEEN_TESTS = 4  # steps from one test whether no handler would be called to the next
_NO_PAIRS: tuple[Rows[HandledShape], IntArray] = rows(HandledShape, 0), np.zeros((0, 2), np.int64)


class Rehearsal:
    """The arrays and wrappers for rehearsals of a world, kept from step to step.

    Attributes:
        left_out: number of the last steps in a row whose rehearsals were left out.
        failure: the exception of a function in the last rehearsal.
        decided: whether a function has changed a collision in it.
    """

    def __init__(self, world: World) -> None:
        self.space = world.space
        self._settings = 0.0, 0.0, 0.0, 1.0  # dt, gravity (2), factor of half a step's damping
        # Whether begin or pre_solve, and post_solve or separate, have changed bodies; stage of the last call (see
        # `Watched`), -1 before the first.
        self._changed, self._stage = [False, False], -1
        self._wrapped: list[tuple[Any, str, Any, Any]] = []  # handler, phase, its function, the wrapper
        self._functions: list[tuple[Any, ...]] = []  # see `private.functions`
        self.failure: BaseException | None = None
        self.decided, self.left_out = False, 0
        self._sync: Sync | None = None  # of the last step, if its rehearsal could be left out
        self._silent, self._untested = False, 0  # whether the last step was silent; steps until that is tested again
        # Number of steps for which decisions apply at least; ignored collisions are ignored as long as shapes touch.
        self._decision_steps = 1.0
        self._pairs: HandledPairs | None = None
        self.go_on(world)

    def go_on(self, world: World) -> bool:
        """Go on in the next world of the space. Returns whether no decision of a handler can apply. Boxes of shapes and
        wrappers are kept."""
        undecided = self._decision_steps <= 0 and self._sync is not None and self._sync.is_ours()
        self.world, self._sync, self._silent = world, None, False
        self.forget_old_handlers()
        if self._pairs is not None:
            self._pairs.type_changes = -1  # so that pairs are found again, in the rows of this world
        self._place = self._bound(None)
        return undecided

    def forget(self, reshaped: bool) -> None:
        """Forget earlier steps; if sizes, filters or places of shapes have changed, also the pairs with handlers."""
        if reshaped:
            self._pairs = None
        self._changed, self._silent, self._untested = [False, False], False, 0
        self.world.forget_changes()

    def is_silent_again(self, dt: float, half_damping: float, sync: Sync) -> bool:
        """Whether this step is silent as the last one was; if so, its rehearsal is done or left out here. For worlds in
        which only handlers can be called (`only_handlers`). Reads the states at the start of the step."""
        world, pairs = self.world, self._pairs
        if not self._silent or sync is not self._sync or pairs is None or world.rules is not NO_RULES:
            return False
        calls = world.joints is not None and world.joints.calls_back()
        if calls or pairs.type_changes != type_changes() or not sync.is_ours():
            return False
        world.gather()
        self._settings = dt, *world.gravity, half_damping
        if self._place(*self._settings) != 0:
            return False
        self._step_without_calls(dt, sync)
        return True

    def forget_old_handlers(self) -> None:
        """Forget the pairs with handlers, if there are handlers for other types now."""
        if self._pairs is not None and self._pairs.handled != private_versions.handled(self.space):
            self._pairs, self._silent, self._untested = None, False, 0

    def before_call(self, stage: int) -> None:
        """Before a function is called: read the bodies, if pymunk has reached another stage."""
        if self._stage != stage:
            self.world.before_call()
            self._stage = stage

    def after_call(self, stage: int) -> None:
        """After a function was called: record its changes in HOOKED[CHANGES_BEFORE] or HOOKED[CHANGES_AFTER]."""
        changed = self.world.after_call(stage > 0)
        self._changed = [self._changed[0] or changed & 1 > 0, self._changed[1] or changed & 2 > 0]

    def run(self, dt: float, half_damping: float, sync: Sync, known: bool) -> int:
        """Take pymunk's step; STATES then has the start of the EECA step, with the changes by begin and pre_solve. An
        exception of a function is raised when pymunk has finished.

        Args:
            sync: of the world.  known: whether arbiters have all decisions, and no body can sleep: then the rehearsal
                may be left out.

        Returns:
            0 or a negative code of `model/step.py`, with nothing done.
        """
        world = self.world
        self._settings = dt, *world.gravity, half_damping
        status = self._place(*self._settings)
        if status < 0:
            return status
        self.failure, self.decided, self._stage, self._sync = None, False, -1, sync if known else None
        if not (continues := sync.continues()):
            self._decision_steps = max(self._decision_steps, 1.0)
        if self._changed[0]:
            world.HOOKED[CHANGES_BEFORE] = 0.0
        self._changed = [False, False]
        if self._untested > 0:
            self._untested -= 1
        elif known and continues and self._calls_none(status > 0):
            self._silent = True
            self._step_without_calls(dt, sync)
            return 0
        elif self._decision_steps <= 0 and continues:  # otherwise nothing was tested
            self._silent, self._untested = False, _BETWEEN_TESTS
        self.left_out = 0
        world.scatter(TURNS)
        self._wrap()
        try:
            for handler, phase, _, watched in self._wrapped:
                setattr(handler, phase, watched)
            self._step(dt)
        finally:
            for handler, phase, function, watched in self._wrapped:
                if getattr(handler, phase) is watched:  # else a function has set another one
                    setattr(handler, phase, function)
        if self.failure is not None:
            raise self.failure
        if self._stage >= 0:  # else nothing was read meanwhile
            world.STATES[READ] = world.HOOKED[REHEARSAL_START]
        if self._changed[0]:
            world.STATES[READ] += world.HOOKED[CHANGES_BEFORE]
        return 0

    def _step_without_calls(self, dt: float, sync: Sync) -> None:
        """The rehearsal of a silent step. Arbiters that were read will probably be read again."""
        taken = sync.arbiters_read or self.left_out >= private_shapes.REINDEXINGS
        self.left_out = 0 if taken else self.left_out + 1
        if taken:
            self.world.scatter(TURNS)
            self._step(dt)

    def _step(self, dt: float) -> None:
        if (hooks := self.world.hooks).none_within_steps():
            private.step_without_end(self.space, dt)
            return
        with hooks.silent, nullcontext() if hooks.joints is None else silent_joints(self, hooks.joints):
            private.step_without_end(self.space, dt)

    def _bound(self, pairs: HandledPairs | None) -> Callable[[float, float, float, float], int]:
        """`rehearsing.place_for_rehearsal`, for these pairs."""
        return place_for_rehearsal.bind(self.world.reading, *((pairs and pairs.arrays) or _NO_PAIRS))

    def _calls_none(self, near: bool) -> bool:
        """Whether pymunk's step would call nothing. `near`: whether a pair may meet in it, or soon after."""
        joints = self.world.joints
        if self._decision_steps > 0 or (joints is not None and joints.calling):
            return False
        if self._pairs is None or self._pairs.type_changes != type_changes():
            self._pairs, self._silent = HandledPairs(self.world, self._pairs), False
            self._place = self._bound(self._pairs)
            near = self._place(*self._settings) > 0
        tested = not near and self._pairs.arrays is not None
        return tested and (self._silent or not self._pairs.remembered())

    def take_left_out_step(self) -> None:
        """Take the step of pymunk that was left out, for its arbiters, unless the space has other bodies now."""
        world, present = self.world, self.world.bodies.gather()
        if present is None:
            return
        world.STATES[READ] = world.HOOKED[REHEARSAL_START]
        self._place(*self._settings)
        world.scatter(TURNS)
        try:
            self._step(self._settings[0])
        finally:
            world.bodies.scatter(present, unchanged=True)
            private_shapes.forget_corrections(world.movers)
            private_shapes.reindex(self.space, world.movers)

    @property
    def after(self) -> bool:
        """Whether post_solve or separate have changed bodies."""
        return self._changed[1]

    def _wrap(self) -> None:
        """Make wrappers of all functions of handlers, unless these are the same as in the last step. If constraints
        have a `post_solve`, that of handlers is called after them (`Hooks.after`)."""
        hooks, now = self.world.hooks, private.functions(self.space)
        late = hooks.joints is not None and len(hooks.joints.after) > 0
        if now != self._functions or late:
            self._functions = [] if late else now
            self._wrapped = [
                (handler, phase, f, Watched(self, f, phase, max(i - 1, 0)))
                for handler, *functions in now
                for i, (phase, f) in enumerate(zip(private.PHASES, functions, strict=True))
                if f is not None
            ]
        if late:
            self._wrapped = [
                (handler, phase, f, hooks.later(f) if phase == private.PHASES[2] else watched)
                for handler, phase, f, watched in self._wrapped
            ]

    def rules(self, earlier: Decisions) -> Rules:
        """The decisions about pairs of shapes in this step: of its own functions, and of `earlier` ones that still
        apply. pymunk keeps them as long as it keeps the arbiter, and ignored collisions as long as the shapes touch.
        Arbiters are only read if a function may have changed one of them."""
        if self.decided:
            self._decision_steps = self.space.collision_persistence + 1
        if self._decision_steps <= 0 and not earlier.laws:
            return NO_RULES
        rules = earlier.rules(self.world)
        self._decision_steps = max(self._decision_steps - 1, 1.0 if rules.ignored else 0.0)
        return rules if rules.ignored or rules.changed else NO_RULES
