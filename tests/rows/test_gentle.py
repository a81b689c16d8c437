"""Contacts that friction wedges, and impulses that nothing explains (`rows/gentle.py`)."""

from __future__ import annotations

import math
import random

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.records import rows
from eeca_pymunk.model.contacts import Problem, Solved
from eeca_pymunk.model.parameters.joints import EXCESSIVE_IMPULSE
from eeca_pymunk.rows.build import normal_rate
from eeca_pymunk.rows.columns import as_columns, breach
from eeca_pymunk.rows.gentle import excessive, unwedge
from eeca_pymunk.rows.laws import solve_columns
from eeca_pymunk.rows.sweeps import push

from ..crowds import SHORT
from .block import Block


def corner(unit: float) -> tuple[Problem, Block]:
    """A particle of mass 2 in a right-angled corner, into which it moves, with mu = 1, as an interval that has not been
    solved: targets 0."""
    pose, velocity = np.zeros((2, 3)), np.zeros((2, 3))
    velocity[0, :2] = -3.0 * unit, -1.0 * unit
    block = Block(pose, velocity, np.array([0.5, 0.0]), np.zeros(2))
    block.wall(0, (-1.0, 0.0), 0.0)
    block.wall(0, (0.0, -1.0), 0.0)
    block.solve(0.0, 1.0)
    block.rows["target"], block.rows["activation"] = 0.0, np.inf
    return Problem(block.rows, block.im, block.ii, pose, 1, 2), block


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_a_corner_holds_what_moves_into_it_without_self_stress(unit: float) -> None:
    """With mu = 1 impulses along the edges of both cones cancel out: any multiple of them may be added to a solution.
    Without friction the solution is unique: the momenta 6 and 2."""
    problem, block = corner(unit)
    stress = 1e8 * unit
    L = np.array([[6.0 * unit + stress, -stress], [2.0 * unit + stress, stress]])
    V = block.velocity.copy()
    push(problem, L, 1.0, V)
    assert np.abs(V).max() <= 1e-6 * unit
    speed = 3.0 * unit
    assert excessive(L, 2, problem.IM, 1, speed)
    out = rows(Solved, 1)[0]
    left = unwedge(problem, L, V, block.velocity.copy(), 1e-13 * unit, speed, out)
    assert out.operations > 0.0
    assert left <= 1e-13 * unit
    assert np.abs(L - [[6.0 * unit, 0.0], [2.0 * unit, 0.0]]).max() <= 1e-13 * unit
    assert np.abs(V).max() <= 1e-13 * unit


def test_excessive_impulses_are_not_finite_or_many_times_the_momenta() -> None:
    inverse = np.array([0.5, 2.0])  # masses 2 and 1/2
    most = EXCESSIVE_IMPULSE * 2.5 * 3.0
    for normal, expected in ((0.999 * most, False), (1.001 * most, True), (np.nan, True)):
        assert excessive(np.array([[normal, 0.0]]), 1, inverse, 2, 3.0) == expected


def test_walls_that_approach_each_other_get_gentle_impulses() -> None:
    """No impulse keeps a body between two walls that close from both sides: without friction there is no solution
    either. What is left gives the body no more than the speed of the walls."""
    pose, velocity = np.zeros((3, 3)), np.zeros((3, 3))
    velocity[1, 0], velocity[2, 0] = 1.0, -1.0
    block = Block(pose, velocity, np.array([1.0, 0.0, 0.0]), np.zeros(3))
    block.contacts += [(0, 1, -1.0, 0.0, 0.0, 0.0), (0, 2, 1.0, 0.0, 0.0, 0.0)]
    block.solve(0.0, 0.0)
    block.rows["target"], block.rows["activation"] = 0.0, np.inf
    problem = Problem(block.rows, block.im, block.ii, pose, 1, 2)
    L, V = np.full((2, 2), np.inf), velocity.copy()
    unwedge(problem, L, V, velocity.copy(), 1e-13, 1.0, rows(Solved, 1)[0])
    assert np.isfinite(L).all()
    assert np.abs(L).max() <= 1e4
    assert abs(V[0, 0]) <= 1.0


def test_an_inactive_contact_breaks_its_law_beyond_the_velocity_that_activates_it() -> None:
    """A contact that is active from -1 on, at a speed of -3: broken by 2, and solved once it is active."""
    problem, block = corner(1.0)
    block.rows["activation"][0] = -1.0
    L, V = np.zeros((2, 2)), block.velocity.copy()
    columns = as_columns(problem)
    assert breach(columns, L, V) == pytest.approx(2.0, rel=1e-15)
    assert solve_columns(columns, L, V, 1e-13, 0, 20, math.inf) <= 1e-13
    assert min(normal_rate(problem.ROWS[i], V) for i in range(2)) >= -1e-13


@pytest.mark.skipif(SHORT, reason="takes minutes in plain Python")
@pytest.mark.parametrize("seed", [2, 4])
def test_what_two_walls_crush_does_not_fly_off(seed: int) -> None:
    """Five bodies between walls that close with 1 m/s. Without friction their impulses may be excessive too: taken as
    they are, bodies leave with 17000 and 38000 m/s."""
    space, rng = pymunk.Space(), random.Random(seed)
    space.gravity = 0.0, -9.81
    floor = pymunk.Segment(space.static_body, (-100, 0), (100, 0), 0.5)
    floor.friction = 0.5
    space.add(floor)
    for side in (-1, 1):
        wall = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        wall.position, wall.velocity = (4.0 * side, 2.5), (-side, 0.0)
        space.add(wall, pymunk.Poly.create_box(wall, (1, 5)))
    bodies = [pymunk.Body() for _ in range(5)]
    for k, body in enumerate(bodies):
        body.position, body.angle = (rng.uniform(-3, 3), 1 + k), rng.uniform(0, 3)
        bar = pymunk.Segment(body, (-0.6, 0), (0.6, 0), 0.1)
        shape = rng.choice((pymunk.Circle(body, 0.5), pymunk.Poly.create_box(body, (1, 0.8)), bar))
        shape.density, shape.friction = 1.0, 0.8
        space.add(body, shape)
    for shape in space.shapes:
        shape.friction = 0.5 if shape is floor else 0.8
    stepper = ep.EECA(space)
    for _ in range(240):
        stepper.step(1 / 60)
        assert max(body.velocity.length for body in bodies) <= 2000.0
