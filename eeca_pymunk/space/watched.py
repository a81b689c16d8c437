"""Watched: a function of a collision handler or constraint that a rehearsal calls."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from .private import spaces as private
from .private.versions import answer

if TYPE_CHECKING:
    from .rehearsal import Rehearsal

_BEGIN, _PRE_SOLVE, *_ = private.PHASES


class Watched:
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
