"""Small worlds that are one island of sustained contacts, stepped by `step_island` alone."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np

from eeca_pymunk.compiled import table_of
from eeca_pymunk.compiled.records import columns, rows
from eeca_pymunk.contacts.correction import correct_penetration
from eeca_pymunk.contacts.forces import copy_recent
from eeca_pymunk.contacts.interval import make_contacts, step_island
from eeca_pymunk.contacts.works import external_work
from eeca_pymunk.geometry.corners import thin as is_thin
from eeca_pymunk.impacts.scene import EventLoop
from eeca_pymunk.impacts.scene_memory import Laid
from eeca_pymunk.model.bodies import POSE, VELOCITY
from eeca_pymunk.model.contacts import Force, Problem
from eeca_pymunk.model.islands import Island
from eeca_pymunk.model.parameters.intervals import OVERLAP_LEFT
from eeca_pymunk.rows.build import conserves

from ..packed import Thing, World

WORKS = ("restitution", "friction", "carried", "lifted", "forces")


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
    ledger: SimpleNamespace = field(default_factory=lambda: SimpleNamespace(**dict.fromkeys(WORKS, 0.0)))

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
        self.m = 0
        self.contacts = make_contacts(0, k)
        # The scene of these bodies: its shapes, its memory of forces.
        moving = int((owner < len(world.body) - 1).sum())
        thin_ones = [s for s in range(len(owner)) if is_thin(world.link[s], world.vertex)]
        thin = sum(s < moving for s in thin_ones) if len(thin_ones) > 1 else 0
        measured = moving, max(2, int(world.link["vertices"].max())), thin, int((world.shape["elasticity"] < 1.0).any())
        laid = Laid(world.body, world.shape, world.link, world.vertex, world.disks, measured)
        self.scene = EventLoop(laid, 0).scene
        self.room(64)

    def room(self, size: int) -> None:
        """Memory of the forces of four times `size` contacts."""
        self.size = size
        self.clean(8 * size)

    def clean(self, size: int) -> None:
        """Memory of this step and the last alone, in tables of `size` rows."""
        scene = self.scene
        keys, forces = np.full(size, -1), rows(Force, size)
        copy_recent(scene.KEYS, scene.FORCES, scene.COUNT, keys, forces, scene.PAR.stamp - 1.0)
        self.scene = scene._replace(KEYS=keys, FORCES=forces)

    @property
    def B(self) -> np.ndarray:
        """The second bodies of the contacts."""
        return self.contacts.ROWS["b"]

    @property
    def L(self) -> np.ndarray:
        """Impulses of the contacts."""
        return self.contacts.L

    def step(self, h: float) -> None:
        """One step; the ledger is added to, and `closes` is how far it misses the change of energy."""
        self.scene.PAR.stamp += 1.0
        x, far = (
            self.pose[:, :2],
            self.extent + 2.5 * h * (np.hypot(*self.v[:, :2].T)) + h * h * np.hypot(*self.gravity),
        )
        a, b = self.all[:, 2], self.all[:, 3]
        near = (np.hypot(*(x[a] - x[b]).T) <= 1.1 * (far[a] + far[b])) | (b >= self.n)
        pairs = np.ascontiguousarray(self.all[near])
        self.contacts = make_contacts(len(pairs), len(self.im))
        before = self.kinetic()
        isle = Island(
            np.arange(len(self.im)), self.pose, self.v, self.acc, self.im, self.ii, self.extent, self.extent, pairs
        )
        while True:
            self.m = step_island(
                table_of(self.scene), table_of(isle), table_of(self.contacts), self.n, h, 40, 0.0, 0.0, 0.0
            )
            if self.m >= 0:
                break
            self.room(2 * self.size)
        vn, self.jump, self.out = self.contacts.VN, self.contacts.JUMP, self.contacts.OUT[0]
        self.losses = np.array((self.out.restitution, self.out.friction))
        self.gap = self.contacts.ROWS["gap"][: self.m].min(initial=0.0)
        self.lift(h)
        forces, carried = self.forces(h, vn), self.carried(vn)
        self.pose, self.v = self.pose + 0.5 * h * (self.v + vn), vn
        self.closes = self.kinetic() - before - (forces + carried - self.losses.sum())
        still = self.energy()
        self.pose, self.v = self.pose + self.jump[:, :3], self.v + self.jump[:, 3:]
        works = (*self.losses, carried, self.energy() - still, forces)
        for name, work in zip(WORKS, works, strict=True):
            setattr(self.ledger, name, getattr(self.ledger, name) + float(work))

    def lift(self, h: float) -> None:
        """Penetration correction, paid from the losses of the step."""
        c, V, n, m = self.contacts, self.v, self.n, self.m
        if m > 0:
            problem, middle = Problem(c.ROWS, self.im, self.ii, self.pose, n, m), self.pose + 0.5 * h * V
            budget = -1.0 if conserves(c.ROWS, m) else float(self.losses.sum())
            correct_penetration(problem, c.L, middle, c.VN, self.acc, h, self.extent, budget, OVERLAP_LEFT, c.JUMP)

    def carried(self, vn: np.ndarray) -> float:
        """External work of the contacts, with velocities `vn` after the step."""
        c = self.contacts
        return float(external_work(c.ROWS, c.L, self.v, vn, self.im, self.ii, self.m))

    def forces(self, h: float, vn: np.ndarray) -> float:
        """Work of the acceleration over the step."""
        mean = 0.5 * (self.v + vn)[: self.n, :2]
        return h * float(((self.acc[: self.n, :2] * mean).sum(axis=1) / self.im[: self.n]).sum())

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
            carried = self.ledger.carried
            self.step(h)
            self.worst_closure = max(self.worst_closure, abs(self.closes))
            self.least_loss = min(self.least_loss, self.losses.min())
            self.deepest = min(self.deepest, self.gap)
            after = self.energy()
            self.rise = max(self.rise, after - energy - (self.ledger.carried - carried))
            energy = after
        return self


def rectangle(mass: float, width: float, height: float) -> float:
    """Moment of inertia."""
    return mass * (width * width + height * height) / 12.0


__all__ = ["Pile", "Thing", "World", "rectangle"]
