"""EECA: the energy-conserving stepper. Its closure makes the `Method` that steps the arrays."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Protocol

from .closures.time_of_impact import TimeOfImpact
from .impacts.taking_over import Kept
from .reentry import CALLING
from .runs import RunningStepper
from .saved import Saved
from .space.private.spaces import handlers
from .space.world import World
from .stepper import Method

if TYPE_CHECKING:
    import pymunk


class Closure(Protocol):
    """Chooses psi2, the parameter that the conservation laws leave free: the instant at which impulses act, tau =
    (1 - psi2) dt / 2 after the start of the step."""

    def prepare(self, world: World) -> Method:
        """A method that steps this world and conserves energy and momentum; UnsupportedFeature for features that the
        closure does not support."""


class EECA(RunningStepper):
    """Conserves energy, linear and angular momentum in every contact, at any dt (the paper's algorithm).

    Args:
        space: a pymunk space.
        closure: the rule for psi2; `TimeOfImpact()` if None.
        sync: update pymunk's own shapes, when queries or drawing read them, and call its post-step callbacks (in spaces
            with collision handlers they are called in any case). False is faster.
        ignore: features to leave out instead of raising UnsupportedFeature; only "friction". Warns once.
    """

    def __init__(
        self, space: pymunk.Space, closure: Closure | None = None, *, sync: bool = True, ignore: Sequence[str] = ()
    ) -> None:
        if closure is not None and (isinstance(closure, type) or not hasattr(closure, "prepare")):
            raise TypeError(f"closure = {closure!r}: give an instance, such as TimeOfImpact(), or None")
        self.closure: Closure = TimeOfImpact() if closure is None else closure
        self._saved: Saved | None = None  # in a copy, until its first step
        super().__init__(space, sync=sync, ignore=ignore)

    def __getstate__(self) -> dict[str, object]:
        known = bool(handlers(self.space)) if self._world is None else self.event_loop is not None
        if known and self.space not in CALLING:
            with suppress(ValueError):  # which the next step raises
                # What the program has changed since the last step, and what handlers have rejected, which pymunk's
                # copies lack, so that the copy has it, too.
                self.catch_up()
        state = super().__getstate__()
        if self._world is not None and (loop := self.event_loop) is not None:
            state["_saved"] = Saved(self._world, loop, self.decisions)
        return state

    def refresh(self) -> None:
        super().refresh()
        self._saved = None

    def make_method(self, world: World) -> Method:
        return self.closure.prepare(world)

    def choose_method(self, world: World, past: World | None, kept: Kept | None = None) -> None:
        before = None if past is None else self.event_loop
        if past is world:  # its rows or joints have changed
            if before is not None:
                before.release()
            world.load()
        if before is not None:
            world.memory = world.memory.other()
        saved, self._saved = self._saved, None
        if past is None and saved is not None and saved.resume(world, self.decisions):
            self._use(saved.method, None)
            return
        self._use(self.make_method(world))
        loop = self.event_loop
        if loop is not None and before is not None and kept is not None:
            loop.go_on_from(before, kept)
        if world.joints is not None:
            assert loop is not None  # other methods refuse joints
            world.joints.planned(loop.held)
            world.find_parted()
            self._method.rule(world.laws())
