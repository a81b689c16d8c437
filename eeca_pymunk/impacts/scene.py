"""The arrays of the event loop for one world, and steps on them, with memory that grows as needed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import AnyArray, FloatArray, IntArray, side_by_side
from ..compiled.library import check
from ..compiled.records import R, Rows, columns, put, rows
from ..contacts.memory import forget
from ..geometry.corners import core_room, thin_memory
from ..islands.accounting import flag_again
from ..joints.held import held_bodies
from ..joints.workspace import make_joints
from ..layout import NOW as READ
from ..model.bodies import CHECK, Body, Member, Next, Rest
from ..model.contacts import Force, Impulse, Pair, Pushed
from ..model.joints import Joint
from ..model.parameters.events import MANY_BODIES, STEP_LOOKS, STEP_LOOKS_BODY
from ..model.parameters.impulses import AUGMENTATION
from ..model.scene import scene_with
from ..model.shapes import Link, Shape
from ..model.step import Missed
from ..pairs.setup import with_lists, with_more_room
from ..report import Details, of_events
from ..transfer import FORCES
from .remembering import Remembering
from .run import ROOM_FOR_IMPACTS, run
from .run_buffers import RunBuffers
from .step import ROOM_FOR_CONTACTS, ROOM_FOR_EVENTS, ROOM_FOR_LISTS, step

if TYPE_CHECKING:
    import pymunk

RULE_COLUMNS = 6
_MISSED = 32  # rows of MISSED: those reported of a step
_CONTACTS = 256  # rows of PUSHED at first, a power of 2
_OF_A_BODY, _MANY = 32, 1 << 16  # rows for each body where contacts may persist, and all rows at most at first


def _longer(table: Rows[R], used: int) -> Rows[R]:
    """A table of twice as many rows, with the first `used` ones copied."""
    longer: Rows[R] = np.zeros(2 * len(table), table.dtype)  # type: ignore[assignment]
    longer[:used] = table[:used]
    return longer


def _details(logged: IntArray, dt: float, bodies: tuple[pymunk.Body, ...], owner: IntArray) -> Details:
    """`of_events` for impulses `logged` as integers."""
    return of_events(logged.reshape(-1).view(Impulse.TYPE), dt, bodies, owner)  # type: ignore[arg-type]


class EventLoop(Remembering):
    """Steps the packed bodies and shapes of a world from impact to impact.

    Args:
        BODY, SHAPE, LINK, VERTEX: see `..model`; BODY has the present poses.
        disks: the first so many rows of BODY are single disks.
        limit: impacts that a body may have in a step.
        joint: (j,) the joints; kept, not copied. Bodies are rows of BODY, or len(BODY) + row of PARTNER (x,), which
            joints cannot move. None for a scene without joints.
        together: whether all contacts of a step act together at its middle, instead of at their instants.
        still: (x,) 1 for rows of PARTNER that never move; None: all.
        order: of the steps of components: 4, for those without dissipation, drives and contacts; or 2.
    """

    def __init__(
        self, BODY: Rows[Body], SHAPE: Rows[Shape], LINK: Rows[Link], VERTEX: FloatArray, disks: int, limit: int,
        joint: Rows[Joint] | None = None, PARTNER: Rows[Body] | None = None, together: bool = False, order: int = 4,
        still: IntArray | None = None,
    ) -> None:  # fmt: skip
        n = len(BODY)
        self.mobility: FloatArray = columns(BODY, "inv_mass", "inv_inertia").copy()
        self.joint, self.partner = rows(Joint, 0) if joint is None else joint, BODY[:0] if PARTNER is None else PARTNER
        self._still: IntArray = np.ones(len(self.partner), np.int64) if still is None else still
        self._smooth: IntArray = np.ones(n, np.int64)
        self._smooth[LINK["owner"][SHAPE["friction"] > 0.0]] = 0
        HELD = held_bodies(BODY, self.joint, self.partner, self._still, self._smooth)
        BODY["inv_mass"][HELD["body"]] = BODY["inv_inertia"][HELD["body"]] = 0.0
        moving = int(np.count_nonzero(LINK["owner"] < n - 1))
        STATE, MEMBER, RESTING, PULL, BEGAN, TIME, OF, PLACE, BLOCK = side_by_side(
            ((n,), Next.TYPE), ((n,), Member.TYPE), ((n,), Rest.TYPE),
            ((n, 3), np.float64), ((n, 3), np.float64), ((8 * n + 64,), np.float64), ((8 * n + 64,), np.int64),
            ((n,), np.int64), ((n,), np.int64),
        )  # fmt: skip
        PLACE[:] = -1
        STATE["shapes"] = np.bincount(LINK["owner"][:moving], minlength=n)
        STATE["first_shape"] = np.cumsum(STATE["shapes"]) - STATE["shapes"]
        STATE["island"] = -1
        lossy = bool((SHAPE["elasticity"] < 1.0).any())
        self.together, self._order = together, order
        room = _CONTACTS
        while lossy and room < min(_OF_A_BODY * n, _MANY):
            room *= 2
        SIDE, CORNER = thin_memory(LINK, VERTEX, moving)
        scene = scene_with(
            BODY=BODY, STATE=STATE, SHAPE=SHAPE, LINK=LINK, VERTEX=VERTEX, CORE=core_room(LINK), SIDE=SIDE,
            CORNER=CORNER, RULE=np.zeros((0, RULE_COLUMNS)), HEAP_TIME=TIME, HEAP_BODY=OF,
            LOG=rows(Impulse, 4 * n + 64), BEGAN=BEGAN, PLACE=PLACE, BLOCK=BLOCK, PULL=PULL, MEMBER=MEMBER,
            RESTING=RESTING, PUSHED_BY=rows(Pair, room), PUSHED=rows(Pushed, room),
            KEYS=np.full(4 * room, -1, np.int64), FORCES=rows(Force, 4 * room), HELD=HELD,
            MISSED=rows(Missed, _MISSED),
        )  # fmt: skip
        scene, self.table = with_lists(scene, moving)
        self.scene = scene
        self._usual: FloatArray = self.scene.MARK["margin"].copy()
        self.scene.COUNT.limit, self.scene.COUNT.disks = limit, disks
        self.scene.COUNT.lossy, self.scene.COUNT.together = lossy, together
        self.scene.COUNT.budget = STEP_LOOKS + STEP_LOOKS_BODY * n * max(n, MANY_BODIES) // MANY_BODIES
        self.scene.MEMBER["tied"] = self.scene.MEMBER["next_tied"] = -1
        self.scene.RESTING["augmentation"] = AUGMENTATION
        self.jointed = joint is not None
        self.plan()

    def plan(self) -> None:
        """Find the components again: after changes of joints' kinds, bodies, eccentric anchors, or of mobilities."""
        self.joints = make_joints(self.scene.BODY, self.joint, self.partner, self._order)
        ring = self.scene.MEMBER
        ring["tied"] = ring["next_tied"] = -1
        for s in range(self.joints.TALLY.components):
            moved = np.flatnonzero(s == self.joints.OF)
            ring["tied"][moved], ring["next_tied"][moved] = moved[0], np.roll(moved, -1)

    def holds_others(self) -> bool:
        """Whether straight paths of joints hold other bodies than those of HELD, after changes of joints or of their
        ends."""
        BODY = self.scene.BODY.copy()
        put(BODY, self.mobility, "inv_mass", "inv_inertia")
        HELD = held_bodies(BODY, self.joint, self.partner, self._still, self._smooth)
        return HELD.tobytes() != self.scene.HELD.tobytes()

    def rebind(self, joint: Rows[Joint], PARTNER: Rows[Body]) -> None:
        """Use other arrays of joints with the same values."""
        self.joint, self.partner = joint, PARTNER
        self.joints = self.joints._replace(JOINT=joint, PARTNER=PARTNER)

    def step(
        self, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray, dt: float, gx: float, gy: float,
        half_damping: float,
    ) -> int:  # fmt: skip
        """Take a step, see `step.step`; a negative result is a code of `transfer.py`."""
        states, call = self._bound
        # Compared one by one, as this is done in every step.
        if states[0] is not STATES or states[1] is not WALK or states[2] is not EXTRA or states[3] is not ENDS:
            call = self._bind_to((STATES, WALK, EXTRA, ENDS))
        status = call(dt, gx, gy, half_damping, -1)
        while status <= ROOM_FOR_LISTS:
            self._grow(check("step", status))
            bits = FORCES if STATES[READ, :, 6:].any() else 0
            status = self._bind_to((STATES, WALK, EXTRA, ENDS))(dt, gx, gy, half_damping, bits)
        return status

    def follow(self, buffers: RunBuffers, states: tuple[AnyArray, ...]) -> int:
        """Take the steps of `buffers`; returns all bits, a negative code of `transfer.py`, or `run.ENERGY`."""
        while True:
            call = buffers.call = buffers.call or self._bind_run(buffers, states)
            status = check("run", call())
            if status == ROOM_FOR_IMPACTS:
                buffers.more_events()
            elif status <= ROOM_FOR_LISTS:
                self._grow(status)
                buffers.call = None
            else:
                return status

    def _bind_run(self, buffers: RunBuffers, states: tuple[AnyArray, ...]) -> Callable[..., int]:
        return run.bind(self.table, self.ties, buffers.table, *states, self._usual)

    def _bind_to(self, states: tuple[AnyArray, ...]) -> Callable[..., int]:
        """The step as machine code, bound to these arrays and to those of the scene."""
        call = step.bind(self.table, self.ties, *states, self._usual)
        self._bound = states, call
        return call

    def _grow(self, wish: int) -> None:
        scene = self.scene
        if wish == ROOM_FOR_EVENTS:
            self.scene = scene._replace(LOG=_longer(scene.LOG, int(scene.COUNT.logged)))
            return
        if wish == ROOM_FOR_CONTACTS:
            size, count = len(scene.KEYS), int(scene.COUNT.remembered)
            self._clean(size)
            if count - scene.COUNT.remembered >= size // 8:
                return
            self._clean(2 * size)
            used = int(scene.COUNT.pushes)
            self.scene = self.scene._replace(
                PUSHED_BY=_longer(scene.PUSHED_BY, used), PUSHED=_longer(scene.PUSHED, used)
            )
            return
        self.scene = with_more_room(scene, float(scene.PAR.now))
        flag_again(self.table)
        # Margin circles have other centres: all bodies are predicted again.
        n, now = len(scene.BODY) - 1, float(scene.PAR.now)
        scene.BODY["due"][:n], scene.STATE["other"][:n] = now, CHECK
        scene.HEAP_TIME[:n], scene.HEAP_BODY[:n], scene.COUNT.heap = now, np.arange(n), n

    def _clean(self, size: int) -> None:
        """Copy the forces of the last step to tables of `size` rows; older ones are dropped."""
        scene = self.scene
        KEYS, TABLE = np.full(size, -1, np.int64), rows(Force, size)
        forget(scene.KEYS, scene.FORCES, scene.COUNT, KEYS, TABLE, float(scene.PAR.stamp) - 1.0)
        self.scene = scene._replace(KEYS=KEYS, FORCES=TABLE)

    def rule(self, rules: Mapping[tuple[int, int], tuple[float, float, float, float]]) -> None:
        """Set the law of pairs of shapes a < b: elasticity (below 0: they pass through each other), friction and
        surface velocity (2)."""
        table = np.array([(*pair, *what) for pair, what in rules.items()], float).reshape(-1, RULE_COLUMNS)
        if not np.array_equal(table, self.scene.RULE):
            self.scene = self.scene._replace(RULE=table)

    @property
    def events(self) -> Rows[Impulse]:
        """(m,) impulses of the last step, a copy."""
        return self.logged().reshape(-1).view(Impulse.TYPE)  # type: ignore[return-value]

    def details(
        self, dt: float, bodies: tuple[pymunk.Body, ...], owner: IntArray
    ) -> Callable[[], Details]:  # fmt: skip
        """A function that makes the arrays of the report of the last step of length dt; `owner` (k,): index in `bodies`
        of each shape's body."""
        return partial(_details, self.logged(), dt, bodies, owner)

    @property
    def book(self) -> FloatArray:
        """(7,) the entries of the ledger of the last step, a copy (`..energy.ledger`)."""
        return self._book.copy()

    @property
    def missed(self) -> Rows[Missed]:
        """(m,) the first budgets and tolerances that the last step has not met, a copy."""
        return self.scene.MISSED[: self.scene.COUNT.unmet].copy()
