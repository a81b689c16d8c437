"""Small worlds as the packed arrays of `eeca_pymunk.model`, for tests of kernels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from eeca_pymunk.compiled.entries import table_fields
from eeca_pymunk.compiled.records import rows
from eeca_pymunk.model.bodies import Body
from eeca_pymunk.model.parameters.events import STEP_LOOKS
from eeca_pymunk.model.scene import Scene
from eeca_pymunk.model.shapes import Link, Shape


def scene_with(**arrays: Any) -> Scene:
    """A scene of these arrays; the others have no rows, and records are 0."""
    for name, dtype, dimensions in table_fields("Scene"):
        if name not in arrays:
            arrays[name] = np.zeros((0,) * dimensions, dtype) if dimensions else np.zeros(1, dtype)[0]
    return Scene(**arrays)


def core_room(LINK: Any) -> np.ndarray:
    """CORE: scratch for the vertices of two shapes."""
    return np.zeros((2, max(2, int(LINK["vertices"].max(initial=2))), 4))


@dataclass
class Thing:
    """A body: shapes are (vertices, rounding); a lone disk is `Thing(shapes=disk(r))`."""

    shapes: list[tuple[Sequence[tuple[float, float]], float]]
    pose: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rate: tuple[float, float, float] = (0.0, 0.0, 0.0)
    pull: tuple[float, float, float] = (0.0, 0.0, 0.0)
    since: float = 0.0
    moves: bool = True  # by impulses

    @property
    def lone(self) -> bool:
        """Whether it is a disk about its centre of mass."""
        vertices = self.shapes[0][0]
        return self.moves and len(self.shapes) == 1 and len(vertices) == 1 and not any(vertices[0])


@dataclass
class World:
    """Things (lone disks first, then moving, then carried ones) and the shapes of the ground."""

    things: list[Thing]
    ground: list[tuple[Sequence[tuple[float, float]], float]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.disks = sum(thing.lone for thing in self.things)
        everything = [*self.things, Thing(self.ground, moves=False)]
        shapes = [(i, v, r) for i, thing in enumerate(everything) for v, r in thing.shapes]
        self.body = rows(Body, len(everything))
        self.shape = rows(Shape, len(shapes))
        self.link = rows(Link, len(shapes))
        self.vertex = np.zeros((sum(len(v) for _, v, _ in shapes), 4))
        for i, thing in enumerate(everything):
            row = self.body[i]
            row.x, row.y, row.angle = thing.pose
            row.vx, row.vy, row.spin = thing.rate
            row.ax, row.ay, row.angular = thing.pull
            row.since, row.inv_mass, row.inv_inertia = thing.since, float(thing.moves), float(thing.moves)
        first = 0
        for s, (i, vertices, rounding) in enumerate(shapes):
            v, count = np.array(vertices, float), len(vertices)
            self.vertex[first : first + count, :2] = v
            if count > 1:
                edge = np.roll(v, -1, axis=0) - v
                length = np.hypot(edge[:, 0], edge[:, 1])[:, None]
                self.vertex[first : first + count, 2:] = np.stack((edge[:, 1], -edge[:, 0]), axis=1) / length
            self.link[s].owner, self.link[s].first, self.link[s].vertices = i, first, count
            size = rounding + np.hypot(v[:, 0], v[:, 1]).max()
            middle = 0.5 * (v.min(axis=0) + v.max(axis=0))
            shape = self.shape[s]
            shape.rounding, shape.extent, shape.centre_x, shape.centre_y = rounding, size, *middle
            shape.bound = rounding + np.hypot(*(v - middle).T).max()
            self.body["extent"][i] = max(self.body["extent"][i], size)
            first += count
        self.scene = scene_with(
            BODY=self.body, SHAPE=self.shape, LINK=self.link, VERTEX=self.vertex, CORE=core_room(self.link)
        )
        self.scene.COUNT.disks, self.scene.COUNT.budget = self.disks, STEP_LOOKS
        self.scene.PAR.share = 1.0


def disk(radius: float) -> list[tuple[Sequence[tuple[float, float]], float]]:
    """The shapes of a lone disk."""
    return [([(0.0, 0.0)], radius)]


def box(width: float, height: float, rounding: float = 0.0) -> list[tuple[Sequence[tuple[float, float]], float]]:
    """The shapes of a box, `rounding` beyond its width and height."""
    x, y = 0.5 * width, 0.5 * height
    return [([(-x, -y), (x, -y), (x, y), (-x, y)], rounding)]


def hull(rng: np.random.Generator, count: int, size: float = 0.6) -> list[tuple[float, float]]:
    """Corners of a convex polygon on a circle, counter-clockwise."""
    angle = 2 * math.pi * (np.arange(count) + rng.uniform(0.0, 0.8, count)) / count + rng.uniform(0.0, 2 * math.pi)
    return [(size * math.cos(a), size * math.sin(a)) for a in angle]


def outline(vertices: np.ndarray, points: int = 101) -> np.ndarray:
    """Points (k, 2) on the boundary of a polygon, a segment or a point."""
    s = np.linspace(0.0, 1.0, points)[:, None, None]
    return np.asarray((vertices + s * (np.roll(vertices, -1, axis=0) - vertices)).reshape(-1, 2))


def placed(vertices: Sequence[tuple[float, float]], pose: Sequence[float]) -> np.ndarray:
    """World vertices (k, 2) at a pose (x, y, angle)."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return np.array(vertices) @ np.array([[c, s], [-s, c]]) + np.array(pose[:2])
