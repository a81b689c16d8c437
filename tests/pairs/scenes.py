"""Crowds of shapes as packed arrays, and what their near lists must hold, by brute force in numpy."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from eeca_pymunk.compiled.records import columns, put
from eeca_pymunk.impacts.scene_memory import Laid, SceneMemory
from eeca_pymunk.model.bodies import POSE, VELOCITY
from eeca_pymunk.model.scene import Scene, scene_of
from eeca_pymunk.pairs import grid, setup
from tests.packed import Thing, World, box, disk

WORD = (1 << 64) - 1  # pymunk's "all categories"


@dataclass
class Crowd:
    """A world with its near lists, which follow the bodies by `renew_circle`."""

    world: World
    near: Scene

    @classmethod
    def of(cls, world: World) -> Crowd:
        """The lists as a step makes them first."""
        measured = moving_of(world), int(world.link["vertices"].max(initial=2)), 0, 0
        laid = Laid(world.body, world.shape, world.link, world.vertex, world.disks, measured)
        return cls(world, scene_of(SceneMemory().scene(laid, 0, False, 0)))

    @property
    def moving(self) -> int:
        """How many shapes move; they have the first numbers."""
        return int(self.near.GRID.moving)

    def renew(self, s: int, t: float = 0.0) -> None:
        """Draw the margin circle of s anew, with more room if that takes it."""
        if grid.renew_circle(self.near, s, t, 0.0) < 0:
            self.near = setup.with_more_room(self.near, t)

    def listed(self) -> list[list[int]]:
        """The neighbours of every moving shape, in the order of the list."""
        near = self.near
        return [
            near.POOL[start : start + count].tolist()
            for start, count in columns(near.LIST, "start", "number").tolist()
        ]  # fmt: skip

    def centres(self, t: float = 0.0) -> np.ndarray:
        """(moving, 2) centres of the bounding circles at instant t, from the packed parabolas."""
        w = self.world
        body, shape = w.body[w.link["owner"][: self.moving]], w.shape[: self.moving]
        s = (t - body["since"])[:, None]
        pose = columns(body, *POSE) + (columns(body, *VELOCITY) + 0.5 * columns(body, "ax", "ay", "angular") * s) * s
        c, d = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        x, y = shape["centre_x"], shape["centre_y"]
        return np.asarray(pose[:, :2] + np.stack((c * x - d * y, d * x + c * y), axis=1))

    def expected(self) -> list[set[int]]:
        """Who must stand in the list of every moving shape: whose margin circle, or box of a static shape, overlaps its
        margin circle, and whom the filters let it meet."""
        w, near, moving = self.world, self.near, self.moving
        place, reach = columns(near.MARK, "x", "y"), w.shape["bound"][:moving] + near.MARK["margin"]
        d = place[:, None] - place
        close = np.hypot(d[..., 0], d[..., 1]) <= reach[:, None] + reach
        sets = []
        for s in range(moving):
            found = {int(o) for o in np.flatnonzero(close[s]) if may_meet(w, s, int(o))}
            for o in range(moving, len(w.shape)):
                points = w.vertex[w.link["first"][o] : w.link["first"][o] + w.link["vertices"][o], :2]
                low, high = points.min(axis=0) - w.shape["rounding"][o], points.max(axis=0) + w.shape["rounding"][o]
                away = np.maximum(np.maximum(low - place[s], place[s] - high), 0.0)
                if math.hypot(*away) <= reach[s] and may_meet(w, s, o):
                    found.add(o)
            sets.append(found)
        return sets

    def check(self) -> None:
        """Lists hold all they must and nothing else, each once; and everybody has somewhere to go."""
        assert (self.near.MARK["margin"] > 0.0).all()
        for s, (found, expected) in enumerate(zip(self.listed(), self.expected(), strict=True)):
            assert len(set(found)) == len(found), f"list of {s} holds somebody twice"
            assert set(found) == expected, f"list of {s}"


def moving_of(world: World) -> int:
    """How many shapes are not the ground's."""
    return int(np.count_nonzero(world.link["owner"] < len(world.body) - 1))


def may_meet(world: World, a: int, b: int) -> bool:
    """pymunk's rules, in Python's whole numbers."""
    i, j = world.link["owner"][a], world.link["owner"][b]
    if i == j or not (world.body["inv_mass"][[i, j]].any() or world.body["inv_inertia"][[i, j]].any()):
        return False
    group_a, categories_a, mask_a = (int(v) & WORD for v in columns(world.link[a], "group", "categories", "mask"))
    group_b, categories_b, mask_b = (int(v) & WORD for v in columns(world.link[b], "group", "categories", "mask"))
    if group_a and group_a == group_b:
        return False
    return bool(categories_a & mask_b) and bool(categories_b & mask_a)


def crowd(
    rng: np.random.Generator,
    radii: np.ndarray,
    boxes: int = 0,
    walls: int = 0,
    kinematic: int = 0,
    filters: bool = False,
    side: float | None = None,
    unit: float = 1.0,
    origin: float = 0.0,
) -> World:
    """Disks of `radii`, boxes that turn about points off their centres, and compound bodies, at random places (they may
    overlap: lists do not mind) in a square of `side` (by default about .3 of it is covered), among random segments."""
    if side is None:
        side = math.sqrt(math.pi * float(radii @ radii) / 0.3)
    size = float(np.median(radii))

    def anywhere(turning: bool) -> dict[str, tuple[float, float, float]]:
        place = unit * rng.uniform(0.0, side, 2) + origin
        spin = rng.uniform(-3.0, 3.0, 2) if turning else np.zeros(2)
        speed, pull = unit * rng.normal(size=2), unit * rng.normal(size=2)
        return {
            "pose": (place[0], place[1], spin[0]), "rate": (speed[0], speed[1], spin[1]),
            "pull": (pull[0], pull[1], spin[1]),
        }  # fmt: skip

    def crooked() -> list[tuple[list[tuple[float, float]], float]]:
        shift = size * unit * rng.uniform(-2.0, 2.0, 2)
        return [
            ([(x + shift[0], y + shift[1]) for x, y in corners], rounding)
            for corners, rounding in box(2.0 * size * unit, size * unit, 0.1 * size * unit)
        ]

    things = [Thing(disk(unit * float(r)), **anywhere(False)) for r in radii]
    things += [Thing(crooked() + (crooked() if i % 3 == 0 else []), **anywhere(True)) for i in range(boxes)]
    things += [Thing(crooked(), moves=False, **anywhere(True)) for _ in range(kinematic)]
    ground = []
    for _ in range(walls):
        start = rng.uniform(0.0, side, 2)
        end = start + rng.normal(size=2) * rng.choice([0.02, 0.3]) * side
        points = [tuple((unit * p + origin).tolist()) for p in (start, end)]
        ground.append((points, unit * float(rng.choice([0.0, 0.2 * size]))))
    world = World(things, ground)
    world.link["categories"] = world.link["mask"] = -1
    if filters:
        kinds = [(0, WORD, WORD), (1, WORD, WORD), (2, 1, WORD), (0, 1 << 63, 1), (0, 1, 1 << 63 | 1), (0, 2, WORD - 2)]
        rows = np.array(kinds, np.uint64).view(np.int64)
        put(world.link, rows[rng.integers(0, len(kinds), len(world.link))], "group", "categories", "mask")
    return world
