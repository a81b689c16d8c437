"""A space of jointed bodies without shapes, stepped through gather, `Components.step` and scatter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pymunk

from eeca_pymunk.arrays import FloatArray, IntArray
from eeca_pymunk.compiled import table_of
from eeca_pymunk.compiled.records import Rows, numbers, row, rows
from eeca_pymunk.joints.components import step_all
from eeca_pymunk.joints.workspace import JointMemory
from eeca_pymunk.model.bodies import ACCELERATION, POSE, VELOCITY, Body
from eeca_pymunk.model.joint_steps import JointLedger
from eeca_pymunk.model.joints import Joint, Joints, joints_of
from eeca_pymunk.space.joints import JointRows


@dataclass
class Components:
    """A plan of the components of some joints, with the memory that stepping them needs.

    Attributes:
        joint: (j,) the joints.  order: 2, or 4 where a component allows it.
    """

    joint: Rows[Joint]
    order: int = 2

    def plan(self, bodies: Rows[Body]) -> None:
        """Find the components of `bodies` (n,), and make room."""
        self.use(joints_of(JointMemory().plan(bodies, self.joint, bodies[:0], self.order)))
        self.arrays.PROGRESS.budget = np.inf

    def use(self, arrays: Joints) -> None:
        """Take these arrays."""
        self.arrays, self._table = arrays, table_of(arrays)

    @property
    def ledger(self) -> Rows[JointLedger]:
        """Energies of the last step, of each component."""
        return self.arrays.STEPPED[: self.arrays.TALLY.components]

    def step(self, bodies: Rows[Body], h: float) -> int:
        """Step all components of `bodies` (n,) by h; the worst status."""
        return step_all(self._table, bodies, h)


class JointedSpace:
    """Steps the bodies and constraints of a space that has no contacts.

    Attributes:
        order: 2 or 4 (where a component allows it).  status: the worst of the last step.
        ledger: energies summed over all steps and components.
    """

    def __init__(self, space: pymunk.Space, order: int = 2) -> None:
        self.space, self.order = space, order
        self.status = 0
        self._items: list[pymunk.Body] = []
        self._joints: tuple[pymunk.Constraint, ...] = ()
        self.ledger: JointLedger = row(JointLedger)
        self._past: JointRows | None = None
        self._plan()

    def _plan(self) -> None:
        """Number bodies and joints, and find the components."""
        space = self.space
        items = dict.fromkeys(space.bodies)
        for c in space.constraints:
            items.setdefault(c.a)
            items.setdefault(c.b)
        self._items = list(items)
        self._inside = set(space.bodies)
        self._joints = tuple(space.constraints)
        self._place: dict[pymunk.Body, int] = {body: i for i, body in enumerate(self._items)}
        self.rows: JointRows = JointRows(space, self._place, len(self._items), self._past)
        self._past = self.rows
        self.bodies: Rows[Body] = rows(Body, len(self._items))
        self._written: FloatArray = np.full((len(self._items), 6), np.nan)
        self._mobility()
        self.components = Components(self.rows.joint, self.order)
        self.components.plan(self.bodies)
        bound = self.rows.joint["body"].ravel()
        self._free = self._moving.copy()
        self._free[bound] &= ~self._dynamic[bound]

    def _mobility(self) -> None:
        self._centre = np.array([tuple(b.center_of_gravity) for b in self._items]).reshape(-1, 2)
        for i, body in enumerate(self._items):
            if body.body_type == pymunk.Body.DYNAMIC:
                self.bodies["inv_mass"][i], self.bodies["inv_inertia"][i] = 1.0 / body.mass, 1.0 / body.moment
        self._dynamic = np.array([b.body_type == pymunk.Body.DYNAMIC for b in self._items])
        self._moving = np.array([b.body_type != pymunk.Body.STATIC and b in self._inside for b in self._items])

    def _gather(self) -> None:
        bodies = self.bodies
        state = np.array([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in self._items])
        self._state = state
        changed = (state != self._written).any(axis=1)
        if changed.any():
            new: IntArray = np.flatnonzero(changed)
            self.rows.touch(new)
            for name, values in zip((*POSE, *VELOCITY), state.T, strict=True):
                bodies[name][new] = values[new]
            c, s = np.cos(state[new, 2]), np.sin(state[new, 2])
            bodies["x"][new] += c * self._centre[new, 0] - s * self._centre[new, 1]
            bodies["y"][new] += s * self._centre[new, 0] + c * self._centre[new, 1]
            for name in VELOCITY:
                bodies[name][~self._moving] = 0.0
        bodies["ax"][self._dynamic], bodies["ay"][self._dynamic] = self.space.gravity

    def step(self, dt: float) -> None:
        """Step the space by dt."""
        if tuple(self.space.constraints) != self._joints:
            self._plan()
        for c in self.rows.before:
            if c.pre_solve is not None:
                c.pre_solve(c, self.space)
        self._gather()
        self.rows.update(self._state, self._place, dt)
        if self.rows.replan:
            self.components.plan(self.bodies)
            self.rows.planned()
        self.status = self.components.step(self.bodies, dt)
        self.book()
        free = self._free
        for x, v, a in zip(POSE, VELOCITY, ACCELERATION, strict=True):
            self.bodies[v][free] += 0.5 * dt * self.bodies[a][free]
            self.bodies[x][free] += dt * self.bodies[v][free]
            self.bodies[v][free] += 0.5 * dt * self.bodies[a][free]
        self._scatter()
        self.rows.write()
        for c in self.rows.after:
            if c.post_solve is not None:
                c.post_solve(c, self.space)

    def book(self) -> None:
        """Add the ledgers of the last step."""
        for one in self.components.ledger:
            numbers(self.ledger)[:] += numbers(one)

    def losses(self) -> tuple[float, ...]:
        """All that has been lost so far."""
        book = self.ledger
        return book.damped, book.limited, book.clamped, book.projected

    def _scatter(self) -> None:
        bodies = self.bodies
        c, s = np.cos(bodies["angle"]), np.sin(bodies["angle"])
        x = bodies["x"] - c * self._centre[:, 0] + s * self._centre[:, 1]
        y = bodies["y"] - s * self._centre[:, 0] - c * self._centre[:, 1]
        for i in np.flatnonzero(self._moving):
            body = self._items[i]
            # pymunk places the centre of mass from the position by the angle it has at that moment.
            body.angle = bodies["angle"][i]
            body.position = x[i], y[i]
            body.velocity, body.angular_velocity = (bodies["vx"][i], bodies["vy"][i]), bodies["spin"][i]
        self._written = np.array([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in self._items])

    def energy(self) -> float:
        """Kinetic energy, potential energy of gravity, and what linear springs hold."""
        bodies, total = self.bodies[self._dynamic], 0.0
        with np.errstate(divide="ignore"):
            mass, moment = (
                1.0 / bodies["inv_mass"],
                np.where(bodies["inv_inertia"] > 0.0, 1.0 / bodies["inv_inertia"], 0.0),
            )
        total += float((0.5 * mass * (bodies["vx"] ** 2 + bodies["vy"] ** 2)).sum())
        total += float((0.5 * moment * bodies["spin"] ** 2).sum())
        total -= float((mass * (bodies["ax"] * bodies["x"] + bodies["ay"] * bodies["y"])).sum())
        for c in self._joints:
            if isinstance(c, pymunk.DampedSpring):
                length = (c.b.local_to_world(c.anchor_b) - c.a.local_to_world(c.anchor_a)).length
                total += 0.5 * c.stiffness * (length - c.rest_length) ** 2
            elif isinstance(c, pymunk.DampedRotarySpring):
                total += 0.5 * c.stiffness * (c.a.angle - c.b.angle - c.rest_angle) ** 2
        return total

    def gain(self) -> float:
        """Energy that the ledger says has come in since the start, without STORED, which `energy` counts."""
        book = self.ledger
        return float(book.motors + book.supports + book.closed - sum(self.losses()))
