"""Sleeping: which bodies of a space sleep, when others fall asleep, and what wakes them.

A sleeping body acts like a static one and takes part in no step. If a moving body touches it within a step, it and its
group wake, and the step is repeated from its start with them awake: no body bounces off a body as if that were fixed.

Bodies fall asleep by `body.sleep()`, or as a group of bodies that touch or are jointed, all of which have been at rest
for `space.sleep_time_threshold`. A body counts as at rest if, at both ends of a step, no force of the program acts and

    |v|, |spin| size <= SLEEP_SPEED |g| dt     and     |x - x0| <= SLEEP_SPEED |g| dt^2 + round-off,

where velocities may have the round-off of the fastest body, x0 is the position at the start, and size the extent of the
body. Then the impulses of contacts and joints, which obey their laws, balance gravity to that accuracy: the body is in
equilibrium. A body at its highest point is slow for an instant, but has the velocity |g| dt one step later. Without
gravity only motion by round-off counts as rest. Islands at rest (`..islands`) meet this criterion; it also applies to
bodies that are solved in every step.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np
import pymunk

from ..arrays import BoolArray, FloatArray, IntArray
from ..compiled.records import over
from ..layout import BODY_ROW, KNOWN_ID
from ..model.contacts import Impulse
from ..model.parameters.rest import SLEEP_PATIENCE, SLEEP_RETRY, SLEEP_SHARE, SLEEP_SPEED
from ..report import Contacts, StepReport
from ..sleepers import approaches, rests, touches_sleeper
from .private import shapes as private_shapes
from .private import sleep as private_sleep
from .private import spaces as private
from .sleep_groups import resting_groups, sleep_together

if TYPE_CHECKING:
    from .sync import Sync
    from .world import World

AT_FIRST: IntArray = np.array([0, SLEEP_PATIENCE])  # `timers` of a new Sleep


def boxes_of(bodies: Iterable[pymunk.Body]) -> tuple[list[pymunk.Body], FloatArray]:
    """The body of each of w shapes, and (w, 4) their left, bottom, right and top in world coordinates."""
    shapes = [(body, shape.bb) for body in bodies for shape in body.shapes]
    boxes = [(box.left, box.bottom, box.right, box.top) for _, box in shapes]
    return [body for body, _ in shapes], np.array(boxes, float).reshape(-1, 4)


class Sleep:
    """The sleeping bodies of a world, and the times for which others have been at rest.

    Args:
        world: of a space whose `sleep_time_threshold` is finite.  past: that of its last world.  sync: of the world.

    Attributes:
        any_asleep, all_asleep: whether any body sleeps; whether all dynamic bodies do, and there is one.
    """

    def __init__(self, world: World, past: Sleep | None, sync: Sync) -> None:
        self.world, self.space, bodies = world, world.space, world.bodies
        slept = bodies.asleep.tolist()
        self._sleepers = [body for body, asleep in zip(bodies.items, slept, strict=True) if asleep]
        self.any_asleep = bool(self._sleepers)
        self.all_asleep = self.any_asleep and not bodies.dynamic.any()
        self._unmoved = private_sleep.unmoved(
            [self.space.static_body, *(b for b, asleep in zip(bodies.items, slept, strict=True) if not asleep)]
            if self.all_asleep
            else []
        )
        self._timestamp = private.timestamp(self.space)
        self._stamp, self._sync = self._timestamp(), sync
        self._wait, self._since = (AT_FIRST if past is None else past.timers).tolist()
        self._rested: FloatArray = np.zeros(len(bodies))  # time at rest
        if past is not None:
            times = np.where(past.world.bodies.asleep, 0.0, past._rested).tolist()
            known = dict(zip(past.world.bodies.items, times, strict=True))
            self._rested[:] = [known.get(body, 0.0) for body in bodies.items]
        self._steps, self._dt = self.space.collision_persistence + 2, 0.0  # see `step`
        self._ready: IntArray = np.zeros(len(bodies), np.int64)
        row = world.IDS[BODY_ROW]
        self._size: FloatArray = np.where(row >= 0, world.BODY["extent"][row], 0.0)
        moved: IntArray = bodies.dynamic.astype(np.int64)
        self._rests = rests.bind(world.STATES, world.IDS, moved, self._size, self._rested, self._ready)
        self._still = bodies.asleep.astype(np.int64), bodies.static.astype(np.int64)
        self._touches: tuple[memoryview | None, Callable[[int], int]] = None, int  # bound to this log
        # Bodies that may wake others before the step, see `wake_ahead`; the index is `world.plain`.
        movers: tuple[BoolArray, BoolArray] = ~bodies.static, ~bodies.static & ~bodies.dynamic
        self._moves: list[IntArray] = [np.flatnonzero(moves) for moves in movers]
        self._nears: dict[bool, tuple[list[pymunk.Body], IntArray, Callable[[float, float], int]]] = {}

    def changed(self) -> bool:
        """Read the states, unless all bodies sleep; returns whether other bodies may sleep now than when this was made,
        or pymunk has taken a step since."""
        if (late := self._timestamp() not in (self._stamp, self._sync.stamp)) or self.all_asleep:
            return late or self.woken()
        self.world.gather()
        return self.any_asleep and not self.world.same_bodies()

    def woken(self) -> bool:
        """Whether a body that slept when this was made may be awake: pymunk's order of bodies has changed."""
        return self.any_asleep and not self.world.bodies.in_order()

    def nothing_moves(self) -> bool:
        """Whether all dynamic bodies sleep, and all others have their old poses and velocity 0, without functions."""
        calls = self.world.hooks.any_body or self.world.collisions
        return self.all_asleep and not calls and self._unmoved()

    def step(self, dt: float) -> None:
        """Take a step in which nothing moves: pymunk's own until it has forgotten all earlier contacts; then none,
        since a step of this dt would change nothing. pymunk's step may wake bodies that touch a kinematic body, and
        correct the overlap; this motion is cleared."""
        if self._steps > 0 or dt != self._dt:
            self._steps, self._dt = self._steps - 1, dt
            private.step_without_end(self.space, dt)
            if self.woken():
                private_sleep.stop_woken(self._sleepers)()
                private_shapes.forget_corrections(private.pointers(self._sleepers))
            self._stamp = self._timestamp()

    def wake(self, bodies: Iterable[pymunk.Body] | None = None) -> None:
        """Wake these bodies and their groups; all bodies if None."""
        for body in private_sleep.asleep(self.space) if bodies is None else bodies:
            body.activate()

    def wake_ahead(self, dt: float) -> bool:
        """Wake the sleeping bodies that a kinematic body may meet in the step that begins with the states read; unless
        the world is plain, all that may be met, since steps that call functions are not repeated. Whether any woke."""
        plain, world = self.world.plain, self.world
        if len(self._moves[plain]) == 0:
            return False
        if plain not in self._nears:
            of, boxes = boxes_of(self._sleepers)
            met = np.zeros(len(of), np.int64)
            self._nears[plain] = of, met, approaches.bind(world.STATES, self._moves[plain], *self._reach, boxes, met)
        of, met, call = self._nears[plain]
        # In a fixed order, unlike a set: pymunk lists woken bodies in that in which they are woken.
        reached = dict.fromkeys([of[w] for w in met[: call(dt, math.hypot(*world.gravity))].tolist()])
        self.wake(reached)
        return len(reached) > 0

    def _left_alone(self, groups: list[list[pymunk.Body]], dt: float) -> list[list[pymunk.Body]]:
        """Those of the groups that `wake_ahead` would not wake in the next step, if all other bodies may move in it."""
        row, moves = self.world.bodies.row, self._moves[self.world.plain].tolist()
        self.world.gather()
        of, boxes = boxes_of(chain.from_iterable(groups))
        met = np.zeros(len(of), np.int64)
        while True:
            sleepers = {row[body] for group in groups for body in group}
            others = np.array([i for i in moves if i not in sleepers], np.int64)
            count = approaches(self.world.STATES, others, *self._reach, boxes, met, dt, math.hypot(*self.world.gravity))
            reached = {of[w] for w in met[:count].tolist()}
            remaining = [group for group in groups if reached.isdisjoint(group)]
            if len(remaining) == len(groups):
                return groups
            groups = remaining

    @cached_property
    def _reach(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """FREE, SIZE and INVERSE of `sleepers.approaches`."""
        bodies = self.world.bodies
        far = np.where(self._size > 0.0, self._size + np.hypot(*bodies.center_of_gravity.T), 0.0)
        return bodies.dynamic.astype(np.int64), far, bodies.inverse_mass.copy()

    def rested(self, bodies: Sequence[pymunk.Body]) -> FloatArray:
        """(N,) the times for which these bodies have been at rest, 0 for those that are not in the world."""
        row, rested = self.world.bodies.row, self._rested.tolist()
        return np.array([rested[row[body]] if body in row else 0.0 for body in bodies], float)

    @property
    def timers(self) -> IntArray:
        """(2,) number of steps until the next search for groups that may fall asleep, and since groups last did."""
        return np.array([self._wait, self._since], np.int64)

    def recall(self, rested: Mapping[pymunk.Body, float], timers: IntArray) -> None:
        """Set times at rest, and timers."""
        self._rested[:] = [rested.get(body, 0.0) for body in self.world.bodies.items]
        self._wait, self._since = timers.tolist()

    def wake_changed(self) -> None:
        """Wake bodies near removed shapes; wake all if static bodies were moved or shapes edited. Also bodies that have
        fallen asleep at the end of the last step, of which this does not know."""
        if not private_sleep.asleep(self.space):
            return
        present = set(self.space.shapes)
        for shape, record in self.world.records.items():
            if record is not None and shape not in present:
                left, bottom, right, top = shape.bb
                room = 1e-3 * (right - left + top - bottom)
                box = pymunk.BB(left - room, bottom - room, right + room, top + room)
                near = [shape.body for shape in self.space.bb_query(box, pymunk.ShapeFilter())]
                self.wake(dict.fromkeys([body for body in near if body is not None and body.is_sleeping]))
        if self.world.static_moved_since() or self.world.edited():
            self.wake()

    def is_touched(self, log: memoryview, count: int) -> bool:
        """Whether a moving body has touched a sleeping one in the first `count` impulses of the log (`Impulse`)."""
        known, call = self._touches
        if known is not log:
            call = touches_sleeper.bind(over(Impulse, log), self.world.owner, *self._still)
            self._touches = log, call
        return bool(call(count))

    def touched(self, contacts: Contacts) -> list[pymunk.Body]:
        """The sleeping bodies that a moving body has touched."""
        asleep, moves = self.world.bodies.asleep, ~self.world.bodies.static
        a, b = contacts.body_a, contacts.body_b
        hit = np.concatenate((a[asleep[a] & moves[b]], b[asleep[b] & moves[a]]))
        # numpy's `unique` imports a module at its first call, in some 10 ms.
        return [self.world.bodies.items[i] for i in sorted(set(hit.tolist()))]

    def rest(self, dt: float) -> bool:
        """Update the times at rest after a step; returns whether any body may fall asleep."""
        # The sum of dt may be less than the threshold by round-off.
        need = self.space.sleep_time_threshold * (1.0 - 1e-9)
        ready = self._rests(SLEEP_SPEED * math.hypot(*self.world.gravity) * dt, dt, need)
        self._wait = max(self._wait - 1, 0)
        self._since += 1
        return self._wait == 0 and ready == 1

    def fall_asleep(self, report: StepReport, dt: float) -> None:
        """Put groups to sleep all of whose bodies have been at rest for long enough, unless something would wake them
        in a step of length dt. `report`: of the last step."""
        bodies, joints = self.world.bodies, self.world.joints
        self._wait = SLEEP_RETRY
        # After bodies have fallen asleep the world is read again and contact forces are lost, so small groups wait.
        enough = max(np.count_nonzero(bodies.dynamic) / SLEEP_SHARE if self._since < SLEEP_PATIENCE else 0.0, 1.0)
        ready = [[bodies.items[i]] for i in self._ready.nonzero()[0].tolist()]
        # A group is left alone only if each of its bodies would be.
        if len(ready) < enough or len(self._left_alone(ready, dt)) < enough:
            return
        pairs = () if joints is None else joints.pairs.values()
        ids = self.world.IDS[KNOWN_ID]
        groups = self._left_alone(resting_groups(self.space, bodies, ids, self._ready, report.contacts, pairs), dt)
        if sum(map(len, groups)) < enough:
            return
        self._since = 0
        for group in groups:
            self._rested[[bodies.row[body] for body in group]] = 0.0
            sleep_together(group)
