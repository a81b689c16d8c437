"""A rehearsal: pymunk's own step, from the same start to the end of free flight, for collision handlers.

pymunk's own detection and solver call them, so that begin, pre_solve, post_solve and separate come in pymunk's order
and with pymunk's numbers. Their decisions (collisions to ignore, restitution, friction, surface velocities, changed
velocities) apply to the EECA step, which replaces the rehearsal.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..layout import EARLY, NOW, REHEARSED, SEEN
from ..rehearsing import HEARD_COLUMNS, approach, changed
from ..transfer import TURNS
from .decisions import Decisions, Rules
from .edits import typings
from .hearing import Hearing
from .private import shapes as private_shapes
from .private import spaces as private
from .private import versions as private_versions
from .watched import Watched, silent_joints

if TYPE_CHECKING:
    from .sync import Sync
    from .world import World

_LATER = 4  # steps for which pymunk may remember pairs that were near
_RENEW = 32  # steps in a row that are left out at most: as reindexing (`sync.py`), that leaves unused handles
_POST_SOLVE = private.PHASES[2]
_NONE: tuple[FloatArray, IntArray] = np.zeros((0, HEARD_COLUMNS)), np.zeros((0, 2), np.int64)  # nothing is heard


class Rehearsal:
    """The arrays and wrappers for rehearsals of a world, kept from step to step.

    Attributes:
        left_out: whether pymunk's step was left out in the last rehearsal.
        failure: the exception of a function in the last rehearsal.
        decided: whether a function has changed a collision in it.
    """

    def __init__(self, world: World) -> None:
        self.world, self.space = world, world.space
        self._approach = self._bound(None)
        (self._differ,) = world.bound(changed)
        self._lengths = 0.0, 0.0, 0.0, 1.0  # dt, gravity, factor of half a step's damping
        # Whether there are changes by begin and pre_solve, and changes by post_solve and separate; the last stage.
        self._changed, self._stage = [False, False], -1
        self._wrapped: list[tuple[Any, str, Any, Any]] = []
        self._functions: list[tuple[Any, ...]] = []
        self.failure: BaseException | None = None
        self.decided, self.left_out, self._ignores, self._without = False, False, not world.undecided, 0
        self._sync: Sync | None = None  # of the last step
        # Whether the last step called nothing for certain; number of steps for which that is not asked again.
        self._unheard, self._later = False, 0
        self._hearing: Hearing | None = None
        self._recent: float = 0.0  # number of steps for which decisions still apply

    def end(self) -> None:
        """Forget the wrappers, which refer to this."""
        self._wrapped, self._functions = [], []

    def forget(self, reshaped: bool) -> None:
        """Forget earlier steps, and, if shapes have other sizes or places, what handlers may hear."""
        if reshaped:
            self._hearing = None
        self._unheard, self._later = False, 0
        self._changed, self._recent, self._ignores = [False, False], 0, True
        self.world.forget_changes()

    def is_silent(self) -> bool:
        """Whether nothing holds that functions have decided, and some steps in a row, all EECA's, called none."""
        return self._without >= _LATER and self._unheard and self._sync is not None and self._sync.is_ours()

    def is_silent_again(self, dt: float, half_damping: float, sync: Sync) -> bool:
        """Whether a step in which nothing but handlers could be called calls none, as the last one: then this is the
        whole rehearsal. The states at the start of the step are read, and not changed."""
        if not self._unheard or sync is not self._sync:
            return False
        self.world.gather()
        self._lengths = dt, *self.world.gravity, half_damping
        if self._approach(*self._lengths) != 0 or not (sync.goes_on() and self._is_unheard(near=False)):
            return False
        self._call_nothing(dt, sync)
        return True

    def listen(self) -> None:
        """Forget what handlers may hear, if there are new ones."""
        if self._hearing is not None and self._hearing.handled != private_versions.handled(self.space):
            self._hearing, self._unheard, self._later = None, False, 0

    def go_on(self, earlier: Rehearsal) -> None:
        """Take over what functions have done in a rehearsal of another world of the space."""
        self._changed, self.decided = earlier._changed, earlier.decided

    def before_call(self, stage: int) -> None:
        """Before a function is called: read the bodies, if pymunk has reached another stage."""
        if self._stage != stage:
            self.world.gather()
            self.world.HELD[SEEN] = self.world.STATES[NOW]
            self._stage = stage

    def after_call(self, stage: int) -> None:
        """After a function was called: record its changes."""
        late = stage > 0
        self.world.gather()
        if self._differ(late):
            self._changed[late] = True

    def run(self, dt: float, half_damping: float, sync: Sync | None = None) -> int:
        """Take pymunk's step; STATES then has the start of the EECA step, with the changes by begin and pre_solve. An
        exception of a function is raised when pymunk has finished.

        Args:
            sync: if given, a step that would call no handler may be left out, see `_call_nothing`. That needs that
                pymunk has taken no step of its own since the last EECA step.

        Returns:
            0 or a negative code of `transfer.py`, with nothing done.
        """
        world = self.world
        self._lengths = dt, *world.gravity, half_damping
        status = self._approach(*self._lengths)
        if status < 0:
            return status
        self.failure, self.decided, self._stage, self._sync = None, False, -1, sync
        if True in self._changed:
            world.forget_changes()
            self._changed = [False, False]
        if self._later > 0:
            self._later -= 1
        else:
            self._unheard = sync is not None and sync.goes_on() and self._is_unheard(status > 0)
            self._later = 0 if self._unheard else _LATER
        if self._unheard and sync is not None:
            self._call_nothing(dt, sync)
            return 0
        self.left_out, self._without = False, 0
        world.scatter(TURNS)
        self._wrap()
        try:
            for handler, phase, _, watched in self._wrapped:
                setattr(handler, phase, watched)
            self._step(dt)
        finally:
            for handler, phase, function, _ in self._wrapped:
                setattr(handler, phase, function)
        if self.failure is not None:
            raise self.failure
        if self._stage >= 0:  # else nothing was read meanwhile
            world.STATES[NOW] = world.HELD[REHEARSED]
        if self._changed[0]:
            world.STATES[NOW] += world.HELD[EARLY]
        return 0

    def _call_nothing(self, dt: float, sync: Sync) -> None:
        """Take pymunk's step, which calls no function, or leave it out: up to _RENEW times in a row, unless arbiters
        were read since the last step; they will probably be read again."""
        self.left_out = not sync.were_read() and self._without < _RENEW
        if self.left_out:
            self._without += 1
            return
        self._without = 0
        self.world.scatter(TURNS)
        self._step(dt)

    def _step(self, dt: float) -> None:
        hooks = self.world.hooks
        if hooks.joints is None or hooks.none_within_steps():
            with hooks.silent:
                private.step_without_end(self.space, dt)
        else:
            with hooks.silent, silent_joints(self, hooks.joints):
                private.step_without_end(self.space, dt)

    def _bound(self, hearing: Hearing | None) -> Callable[[float, float, float, float], int]:
        """See `rehearsing.approach`."""
        world, heard = self.world, None if hearing is None else hearing.arrays
        return approach.bind(world.reading, *(heard or _NONE))

    def _is_unheard(self, near: bool) -> bool:
        """Whether pymunk's step would call nothing; `near`: whether a pair may meet in it, or soon after."""
        joints = self.world.joints
        if self._recent > 0 or self._ignores or (joints is not None and joints.calling):
            return False
        if self._hearing is None or self._hearing.typings != typings():
            self._hearing, self._unheard = Hearing(self.world), False
            self._approach = self._bound(self._hearing)
            near = self._approach(*self._lengths) > 0
        if near or self._hearing.arrays is None:
            return False
        return self._unheard or not self._hearing.remembered()

    def make_up(self) -> None:
        """Take the step of pymunk that was left out, for its arbiters, unless the space has other bodies now."""
        world, present = self.world, self.world.bodies.gather()
        if present is None:
            return
        world.STATES[NOW] = world.HELD[REHEARSED]
        self._approach(*self._lengths)
        world.scatter(TURNS)
        try:
            self._step(self._lengths[0])
        finally:
            world.bodies.scatter(present, unchanged=True)
            private_shapes.reindex_anew(self.space, world.movers)

    @property
    def after(self) -> bool:
        """Whether post_solve and separate have changed anything."""
        return self._changed[1]

    def _wrap(self) -> None:
        """Make wrappers of all functions of handlers; those of the last step are used again if the functions are
        equal."""
        hooks, now = self.world.hooks, private.functions(self.space)
        late = hooks.joints is not None and len(hooks.joints.after) > 0
        if now != self._functions or late:
            self._functions = now
            self._wrapped = [
                (handler, phase, f, Watched(self, f, phase, max(i - 1, 0)))
                for handler, *functions in now
                for i, (phase, f) in enumerate(zip(private.PHASES, functions, strict=True))
                if f is not None
            ]
        if late:
            self._wrapped = [
                (handler, phase, f, hooks.later(f) if phase == _POST_SOLVE else watched)
                for handler, phase, f, watched in self._wrapped
            ]

    def rules(self, earlier: Decisions) -> Rules:
        """The decisions about pairs of shapes by functions of this step, and by earlier ones.

        Values of arbiters differ from those of shapes only if a function has changed them. pymunk keeps such decisions
        as long as it keeps arbiters, and ignored collisions as long as the shapes touch.
        """
        if self.decided:
            self._recent = self.space.collision_persistence + 1
        if self._recent <= 0 and not self._ignores and not earlier.laws:
            return Rules() if self.world.rules.some else self.world.rules
        self._recent -= 1
        rules = earlier.rules(self.world)
        self._ignores = bool(rules.ignored)
        return rules
