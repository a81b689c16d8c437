"""Re-entry: functions that are called within a step of a space cannot step that space."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pymunk

BUSY: set[pymunk.Space] = set()  # spaces whose own functions are being called


def refuse_within(space: pymunk.Space) -> None:
    """RuntimeError within a step of this space."""
    if space in BUSY:
        raise RuntimeError(
            f"step was called for {space} from within its own step, by a collision handler or a function of a "
            "body or constraint: step it when that step has returned, or in space.add_post_step_callback"
        )
