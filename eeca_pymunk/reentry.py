"""Re-entry: functions that are called within a step of a space cannot step that space."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pymunk

BUSY: set[pymunk.Space] = set()  # spaces whose own functions are being called


class FunctionsCalled:
    """A part of a step in which functions of this space are called; such parts may be within each other. As a class,
    since `contextlib` takes a microsecond and a half."""

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
    """RuntimeError within a step of this space."""
    if space in BUSY:
        raise RuntimeError(
            f"step was called for {space} from within its own step, by a collision handler or a function of a "
            "body or constraint: step it when that step has returned, or in space.add_post_step_callback"
        )
