"""Layouts of piles that fall between two walls: aligned columns, hexagonal rows, at random, an avalanche."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pymunk

from .scene import Point

LAYOUTS = ("columns", "hexagonal", "random", "avalanche")
KINDS = ("disks", "boxes", "mixed")
GRAVITY, RADIUS = 9.81, 0.5  # m/s²; m, of the largest disk, and half the side of the largest box
SMALLEST = 0.7  # of that, where sizes vary
HASH_FROM = 50  # bodies


def _places(layout: str, count: int, side: int, rng: np.random.Generator) -> Iterator[Point]:
    """Centres of bodies of radius RADIUS that do not touch, in units of it."""
    if layout == "avalanche":  # a block a third as wide as the floor, in contact with one wall
        side = max(side // 2, 1)
    for i in range(count):
        row, column = divmod(i, side)
        if layout == "hexagonal":
            yield 2.1 * column + 1.05 * (row % 2) + 1.1, 1.1 + 1.85 * row
        elif layout == "random":
            yield 3.0 * column + 1.6 + float(rng.uniform(-0.5, 0.5)), 1.6 + 3.0 * row + float(rng.uniform(-0.5, 0.5))
        elif layout == "avalanche":
            yield 2.05 * column + 1.05 + 0.02 * float(rng.random()), 1.05 + 2.05 * row
        else:
            yield 2.9 * column + 1.5, 1.2 + 2.9 * row


def build(
    layout: str, kind: str, count: int, elasticity: float = 0.3, friction: float = 0.5, seed: int = 0
) -> pymunk.Space:  # fmt: skip
    """`count` bodies of equal density above a floor. Sizes vary with the seed, but for the hexagonal layout; boxes are
    aligned in columns and turned at random elsewhere. Elasticity and friction are of contacts.

    Raises: ValueError for an unknown layout or kind.
    """
    if layout not in LAYOUTS or kind not in KINDS:
        raise ValueError(f"layout {layout!r} of {kind!r}: choose from {LAYOUTS} and {KINDS}")
    rng = np.random.default_rng(seed)
    space, side = pymunk.Space(), math.ceil(math.sqrt(count))
    space.gravity = (0.0, -GRAVITY)
    width = RADIUS * (3.0 * side + 1.0)
    for i, (x, y) in enumerate(_places(layout, count, side, rng)):
        size = 1.0 if layout == "hexagonal" else float(rng.uniform(SMALLEST, 1.0))
        shape: pymunk.Shape
        if kind == "disks" or (kind == "mixed" and i % 2):
            body = pymunk.Body(size**2, pymunk.moment_for_circle(size**2, 0.0, RADIUS * size))
            shape = pymunk.Circle(body, RADIUS * size)
        else:
            # A box that turns stays within the circle of its place.
            edge = 2.0 * RADIUS * size * (0.95 if layout in ("columns", "avalanche") else math.sqrt(0.5))
            body = pymunk.Body(size**2, pymunk.moment_for_box(size**2, (edge, edge)))
            body.angle = 0.0 if layout in ("columns", "avalanche") else float(rng.uniform(0.0, math.pi / 2))
            shape = pymunk.Poly.create_box(body, (edge, edge))
        body.position = (RADIUS * x, RADIUS * y)
        space.add(body, shape)
    top = RADIUS * (6.0 * side + 10.0)
    for a, b in (((0.0, 0.0), (width, 0.0)), ((0.0, 0.0), (0.0, top)), ((width, 0.0), (width, top))):
        space.add(pymunk.Segment(space.static_body, a, b, 0.0))
    for shape in space.shapes:
        # pymunk takes the product of the two shapes.
        shape.elasticity, shape.friction = math.sqrt(elasticity), math.sqrt(friction)
    if count >= HASH_FROM:
        space.use_spatial_hash(3.0 * RADIUS, 2 * count)
    return space
