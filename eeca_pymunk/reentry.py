"""Re-entry: functions of the program that are called within a step of a space cannot step that space."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pymunk

BUSY: set[pymunk.Space] = set()  # spaces within whose step functions are being called


class FunctionsCalled:
    """Within this block the space is in BUSY. Such blocks may be nested. A class, because a generator with
    `contextmanager` takes 1.5 microseconds more."""

    __slots__ = ("_outermost", "_space")

    def __init__(self, space: pymunk.Space) -> None:
        self._space = space

    def __enter__(self) -> None:
        self._outermost = self._space not in BUSY
        BUSY.add(self._space)

    def __exit__(self, *_: object) -> None:
        if self._outermost:
            BUSY.discard(self._space)


def refuse_within(space: pymunk.Space) -> None:
    """RuntimeError if the space is in BUSY."""
    if space in BUSY:
        raise RuntimeError(
            f"step, run or set_state was called for {space} from within its own step, by a collision handler or a "
            "function of a body or constraint: step it when that step has returned, or in space.add_post_step_callback"
        )
