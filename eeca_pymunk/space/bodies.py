"""Bodies: arrays of a space's bodies. `gather` reads their states from pymunk, `scatter` writes them, in one batch call
each."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import cached_property
from typing import Any

import numpy as np
import pymunk
from pymunk import batch

from ..arrays import BoolArray, FloatArray, IntArray, rotate_all
from ..compiled.records import Rows, columns, from_bytes, put
from ..energy.invariants import Invariants, traces
from ..errors import NotFiniteError
from ..layout import STATE_COLUMNS
from ..model.values import DYNAMIC, STATIC, BodyValues
from . import body_values
from .private import batch as private_batch
from .private import sleep as private_sleep

_FIELDS = batch.BodyFields
_STATE = _FIELDS.POSITION | _FIELDS.ANGLE | _FIELDS.VELOCITY | _FIELDS.ANGULAR_VELOCITY | _FIELDS.FORCE | _FIELDS.TORQUE
STATE_FIELDS = _FIELDS.BODY_ID | _STATE
# Columns of one row of the state, in the order pymunk.batch writes them.
POSITION, ANGLE, VELOCITY = slice(0, 2), 2, slice(3, 5)
ANGULAR_VELOCITY, FORCE, TORQUE = 5, slice(6, 8), 8
COLUMN_NAMES = (
    "position.x", "position.y", "angle", "velocity.x", "velocity.y", "angular_velocity", "force.x", "force.y", "torque",
)  # fmt: skip


def moving(space: pymunk.Space) -> list[pymunk.Body]:
    """The bodies of a space that are not static, in pymunk's order."""
    return [b for b in space.bodies if b.body_type != pymunk.Body.STATIC]


_OF_MASS = "mass", "moment", "inverse_mass", "inverse_moment"


def _column(name: str) -> Any:
    """The column of `Bodies.VALUES` with this name, an attribute of `Bodies`."""
    return cached_property(lambda bodies: bodies.VALUES[name])


class Bodies:
    """The bodies of one space, one row each, in the order of `pymunk.batch`.

    Masses, moments and kinds are read once; ValueError for a dynamic body without a positive mass and moment.

    Args:
        space: a pymunk space.  sleeps: whether bodies may sleep; sleeping ones then count as static.
        before: an earlier reading of the same space; its values are used again, except those of bodies in `stale`.
        ids: (N,) pymunk's ids (`body.id`) in its present order; the array is kept, not copied. None: they are read.

    Attributes:
        items: the pymunk bodies, by row.  row: the row of each body.  ids: (N,) see above.
        fresh: number of bodies whose values were read anew.
        arranged: whether pymunk's order is that in which bodies were added, with the static body last.
        VALUES: (N,) `BodyValues`, with the columns `mass` and `moment` (mass length²), infinite for static and
            kinematic bodies; `inverse_mass` and `inverse_moment`, 0 for these.
    """

    def __init__(
        self, space: pymunk.Space, sleeps: bool = False, before: Bodies | None = None, stale: Collection[Any] = (),
        ids: IntArray | None = None,
    ) -> None:  # fmt: skip
        self.space = space
        ground = space.static_body  # created at its first access
        everyone = (*space.bodies, ground)
        self.ids: IntArray = self._read()[0] if ids is None else ids
        listed: list[int] = self.ids.tolist()
        old: dict[pymunk.Body, int] = {}
        known: dict[int, tuple[pymunk.Body, bytes]] = {}
        if before is not None:
            old, known = before.row, before._known
            if changed := [old[body] for body in stale if body in old]:
                known = known.copy()
                for row in changed:
                    del known[before.items[row].id]
        missing = [i for i in listed if i not in known]
        self.fresh = len(missing)
        if missing:
            new = {b.id: b for b in everyone if b not in old or b in stale}
            known = {**known, **{i: (new[i], body_values.read(new[i])) for i in missing}}
        self._known: dict[int, tuple[pymunk.Body, bytes]] = {i: known[i] for i in listed}
        self.items: tuple[pymunk.Body, ...] = tuple([body for body, _ in self._known.values()])
        self.row: dict[pymunk.Body, int] = dict(zip(self.items, range(len(listed)), strict=True))
        self._values: list[bytes] = [values for _, values in self._known.values()]
        self.VALUES: Rows[BodyValues] = from_bytes(BodyValues, self._values)
        self.arranged = self.items == everyone
        if sleeps:
            self.asleep[:] = private_sleep.sleeping(self.items)
            self.VALUES["kind"][self.asleep], self.VALUES["asleep"] = STATIC, self.asleep
            masses = np.where(self.asleep[:, None], body_values.FIXED, columns(self.VALUES, *_OF_MASS))
            put(self.VALUES, masses, *_OF_MASS)
            # Functions of sleeping bodies are not called, as under pymunk.
            self.VALUES["steered"][self.asleep] = self.VALUES["moved"][self.asleep] = 0
        if not self.arranged:
            # pymunk's order changes when bodies sleep or are removed, and a copy of the space has another one: `place`
            # is the order of addition, which copies share.
            place = {body: i for i, body in enumerate(everyone)}
            self.VALUES["place"] = [place[body] for body in self.items]

    mass: FloatArray = _column("mass")
    moment: FloatArray = _column("moment")
    inverse_mass: FloatArray = _column("inverse_mass")
    inverse_moment: FloatArray = _column("inverse_moment")

    @cached_property
    def asleep(self) -> BoolArray:
        """(N,) which bodies sleep."""
        return np.zeros(len(self.items), bool)

    @cached_property
    def dynamic(self) -> BoolArray:
        """(N,) which bodies are dynamic, and awake."""
        dynamic: BoolArray = self.VALUES["kind"] == DYNAMIC
        return dynamic

    @cached_property
    def static(self) -> BoolArray:
        """(N,) which bodies are static, or asleep."""
        static: BoolArray = self.VALUES["kind"] == STATIC
        return static

    @cached_property
    def velocity_hooks(self) -> IntArray:
        """Rows of the bodies with a velocity function."""
        return self.VALUES["steered"].nonzero()[0]

    @cached_property
    def position_hooks(self) -> IntArray:
        """Rows of the bodies with a position function."""
        return self.VALUES["moved"].nonzero()[0]

    @cached_property
    def center_of_gravity(self) -> FloatArray:
        """(N, 2) length, in body coordinates."""
        return columns(self.VALUES, "centre_x", "centre_y")

    def same_in(self, before: Bodies) -> list[tuple[int, int, bool]]:
        """Rows, here and in an earlier reading, of the bodies that are not static here and have the same kind and
        centre of mass; and whether they were awake there with the same mass and moment."""
        old, kinds, slept = before.row, self.VALUES["kind"].tolist(), before.asleep.tolist()
        at = [(i, old[body]) for body, i in self.row.items() if body in old and kinds[i] != STATIC]
        new, known, values = self._values, before._values, body_values
        return [
            (i, j, not slept[j] and (new[i] is known[j] or values.masses(new[i]) == values.masses(known[j])))
            for i, j in at
            if new[i] is known[j] or values.centre(new[i]) == values.centre(known[j])
        ]

    @cached_property
    def start(self) -> FloatArray:
        """(N, 9) the present state."""
        return self._read()[1]

    def changed(self, row: int) -> tuple[bytes | None, bool]:
        """The values of a body if they have changed, else None; and whether others than mass and moment have changed.
        ValueError if they are invalid."""
        new, old = body_values.read(self.items[row]), self._values[row]
        return None if new == old else new, body_values.others(new) != body_values.others(old)

    def set_masses(self, found: Mapping[int, bytes]) -> None:
        """Set masses and moments of bodies, by row, to those in the values that `changed` has returned."""
        for i, values in found.items():
            self._values[i], self._known[self.items[i].id] = values, (self.items[i], values)
            masses = body_values.masses(values)
            self.mass[i], self.moment[i], self.inverse_mass[i], self.inverse_moment[i] = masses

    def __len__(self) -> int:
        return len(self.items)

    @cached_property
    def in_order(self) -> Callable[[], bool]:
        """Function that returns whether pymunk's order of bodies is the same: no body was added or removed, fell asleep
        or woke."""
        return private_batch.ordered(self.space, self.ids)

    @property
    def reached(self) -> tuple[pymunk.Body, ...] | None:
        """The bodies that do not sleep, which are the first ones in pymunk's order; None if no body sleeps. Writing the
        others would wake them."""
        asleep = self.asleep.tolist() if "asleep" in self.__dict__ else []
        return self.items[: asleep.index(True)] if True in asleep else None

    def _read(self) -> tuple[IntArray, FloatArray]:
        """(N,) ids and (N, 9) state now."""
        N = len((*self.space.bodies, self.space.static_body))
        ids, state = np.zeros(N + 1, np.int64), np.zeros((N + 1, STATE_COLUMNS))
        private_batch.reader(self.space, STATE_FIELDS, state, ids)()
        return ids[:N], state[:N]

    def gather(self) -> FloatArray | None:
        """The (N, 9) state now: position, angle, velocity, angular velocity, force, torque (see COLUMN_NAMES).

        None if the space has other bodies now, so that a new `Bodies` is needed.
        """
        ids, state = self._read()
        return state if np.array_equal(ids, self.ids) else None

    def check_finite(self, state: FloatArray, remedy: str = "set a finite value before stepping") -> None:
        """Raise NotFiniteError, which names body and value, if any number of a state is NaN or infinite."""
        if np.count_nonzero(np.isfinite(state)) < state.size:  # `all` takes five times as long for few bodies
            i, j = np.argwhere(~np.isfinite(state))[0]
            raise NotFiniteError(f"{COLUMN_NAMES[j]} of {self.items[i]} is {state[i, j]}: {remedy}")

    def invariants(self, state: FloatArray, gravity: tuple[float, float]) -> Invariants:
        """Energy and momenta in an (N, 9) state."""
        d, center = self.dynamic, state[:, POSITION]
        if self.center_of_gravity.any():
            center = center + rotate_all(self.center_of_gravity, state[:, ANGLE])
        motion = center[d][None], state[d, VELOCITY][None], state[d, ANGULAR_VELOCITY][None]
        kinetic, potential, linear, angular = traces(self.mass[d], self.moment[d], *motion, gravity)
        return Invariants(float(kinetic[0]), float(potential[0]), linear[0], float(angular[0]))

    def scatter(self, state: FloatArray, *, unchanged: bool = False) -> None:
        """Write the whole (N, 9) state to the bodies of these rows that are still in the space.

        `unchanged`: all are, because no callback has run since the state was gathered.
        """
        if self.asleep.any() or (not unchanged and not np.array_equal(self._read()[0], self.ids)):
            # The batch call writes in pymunk's order, so that rows would go to wrong bodies; and it wakes all bodies.
            for body, static, row in zip(self.items, self.static.tolist(), state.tolist(), strict=True):
                if body.space is self.space and not static:
                    body.position, body.angle = (row[0], row[1]), row[2]
                    body.velocity, body.angular_velocity = (row[3], row[4]), row[5]
                    body.force, body.torque = (row[6], row[7]), row[8]
            return
        write = private_batch.writer(self.space, _STATE, np.ascontiguousarray(state))
        # pymunk places a body whose centre of mass is not its origin by its present angle: the second call uses the new
        # angle.
        for _ in range(2 if self.center_of_gravity.any() else 1):
            write()


def measure(space: pymunk.Space) -> Invariants:
    """Energy, linear and angular momentum of the space now, see `Invariants`."""
    bodies = Bodies(space)
    return bodies.invariants(bodies.start, space.gravity)
