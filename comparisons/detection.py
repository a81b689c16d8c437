"""Detection: near lists with margins of their own against the arbiters of a space of grown shapes, cost and pairs.

Two sources of the pairs that may meet, with equal margins, along the same run. A *margin twin* is a private pymunk
space in which every shape is grown by its margin: pymunk's broad and narrow phase report which of them overlap, all at
once, as soon as the first shape has used its margin up. *Near lists* are made anew for one shape at a time, by a grid
of bounding circles. pymunk's pairs of outlines are fewer; ours cost a search of a few cells.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from functools import partial

import numpy as np
import pymunk
from pymunk import batch
from tqdm import tqdm

import eeca_pymunk as ep
import scenes
from comparisons.output import Output, Row
from eeca_pymunk.arrays import FloatArray, IntArray
from eeca_pymunk.compiled import table_of
from eeca_pymunk.compiled.records import columns
from eeca_pymunk.impacts.scene_memory import SceneMemory
from eeca_pymunk.model.bodies import POSE
from eeca_pymunk.model.scene import scene_of
from eeca_pymunk.pairs import grid, setup
from eeca_pymunk.space.world import World
from scenes.scene import add_disk, add_walls

Pairs = set[tuple[int, int]]
Build = Callable[[], pymunk.Space]
DT = 1e-3  # s
STEPS = 60
_SURE = 0.99  # of its margin, up to which a shape's list is trusted
_HASH_FROM = 200  # moving shapes from which pymunk's spatial hash is faster than its tree


class Twin:
    """A private space with a copy of every shape of a world, one body each, grown by a margin."""

    def __init__(self, world: World, moving: int, margin: FloatArray) -> None:
        self.world, self.moving = world, moving
        space = self.space = pymunk.Space()
        space.iterations = space.collision_persistence = 1
        shape_of: dict[int, int] = {}
        margin = np.r_[margin, np.zeros(len(world.SHAPE) - moving)]
        for s, shape in enumerate(world.shapes):
            body = pymunk.Body(1.0, 1.0) if s < moving else pymunk.Body(body_type=pymunk.Body.STATIC)
            first, count = world.LINK[s].first, world.LINK[s].vertices
            points = [(float(x), float(y)) for x, y in world.VERTEX[first : first + count, :2]]
            radius = float(world.SHAPE["rounding"][s] + margin[s])
            copy: pymunk.Shape
            if count == 1:
                copy = pymunk.Circle(body, radius, points[0])
            elif count == 2:
                copy = pymunk.Segment(body, points[0], points[1], radius)
            else:
                copy = pymunk.Poly(body, points, radius=radius)
            copy.filter, copy.sensor = shape.filter, True  # found, but not solved for
            space.add(body, copy)
            shape_of[body.id] = s
        if moving >= _HASH_FROM:
            size = world.SHAPE["bound"][:moving] + margin[:moving]
            space.use_spatial_hash(2.5 * float(np.median(size)), 4 * moving)
        self._fields = batch.BodyFields.POSITION | batch.BodyFields.ANGLE
        self._in, self._out = batch.Buffer(), batch.Buffer()
        batch.get_space_bodies(space, batch.BodyFields.BODY_ID | self._fields, self._out)
        ids = np.frombuffer(self._out.int_buf(), dtype=np.uintp)
        self._poses = np.frombuffer(self._out.float_buf()).reshape(-1, 3).copy()
        walk = np.array([shape_of[int(i)] for i in ids])
        self._slot = np.argsort(walk)[:moving]
        self._sorted = np.argsort(ids)
        self._ids, self._shape = ids[self._sorted], walk[self._sorted]

    def find(self, pose: FloatArray) -> IntArray:
        """(m, 2) pairs of copies that overlap where the shapes that move are at `pose` (moving, 3)."""
        self._poses[self._slot] = pose
        self._in.set_float_buf(self._poses.reshape(-1))
        batch.set_space_bodies(self.space, self._fields, self._in)
        self.space.step(1.0)
        self._out.clear()
        batch.get_space_arbiters(self.space, batch.ArbiterFields.BODY_A_ID | batch.ArbiterFields.BODY_B_ID, self._out)
        found = np.frombuffer(self._out.int_buf(), dtype=np.uintp)
        pairs: IntArray = self._shape[np.searchsorted(self._ids, found)].reshape(-1, 2)
        return pairs


class Lists:
    """Our lists of the same world, and how far shapes have gone since theirs were made."""

    def __init__(self, world: World, moving: int) -> None:
        self.world, self.moving = world, moving
        self.near = scene_of(SceneMemory().scene(world.laid, 0, False, 0))
        if np.isinf(self.near.MARK["margin"]).any():
            raise ValueError(f"{moving} shapes stand in all lists: there is nothing to detect")

    @property
    def margin(self) -> FloatArray:
        """(moving,) margins, length."""
        column: FloatArray = self.near.MARK["margin"]
        return column

    def gone(self) -> FloatArray:
        """(moving,) part of its margin that each shape has used."""
        world, n = self.world, self.moving
        pose = poses(world, n)
        c, d = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        x, y = world.SHAPE["centre_x"][:n], world.SHAPE["centre_y"][:n]
        place = pose[:, :2] + np.stack((c * x - d * y, d * x + c * y), axis=1)
        used: FloatArray = np.hypot(*(place - columns(self.near.MARK, "x", "y")).T) / self.margin
        return used

    def renew(self, which: IntArray) -> None:
        """Make the lists of some shapes anew, where they are now."""
        for s in which.tolist():
            if grid.renew_circle(self.near, s, 0.0, 0.0) < 0:
                self.near = setup.with_more_room(self.near, 0.0)
                return

    def pairs(self) -> Pairs:
        """All pairs of the lists."""
        near = self.near
        found: Pairs = set()
        for s, (start, count) in enumerate(columns(near.LIST, "start", "number").tolist()):
            found |= {(min(s, o), max(s, o)) for o in near.POOL[start : start + count].tolist()}
        return found


def poses(world: World, moving: int) -> FloatArray:
    """(moving, 3) of the bodies of the shapes that move."""
    found: FloatArray = columns(world.BODY, *POSE)[world.LINK["owner"][:moving]]
    return found


def as_set(pairs: IntArray, moving: int) -> Pairs:
    """Pairs (a < b) of which one moves."""
    return {(min(a, b), max(a, b)) for a, b in pairs.tolist() if min(a, b) < moving}


def check(world: World, lists: Lists, twin: Twin, slack: Twin) -> None:
    """Every pair that pymunk finds within full margins is in lists made here and now; every pair that it finds within
    the `slack` that all margins still have is in the lists as they are. ValueError for a pair that is missing."""
    moving = lists.moving
    pose = poses(world, moving)
    ours = lists.pairs()
    anew = Lists(world, moving)
    anew.near.MARK["margin"] = lists.margin
    anew.near = setup.with_more_room(anew.near, 0.0)
    for found, held, what in ((slack.find(pose), ours, "kept"), (twin.find(pose), anew.pairs(), "new")):
        if missing := {p for p in as_set(found, moving) if _meet(world, *p)} - held:
            raise ValueError(f"{what} lists lack {sorted(missing)[:5]}")


def _meet(world: World, a: int, b: int) -> bool:
    i, j = world.LINK["owner"][a], world.LINK["owner"][b]
    return bool(i != j and (world.BODY["inv_mass"][i] > 0.0 or world.BODY["inv_mass"][j] > 0.0))


def case(name: str, build: Build, steps: int = STEPS, dt: float = DT, looks: int = 5) -> Row:
    """Both sources along the same run of a scene; times are of this process. A list made anew costs its share of all
    lists made at once: one by one they are made within compiled steps."""
    space = build()
    stepper, world = ep.EECA(space, sync=False), World(space)
    world.load()
    moving = int(np.count_nonzero(world.LINK["owner"] < len(world.BODY) - 1))
    lists = Lists(world, moving)
    twin, slack = Twin(world, moving, lists.margin), Twin(world, moving, (1.0 - _SURE) * lists.margin)
    builds, finds = [], []
    made = found_anew = 0
    twin_at = poses(world, moving).copy()
    for k in range(steps):
        stepper.step(dt)
        world.load()
        left = np.flatnonzero(lists.gone() > _SURE)
        lists.renew(left)
        made += len(left)
        pose = poses(world, moving)
        turned = np.abs(pose[:, 2] - twin_at[:, 2]) * world.SHAPE["extent"][:moving]
        if (np.hypot(*(pose[:, :2] - twin_at[:, :2]).T) + turned > lists.margin).any():
            found_anew, twin_at = found_anew + 1, pose.copy()
        if k % max(1, steps // looks) == 0:
            begin = time.process_time()
            twin.find(pose)
            finds.append(time.process_time() - begin)
            check(world, lists, twin, slack)
    for _ in range(looks):
        begin = time.process_time()
        grid.build(table_of(lists.near), 0.0)
        builds.append(time.process_time() - begin)
    listed, pairs = lists.pairs(), as_set(twin.find(pose), moving)
    find, build_all = statistics.median(finds), statistics.median(builds)
    spent = build_all * made / moving
    return {
        "scene": name, "shapes": moving,
        "margin/radius": float(np.median(lists.margin / world.SHAPE["bound"][:moving])),
        "lists: pairs": len(listed), "twin: pairs": len(pairs), "lists, all at once (us)": 1e6 * build_all,
        "twin, all at once (us)": 1e6 * find, "lists made/step": made / steps, "twin found/step": found_anew / steps,
        "lists (us/step)": 1e6 * spent / steps, "twin (us/step)": 1e6 * find * found_anew / steps,
        "twin/lists": find * found_anew / spent if spent > 0.0 else None,
    }  # fmt: skip


def boxes(count: int, seed: int = 0) -> pymunk.Space:
    """`count` elastic boxes 2 : 1 that turn, with normal velocities and spins, .3 of a unit box."""
    rng = np.random.default_rng(seed)
    space, columns = pymunk.Space(), int(np.ceil(np.sqrt(count)))
    pitch = 1.0 / columns
    height = pitch * np.sqrt(0.3 / 2.0)
    for cell in range(count):
        body = pymunk.Body(1.0, height**2 * 5.0 / 12.0)
        body.position = ((cell % columns + 0.5) * pitch, (cell // columns + 0.5) * pitch)
        body.velocity = tuple(rng.normal(size=2).tolist())
        body.angular_velocity = float(rng.normal()) / (2.0 * height)
        shape = pymunk.Poly.create_box(body, (2.0 * height, height))
        shape.elasticity = 1.0
        space.add(body, shape)
    _fence(space)
    return space


def sizes(count: int, ratio: float = 30.0, seed: int = 0) -> pymunk.Space:
    """`count` disks from r to `ratio` r, evenly in the logarithm, at places clear of each other."""
    rng = np.random.default_rng(seed)
    radius = np.sort(ratio ** rng.uniform(-1.0, 0.0, count))[::-1]
    radius *= np.sqrt(0.25 / (np.pi * float(radius @ radius)))
    space, place = pymunk.Space(), np.zeros((count, 2))
    for i, r in enumerate(radius.tolist()):
        while True:
            place[i] = rng.uniform(1.01 * r, 1.0 - 1.01 * r, 2)
            if (np.hypot(*(place[:i] - place[i]).T) > 1.01 * (radius[:i] + r)).all():
                break
        add_disk(space, tuple(place[i].tolist()), r, (r / radius[0]) ** 2, tuple(rng.normal(size=2).tolist()))
    _fence(space)
    return space


def _fence(space: pymunk.Space) -> None:
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))


def _gas(count: int) -> pymunk.Space:
    return scenes.build("gas", count=count, packing=0.3).space


def cases() -> dict[str, Build]:
    """The scenes by name."""
    found: dict[str, Build] = {f"{n} disks": partial(_gas, n) for n in (100, 1000, 10_000)}
    found |= {f"{n} boxes": partial(boxes, n) for n in (20, 100, 1000)}
    found |= {f"{n} disks 1:30": partial(sizes, n) for n in (100, 1000)}
    return found


def run(output: Output, full: bool) -> None:
    """Print the table; write CSV."""
    output.parameters({"dt": DT, "steps": STEPS})
    rows = [case(name, build) for name, build in tqdm(cases().items(), desc="detection", disable=None)]
    output.table("Pairs that may meet: near lists against pymunk's arbiters of grown shapes", rows)
    print("every pair that pymunk found within the margins was in the lists")
