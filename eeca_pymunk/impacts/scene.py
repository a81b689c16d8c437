"""The arrays of the event loop for one world, and steps on them, with memory that grows as needed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray, IntArray
from ..compiled import Table, replaced
from ..compiled.library import result_of
from ..compiled.records import Rows, columns, from_bytes, rows
from ..contacts.forces import copy_recent
from ..islands.accounting import flag_pairs
from ..joints.pinned import find_pinned, release_held
from ..joints.workspace import NO_LINKAGE, Linkage, tie_components
from ..model.bodies import CHECK, MOBILITY, Body
from ..model.contacts import Force, Impulse
from ..model.joints import Joint, Pinned
from ..model.parameters.events import MANY_BODIES, STEP_LOOKS, STEP_LOOKS_BODY
from ..model.scene import Scene
from ..model.step import IMPACTS_FULL, LOG_FULL, PUSHES_FULL, Missed, needs_memory
from ..pairs.setup import with_more_room
from ..report import Details, of_events
from . import step as stages
from .edits import Changes, change_words, renew
from .memory import lengthened
from .remembering import UNBOUND, Remembering
from .run import RunBuffers, run
from .scene_memory import RULE_COLUMNS, Laid, SceneMemory
from .taking_over import Kept, take_over

if TYPE_CHECKING:
    import pymunk


def _details(logged: bytes, dt: float, bodies: tuple[pymunk.Body, ...], owner: IntArray) -> Details:
    """`of_events` for the bytes of impulses."""
    return of_events(from_bytes(Impulse, [logged]), dt, bodies, owner)


class EventLoop(Remembering):
    """Steps the packed bodies and shapes of a world from impact to impact.

    Args:
        laid: the rows of the world.
        limit: impacts that a body may have in a step.
        linkage: its joints; kept, not copied.
        together: whether all contacts of a step act together at its middle, instead of at their instants.
        memory: of the scene before, which is lost; None: new.

    Attributes:
        n: number of rows of BODY.  held: those of the bodies that joints hold where they are.
        thin: whether thin shapes may meet, whose sides are remembered.
    """

    def __init__(
        self, laid: Laid, limit: int, linkage: Linkage = NO_LINKAGE, together: bool = False,
        memory: SceneMemory | None = None,
    ) -> None:  # fmt: skip
        memory = memory or SceneMemory()
        self.held: Sequence[int]
        n = self.n = len(laid.BODY)
        self.together, self.measured = together, list(laid.measured)
        budget = STEP_LOOKS + STEP_LOOKS_BODY * n * max(n, MANY_BODIES) // MANY_BODIES
        self.table = memory.scene(laid, limit, together, budget)
        self._view(*memory.records())
        self._bound = UNBOUND
        self._memory, self.thin = memory, memory.thin > 0
        self._rules: dict[tuple[int, int], tuple[float, float, float, float]] = {}  # those of the table
        self._plan(linkage)

    def release(self) -> None:
        """Give the bodies that joints hold their mobilities back."""
        if self.jointed:
            release_held(self.table, self.ties)

    @property
    def pinned(self) -> Rows[Pinned]:
        """The bodies that joints hold where they are."""
        return self.joints.PINNED[: len(self.held)]

    @property
    def mobility(self) -> FloatArray:
        """(n, 2) 1/mass and 1/moment of bodies, also of those that joints hold."""
        found, pinned = columns(self.scene.BODY, *MOBILITY), self.pinned
        found[pinned["body"]] = columns(pinned, *MOBILITY)
        return found

    def _plan(self, linkage: Linkage) -> None:
        """Find which bodies the joints hold and tie together."""
        self.joint, self.partner, _ = linkage
        self._bound, self.held = UNBOUND, ()
        if self.jointed:
            plans = self._memory.joints
            self.ties = plans.plan(self.table, self.n, linkage)
            self.held = plans.held
        else:
            self.ties = self._memory.unjointed(self.table, self.n)

    def rejoin(self, linkage: Linkage = NO_LINKAGE, replan: bool = True) -> None:
        """Go on with other joints, or with edited ones, on the rows of the scene, which have the present poses.

        Args:
            replan: whether components may be others. If not, they are planned anew only if the joints hold other bodies
                where they are than before.
        """
        self.release()
        if replan or find_pinned(self.table, self.ties):
            self.release()
            self._plan(linkage)
            if not self.jointed:
                tie_components(self.table, self.ties)

    def rebind(self, joint: Rows[Joint], PARTNER: Rows[Body]) -> None:
        """Use other arrays of joints with the same values."""
        self.joint, self.partner = joint, PARTNER
        self.joints = self.joints._replace(JOINT=joint, PARTNER=PARTNER)

    def step(self, reading: Table, dt: float, gx: float, gy: float, half_damping: float) -> int:
        """Take a step, see `step.step`; a negative result is a code of `model/step.py`."""
        known, call = self._bound
        if known is not reading:
            call = stages.step.bind(self.table, self.ties, reading)
            self._bound = reading, call
        status = call(dt, gx, gy, half_damping)
        while status < 0 and needs_memory(status):
            self._grow(result_of("step", status))
            status = stages.resume_step.bind(self.table, self.ties, reading)()
        return status

    def follow(self, buffers: RunBuffers, reading: Table) -> int:
        """Take the steps of `buffers` on the states of a reading; returns all bits, or a negative code of
        `model/step.py`."""
        while True:
            call = buffers.call = buffers.call or run.bind(self.table, self.ties, buffers.table, reading)
            status = result_of("run", call())
            if status == IMPACTS_FULL:
                buffers.more_events()
            elif needs_memory(status):
                self._grow(status)
                buffers.call = None
            else:
                return status

    def _grow(self, status: int) -> None:
        """Provide the memory that a step needs which has returned this status; it can then be resumed."""
        scene = self.scene
        if status == LOG_FULL:
            self.scene = scene._replace(LOG=lengthened(scene.LOG, int(scene.COUNT.logged)))
            self._memory.log = len(self.scene.LOG)
            return
        if status == PUSHES_FULL:
            size, count = len(scene.KEYS), int(scene.COUNT.remembered)
            self._clean(size)
            if count - scene.COUNT.remembered >= size // 8:
                return
            self._clean(2 * size)
            used = int(scene.COUNT.pushes)
            self.scene = self.scene._replace(
                PUSHED_BY=lengthened(scene.PUSHED_BY, used), PUSHED=lengthened(scene.PUSHED, used)
            )
            self._memory.contacts = len(self.scene.PUSHED)
            return
        self.scene = with_more_room(scene, float(scene.PAR.now))
        flag_pairs(self.table)
        # Margin circles have other centres: all bodies are predicted again.
        n, now = len(scene.BODY) - 1, float(scene.PAR.now)
        scene.BODY["due"][:n], scene.STATE["other"][:n] = now, CHECK
        scene.HEAP_TIME[:n], scene.HEAP_BODY[:n], scene.COUNT.heap = now, np.arange(n), n

    def _clean(self, size: int) -> None:
        """Copy the forces of the last step to tables of `size` rows; older ones are dropped."""
        scene = self.scene
        KEYS, TABLE = np.full(size, -1, np.int64), rows(Force, size)
        copy_recent(scene.KEYS, scene.FORCES, scene.COUNT, KEYS, TABLE, float(scene.PAR.stamp) - 1.0)
        self.scene = scene._replace(KEYS=KEYS, FORCES=TABLE)

    def go_on(self, changes: Changes, measured: Sequence[int]) -> bool:
        """Go on after changes of the rows in place; False if a new scene is needed. `measured`: the `Measures` of the
        rows now."""
        if list(measured) != self.measured:
            return False
        return bool(renew(self.table, self._memory.words(change_words(changes))))

    def go_on_from(self, before: EventLoop, kept: Kept) -> None:
        """Before the first step: go on with the results of the loop before, for the rows that are the same."""
        take_over(before.table, self.table, self._memory.words(kept.words()))

    def rule(self, rules: Mapping[tuple[int, int], tuple[float, float, float, float]]) -> None:
        """Set the law of pairs of shapes a < b: elasticity (below 0: they pass through each other), friction and
        surface velocity (2)."""
        if rules != self._rules:
            self._rules = dict(rules)
            table = np.array([(*pair, *what) for pair, what in rules.items()], float).reshape(-1, RULE_COLUMNS)
            self.table, self._bound = replaced(self.table, Scene, "RULE", table), UNBOUND

    @property
    def events(self) -> Rows[Impulse]:
        """(m,) impulses of the last step, a copy."""
        return from_bytes(Impulse, [self.logged()])

    def details(self, dt: float, bodies: tuple[pymunk.Body, ...], owner: IntArray) -> Callable[[], Details]:
        """A function that makes the arrays of the report of the last step of length dt; `owner` (k,): index in `bodies`
        of each shape's body."""
        return partial(_details, self.logged(), dt, bodies, owner)

    @property
    def missed(self) -> Rows[Missed]:
        """(m,) the first budgets and tolerances that the last step has not met, a copy."""
        return self.scene.MISSED[: self.scene.COUNT.unmet].copy()
