"""Rods without width that lie on a wall without width, and what a program may do to them."""

from __future__ import annotations

import copy
import math
import pickle

import numpy as np
import pymunk

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


def add_far(heap: Heap) -> None:
    """A disk that touches nothing."""
    disk = pymunk.Body(heap.bodies[0].mass, heap.bodies[0].moment)
    disk.position = tuple(heap.unit * (9.0 * heap.up - 9.0 * heap.along))
    heap.space.add(disk, pymunk.Circle(disk, 0.1 * heap.unit))


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
