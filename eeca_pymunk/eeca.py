"""EECA: the energy-conserving stepper. Its closure makes a `Method` that steps the arrays; the rest is shared with all
steppers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Protocol
from weakref import ref

from .arrays import AnyArray, FloatArray, IntArray
from .closures.time_of_impact import TimeOfImpact
from .impacts.scene import EventLoop
from .reentry import BUSY
from .report import Details, Outcome
from .runs import RunningStepper
from .saved import Saved, sides_of
from .space.arbiters import Touches, show_contacts, touches
from .space.decisions import Rules
from .space.world import World
from .transfer import OTHER_BODIES
from .unmet import Unmet, of_missed

if TYPE_CHECKING:
    import pymunk


class Method(Protocol):
    """Steps the arrays of one world. Results of earlier steps that it keeps, such as contact forces, last as long as
    the world."""

    def step(
        self, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, dt: float, gx: float, gy: float,
        half_damping: float,
    ) -> int:  # fmt: skip
        """From the states read to those to be written: status bits or a negative code of `transfer.py`."""

    def rule(self, rules: Mapping[tuple[int, int], tuple[float, float, float, float]]) -> None:
        """Values of collision handlers for pairs of shapes (a < b) in the next step: elasticity (negative: no
        collision), friction, and surface velocity of b relative to a."""

    def details(
        self, dt: float, bodies: tuple[pymunk.Body, ...], owner: IntArray
    ) -> Details | Callable[[], Details]:  # fmt: skip
        """The arrays of the report of the last step, or a function that makes them; `owner` (k,): index in `bodies` of
        the body of each shape."""

    def outcome(self) -> Outcome:
        """Of the last step, or of none."""


class Closure(Protocol):
    """Chooses psi2, the parameter that conservation leaves free: the instant at which impulses act."""

    def prepare(self, world: World) -> Method:
        """The method that steps this world, energy and momentum exact; UnsupportedFeature for features that the closure
        does not support."""


class EECA(RunningStepper):
    """Conserves energy, linear and angular momentum through every contact, at any dt (paper).

    Args:
        space: a pymunk space.
        closure: the rule for psi2; `TimeOfImpact()` if None.
        sync: update pymunk's own shapes after each step, for its queries and drawing, and call its post-step callbacks
            (in spaces with collision handlers they are called in any case). False is faster.
        ignore: features to leave out instead of raising UnsupportedFeature; only "friction". Warns once.
    """

    def __init__(
        self, space: pymunk.Space, closure: Closure | None = None, *, sync: bool = True, ignore: Sequence[str] = ()
    ) -> None:
        self.closure: Closure = TimeOfImpact() if closure is None else closure
        self._saved: Saved | None = None  # in a copy, until its first step
        self._ruled: Rules | None = None  # the rules that the method has
        self._shown: tuple[float, World | None, Touches | None] = -1.0, None, None
        super().__init__(space, sync=sync, ignore=ignore)

    def __getstate__(self) -> dict[str, object]:
        state = super().__getstate__()
        state.pop("_method", None)
        state["_shown"] = -1.0, None, None
        world = self._world
        if world is not None and isinstance(self._method, EventLoop):
            state["_saved"] = Saved(world, self._method, self.decisions)
        return state

    def refresh(self) -> None:
        super().refresh()
        self._saved = None

    def prepare(self, world: World, past: World | None) -> None:
        myself = ref(self)
        show_contacts(self.space, lambda: None if (me := myself()) is None else me._touches())
        self._sync.renews = self._sleep is None  # groups of sleeping bodies are found from arbiters
        saved, self._saved, self._ruled = self._saved, None, None
        if saved is not None and saved.resume(world, self.decisions):
            self._method: Method = saved.method
            return
        sides = None if past is None or (loop := self.event_loop) is None else sides_of(past, loop)
        world.load(mobilities=world is past)
        self._method = self.closure.prepare(world)
        if self._patches and world.joints is None and isinstance(self._method, EventLoop):
            self._method.keep_fresh()
        if sides is not None and isinstance(self._method, EventLoop):
            sides.recall(world, self._method)
        if world.joints is not None:
            world.joints.planned()
            world.find_parted()
            self._method.rule(world.laws())

    @property
    def event_loop(self) -> EventLoop | None:
        return self._method if isinstance(self._method, EventLoop) else None

    def _touches(self) -> Touches | None:
        """Pairs that touched in the last step, for pymunk's arbiters; None if pymunk has taken a step since."""
        world = self._world
        self._sync.renew()
        if world is None or not isinstance(self._method, EventLoop) or not self._sync.is_ours():
            return None
        step = self._method.scene.PAR.stamp
        if self._shown[0] != step or self._shown[1] is not world:
            self._shown = step, world, Touches(touches(self._method.events, world.shapes))
        return self._shown[2]

    def adjust(self, world: World, dt: float) -> bool:
        parted = False
        joints = world.joints
        if joints is not None:
            if joints.functions or joints.edited:
                BUSY.add(self.space)
                try:
                    joints.update(world.state, world.bodies.row, dt)
                finally:
                    BUSY.discard(self.space)
            elif not joints.idle():
                joints.update(world.state, world.bodies.row, dt)
            if joints.replan or joints.ends_moved:
                assert isinstance(self._method, EventLoop)
                if self._method.holds_others():
                    return False
                if joints.replan:
                    self._method.plan()
                joints.planned()
            parted = world.find_parted()
        if parted or (world.collisions and world.rules is not self._ruled):
            self._ruled = world.rules
            self._method.rule(world.laws())
        return True

    def advance(self, world: World, dt: float, half_damping: float) -> int:
        gx, gy = world.gravity
        if not world.plain and not self.adjust(world, dt):
            return OTHER_BODIES
        return self._method.step(world.STATES, world.WALK, world.EXTRA, world.ENDS, dt, gx, gy, half_damping)

    def rewound(self, world: World) -> list[AnyArray]:
        loop = self.event_loop
        return [*super().rewound(world), *(() if loop is None else (loop.scene.SIDE,))]

    def details(self, world: World, dt: float) -> Details | Callable[[], Details]:
        return self._method.details(dt, world.bodies.items, world.owner)

    def unmet(self, world: World) -> tuple[Unmet, ...] | Callable[[], tuple[Unmet, ...]]:
        if not isinstance(self._method, EventLoop):
            return ()
        return partial(of_missed, self._method.missed, world.bodies.items, world.owner)

    def outcome(self) -> Outcome:
        return self._method.outcome()
