"""Re-entry: functions that are called within a step of a space cannot step that space."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pymunk

BUSY: set[pymunk.Space] = set()  # spaces whose own functions are being called


@contextmanager
def functions_called(space: pymunk.Space) -> Iterator[None]:
    """A part of a step in which functions of this space are called; such parts may be within each other."""
    outermost = space not in BUSY
    BUSY.add(space)
    try:
        yield
    finally:
        if outermost:
            BUSY.discard(space)


def refuse_within(space: pymunk.Space) -> None:
    """RuntimeError within a step of this space."""
    if space in BUSY:
        raise RuntimeError(
            f"step was called for {space} from within its own step, by a collision handler or a function of a "
            "body or constraint: step it when that step has returned, or in space.add_post_step_callback"
        )
