"""The arrays of the event loop for one world, and a step on them that gets the room it wants."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import AnyArray, FloatArray, IntArray, side_by_side
from ..compiled import table_of
from ..compiled.library import check
from ..layout import COUNT as VERTICES
from ..layout import DUE, ELASTICITY, EVENT_COLUMNS, OWNER
from ..layout import NOW as READ
from ..pairs.layout import MARGIN
from ..pairs.setup import near_lists, rebuilt
from ..report import Details, of_events
from ..sustained.memory import FORCE_COLUMNS, forget
from ..sustained.relax import FRESH
from ..transfer import FORCES
from .booking import flag_again
from .layout import (
    AFTER,
    BLOCKS,
    CHECK,
    COUNT_LENGTH,
    DISKS,
    FIRST_SHAPE,
    HEAP,
    ISLAND,
    LEDGER,
    LIMIT,
    LOCK,
    LOGGED,
    MEMBER_COLUMNS,
    NEXT_TIED,
    NOW,
    OTHER,
    PAR_LENGTH,
    PUSHED_COLUMNS,
    PUSHES,
    RELAX,
    REMEMBERED,
    RESTING_COLUMNS,
    SHAPES,
    SOLVES,
    STAMP,
    STATE_COLUMNS,
    TIED,
    UNMET,
    Scene,
)  # fmt: skip
from .step import ROOM_FOR_CONTACTS, ROOM_FOR_EVENTS, ROOM_FOR_LISTS, step
from .together import step_together

if TYPE_CHECKING:
    import pymunk

RULE_COLUMNS = 6
UNBOUND: tuple[tuple[AnyArray | None, ...], Callable[..., int]] = (None,) * 4, int
_CONTACTS = 256  # of islands, that there is room for at first; powers of 2
_OF_A_BODY, _MANY = 32, 1 << 16  # for each body where contacts may last, up to so many: untouched memory is free


def _longer(table: AnyArray, used: int) -> AnyArray:
    """A table of twice as many rows, with those in use."""
    longer = np.zeros((2 * len(table), *table.shape[1:]), table.dtype)
    longer[:used] = table[:used]
    return longer


class EventLoop:
    """Steps the packed bodies and shapes of a world from impact to impact.

    Args:
        BODY, SHAPE, LINK, VERTEX: see `..layout`; BODY has the poses of now.
        disks: the first so many rows of BODY are lone disks.
        limit: impacts that a body may have in a step.
    """

    def __init__(
        self, BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, VERTEX: FloatArray, disks: int, limit: int
    ) -> None:
        n = len(BODY)
        self.disks = disks
        moving = int(np.count_nonzero(LINK[:, OWNER] < n - 1))
        STATE, MEMBER, RESTING, PULL, BEGAN, TIME, OF, PLACE, BLOCK = side_by_side(
            ((n, STATE_COLUMNS), np.int64), ((n, MEMBER_COLUMNS), np.int64), ((n, RESTING_COLUMNS), np.float64),
            ((n, 3), np.float64), ((n, 3), np.float64), ((8 * n + 64,), np.float64), ((8 * n + 64,), np.int64),
            ((n,), np.int64), ((n,), np.int64),
        )  # fmt: skip
        PLACE[:] = -1
        STATE[:, SHAPES] = np.bincount(LINK[:moving, OWNER], minlength=n)
        STATE[:, FIRST_SHAPE] = np.cumsum(STATE[:, SHAPES]) - STATE[:, SHAPES]
        STATE[:, ISLAND] = -1
        near = near_lists(BODY, SHAPE, LINK, VERTEX, moving)
        vertices = max(2, int(LINK[:, VERTICES].max(initial=2)))
        lossy = bool((SHAPE[:, ELASTICITY] < 1.0).any())
        self._options: tuple[int, ...] = disks, lossy  # numbers that the step takes besides dt, gravity and damping
        room = _CONTACTS
        while lossy and room < min(_OF_A_BODY * n, _MANY):
            room *= 2
        self.scene = Scene(
            BODY, STATE, SHAPE, LINK, VERTEX, *near, np.zeros((0, RULE_COLUMNS)), TIME, OF,
            np.zeros((4 * n + 64, EVENT_COLUMNS)), BEGAN, PLACE, BLOCK, PULL, MEMBER, RESTING,
            np.zeros((room, 3), np.int64), np.zeros((room, PUSHED_COLUMNS)),
            np.full(4 * room, -1, np.int64), np.zeros((4 * room, FORCE_COLUMNS)),
            np.zeros((2, vertices, 4)), np.zeros(PAR_LENGTH), np.zeros(COUNT_LENGTH, np.int64),
        )  # fmt: skip
        self.near = near
        self.scene.COUNT[LIMIT], self.scene.COUNT[DISKS] = limit, disks
        self.scene.MEMBER[:, TIED : NEXT_TIED + 1] = -1
        self.scene.RESTING[:, RELAX : RELAX + 3] = FRESH

    @property
    def scene(self) -> Scene:
        """All arrays; replace some by setting another."""
        return self._scene

    @scene.setter
    def scene(self, arrays: Scene) -> None:
        self._scene, self.table = arrays, table_of(arrays)
        self._bound: tuple[tuple[AnyArray | None, ...], Callable[..., int]] = UNBOUND
        self._book: FloatArray = arrays.PAR[LEDGER : AFTER + 1]

    def step(
        self, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, dt: float, gx: float, gy: float,
        left: float,
    ) -> int:  # fmt: skip
        """See `step.step`; a negative answer is one of `transfer.py`."""
        states, call = self._bound
        # One by one, since this is paid in every step.
        if states[0] is not STATES or states[1] is not WALK or states[2] is not EXTRA or states[3] is not ENDS:
            call = self._bind_to((STATES, WALK, EXTRA, ENDS))
        status = call(dt, gx, gy, left, *self._options, -1)
        while status <= ROOM_FOR_LISTS:
            self._grow(check("step", status))
            bits = FORCES if STATES[READ, :, 6:].any() else 0
            status = self._bind_to((STATES, WALK, EXTRA, ENDS))(dt, gx, gy, left, *self._options, bits)
        return status

    def _bind_to(self, states: tuple[AnyArray, ...]) -> Callable[..., int]:
        """The step as machine code, bound to these arrays and to those of the scene."""
        call = self._bind(states)
        self._bound = states, call
        return call

    def _bind(self, states: tuple[AnyArray, ...]) -> Callable[..., int]:
        return step.bind(self.table, *states)

    def __getstate__(self) -> dict[str, object]:
        # Addresses are those of this process.
        return {key: value for key, value in self.__dict__.items() if key not in ("table", "_bound")}

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)
        self.scene = self._scene

    def _grow(self, wish: int) -> None:
        scene = self.scene
        if wish == ROOM_FOR_EVENTS:
            self.scene = scene._replace(LOG=_longer(scene.LOG, int(scene.COUNT[LOGGED])))
            return
        if wish == ROOM_FOR_CONTACTS:
            size, count = len(scene.KEYS), int(scene.COUNT[REMEMBERED])
            self._clean(size)
            if count - scene.COUNT[REMEMBERED] >= size // 8:
                return
            self._clean(2 * size)
            used = int(scene.COUNT[PUSHES])
            self.scene = self.scene._replace(
                PUSHED_BY=_longer(scene.PUSHED_BY, used), PUSHED=_longer(scene.PUSHED, used)
            )
            return
        self.near = rebuilt(self.near.larger(), scene.BODY, scene.SHAPE, scene.LINK, float(scene.PAR[NOW]))
        self.scene = scene._replace(POOL=self.near.POOL, FLAG=self.near.FLAG)
        flag_again(self.table)
        # Margin circles are drawn about other places now: everybody is forecast anew.
        n, now = len(scene.BODY) - 1, float(scene.PAR[NOW])
        scene.BODY[:n, DUE], scene.STATE[:n, OTHER] = now, CHECK
        scene.HEAP_TIME[:n], scene.HEAP_BODY[:n], scene.COUNT[HEAP] = now, np.arange(n), n

    def _clean(self, size: int) -> None:
        """Forget the forces of steps before the last one, in tables of so many rows."""
        scene = self.scene
        KEYS, TABLE = np.full(size, -1, np.int64), np.zeros((size, FORCE_COLUMNS))
        forget(scene.KEYS, scene.FORCES, scene.COUNT[REMEMBERED:], KEYS, TABLE, float(scene.PAR[STAMP]) - 1.0)
        self.scene = scene._replace(KEYS=KEYS, FORCES=TABLE)

    def rule(self, rules: Mapping[tuple[int, int], tuple[float, float, float, float]]) -> None:
        """Let pairs of shapes (a < b) have this elasticity (below 0: they pass), friction and surface velocity from now
        on."""
        table = np.array([(*pair, *what) for pair, what in rules.items()], float).reshape(-1, RULE_COLUMNS)
        if len(table) or len(self.scene.RULE):
            self.scene = self.scene._replace(RULE=table)

    @property
    def events(self) -> FloatArray:
        """(m, 11) EVENT rows of the last step, a copy."""
        return self.scene.LOG[: self.scene.COUNT[LOGGED]].copy()

    def details(
        self, dt: float, bodies: tuple[pymunk.Body, ...], owner: IntArray
    ) -> Callable[[], Details]:  # fmt: skip
        """What makes the arrays of the report of the last step; `owner` (k,) is the place of every shape's body in
        `bodies`."""
        return partial(of_events, self.events, dt, bodies, owner)

    @property
    def book(self) -> FloatArray:
        """(7,) what the ledger of the last step is made of, a copy (`..energy.ledger`)."""
        return self._book.copy()

    @property
    def lock(self) -> float:
        """Scale of the energy lock of the last step that was farthest from 1."""
        return float(self.scene.PAR[LOCK])

    @property
    def converged(self) -> bool:
        """Whether the last step left nothing undone."""
        return bool(self.scene.COUNT[UNMET] == 0)

    @property
    def iterations(self) -> int:
        """Solves of islands and of blocks in the last step."""
        return int(self.scene.COUNT[SOLVES] + self.scene.COUNT[BLOCKS])


class Together(EventLoop):
    """Steps the same arrays with all contacts of a step acting together at its middle (`together.py`)."""

    def __init__(self, BODY: FloatArray, SHAPE: FloatArray, LINK: IntArray, VERTEX: FloatArray, disks: int) -> None:
        super().__init__(BODY, SHAPE, LINK, VERTEX, disks, 0)
        self._usual: FloatArray = self.near.MARK[:, MARGIN].copy()
        self._options = ()

    def _bind(self, states: tuple[AnyArray, ...]) -> Callable[..., int]:
        return step_together.bind(self.table, *states, self._usual)
