"""Listing: the constraints of a space, what is read of them independently of the rows of their bodies, and their edits.

pymunk records no edits: its setters write into Chipmunk at once. But all attributes of constraints are set in Python.
So `pymunk.Constraint.__setattr__` is replaced when the first `ConstraintEdits` is made; for constraints without one it
acts as before.
"""

from __future__ import annotations

from typing import Any, NamedTuple
from weakref import ref

import numpy as np
import pymunk

from ..model.joints import RATCHET
from .constraints import NUMBERS, ConstraintValues, read
from .private import joints as private_joints
from .spring_functions import own_function

_ROUND_OFF = 1e-12  # of the distance of a pin's anchors, over that distance
# The attributes of a `Listing` that another one of the same constraints uses again.
_LISTED = (
    "pairs", "bodies", "ends", "row", "values", "calls", "ratchets", "functions", "with_law", "before",
    "after", "calling", "centres",
)  # fmt: skip

# All `ConstraintEdits` by their numbers. To iterate over a `WeakSet` takes ten times as long, in every edit of one.
_watching: dict[int, ref[ConstraintEdits]] = {}
_native_setattr = pymunk.Constraint.__setattr__


class Calls(NamedTuple):
    """The functions of a constraint, None for none, and whether its bodies collide."""

    own: object  # the force or torque function of the program
    before: object  # `pre_solve`
    after: object  # `post_solve`
    collide: bool


def calls_of(item: pymunk.Constraint) -> Calls:
    """The functions of a constraint now."""
    return Calls(own_function(item), item.pre_solve, item.post_solve, bool(item.collide_bodies))


class Listing:
    """The constraints of a space. Values that `past`, an earlier listing, has read are used again.

    Attributes:
        items: the constraints, in the order of the rows.  row: the row of each.
        pairs: the bodies of each.  bodies: all of these.  ends: (j, 2) places in `bodies`.
        values, calls: the values and the functions of each.
        fresh: rows of the constraints that `past` does not have.
        functions: rows of springs that have a force or torque function of the program.  with_law: these springs.
        before, after, calling: constraints with a `pre_solve`, with a `post_solve`, with either.
        centres: of gravity of `bodies`, to which the anchors in `values` are relative.
        ratchets: rows of the ratchets.
    """

    def __init__(self, space: pymunk.Space, past: Listing | None) -> None:
        self.space, self.items = space, list[pymunk.Constraint](space.constraints)
        if past is not None and past.items == self.items:
            own, before = vars(self), vars(past)
            for name in _LISTED:
                own[name] = before[name]
            self.fresh: list[int] = []
            return
        known = {} if past is None else {item: (past.values[j], past.calls[j]) for item, j in past.row.items()}
        pairs = {} if past is None else past.pairs
        self.pairs: dict[pymunk.Constraint, tuple[pymunk.Body, pymunk.Body]] = {
            item: pairs.get(item) or (item.a, item.b) for item in self.items
        }
        places: dict[pymunk.Body, int] = {}
        ends = [places.setdefault(body, len(places)) for pair in self.pairs.values() for body in pair]
        self.bodies, self.ends = list(places), np.array(ends, np.int64).reshape(-1, 2)
        self.row: dict[pymunk.Constraint, int] = {item: j for j, item in enumerate(self.items)}
        self.fresh = [j for j, item in enumerate(self.items) if item not in known]
        found = [known.get(item) or (read(item), calls_of(item)) for item in self.items]
        self.values: list[ConstraintValues] = [values for values, _ in found]
        self.calls: list[Calls] = [calls for _, calls in found]
        self.centres = self._centres()
        self.find_functions()

    def _centres(self) -> list[tuple[float, float]]:
        return [private_joints.centre_and_kind(body)[:2] for body in self.bodies]

    def recentred(self) -> list[int]:
        """The rows of the constraints of bodies whose centre of gravity has changed since `centres` were read, which
        are read again: the values of these constraints have to be, too."""
        before, self.centres = self.centres, self._centres()
        moved = [centre != now for centre, now in zip(before, self.centres, strict=True)]
        return np.flatnonzero(np.array(moved)[self.ends].any(axis=1)).tolist() if any(moved) else []

    def find_functions(self) -> None:
        """Find the lists of constraints that depend on kinds, bounds and functions."""
        self.ratchets = [j for j, values in enumerate(self.values) if values.kind == RATCHET]
        self.functions = [j for j, calls in enumerate(self.calls) if calls.own]
        self.with_law = [self.items[j] for j in self.functions]
        self.before = [item for item, calls in zip(self.items, self.calls, strict=True) if calls.before is not None]
        self.after = [item for item, calls in zip(self.items, self.calls, strict=True) if calls.after is not None]
        self.calling = list(dict.fromkeys((*self.before, *self.after)))

    def measured(self) -> list[int]:
        """Rows of the pins whose length is the distance of their anchors, up to round-off: pickles of pymunk lack the
        lengths of pins, so that a loaded pin has this one."""
        found = []
        for j, item in enumerate(self.items):
            if isinstance(item, pymunk.PinJoint):
                distance = item.a.local_to_world(item.anchor_a).get_distance(item.b.local_to_world(item.anchor_b))
                if abs(item.distance - distance) <= _ROUND_OFF * distance:
                    found.append(j)
        return found


class ConstraintEdits:
    """The edits of the constraints of one listing.

    Attributes:
        rows: those of the constraints of which an attribute was set since the last `take`, and whether one was set
            beside `constraints.NUMBERS`.
    """

    def __init__(self, row: dict[pymunk.Constraint, int]) -> None:
        """`row`: the row of each constraint."""
        self._row = row
        self.rows: dict[int, bool] = {}
        number = id(self)
        _watching[number] = ref(self, lambda _: _watching.pop(number))
        if pymunk.Constraint.__setattr__ is not _set:
            pymunk.Constraint.__setattr__ = _set  # type: ignore[method-assign, assignment]

    def take(self) -> dict[int, bool]:
        """Return the rows, and clear them."""
        edited, self.rows = self.rows, {}
        return edited

    def forget(self, row: int) -> None:
        """Remove a row, of which this package has just set an attribute itself."""
        self.rows.pop(int(row), None)

    def record(self, constraint: pymunk.Constraint, name: str) -> None:
        """Record that this attribute of a constraint was set."""
        row = self._row.get(constraint)
        if row is not None:
            self.rows[row] = self.rows.get(row, False) or name not in NUMBERS


def _set(self: pymunk.Constraint, name: str, value: Any) -> None:
    _native_setattr(self, name, value)
    for watching in list(_watching.values()):
        edits = watching()
        if edits is not None:
            edits.record(self, name)
