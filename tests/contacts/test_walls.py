"""Light bodies between heavy ones and a wall, in islands whose solves come to no end."""

from __future__ import annotations

from itertools import islice, pairwise
from random import Random

import pymunk
import pytest

import eeca_pymunk as ep

DT = 1 / 30
WIDTH, HALF = 1.0, 0.25  # of the light boxes, lengths: width, and half the height with the rounding


def loaded_row(seed: int, unit: float, elastic: float) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """Six boxes side by side on a floor, and on each a column of five polygons of 500 to 5000 times their mass."""
    chance, space = Random(seed), pymunk.Space()
    space.gravity = 0.0, -9.81 * unit
    for p, q in (((-1.0, 0.0), (8.2, 0.0)), ((-0.7, 0.0), (-0.7, 60.0)), ((6.7, 0.0), (6.7, 60.0))):
        wall = pymunk.Segment(space.static_body, (p[0] * unit, p[1] * unit), (q[0] * unit, q[1] * unit), 0.0)
        wall.friction, wall.elasticity = 1.0, elastic
        space.add(wall)
    light = []
    for level in range(6):
        for column in range(6):
            mass = 1.0 if level == 0 else 5000.0 * chance.uniform(0.1, 1.0)
            body = pymunk.Body(mass, 0.1 * mass * unit * unit)
            body.position = (1.2 * column + chance.uniform(-0.05, 0.05)) * unit, (0.3 + level) * unit
            shape: pymunk.Poly
            if level == 0:
                rounding = 0.05 * unit
                shape = pymunk.Poly.create_box(body, (WIDTH * unit, 2.0 * HALF * unit - 2.0 * rounding), rounding)
                light.append(body)
            else:
                body.angle = chance.uniform(-3.0, 3.0)
                corners = ((0.5, -0.3), (0.4, 0.4), (-0.4, 0.3), (-0.5, -0.2))
                shape = pymunk.Poly(body, [(x * unit, y * unit) for x, y in corners])
            shape.friction, shape.elasticity = 1.0, elastic
            space.add(body, shape)
    return space, light


@pytest.mark.parametrize(("unit", "elastic", "joined"), [(1.0, 0.0, 0), (1.0, 0.5, 0), (1e-3, 0.0, 0), (1.0, 0.0, 6)])
def test_light_boxes_under_heavy_ones_stay_above_the_floor(unit: float, elastic: float, joined: int) -> None:
    space, light = loaded_row(1, unit, elastic)
    heavy = [body for body in space.bodies if body not in light]
    for a, b in islice(pairwise(heavy), 0, 4 * joined, 4):
        space.add(pymunk.PinJoint(a, b))
    stepper = ep.EECA(space)
    for _ in range(90):
        energy = ep.measure(space).energy
        stepper.step(DT)
        assert ep.measure(space).energy <= energy + 1e-11 * 5000.0 * 36 * 9.81 * unit * unit * 5.0
        assert min(body.position.y for body in light) > 0.0
