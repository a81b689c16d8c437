"""Rods without width that lie on a wall without width stay on it, whatever a program does meanwhile, at any dt.

Their distance is 0, or an overlap that an interval allows, so that nothing but the side that their pair remembers, or
the forces that press them together, tells on which side of the wall they are.
"""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep

# Length (m), mass (kg), dt (s), and the angle of the wall; the heap's gravity is normal to it.
SIZES = [(1.0, 1.0, 1 / 60, 0.0), (1e-3, 1e4, 1.0, 2.0), (1e3, 1e-2, 10.0, math.pi), (1.0, 2e4, 0.1, -math.pi / 2)]
DEEP = 5e-5  # of a rod: how far it may be below the wall


class Heap:
    """A rod and two rods on each other that lie on a wall; the last one is the widest, and consists of two segments. A
    box lies in the last one, deeper than an interval allows."""

    def __init__(self, unit: float, mass: float, dt: float, turn: float, deep: float = 0.0) -> None:
        self.unit, self.dt = unit, dt
        self.along = pymunk.Vec2d(math.cos(turn), math.sin(turn))
        self.up = self.along.perpendicular()
        self.space = space = pymunk.Space()
        space.gravity = tuple(-10.0 * unit * self.up)
        self.wall = self.new_wall()
        space.add(self.wall)
        self.bodies: list[pymunk.Body] = []
        for x, halves in ((-3.0, [(-1.0, 1.0)]), (3.0, [(-0.6, 0.6)]), (3.0, [(-1.0, 0.0), (0.0, 1.0)])):
            body = pymunk.Body(mass, mass * unit * unit / 3.0)
            body.position, body.angle = tuple(x * unit * self.along - deep * unit * self.up), turn
            rods = [pymunk.Segment(body, (a * unit, 0.0), (b * unit, 0.0), 0.0) for a, b in halves]
            for rod in rods:
                rod.friction = 0.5
            space.add(body, *rods)
            self.bodies.append(body)
        box = pymunk.Body(mass, mass * unit * unit / 50.0)
        box.position, box.angle = tuple(unit * (3.8 * self.along + 0.13 * self.up)), turn
        space.add(box, pymunk.Poly.create_box(box, (0.3 * unit, 0.3 * unit)))
        self.stepper = ep.EECA(space)

    def new_wall(self) -> pymunk.Segment:
        far = 20.0 * self.unit * self.along
        wall = pymunk.Segment(self.space.static_body, tuple(-far), tuple(far), 0.0)
        wall.friction = 0.5
        return wall

    def run(self, steps: int = 4) -> None:
        for _ in range(steps):
            self.stepper.step(self.dt)

    @property
    def heights(self) -> list[float]:
        """Of the bodies above the wall, in units."""
        return [body.position.dot(self.up) / self.unit for body in self.bodies]

    def lies(self) -> bool:
        return max(map(abs, self.heights)) < 5e-4


def add_below(heap: Heap) -> None:
    """A triangle that hangs below the wall: the first body cannot rise any more, and does not fall."""
    u = heap.unit
    corners = [(-0.2 * u, -0.5 * u), (0.2 * u, -0.5 * u), (0.0, -0.1 * u)]
    heap.space.add(pymunk.Poly(heap.bodies[0], corners))


def add_rod_below(heap: Heap) -> None:
    """A rod below the wall; then what the upper one remembers is lost."""
    u = heap.unit
    upper = next(iter(heap.bodies[0].shapes))
    heap.space.add(pymunk.Segment(heap.bodies[0], (-0.3 * u, -0.2 * u), (0.3 * u, -0.2 * u), 0.0))
    heap.run()
    heap.space.remove(upper)
    heap.space.add(upper)


def add_flush(heap: Heap) -> None:
    u = heap.unit
    heap.space.add(pymunk.Segment(heap.bodies[0], (0.0, 0.0), (1.5 * u, 0.0), 0.0))


def exchange_wall(heap: Heap) -> None:
    heap.space.remove(heap.wall)
    heap.wall = heap.new_wall()
    heap.space.add(heap.wall)


def move_wall(heap: Heap) -> None:
    """Along itself."""
    heap.wall.body.position = tuple(0.01 * heap.unit * heap.along)
    heap.space.reindex_static()


def move_bodies(heap: Heap) -> None:
    """Along the wall."""
    for body in heap.bodies:
        body.position += 0.01 * heap.unit * heap.along
        heap.space.reindex_shapes_for_body(body)


def put_in_again(heap: Heap) -> None:
    for body in heap.bodies:
        heap.space.remove(body, *(shapes := list(body.shapes)))
        heap.space.add(body, *shapes)


def change_radii(heap: Heap) -> None:
    for body in heap.bodies:
        for rod in body.shapes:
            assert isinstance(rod, pymunk.Segment)
            rod.unsafe_set_radius(1e-7 * heap.unit)


def change_filters(heap: Heap) -> None:
    """To others that collide too."""
    for k, body in enumerate(heap.bodies):
        for rod in body.shapes:
            rod.filter = pymunk.ShapeFilter(categories=1 << k)


def be_sensors(heap: Heap) -> None:
    """For as long as no step is taken."""
    for on in (True, False):
        for body in heap.bodies:
            for rod in body.shapes:
                rod.sensor = on


def refresh(heap: Heap) -> None:
    heap.stepper.refresh()


def step_by_another(heap: Heap) -> None:
    heap.stepper = ep.EECA(heap.space)


def set_poses(heap: Heap) -> None:
    heap.stepper.set_state(np.array([(*b.position, b.angle, 0.0, 0.0, 0.0) for b in heap.space.bodies]))


def set_state(heap: Heap) -> None:
    heap.stepper.set_state(heap.stepper.get_state())


def go_on_in_copy(heap: Heap) -> None:
    heap.space, heap.stepper, heap.bodies = copy.deepcopy((heap.space, heap.stepper, heap.bodies))


def go_on_from_pickle(heap: Heap) -> None:
    heap.space, heap.stepper, heap.bodies = pickle.loads(pickle.dumps((heap.space, heap.stepper, heap.bodies)))


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
