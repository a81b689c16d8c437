"""Rods without width that lie on a wall without width stay on it, whatever a program does meanwhile, at any dt.

Their distance is 0, or an overlap that an interval allows, so that nothing but the side that their pair remembers, or
the forces that press them together, tells on which side of the wall they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pymunk
import pytest

import eeca_pymunk as ep

from .flush import (
    DEEP,
    SIZES,
    Heap,
    add_below,
    add_far,
    add_flush,
    add_rod_below,
    be_sensors,
    change_filters,
    change_radii,
    exchange_wall,
    go_on_from_pickle,
    go_on_in_copy,
    move_bodies,
    move_wall,
    put_in_again,
    refresh,
    set_poses,
    set_state,
    step_by_another,
)

DONE = [
    add_below, add_rod_below, add_flush, exchange_wall, move_wall, move_bodies, put_in_again, change_radii,
    change_filters, be_sensors, refresh, step_by_another, set_poses, set_state, go_on_in_copy, go_on_from_pickle,
]  # fmt: skip
FORGETS = [refresh, step_by_another, set_state, go_on_in_copy, go_on_from_pickle]


@pytest.mark.parametrize("deep", [0.0, DEEP])
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("do", DONE)
def test_what_lies_on_a_wall_stays_on_it(
    do: Callable[[Heap], None], size: tuple[float, float, float, float], deep: float
) -> None:
    heap = Heap(*size, deep)
    heap.run()
    assert heap.lies()
    do(heap)
    heap.run()
    assert heap.lies()


@pytest.mark.parametrize("deep", [0.0, DEEP])
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("do", [None, *FORGETS])
def test_what_sleeps_on_a_wall_stays_on_it_when_something_wakes_it(
    do: Callable[[Heap], None] | None, size: tuple[float, float, float, float], deep: float
) -> None:
    """A disk falls on it."""
    heap = Heap(*size, deep)
    heap.space.sleep_time_threshold = 2.0 * heap.dt
    heap.run(60)
    assert all(body.is_sleeping for body in heap.space.bodies)
    if do is not None:
        do(heap)
    disk = pymunk.Body(heap.bodies[0].mass, heap.bodies[0].moment)
    disk.position = tuple(heap.bodies[2].position + 0.5 * heap.unit * (heap.up + heap.along))
    heap.space.add(disk, pymunk.Circle(disk, 0.1 * heap.unit))
    heap.run(max(8, math.ceil(1.0 / heap.dt)))
    assert heap.lies()
    assert disk.position.dot(heap.up) > 0.0


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("do", [None, add_far, add_flush])
def test_what_lies_in_a_wall_leaves_it_to_the_side_on_which_it_lay(
    do: Callable[[Heap], None] | None, size: tuple[float, float, float, float]
) -> None:
    """Its gravity ends, so that no force tells the side: what its pair remembers does, also after an addition; of a
    shape that is new the other shape of its body."""
    heap = Heap(*size, DEEP)
    heap.run()
    before = heap.heights[0]
    assert before < 0.0
    heap.space.gravity = 0.0, 0.0
    if do is not None:
        do(heap)
    heap.bodies[0].velocity = tuple(0.01 * heap.unit / heap.dt * heap.up)
    heap.run(2)
    assert heap.heights[0] == pytest.approx(before + 0.02)


@pytest.mark.parametrize("velocity", [(0.0, 0.0), (1.0, 0.0), (0.0, -1.0)])
@pytest.mark.parametrize("deep", [2e-3, 1e-2])
def test_a_rod_that_a_program_puts_below_a_wall_is_below_it(deep: float, velocity: tuple[float, float]) -> None:
    heap = Heap(1.0, 1.0, 0.1, 0.0)
    heap.run()
    heap.bodies[0].position, heap.bodies[0].velocity = (-3.0, -deep), velocity
    heap.run(1)
    assert heap.heights[0] == pytest.approx(-deep + 0.1 * velocity[1] - 0.05)


@pytest.mark.parametrize("size", SIZES)
def test_a_rod_that_fell_through_while_filters_let_it_is_not_pulled_back(
    size: tuple[float, float, float, float],
) -> None:
    """It lies on the wall, passes through it by a tenth of its length, and then collides again: from below."""
    heap = Heap(*size)
    heap.run()
    rod = next(iter(heap.bodies[0].shapes))
    kept, rod.filter = rod.filter, pymunk.ShapeFilter(mask=0)
    heap.stepper.step(0.14)
    below = heap.heights[0]
    assert below == pytest.approx(-0.5 * 10.0 * 0.14**2)
    rod.filter = kept
    heap.stepper.step(0.01)
    assert heap.heights[0] == pytest.approx(-0.5 * 10.0 * 0.15**2)


def test_a_rod_that_fell_through_while_a_handler_let_it_is_not_pulled_back() -> None:
    """It has a width, as pymunk calls no handler for shapes without that lie on each other."""
    space, passes = pymunk.Space(), [False]
    space.gravity = 0.0, -10.0
    body = pymunk.Body(1.0, 1.0)
    body.position = 0.0, 0.02
    rod = pymunk.Segment(body, (-1.0, 0.0), (1.0, 0.0), 0.02)
    space.add(body, rod, pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0))

    def decide(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        arbiter.process_collision = not passes[0]

    rod.collision_type = 7
    space.on_collision(7, None, begin=decide, pre_solve=decide)
    stepper = ep.EECA(space)
    for passes[0], steps in ((False, 5), (True, 14), (False, 1)):
        for _ in range(steps):
            stepper.step(0.01)
    assert body.position.y == pytest.approx(0.02 - 0.5 * 10.0 * 0.15**2)
