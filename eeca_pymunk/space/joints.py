"""Joints: the constraints of a space in packed arrays, what the user changed since, and what goes back."""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pymunk

from ..arrays import FloatArray, IntArray
from ..joints.layout import (
    ANCHOR_AX,
    BODY_A,
    BODY_B,
    IMPULSE_1,
    IMPULSE_2,
    JOINT_COLUMNS,
    KIND,
    MOTOR,
    NOTCH,
    RATCHET,
    ROTARY_SPRING,
    SOFT,
    SPRING,
    TIE_COLUMNS,
    TOUCHED,
)
from . import private
from .constraints import check_constraint, read
from .edits import Edits, show_impulses, showings, shown
from .partners import Partners
from .spring_functions import Motion, Rate, law, own_function, put_law

ANCHORS = slice(ANCHOR_AX, ANCHOR_AX + 4)


class Impulses:
    """What `constraint.impulse` would be after native's step, by row. It outlives the stepper, and holds no constraint.

    Attributes:
        joint, tie: the rows.  ours: pymunk's count of its own steps when they were written.
    """

    def __init__(self, space: pymunk.Space, joint: FloatArray, tie: IntArray) -> None:
        self._space = weakref.ref(space)
        self.joint, self.tie = joint, tie
        self.ours = -1

    def read(self, j: int) -> float | None:
        """Of springs signed (positive pushes), else >= 0; None if native has taken a step of its own since."""
        space = self._space()
        if space is not None and private.timestamp(space)() != self.ours:
            return None
        first, second = self.joint[j, IMPULSE_1], self.joint[j, IMPULSE_2]
        if self.tie[j, KIND] in (SPRING, ROTARY_SPRING):
            return float(first)
        return math.hypot(first, second)


class JointRows:
    """The constraints of a space as JOINT and TIE rows, kept up to date with what the user changes.

    Attributes:
        items: the constraints, in the order of the rows.  joint: (j, JOINT_COLUMNS).  tie: (j, TIE_COLUMNS).
        row: the row of each constraint.
        functions: rows of springs that have a force or torque function of the user's own.  own: these springs.
        before, after, calling: constraints with a `pre_solve`, with a `post_solve`, with either.
        partners: bodies of joints that have no row of their own; theirs are n + row of PARTNER.
        parted: pairs of bodies whose shapes pass through one another, by `collide_bodies`; None where nobody has looked
            since that changed.
        rates: of springs with functions of their own, what the step before was answered, see `put_law`.
        replan: whether kinds, places or softness of joints have changed since `planned` was called.
    """

    def __init__(
        self, space: pymunk.Space, row: Mapping[pymunk.Body, int], n: int, past: JointRows | None = None
    ) -> None:
        """The rows of the constraints of `space`, whose bodies have these rows of n; what `past` knows is kept."""
        self.space, self._n = space, n
        self._impulses: Impulses | None = None
        self._showings = -1
        self.items = list(space.constraints)
        self.joint: FloatArray = np.zeros((len(self.items), JOINT_COLUMNS))
        self.tie: IntArray = np.zeros((len(self.items), TIE_COLUMNS), np.int64)
        others = [body for item in self.items for body in (item.a, item.b) if body not in row]
        self.partners: Partners = Partners(tuple(dict.fromkeys(others)), space, None if past is None else past.partners)
        self._row_of = {**row, **{body: n + i for i, body in enumerate(self.partners.items)}}
        known = {} if past is None else past.row
        if past is not None:
            past.refresh()
        for j, item in enumerate(self.items):
            if past is not None and (i := known.get(item, -1)) >= 0:
                self.joint[j], self.tie[j] = past.joint[i], past.tie[i]
            else:
                check_constraint(item)
                read(item, self.joint[j], self.tie[j])
                self.tie[j, TOUCHED] = 1
            self.tie[j, BODY_A], self.tie[j, BODY_B] = self._row_of[item.a], self._row_of[item.b]
        self.touch(n + self.partners.changed)
        self.row: dict[pymunk.Constraint, int] = {item: j for j, item in enumerate(self.items)}
        self._edits = Edits(self.row)
        self._ratchets = np.flatnonzero(self.tie[:, KIND] == RATCHET).tolist()
        self._timestamp = private.timestamp(space)
        self.rates: dict[pymunk.Constraint, Rate] = {} if past is None else past.rates
        self.replan = True
        self._find_functions()

    def is_of(self, space: pymunk.Space) -> bool:
        """Whether these are the constraints that the space has now."""
        return self.items == list(space.constraints)

    def _find_functions(self) -> None:
        self.functions = [j for j, item in enumerate(self.items) if own_function(item)]
        self.own = [self.items[j] for j in self.functions]
        self.before = [item for item in self.items if item.pre_solve is not None]
        self.after = [item for item in self.items if item.post_solve is not None]
        self.calling = list(dict.fromkeys((*self.before, *self.after)))
        self._pushing = [item for j, item in enumerate(self.items) if self._push(j)]
        self.parted: frozenset[tuple[pymunk.Body, pymunk.Body]] | None = None

    def refresh(self) -> bool:
        """Read anew the constraints that the user changed; whether joints must be planned anew."""
        if not self._edits.some:
            return self.replan
        edited = self._edits.take()
        try:
            for j in edited:
                check_constraint(self.items[j])
        except ValueError:
            self._edits.add(edited)
            raise
        for j in sorted(edited):
            off_before, kind, soft = self.joint[j, ANCHORS] != 0.0, self.tie[j, KIND], self.tie[j, SOFT]
            read(self.items[j], self.joint[j], self.tie[j])
            self.tie[j, TOUCHED] = 1
            off = self.joint[j, ANCHORS] != 0.0
            if kind != self.tie[j, KIND] or soft != self.tie[j, SOFT] or bool((off != off_before).any()):
                self.replan = True
        self._find_functions()
        return self.replan

    def laws(self) -> list[Callable[[Any, float], float]]:
        """The laws of the springs with functions of their own in the last step."""
        return [law(self.items[j], self.joint[j]) for j in self.functions]

    def pushing(self) -> list[pymunk.Constraint]:
        """The constraints that push, in a step of pymunk, where everything is at rest: springs, motors, joints that are
        apart or may be, and those of bodies that the batch calls do not reach."""
        if not self.tie[:, TOUCHED].any():
            return self._pushing
        return [*self._pushing, *(self.items[j] for j in np.flatnonzero(self.tie[:, TOUCHED]).tolist())]

    def _push(self, j: int) -> bool:
        item, kind = self.items[j], self.tie[j, KIND]
        out = any(body in self.partners.items and body.body_type == pymunk.Body.DYNAMIC for body in (item.a, item.b))
        return out or self.tie[j, SOFT] != 0 or kind in (SPRING, ROTARY_SPRING, MOTOR)

    def planned(self) -> None:
        """The joints have been planned as they are."""
        self.replan = False

    def calls_back(self) -> bool:
        """Whether a constraint has a function that is called once a step."""
        if self._edits.some:
            self.refresh()
        return len(self.calling) > 0

    @property
    def edited(self) -> bool:
        """Whether the user has changed a constraint that was not read since."""
        return len(self._edits.some) > 0

    def idle(self) -> bool:
        """Whether there is nothing for `look` to do."""
        return not (self._edits.some or self.functions or self.partners.outside)

    def look(self, state: FloatArray, place: Mapping[pymunk.Body, int], dt: float) -> None:
        """Bring what the step needs up to date: edits, places of partners, laws of springs with functions.

        Args:
            state: (N, 9) the start of the step.  place: the rows of bodies there.  dt: time.
        """
        self.refresh()
        moved = self.partners.read()
        if len(moved):
            self.touch(self._n + moved)
        for j in self.functions:
            item = self.items[j]
            a, b = (self._motion(body, state, place) for body in (item.a, item.b))
            self.rates[item] = put_law(item, a, b, dt, self.joint[j], self.rates.get(item))

    def _motion(self, body: pymunk.Body, state: FloatArray, place: Mapping[pymunk.Body, int]) -> Motion:
        row = self._row_of[body]
        if row >= self._n:
            return self.partners.motion(row - self._n)
        x, y, angle, vx, vy, spin = state[place[body], :6].tolist()
        return x, y, angle, vx, vy, spin

    def part(self) -> frozenset[tuple[pymunk.Body, pymunk.Body]]:
        """`parted`, looked for if need be."""
        if self.parted is None:
            self.parted = frozenset((item.a, item.b) for item in self.items if not item.collide_bodies)
        return self.parted

    def touch(self, rows: IntArray) -> None:
        """Mark the joints of bodies (rows) that the user has moved or pushed."""
        for row in rows.tolist():
            self.tie[(self.tie[:, BODY_A] == row) | (self.tie[:, BODY_B] == row), TOUCHED] = 1

    def write(self) -> None:
        """Give ratchets the notch they have reached, and let `constraint.impulse` read ours."""
        told = self._impulses
        if told is None or told.joint is not self.joint:
            self._impulses = told = Impulses(self.space, self.joint, self.tie)
            self._showings, self._reading = -1, told.read
        told.ours = self._timestamp()
        for j in self._ratchets:
            item = self.items[j]
            if item.angle != self.joint[j, NOTCH]:
                item.angle = float(self.joint[j, NOTCH])
                self._edits.forget(j)
        if self._showings != showings():
            if shown(self.items[0]) is not self._reading:
                show_impulses(self.items, self._reading)
            self._showings = showings()
