"""Re-entry: functions of the program that are called within a step of a space cannot step that space, nor can another
thread step it meanwhile, or while its rollouts are computed."""

from __future__ import annotations

from threading import get_ident
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pymunk

CALLING: set[pymunk.Space] = set()  # spaces within whose step functions are being called
STEPPING: dict[pymunk.Space, int] = {}  # spaces that are being stepped, by which thread
_CALLS = "step, run, rollout, get_state or set_state"


class FunctionsCalled:
    """Within this block the space is in CALLING. Such blocks may be nested. A class, because a generator with
    `contextmanager` takes 1.5 microseconds more."""

    __slots__ = ("_outermost", "_space")

    def __init__(self, space: pymunk.Space) -> None:
        self._space = space

    def __enter__(self) -> None:
        self._outermost = self._space not in CALLING
        CALLING.add(self._space)

    def __exit__(self, *_: object) -> None:
        if self._outermost:
            CALLING.discard(self._space)


class Entered:
    """Within this block the space is in STEPPING, unless another thread steps it, see `enter`."""

    __slots__ = ("_outermost", "_space")

    def __init__(self, space: pymunk.Space) -> None:
        self._space = space

    def __enter__(self) -> None:
        self._outermost = enter(self._space)

    def __exit__(self, *_: object) -> None:
        if self._outermost:
            del STEPPING[self._space]


def of_another_thread(space: pymunk.Space) -> RuntimeError:
    """The error of a thread that steps a space while another one does."""
    return RuntimeError(
        f"{_CALLS} was called for {space} while another thread steps it: give each thread a space and a stepper of its "
        "own, or let them wait for each other"
    )


def refuse_within(space: pymunk.Space) -> None:
    """RuntimeError if the space is in CALLING."""
    if space in CALLING:
        if STEPPING.get(space, get_ident()) != get_ident():
            raise of_another_thread(space)
        raise RuntimeError(
            f"{_CALLS} was called for {space} from within its own step, by a collision handler or a function of a body "
            "or constraint: step it when that step has returned, or in space.add_post_step_callback"
        )


def enter(space: pymunk.Space) -> bool:
    """Begin a step of a space, or what else reads or writes it; returns whether this is the outermost one, which at its
    end has to delete the space from STEPPING: post-step callbacks may step it again.

    Raises:
        RuntimeError: another thread steps it.
    """
    thread, outermost = get_ident(), space not in STEPPING
    if STEPPING.setdefault(space, thread) != thread:
        raise of_another_thread(space)
    return outermost
