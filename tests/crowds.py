"""Spaces with crowds of disks, and what must hold after each step."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from comparisons.exact import Gas
from eeca_pymunk.compiled import plain
from scenes.scene import add_disk, add_walls

SHORT = plain()  # plain Python takes a hundred times as long

Bodies = list[pymunk.Body]


def positions(bodies: Bodies) -> np.ndarray:
    return np.array([b.position for b in bodies])


def state(space: pymunk.Space) -> np.ndarray:
    """(N, 6) poses and velocities of all bodies, to be compared bit by bit."""
    return np.array([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies])


def radii(bodies: Bodies) -> np.ndarray:
    return np.array([next(iter(b.shapes)).radius for b in bodies])  # type: ignore[attr-defined]


def reference(bodies: Bodies, side: float = 1.0) -> Gas:
    """The event by event solution from here on, without gravity."""
    velocity = np.array([b.velocity for b in bodies])
    return Gas(positions(bodies), velocity, radii(bodies), np.array([b.mass for b in bodies]), side)


def box_of(sizes: np.ndarray, seed: int, side: float = 1.0, gravity: float = 0.0) -> tuple[pymunk.Space, Bodies]:
    """Elastic disks of these radii, masses as their areas, at random places clear of each other in a square box;
    the large ones are put down first. Velocity components are normal with unit spread, times `side`."""
    rng = np.random.default_rng(seed)
    place = np.zeros((len(sizes), 2))
    order = np.argsort(-sizes, kind="stable")
    for k, i in enumerate(order):
        before = order[:k]
        while True:
            place[i] = rng.uniform(sizes[i] * 1.01, side - 1.01 * sizes[i], 2)
            if (np.hypot(*(place[before] - place[i]).T) > 1.01 * (sizes[before] + sizes[i])).all():
                break
    space = pymunk.Space()
    space.gravity = (0.0, -gravity)
    mass = (sizes / sizes.max()) ** 2
    bodies = [
        add_disk(space, (float(x), float(y)), float(r), float(m), tuple((side * rng.normal(size=2)).tolist()))
        for (x, y), r, m in zip(place, sizes, mass, strict=True)
    ]
    corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]
    add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
    return space, bodies


def deepest(bodies: Bodies, side: float = math.inf) -> float:
    """The deepest overlap of two disks, or of one with the walls x, y = 0 and `side`, over the smaller radius."""
    place, radius = positions(bodies), radii(bodies)
    d = place[:, None] - place
    overlap = radius[:, None] + radius - np.hypot(d[..., 0], d[..., 1])
    np.fill_diagonal(overlap, -np.inf)
    pairs = float((overlap / np.minimum(radius[:, None], radius)).max())
    if side == math.inf:
        return pairs
    walls = np.maximum(radius[:, None] - place, place + radius[:, None] - side) / radius[:, None]
    return max(pairs, float(walls.max()))
