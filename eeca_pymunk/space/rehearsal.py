"""A rehearsal: pymunk's own step, from the same start to the end of free flight, for collision handlers.

pymunk's own detection and solver call them, so that begin, pre_solve, post_solve and separate come in pymunk's order
and with pymunk's numbers. Their decisions (collisions to ignore, restitution, friction, surface velocities, changed
velocities) apply to the EECA step, which replaces the rehearsal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import pymunk

from ..layout import NOW
from ..rehearsing import approach, changed
from ..transfer import TURNS
from . import private, private_joints
from .decisions import Decisions, Rules
from .joints import JointRows
from .private_versions import answer

if TYPE_CHECKING:
    from .world import World

_BEGIN, _PRE_SOLVE, _POST_SOLVE, _ = private.PHASES


class _Watched:
    """Wrapper of a function of a handler or constraint that records changes to bodies, decisions, and exceptions.

    `phase`: of a handler, "" of a constraint. `stage`: number of pymunk's stage in which the function is called, 0 for
    begin and pre_solve; between two calls of one stage pymunk changes no body.
    """

    __slots__ = ("_decides", "_phase", "_rehearsal", "_stage", "function")

    def __init__(self, rehearsal: Rehearsal, function: Callable[..., Any], phase: str, stage: int) -> None:
        self._rehearsal, self.function, self._phase, self._stage = rehearsal, function, phase, stage
        self._decides = phase in (_BEGIN, _PRE_SOLVE)

    def __call__(self, *arguments: Any) -> bool | None:
        rehearsal = self._rehearsal
        if rehearsal.failure is not None:
            return True
        rehearsal.before_call(self._stage)
        before = private.decision(arguments[0]) if self._decides else None
        answered: bool | None = True
        try:
            answered = answer(self.function(*arguments), self.function, self._phase)
        except BaseException as error:
            # pymunk's C code would discard it.
            rehearsal.failure = error
        if self._decides and (answered is False or private.decision(arguments[0]) != before):
            rehearsal.decided = True
        rehearsal.after_call(self._stage)
        return answered


class Rehearsal:
    """The arrays and wrappers for rehearsals of a world, kept from step to step.

    Attributes:
        failure: the exception of a function in the last rehearsal.
        decided: whether a function has changed a collision in it.
    """

    def __init__(self, world: World) -> None:
        self.world, self.space = world, world.space
        self._start, self._known = np.zeros_like(world.START), np.zeros_like(world.START)
        self._approach = approach.bind(world.STATES, world.WALK, world.EXTRA, world.BODY, world.ENDS, self._start)
        # Whether there are changes by begin and pre_solve, and changes by post_solve and separate; the last stage.
        self._changed, self._stage = [False, False], -1
        self._wrapped: list[tuple[Any, str, Any, Any]] = []
        self._functions: list[tuple[Any, ...]] = []
        self.failure: BaseException | None = None
        self.decided, self._ignores = False, True
        self._recent: float = 0.0  # number of steps for which decisions still apply

    @cached_property
    def _differ(self) -> list[Callable[[], int]]:
        return [changed.bind(self.world.STATES, self._known, table) for table in self.world.CHANGES]

    def forget(self) -> None:
        """Forget earlier steps."""
        self._changed, self._recent, self._ignores = [False, False], 0, True
        self.world.CHANGES.fill(0.0)

    def go_on(self, earlier: Rehearsal) -> None:
        """Take over what functions have done in a rehearsal of another world of the space."""
        self._changed, self.decided = earlier._changed, earlier.decided

    def before_call(self, stage: int) -> None:
        """Before a function is called: read the bodies, if pymunk has reached another stage."""
        if self._stage != stage:
            self.world.gather()
            np.copyto(self._known, self.world.STATES[NOW])
            self._stage = stage

    def after_call(self, stage: int) -> None:
        """After a function was called: record its changes."""
        late = stage > 0
        self.world.gather()
        if self._differ[late]():
            self._changed[late] = True

    def run(self, dt: float, half_damping: float) -> int:
        """Take pymunk's step; STATES then has the start of the EECA step, with the changes by begin and pre_solve. An
        exception of a function is raised when pymunk has finished.

        Returns:
            0 or a negative code of `transfer.py`, with nothing done.
        """
        world, hooks = self.world, self.world.hooks
        gx, gy = world.gravity
        status = self._approach(dt, gx, gy, half_damping)
        if status < 0:
            return status
        self.failure, self.decided, self._stage = None, False, -1
        if True in self._changed:
            world.CHANGES.fill(0.0)
            self._changed = [False, False]
        world.scatter(TURNS)
        self._wrap()
        try:
            for handler, phase, _, watched in self._wrapped:
                setattr(handler, phase, watched)
            if hooks.none_within_steps():
                private.step_without_end(self.space, dt)
            else:
                with hooks.silent(), self._silent_joints(hooks.joints):
                    private.step_without_end(self.space, dt)
        finally:
            for handler, phase, function, _ in self._wrapped:
                setattr(handler, phase, function)
        if self.failure is not None:
            raise self.failure
        if self._stage >= 0:  # else nothing was read meanwhile
            np.copyto(world.STATES[NOW], self._start)
        if self._changed[0]:
            world.STATES[NOW] += world.CHANGES[0]
        return status

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
                (handler, phase, f, _Watched(self, f, phase, max(i - 1, 0)))
                for handler, *functions in now
                for i, (phase, f) in enumerate(zip(private.PHASES, functions, strict=True))
                if f is not None
            ]
        if late:
            self._wrapped = [
                (handler, phase, f, hooks.later(f) if phase == _POST_SOLVE else watched)
                for handler, phase, f, watched in self._wrapped
            ]

    @contextmanager
    def _silent_joints(self, joints: JointRows | None) -> Iterator[None]:
        """Within this block `pre_solve` of constraints is wrapped, and their other functions are not called."""
        if joints is None:
            yield
            return
        mute = [item for item in joints.calling if item.pre_solve is None or item.a.space is None]
        with ExitStack() as held:
            if joints.partners.outside:
                held.callback(private_joints.restore_motions, joints.partners.motions())
            if mute:
                held.enter_context(private_joints.silent(mute))
            if joints.own:
                held.enter_context(private_joints.with_laws(joints.own, joints.laws()))
            if joints.before:
                held.enter_context(self._watched_joints([item for item in joints.before if item not in mute]))
            yield

    @contextmanager
    def _watched_joints(self, items: Sequence[pymunk.Constraint]) -> Iterator[None]:
        """Within this block `pre_solve` of constraints is wrapped, and `post_solve` is not called."""
        functions = [(item, item.pre_solve, item.post_solve) for item in items]
        try:
            for item, before, after in functions:
                assert before is not None
                silent = None if after is None else lambda *_: None
                private_joints.replace_functions(item, _Watched(self, before, "", 0), silent)
            yield
        finally:
            for item, before, after in functions:
                private_joints.replace_functions(item, before, after)

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
