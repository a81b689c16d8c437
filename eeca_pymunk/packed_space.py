"""PackedSpace: a stepper's arrays of its space, updated when the space has changed."""

from __future__ import annotations

import math
import warnings
from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar
from weakref import WeakMethod

import numpy as np

from .arrays import FloatArray, IntArray
from .energy.ledger import BOOK_AFTER
from .errors import NotFiniteError
from .impacts.scene import EventLoop
from .impacts.taking_over import Kept
from .model.step import ENERGY, NOT_FINITE, OVERFLOW
from .space.arbiters import Touches
from .space.checks import check_ignored
from .space.decisions import NO_RULES, Decisions, Rules
from .space.describe import describe
from .space.patching import kept_rows
from .space.sleep_groups import put_to_sleep, sleeping_groups, wake_neighbours
from .space.sleeping import AT_FIRST, Sleep
from .space.sync import Sync
from .space.world import World
from .stepper import Method, Stepper

if TYPE_CHECKING:
    import pymunk

TOO_FAR = "the step would overflow; take a smaller dt, or stop this run"  # remedy, at the end of messages

Own = TypeVar("Own", bound="PackedSpace")
# Bodies, and the result of `PackedSpace.sleep_state` for these.
Slept: TypeAlias = tuple[list["pymunk.Body"], FloatArray, IntArray, IntArray]


class PackedSpace(Stepper):
    """A stepper that keeps its space as the arrays of a `World`; arguments as of `PackedStepper`.

    Attributes:
        reads: number of readings of the whole space: the first, and those after changes that cannot be patched.
        patches: number of other updates: after edits in place (`space/patching.py`), and of constraints added, removed.
        objects_read: number of bodies, shapes and constraints that both have read from pymunk.
        decisions: of collision handlers in earlier steps.
    """

    def __init__(self, space: pymunk.Space, *, sync: bool = True, ignore: Sequence[str] = ()) -> None:
        super().__init__(space)
        self.sync = sync
        self.ignore = check_ignored(ignore)
        self._warned = False
        self._world: World | None = None
        self._sync: Sync
        self._sleep: Sleep | None = None  # None if bodies cannot sleep
        self._slept: Slept | None = None  # in a copy, until its first step
        self._method: Method
        self._ruled: Rules | None = None  # the rules that the method has
        # The pairs that arbiters show: stamp of the step, world, pairs.
        self._shown: tuple[float, World | None, Touches | None] = -1.0, None, None
        self._idle_book: list[float] | None = None  # book of a step in which all dynamic bodies sleep: zeros
        self.reads = self.patches = self.objects_read = 0
        self.decisions = Decisions()
        self._update_world()

    def __getstate__(self) -> dict[str, object]:
        # Called for copies and pickles. The original is not changed; the copy reads its space at its first step.
        state = self.__dict__.copy()
        for made in ("_sync", "_method"):
            state.pop(made, None)
        state["_world"] = state["_sleep"] = None
        state["_shown"] = -1.0, None, None
        state["decisions"] = Decisions()
        if self.space.sleep_time_threshold < math.inf:
            bodies = list(self.space.bodies)
            state["_slept"] = bodies, *self.sleep_state(bodies)
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._put_copy_to_sleep()

    def _put_copy_to_sleep(self) -> None:
        """In a copy, put to sleep the bodies that sleep in the original: those of pymunk's copies are awake. Called
        again before its first step: a space that refers to its stepper is still without bodies at the first call."""
        if self._slept is not None:
            bodies, _, groups, _ = self._slept
            if all(body.space is self.space for body in bodies):
                put_to_sleep(bodies, groups)
                groups.fill(-1)  # once only

    def __copy__(self: Own) -> Own:
        """Another stepper of the same space, without results of earlier steps, whose arrays two cannot share."""
        other = type(self).__new__(type(self))
        other.__dict__.update({**self.__getstate__(), "_saved": None, "_slept": None})
        return other

    def refresh(self) -> None:
        self._world = None
        self.decisions.forget(self.space)
        if self._sleep is not None:
            self._sleep.recall({}, AT_FIRST)

    @abstractmethod
    def make_method(self, world: World) -> Method:
        """A method for a world, without results of earlier steps."""

    def choose_method(self, world: World, past: World | None, kept: Kept | None = None) -> None:
        """Choose the method of a world. `past`: that of the present method, the same one if its joints or rows have
        changed; None at first, or after `refresh`.  `kept`: its rows for which results of earlier steps hold."""
        self._use(self.make_method(world))

    def _use(self, method: Method, ruled: Rules | None = NO_RULES) -> None:
        """Step the present world by this method, which has these rules; None if they are unknown."""
        self._method, self._ruled = method, ruled

    @property
    def event_loop(self) -> EventLoop | None:
        """The event loop of the present world; None if its method is none."""
        return self._method if isinstance(self._method, EventLoop) else None

    def patch(self, world: World, moved: bool) -> bool:
        """Write edits of shapes and bodies into the rows of a world, and into the arrays of the method. No shape or
        body was added or removed. False if a new reading is needed. `moved`: whether static bodies may have moved."""
        return False

    @property
    def model(self) -> str:
        return describe(self._present())

    def _present(self) -> World:
        """The present space as a checked World; the states in its arrays may be those of an earlier step."""
        world = self._world
        return world if world is not None and world.current() else self._update_world()

    def _update_world(self, anew: bool = False) -> World:
        """The present space as a checked World: the last one, or that one patched, or a new reading (if `anew`)."""
        past, self._world = self._world, None
        self._put_copy_to_sleep()
        if self._sleep is not None and self.space.sleep_time_threshold == math.inf:
            self._sleep.wake()
            self._sleep, anew = None, True
        if self._sleep is not None and past is not None and tuple(self.space.gravity) != tuple(past.gravity):
            self._sleep.wake()  # pymunk has woken only every second group
        if past is not None and past.same_things():
            if not (anew or past.edited()):
                return self._update_settings(past)
            if self._patchable(past) and self.patch(past, anew):
                self.patches += 1
                return self._adopt(past)
        if self._sleep is not None:
            self._sleep.wake_changed()
            wake_neighbours(self.space)
        world = World(self.space, self.ignore, past)
        if world.lacks_friction and not self._warned:
            self._warned = True
            warnings.warn(f"{type(self).__name__} steps on without the friction of this space", stacklevel=4)
        self.reads += 1
        last = None if past is None else self._sync
        self._sync = Sync(world, WeakMethod(self._touches) if last is None else last.touches, last)
        self._sleep = Sleep(world, self._sleep, self._sync) if world.sleeps else None
        slept, self._slept = self._slept, None
        if self._sleep is not None and slept is not None:
            self._sleep.recall(dict(zip(slept[0], slept[1].tolist(), strict=True)), slept[3])
        kept = None if past is None or past.void or self.event_loop is None else kept_rows(world, past)
        self.choose_method(world, past, kept)
        if self._sleep is not None and (book := self._method.outcome()[0]) is not None:
            self._idle_book = [0.0] * len(book)
        return self._adopt(world)

    def _patchable(self, world: World) -> bool:
        """Whether `patch` may be tried. Where bodies may sleep, only if none sleeps, since changes would wake some, and
        pymunk has taken no step of its own, after which the space is read again anyway."""
        if self._sleep is None:
            return self.space.sleep_time_threshold == math.inf and (world.joints is None or world.edited())
        return world.edited() and not (self._sleep.any_asleep or self._sleep.changed())

    def _update_settings(self, world: World) -> World:
        """The world of the last step, after changes of settings and joints only."""
        joints = world.joints
        world.read_settings()
        if self._sleep is None and self.space.sleep_time_threshold < math.inf:
            self._sleep = Sleep(world, None, self._sync)
        if world.joints is not joints:
            self.patches += 1
            if (loop := self.event_loop) is None:
                self.choose_method(world, world)
            elif world.joints is None:
                loop.rejoin()
                world.find_parted()
                loop.rule(world.laws())
        return self._adopt(world)

    def _touches(self) -> Touches | None:
        """Pairs that touched in the last step, for pymunk's arbiters; None if pymunk has taken a step since."""
        self._sync.renew()
        world, loop = self._world, self.event_loop
        if world is None or loop is None or not self._sync.is_ours():
            return None
        if self._shown[:2] != (loop.stamp, world):
            self._shown = loop.stamp, world, Touches(loop.events, dict(enumerate(world.shapes)))
        return self._shown[2]

    def _adopt(self, world: World) -> World:
        """Use this world, which is current, in the next steps."""
        self.objects_read, world.objects_read = self.objects_read + world.objects_read, 0
        self._world = world
        return world

    def wake(self) -> None:
        """Wake all bodies."""
        if self._sleep is not None:
            self._sleep.wake()
            wake_neighbours(self.space)

    def sleep_state(self, bodies: Sequence[pymunk.Body]) -> tuple[FloatArray, IntArray, IntArray]:
        """(N,) times at rest of the bodies, (N,) their groups as of `sleeping_groups`, (2,) `Sleep.timers`."""
        if self._sleep is None:
            return np.zeros(len(bodies)), sleeping_groups(bodies), np.zeros(2, np.int64)
        return self._sleep.rested(bodies), sleeping_groups(bodies), self._sleep.timers

    def recall_sleep(
        self, bodies: Sequence[pymunk.Body], rested: FloatArray, groups: IntArray, timers: IntArray
    ) -> None:
        """Restore what `sleep_state` returned, for bodies that are all awake."""
        if self._sleep is not None:
            put_to_sleep(bodies, groups)
            self._update_world(anew=bool((groups >= 0).any()))
            self._sleep.recall(dict(zip(bodies, rested.tolist(), strict=True)), timers)

    def _undo(self, world: World, state: FloatArray) -> None:
        """After a failure in a step: restore the states (N, 9) of the bodies; the space is read again."""
        self._world = None
        world.bodies.scatter(state)

    def _raise_failure(self, world: World, dt: float, status: int) -> None:
        """Raise NotFiniteError for a negative status, with the body and value if known."""
        self._world = None
        if status == ENERGY:
            book = self._method.outcome()[0]
            assert book is not None  # without a ledger there is no such status
            raise NotFiniteError(f"the energy of the space would be {book[BOOK_AFTER]} after dt = {dt}: {TOO_FAR}")
        if status == NOT_FINITE:
            world.bodies.check_finite(world.state)
        if status == OVERFLOW:
            world.bodies.check_finite(world.ended(), TOO_FAR)
        raise NotFiniteError(f"a body would move an infinite distance within dt = {dt}: {TOO_FAR}")
