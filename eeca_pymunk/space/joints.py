"""Joints: the constraints of a space as packed arrays, their edits, and results that are written back."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pymunk

from ..arrays import FloatArray, IntArray
from ..compiled.records import over, selected
from ..joints.workspace import Linkage
from ..model.joints import Joint
from ..reentry import FunctionsCalled
from .constraint_impulses import ConstraintImpulses
from .constraints import read
from .edits import clock
from .listing import ConstraintEdits, Listing, calls_of
from .partners import Partners
from .private import spaces as private
from .spring_functions import BodyMotion, Rate, force_function, write_law


class JointRows(Listing):
    """The constraints of a space as rows of JOINT, updated after edits by the program.

    Attributes, beside those of `Listing`:
        joint: (j,) the rows.
        partners: bodies of joints without a row in BODY; in `joint["body"]` their numbers are n + row of PARTNER.
        parted: pairs of bodies whose shapes do not collide, by `collide_bodies`; None after a change (`find_parted`).
        rates: of springs with functions, the rate of length and the dt of the last step, see `write_law`.
        replan: whether kinds, anchors or bounds of joints have changed since `planned` was called, so that components
            need a new plan.
        ends_moved: whether lengths or anchors have changed since then, or poses of static bodies outside the space, or
            of kinematic ones at rest, so that other bodies may be held by joints (`..joints.pinned`).
        still: see `Linkage`.
    """

    def __init__(self, space: pymunk.Space, row: Mapping[pymunk.Body, int], n: int, past: JointRows | None) -> None:
        """Read the constraints of `space`. `row`: row in BODY (of n rows) of its bodies. Rows of `past` are used again.

        Raises:
            ValueError, UnsupportedFeature: see `check_constraint`.  NotFiniteError: see `Partners`.
        """
        if past is not None:
            past.refresh(anew=True)
        super().__init__(space, past)
        before = [-1] * len(self.items) if past is None else [past.row.get(item, -1) for item in self.items]
        self._memory: bytearray = selected(Joint, bytearray() if past is None else past._memory, before)
        self.joint = over(Joint, self._memory)
        self._impulses = ConstraintImpulses(space, self.joint)
        others = [body for body in self.bodies if body not in row]
        self._number(row, n, others)
        for j in self.fresh:
            self.values[j].put(self._memory, j, *self.joint["body"][j].tolist())
        self.partners: Partners = Partners(others, space, self.joint, n, None if past is None else past.partners)
        self.still[n:] = self.partners.still
        self._edits, self._timestamp = ConstraintEdits(self.row), private.timestamp(space)
        self._clock = clock()
        rates = {} if past is None else past.rates
        self.rates: dict[pymunk.Constraint, Rate] = {item: rates[item] for item in self.items if item in rates}
        self.parted: frozenset[tuple[pymunk.Body, pymunk.Body]] | None = None

    def _number(self, row: Mapping[pymunk.Body, int], n: int, others: Sequence[pymunk.Body]) -> None:
        """Write the numbers of bodies: those of `row`, and from n on of `others`. Components need a new plan."""
        self._n, self._row_of = n, {**row, **{body: n + i for i, body in enumerate(others)}}
        self.joint["body"] = np.array([self._row_of[body] for body in self.bodies], np.int64)[self.ends]
        self.replan, self.ends_moved, self._held = True, False, frozenset[int]()
        self._carriers = [body for body in self.bodies if body in row and private.may_rest(body)]  # kinematic
        self.still: IntArray = np.zeros(n + len(others) if others or self._carriers else 0, np.int64)
        # From the first step on: places of the carriers among all bodies; poses of all, None of those that move.
        self._places: list[int] = []
        self._poses: list[list[float] | None] | None = None

    def renumber(self, row: Mapping[pymunk.Body, int], n: int, edited: Collection[Any] | None) -> bool:
        """Use other rows of bodies, see `__init__`. False, with nothing done, if constraints or partners are others.
        `edited`: since the last reading, bodies among others; None if unknown."""
        others = tuple([body for body in self.bodies if body not in row])
        if self.items != list(self.space.constraints) or others != self.partners.items:
            return False
        anew = edited is None or not set(edited).isdisjoint(self.bodies)
        self.refresh(anew)
        self._number(row, n, others)
        self.fresh = []
        self.partners.renumber(self.space, n, anew)
        self.still[n:] = self.partners.still
        self.parted = None
        return True

    @property
    def linkage(self) -> Linkage:
        """The arrays that the event loop takes."""
        return Linkage(self.joint, self.partners.PARTNER, self.still)

    def refresh(self, anew: bool = False) -> bool:
        """Read edited constraints again; returns whether a new plan of components is needed. Edits of bodies in the
        space are looked for only if these are read `anew`."""
        if anew or (self.partners.outside and self._clock != clock()):
            self._clock = clock()
            for j in self.recentred():
                self._edits.record(self.items[j], "anchor_a")
        if not self._edits.rows:
            return self.replan
        edited = self._edits.take()
        try:
            found = {j: read(self.items[j]) for j in sorted(edited)}
        except ValueError:
            self._edits.rows.update(edited)
            raise
        regroup = False  # whether `find_functions` may find other constraints
        for j, values in found.items():
            item, before = self.items[j], self.values[j]
            a, b = self.pairs[item]
            values.put(self._memory, j, self._row_of[a], self._row_of[b])
            self.values[j] = values
            if before.shape != values.shape:
                self.ends_moved |= before.reach != values.reach
                if before.plan != values.plan:
                    self.replan = regroup = True
            elif before.gear != values.gear and any(self._is_fixed(body) for body in self.pairs[item]):
                self.ends_moved = True
            if edited[j] and (calls := calls_of(item)) != self.calls[j]:
                self.calls[j], regroup = calls, True
        if regroup:
            self.find_functions()
            self.parted = None
        return self.replan

    def laws(self) -> list[Callable[[Any, float], float]]:
        """The linear laws of the springs with functions in the last step."""
        return [force_function(self.items[j], self.joint[j]) for j in self.functions]

    def set_length(self, j: int, length: float) -> None:
        """Set the length of the pin of row j, without recording an edit."""
        self.items[j].distance = length
        self._edits.forget(j)
        self.joint[j].length = length

    def planned(self, held: Iterable[int]) -> None:
        """Record that the plan of the components fits the present joints, which hold these rows of BODY."""
        self.replan = self.ends_moved = False
        self._held = frozenset(held)

    def _is_fixed(self, body: pymunk.Body) -> bool:
        """Whether gears can hold others on this body: it does not move, or joints hold it."""
        row = self._row_of[body]
        return body.body_type == pymunk.Body.STATIC or row in self._held or bool(self.still[row : row + 1].any())

    def calls_back(self) -> bool:
        """Whether a constraint has a function that is called once a step."""
        if self._edits.rows:
            self.refresh()
        return len(self.calling) > 0

    def calls_any(self) -> bool:
        """Whether a step calls a function of a constraint, once or more often."""
        return self.calls_back() or len(self.functions) > 0

    @property
    def edited(self) -> bool:
        """Whether there are edited constraints that were not read since."""
        return len(self._edits.rows) > 0

    def unchanged(self, state: FloatArray) -> bool:
        """Whether `update` has nothing to do: nothing has changed, but poses of partners, which are read here. state:
        (N, 9) at the start of the step."""
        if self.partners.outside and self._clock != clock():
            return False
        if self._edits.rows or self.replan or self.ends_moved or self.parted is None or self.functions:
            return False
        self.ends_moved = len(self.partners.outside) > 0 and self.partners.read() > 0
        return not (self.ends_moved or (self._carriers and self._poses_of_carriers(state) != self._poses))

    def _poses_of_carriers(self, state: FloatArray) -> list[list[float] | None]:
        """The poses of the kinematic bodies of the space that joints hold; None for those that move."""
        # Row by row: numpy's indices take several times as long for few bodies.
        return [None if any((at := state[place, :6].tolist())[3:]) else at[:3] for place in self._places]

    def catch_up(self, state: FloatArray, place: Mapping[pymunk.Body, int]) -> None:
        """Read edited constraints and moved partners again, and which kinematic bodies are at rest. Arguments as of
        `update`."""
        self.refresh()
        self.ends_moved |= len(self.partners.outside) > 0 and self.partners.read() > 0
        self._places = [place[body] for body in self._carriers]
        if self._carriers and (now := self._poses_of_carriers(state)) != self._poses:
            self._poses, self.ends_moved = now, True
            self.still[[self._row_of[body] for body in self._carriers]] = [pose is not None for pose in now]

    def update(self, state: FloatArray, place: Mapping[pymunk.Body, int], dt: float) -> None:
        """Update what the step needs: edited constraints, poses of partners, laws of springs with functions.

        Args:
            state: (N, 9) at the start of the step.  place: rows of bodies in it.  dt: time.

        Raises:
            ValueError, UnsupportedFeature, NotFiniteError: as the first reading does.  NotFiniteError: a function of a
                spring has not returned a finite number.
        """
        self.catch_up(state, place)
        if self.functions:
            with FunctionsCalled(self.space), private.locked(self.space):
                for j in self.functions:
                    item = self.items[j]
                    a, b = (self._motion(body, state, place) for body in (item.a, item.b))
                    self.rates[item] = write_law(item, a, b, dt, self.joint[j], self.rates.get(item))

    def _motion(self, body: pymunk.Body, state: FloatArray, place: Mapping[pymunk.Body, int]) -> BodyMotion:
        row = self._row_of[body]
        if row >= self._n:
            return self.partners.motion(row - self._n)
        return tuple(state[place[body], :6].tolist())

    def find_parted(self, owner: IntArray, bodies: Sequence[pymunk.Body]) -> set[tuple[int, int]]:
        """Find `parted`; returns the pairs (i < j) of shapes of these bodies. `owner` (k,): index in `bodies` of the
        body of each shape."""
        pairs = zip(self.pairs.values(), self.calls, strict=True)
        self.parted = frozenset(pair for pair, calls in pairs if not calls.collide)
        of: dict[pymunk.Body, list[int]] = {}
        for k, i in enumerate(owner.tolist() if self.parted else ()):
            of.setdefault(bodies[i], []).append(k)
        return {(min(i, j), max(i, j)) for a, b in self.parted for i in of.get(a, ()) for j in of.get(b, ())}

    def write(self) -> None:
        """Write notches of ratchets, and let `constraint.impulse` return the impulses of the step."""
        for j in self.ratchets:
            item = self.items[j]
            if item.angle != self.joint[j].notch:
                item.angle = float(self.joint[j].notch)
                self._edits.forget(j)
        self._impulses.show(self.items, self._timestamp())

    def go_on(self, dt: float) -> None:
        """After a step in which all bodies sleep: see `ConstraintImpulses.go_on`."""
        self._impulses.go_on(self.items, self._timestamp(), dt)
