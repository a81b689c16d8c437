"""Steps of single disks on numpy arrays: their start, the near pairs, and the motion of the bodies.

Shared by `Dashpot` and the penalty steppers. `Disks` is the method (`..stepper.Method`) that steps a world. All arrays
of bodies have the rows of BODY; the last row is the ground, the body of all static shapes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..compiled import Table, table_of
from ..compiled.records import columns, put
from ..geometry.gap import gaps
from ..model.parameters.detection import GAP_ROUND_OFF
from ..model.scene import scene_of
from ..model.step import EVENTS
from ..model.values import reading_of
from ..pairs.candidates import candidates
from ..pairs.setup import with_more_room
from ..report import Contacts, Details, Outcome
from ..transfer import read_states, write_states
from .refusals import check_disks

if TYPE_CHECKING:
    import pymunk

    from ..space.world import World


@dataclass(frozen=True)
class Start:
    """The n bodies at the start of a step: position, velocity and acceleration (n, 2), the last with gravity."""

    dt: float
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    inverse_mass: FloatArray

    @property
    def free_velocity(self) -> FloatArray:
        """(n, 2) velocity at the end of the free flight."""
        return self.velocity + self.dt * self.acceleration

    @property
    def free_displacement(self) -> FloatArray:
        """(n, 2) displacement of the free flight over the step."""
        with np.errstate(over="ignore", invalid="ignore"):  # `step` raises for it
            return self.dt * self.velocity + (0.5 * self.dt**2) * self.acceleration

    def at(self, rows: IntArray, time: FloatArray | float) -> FloatArray:
        """(m, 2) positions of the bodies `rows` on the free flight, at one instant or each at its own (m,)."""
        t = time[:, None] if isinstance(time, np.ndarray) else time
        return self.position[rows] + t * self.velocity[rows] + (0.5 * t * t) * self.acceleration[rows]


@dataclass(frozen=True)
class DiskMotion:
    """Velocity and displacement (n, 2) of all bodies over a step, and its report; `details` is None without
    contacts."""

    velocity: FloatArray
    displacement: FloatArray
    details: Details | None = None
    lock: float = 1.0
    converged: bool = True
    iterations: int = 0


class Geometry(NamedTuple):
    """Gap (m,) length, normal (m, 2) from a to b, and point (m, 2) halfway between the surfaces, of every pair."""

    gap: FloatArray
    normal: FloatArray
    point: FloatArray

    def take(self, which: IntArray) -> Geometry:
        """The geometry of the pairs `which`."""
        return Geometry(self.gap[which], self.normal[which], self.point[which])


class Pairs:
    """m pairs of shapes: a single disk with a single disk or a static shape.

    Attributes:
        shapes: (m, 2) shapes a < b.  row_a, row_b: (m,) bodies.  walls: (m,) whether b is static.
        extent: (m,) length, sum of the roundings.
    """

    def __init__(self, disks: Disks, shapes: IntArray) -> None:
        self._disks, self.shapes = disks, shapes
        world = disks.world
        self.row_a: IntArray = world.LINK["owner"][shapes[:, 0]]
        self.row_b: IntArray = world.LINK["owner"][shapes[:, 1]]
        self.walls: BoolArray = self.row_b == len(world.BODY) - 1
        self.extent: FloatArray = world.SHAPE["rounding"][shapes[:, 0]] + world.SHAPE["rounding"][shapes[:, 1]]

    def __len__(self) -> int:
        return len(self.shapes)

    @property
    def key(self) -> IntArray:
        """(m,) one number per pair, the same in every list."""
        result: IntArray = self.shapes[:, 0] * len(self._disks.world.SHAPE) + self.shapes[:, 1]
        return result

    @property
    def elasticity(self) -> FloatArray:
        """(m,) the product of the two shapes' elasticities, as in pymunk, unless a collision handler sets another."""
        SHAPE = self._disks.world.SHAPE
        result: FloatArray = SHAPE["elasticity"][self.shapes[:, 0]] * SHAPE["elasticity"][self.shapes[:, 1]]
        for pair, (e, *_) in self._disks.rules.items():
            result[(self.shapes == pair).all(axis=1)] = e
        return result

    def take(self, which: BoolArray | IntArray) -> Pairs:
        """The pairs selected by a mask or by indices."""
        return Pairs(self._disks, self.shapes[which])

    def between(self, position_a: FloatArray, position_b: FloatArray) -> Geometry:
        """Geometry with the bodies of each pair at the positions (m, 2) given for it."""
        m = len(self)
        POSE_A, POSE_B, OUT = np.zeros((m, 3)), np.zeros((m, 3)), np.empty((m, 5))
        POSE_A[:, :2], POSE_B[:, :2] = position_a, position_b
        gaps(self._disks.table, self.shapes, POSE_A, POSE_B, OUT)
        return Geometry(OUT[:, 0].copy(), OUT[:, 1:3].copy(), OUT[:, 3:5].copy())

    def at(self, position: FloatArray) -> Geometry:
        """Geometry with the bodies at (n, 2) `position`."""
        return self.between(position[self.row_a], position[self.row_b])

    def contacts(self, at: Geometry, gap: FloatArray, time: FloatArray) -> Contacts:
        """The contacts of a report: geometry where impulses act, (m,) gaps at the start of the step, (m,) instants."""
        world = self._disks.world
        a, b = world.owner[self.shapes[:, 0]], world.owner[self.shapes[:, 1]]
        return Contacts(world.bodies.items, a, b, at.normal, at.point, gap, time)


class Disks:
    """The single disks and static shapes of a world; UnsupportedFeature for joints, other moving shapes, and friction.

    Args:
        world: just read, with the present poses in BODY.  mover: name of the closure or stepper, for messages.
        move: the motion over a step, from the disks and their start.

    Attributes:
        table: of the scene, which has the near lists of the shapes.
    """

    def __init__(self, world: World, mover: str, move: Callable[[Disks, Start], DiskMotion]) -> None:
        moving = int(np.count_nonzero(world.LINK["owner"] < len(world.BODY) - 1))
        check_disks(world, moving, mover)
        self.world, self.move = world, move
        self.rules: Mapping[tuple[int, int], tuple[float, float, float, float]] = {}
        self.motion = DiskMotion(np.zeros((0, 2)), np.zeros((0, 2)))  # of the last step
        self.table = world.memory.scene(world.laid, 0, False, 0)
        self._found, self._out = np.zeros((4 * moving + 16, 2), np.int64), np.zeros((4 * moving + 16, 6))

    def step(self, reading: Table, dt: float, gx: float, gy: float, half_damping: float) -> int:
        """From the states read to those to be written, see `transfer.py`; contacts do not change spins. `half_damping`:
        factor of half a step's damping."""
        R, BODY = reading_of(reading), self.world.BODY
        STATES, IDS, EXTRA, ENDS = R.STATES, R.IDS, R.EXTRA, R.ENDS
        status = read_states(STATES, IDS, EXTRA, BODY, gx, gy, half_damping)
        if status < 0:
            return status
        start = Start(
            dt, columns(BODY, "x", "y"), columns(BODY, "vx", "vy"), columns(BODY, "ax", "ay"), BODY["inv_mass"].copy()
        )  # fmt: skip
        finite = np.isfinite(start.free_displacement).all()
        motion = self.move(self, start) if finite else DiskMotion(start.velocity, start.free_displacement)
        self.motion = motion
        put(BODY, columns(BODY, "x", "y") + motion.displacement, "x", "y")
        put(BODY, motion.velocity, "vx", "vy")
        BODY["angle"] += dt * (BODY["spin"] + 0.5 * dt * BODY["angular"])
        BODY["spin"] += dt * BODY["angular"]
        BODY["since"] = dt
        if motion.details is not None:
            status |= EVENTS
        return write_states(STATES, IDS, EXTRA, BODY, ENDS, half_damping, status)

    def rule(self, rules: Mapping[tuple[int, int], tuple[float, float, float, float]]) -> None:
        """Set the elasticity of pairs of shapes (a < b) for the following steps, negative if they do not collide."""
        self.rules = rules

    def details(self, dt: float, bodies: tuple[pymunk.Body, ...], owner: IntArray) -> Details:
        """The arrays of the report of the last step, which had contacts."""
        assert self.motion.details is not None
        return self.motion.details

    def outcome(self) -> Outcome:
        """Of the last step; no ledger is kept."""
        return None, self.motion.lock, self.motion.converged, self.motion.iterations

    def near(
        self, start: Start, displacement: FloatArray, extra: FloatArray | float = 0.0
    ) -> tuple[Pairs, Geometry, FloatArray]:
        """The pairs that may meet within the step, their geometry at its start, and (m,) lengths up to which gaps are
        round-off.

        A body's reach is twice the length of its free flight and `extra` (n,), as impulses may accelerate it. Bodies
        that move farther are searched again (`simultaneous.move_disks`).
        """
        # Sagitta of the parabola, a dt² / 8.
        bow = (0.125 * start.dt**2) * np.hypot(*start.acceleration.T)
        far = np.abs(start.position).max(axis=1)
        reach = 2.0 * (np.hypot(*displacement.T) + bow + GAP_ROUND_OFF * far + extra)
        found, out = self._candidates(reach)
        order = np.lexsort((found[:, 1], found[:, 0]))
        found, out = found[order], out[order]
        ignored = [pair for pair, (e, *_) in self.rules.items() if e < 0.0]
        if ignored:
            keep = ~(found[:, None] == np.array(ignored)).all(axis=2).any(axis=1)
            found, out = found[keep], out[keep]
        return Pairs(self, found), Geometry(out[:, 0], out[:, 1:3], out[:, 3:5]), out[:, 5]

    def _candidates(self, reach: FloatArray) -> tuple[IntArray, FloatArray]:
        while True:
            count = candidates(self.table, reach, self._found, self._out)
            if count < 0:
                self.table = table_of(with_more_room(scene_of(self.table), 0.0))
            elif count > len(self._found):
                self._found, self._out = np.zeros((2 * count, 2), np.int64), np.zeros((2 * count, 6))
            else:
                return self._found[:count], self._out[:count]
