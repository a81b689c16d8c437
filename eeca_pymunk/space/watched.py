"""Watched: wrappers of the functions of collision handlers and constraints that a rehearsal calls; functions of
constraints that it must not call are removed meanwhile."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any

import pymunk

from .joints import JointRows
from .private import joints as private_joints
from .private import spaces as private
from .private.joints import clear_max_forces, motions, restore_max_forces, restore_motions, silent, with_laws
from .private.versions import decision, to_return

if TYPE_CHECKING:
    from .rehearsal import Rehearsal

_BEGIN, _PRE_SOLVE, *_ = private.PHASES


class Watched:
    """Wrapper of a function of a handler or constraint that records changes to bodies, decisions, and exceptions.

    After an exception no further function is called in this rehearsal.

    Args:
        phase: one of `private.PHASES` for a handler, "" for a constraint.
        stage: number of pymunk's stage in which the function is called: 0 for begin and pre_solve, 1 for post_solve, 2
            for separate. Between two calls of one stage pymunk changes no body.
    """

    __slots__ = ("_decides", "_rehearsal", "_stage", "function")

    def __init__(self, rehearsal: Rehearsal, function: Callable[..., Any], phase: str, stage: int) -> None:
        self._rehearsal, self.function, self._stage = rehearsal, function, stage
        self._decides = phase in (_BEGIN, _PRE_SOLVE)

    def __call__(self, *arguments: Any) -> bool | None:
        rehearsal = self._rehearsal
        if rehearsal.failure is not None:
            return True
        rehearsal.before_call(self._stage)
        before = decision(arguments[0]) if self._decides else None
        result: bool | None = True
        try:
            value = self.function(*arguments)
            result = to_return(value, self.function) if self._decides else None
        except BaseException as error:
            # pymunk's C code would discard it; `Rehearsal.run` raises it.
            rehearsal.failure = error
        if self._decides and (result is False or decision(arguments[0]) != before):
            rehearsal.decided = True
        rehearsal.after_call(self._stage)
        return result


@contextmanager
def silent_joints(rehearsal: Rehearsal, joints: JointRows) -> Iterator[None]:
    """Within this block `pre_solve` of constraints is wrapped, and their other functions are not called: springs use
    the linear laws of the last step. Bodies that no step moves keep their velocities."""
    # `Hooks.before` calls `pre_solve` where the first body is outside the space: pymunk does not.
    silenced = [item for item in joints.calling if item.pre_solve is None or item.a.space is None]
    with ExitStack() as stack:
        if joints.partners.items:  # constraints change their velocities; to nan if no body of a constraint can be moved
            stack.callback(restore_motions, motions(private.pointers(joints.partners.items)))
        if silenced:
            stack.enter_context(silent(silenced))
        if joints.with_law:
            stack.enter_context(with_laws(joints.with_law, joints.laws()))
        for item in joints.before:
            before, after = item.pre_solve, item.post_solve
            if item not in silenced and before is not None:
                nothing = None if after is None else lambda *_: None
                watched = Watched(rehearsal, before, "", 0)
                private_joints.replace_functions(item, watched, nothing)
                stack.callback(private_joints.restore_functions, item, (watched, nothing), (before, after))
        yield


def stop_joints(space: pymunk.Space, forces: bool) -> Callable[[], None]:
    """Let steps of pymunk call no functions of constraints, and what no step moves keep its velocities, until the
    function that is returned is called: also for constraints that the program has added, or whose bodies it has
    changed, since the last step of EECA. `forces`: whether constraints exert forces."""
    items = private_joints.awake(list(space.constraints))  # writing the others would wake bodies
    kept, max_forces = private_joints.motions_of_ends(items), [] if forces else clear_max_forces(items)
    own = [item for item in items if private_joints.law_of(item) is not None]
    called = [item for item in items if private_joints.has_functions(item)]
    within = ExitStack()
    if own:
        within.enter_context(with_laws(own, [lambda *_: 0.0] * len(own)))
    if called:
        within.enter_context(silent(called))

    def go_on() -> None:
        within.close()
        restore_max_forces(max_forces)
        restore_motions(kept)

    return go_on
