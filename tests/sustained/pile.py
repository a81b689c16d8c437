"""Small worlds that are one island of sustained contacts, stepped by `step_island` alone."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from eeca_pymunk.compiled.records import columns, row, rows
from eeca_pymunk.model.bodies import POSE, VELOCITY, Rest
from eeca_pymunk.model.contacts import Row
from eeca_pymunk.model.parameters.intervals import FIRST_AUGMENTATION
from eeca_pymunk.model.step import Count
from eeca_pymunk.sustained.ledger import LEDGER_SIZE
from eeca_pymunk.sustained.memory import FORCE_COLUMNS, forget
from eeca_pymunk.sustained.step import OUT_SIZE, step_island

from ..packed import Thing, World

NO_RULE = np.zeros((0, 6))


@dataclass
class Pile:
    """Things on the ground under constant acceleration. The ground is the last local body, absent if it has no shape.

    `elasticity` and `friction` are those of every contact. Things with `moves=False` are carried (kinematic); they
    come last. Masses and moments (n,) of those that move.
    """

    world: World
    mass: np.ndarray
    moment: np.ndarray
    gravity: tuple[float, float] = (0.0, 0.0)
    elasticity: float = 0.0
    friction: float = 0.0
    ledger: np.ndarray = field(default_factory=lambda: np.zeros(LEDGER_SIZE))

    def __post_init__(self) -> None:
        world = self.world
        grounded = len(world.ground) > 0
        k = len(world.things) + grounded
        self.n = sum(thing.moves for thing in world.things)
        body = world.body[:k]
        self.pose, self.v = columns(body, *POSE), columns(body, *VELOCITY)
        self.acc, self.extent = np.zeros((k, 3)), body["extent"].copy()
        self.acc[: self.n, :2] = self.gravity
        self.im, self.ii = np.zeros(k), np.zeros(k)
        self.im[: self.n], self.ii[: self.n] = 1.0 / np.asarray(self.mass), 1.0 / np.asarray(self.moment)
        # Contacts have the product of both shapes' values.
        world.shape["elasticity"] = np.sqrt(self.elasticity)
        world.shape["friction"] = np.sqrt(self.friction)
        owner = world.link["owner"]
        self.all = np.array(
            [(s, r, owner[s], owner[r]) for s in range(len(owner)) for r in range(s + 1, len(owner))
             if owner[s] != owner[r] and min(owner[s], owner[r]) < self.n], np.int64,
        ).reshape(-1, 4)  # fmt: skip
        self.state, self.stamp, self.m = row(Rest), 0.0, 0
        self.state.augmentation = FIRST_AUGMENTATION
        self.keys, self.forces, self.count = np.full(64, -1), np.zeros((64, FORCE_COLUMNS)), row(Count)
        self.jump, self.out = np.zeros((k, 6)), np.zeros(OUT_SIZE)
        self.room(64)

    def room(self, size: int) -> None:
        """Rows for `size` contacts, and memory for four times as many."""
        self.A, self.B, self.key = (np.zeros(size, np.int64) for _ in range(3))
        self.rows, self.L, self.loss = rows(Row, size), np.zeros((size, 2)), np.zeros((size, 2))
        self.clean(8 * size)

    def clean(self, size: int) -> None:
        """Memory of this step and the last alone, in tables of `size` rows."""
        keys, forces = np.full(size, -1), np.zeros((size, FORCE_COLUMNS))
        forget(self.keys, self.forces, self.count, keys, forces, self.stamp - 1.0)
        self.keys, self.forces = keys, forces

    def step(self, h: float) -> None:
        """One step; the ledger is added to, and `closes` is how far it misses the change of energy."""
        self.stamp += 1.0
        shape, link, vertex, work = self.world.geometry
        x, far = (
            self.pose[:, :2],
            self.extent + 2.5 * h * (np.hypot(*self.v[:, :2].T)) + h * h * np.hypot(*self.gravity),
        )
        a, b = self.all[:, 2], self.all[:, 3]
        near = (np.hypot(*(x[a] - x[b]).T) <= 1.1 * (far[a] + far[b])) | (b >= self.n)
        pairs = np.ascontiguousarray(self.all[near])
        before, ledger = self.kinetic(), self.ledger.copy()
        vn = np.empty_like(self.v)
        while True:
            self.m = step_island(
                self.pose, self.v, self.acc, self.im, self.ii, self.extent, self.extent, self.n, pairs, len(pairs),
                shape, NO_RULE, link, vertex, work, h, 40, 0.0, 0.0, 0.0, self.keys, self.forces, self.count,
                self.stamp, self.state, 0.0,
                self.A, self.B, self.rows, self.key, self.L, self.loss, vn, self.jump, self.ledger, self.out,
            )  # fmt: skip
            if self.m >= 0:
                break
            if 4 * self.count[0] > len(self.keys):
                self.clean(len(self.keys))
            else:
                self.room(2 * len(self.A))
        way = 0.5 * h * (self.v + vn)
        self.pose = self.pose + way + self.jump[:, :3]
        self.v = vn + self.jump[:, 3:]
        now = self.ledger - ledger
        lifted = -((self.acc * self.jump[:, :3])[: self.n, :2] / self.im[: self.n, None]).sum()
        self.closes = self.kinetic() + lifted - before - (now[4] + now[2] + now[3] - now[0] - now[1])
        self.losses = now[:2]

    def kinetic(self) -> float:
        n = self.n
        return float(0.5 * ((self.v[:n, :2] ** 2).sum(axis=1) / self.im[:n] + self.v[:n, 2] ** 2 / self.ii[:n]).sum())

    def potential(self) -> float:
        n = self.n
        return -float(((self.pose[:n, :2] * self.acc[:n, :2]).sum(axis=1) / self.im[:n]).sum())

    def energy(self) -> float:
        return self.kinetic() + self.potential()

    def run(self, steps: int, h: float) -> Pile:
        """Steps; afterwards `worst_closure` and `least_loss` and `rise`, each of any step, are known."""
        self.worst_closure = self.rise = 0.0
        self.least_loss = self.deepest = 0.0
        energy = self.energy()
        for _ in range(steps):
            carried = self.ledger[2]
            self.step(h)
            self.worst_closure = max(self.worst_closure, abs(self.closes))
            self.least_loss = min(self.least_loss, self.losses.min())
            self.deepest = min(self.deepest, self.out[5])
            after = self.energy()
            self.rise = max(self.rise, after - energy - (self.ledger[2] - carried))
            energy = after
        return self


def rectangle(mass: float, width: float, height: float) -> float:
    """Moment of inertia."""
    return mass * (width * width + height * height) / 12.0


__all__ = ["Pile", "Thing", "World", "rectangle"]
