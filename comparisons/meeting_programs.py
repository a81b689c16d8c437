"""Where features meet, as programs see it: threads, callbacks, saving, other steppers, what is read after a step."""

from __future__ import annotations

import copy
import math
import pickle
import subprocess
import sys
import threading

import pymunk

import eeca_pymunk as ep
from scenes.scene import add_disk

DT = 1 / 60
G = 9.81
Measured = tuple[str, float, float]  # what was measured, its value, and the most that its law allows
_FIRST_STEP = """
import sys, pymunk, eeca_pymunk as ep
space = pymunk.Space()
body = pymunk.Body(1.0, 1.0)
space.add(body, pymunk.Circle(body, 1.0), pymunk.PinJoint(space.static_body, body, (0.0, 2.0)))
ep.EECA(space).step(1 / 60)
sys.exit("numba" in sys.modules)
"""


def world(gravity: float = G) -> pymunk.Space:
    """A space with a floor without width at y = 0."""
    space = pymunk.Space()
    space.gravity = 0.0, -gravity
    floor = pymunk.Segment(space.static_body, (-1e4, 0), (1e4, 0), 0.0)
    floor.friction = 0.5
    space.add(floor)
    return space


def box(
    space: pymunk.Space, x: float, y: float, w: float, h: float, angle: float = 0.0, mass: float = 1.0
) -> pymunk.Body:
    """A box with friction .5."""
    body = pymunk.Body(mass, pymunk.moment_for_box(mass, (w, h)))
    body.position, body.angle = (x, y), angle
    shape = pymunk.Poly.create_box(body, (w, h))
    shape.friction = 0.5
    space.add(body, shape)
    return body


def poses(space: pymunk.Space) -> list[tuple[float, ...]]:
    """Positions, angles and velocities."""
    return [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies]


def heap(joined: bool = True) -> pymunk.Space:
    """Boxes that fall on one another, two of them joined."""
    space = world()
    boxes = [box(space, 0.9 * (i % 3), 0.6 + 1.05 * i, 0.8, 0.8, 0.1 * i) for i in range(6)]
    if joined:
        space.add(pymunk.PinJoint(boxes[0], boxes[1]))
    return space


def threads() -> Measured:
    """Paths of four spaces stepped by four threads, against the same in turn."""

    def path(out: dict[int, object], i: int) -> None:
        space = heap(i % 2 == 1)
        stepper = ep.EECA(space)
        for _ in range(60):
            stepper.step(DT)
        out[i] = poses(space)

    together: dict[int, object] = {}
    workers = [threading.Thread(target=path, args=(together, i)) for i in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    alone: dict[int, object] = {}
    for i in range(4):
        path(alone, i)
    return "paths that differ, of 4", float(sum(together.get(i) != alone[i] for i in range(4))), 0.0


def saving() -> Measured:
    """A run that is saved at every step, its copy, and one that is not."""
    runs = []
    for save in (False, True):
        space = heap()
        stepper = ep.EECA(space)
        for _ in range(60):
            stepper.step(DT)
            if save:
                pickle.dumps(stepper)
        runs.append(poses(space))
    again, _ = pickle.loads(pickle.dumps((space, stepper)))
    differ = runs[0] != runs[1] or poses(again) != runs[1] or poses(copy.deepcopy(space)) != runs[1]
    return "runs that differ", float(differ), 0.0


def set_back() -> Measured:
    """Poses and velocities set back and refreshed: the same path again."""
    space = heap()
    stepper = ep.EECA(space)
    bodies, start, paths = list(space.bodies), poses(space), []
    for _ in range(2):
        for body, (x, y, angle, vx, vy, spin) in zip(bodies, start, strict=True):
            body.position, body.angle, body.velocity, body.angular_velocity = (x, y), angle, (vx, vy), spin
            space.reindex_shapes_for_body(body)
        stepper.refresh()
        for _ in range(60):
            stepper.step(DT)
        paths.append(poses(space))
    return (
        "largest difference",
        max(abs(p - q) for a, b in zip(*paths, strict=True) for p, q in zip(a, b, strict=True)),
        0.0,
    )


def within() -> Measured:
    """`step` within a handler, and energies beyond all numbers: errors that change nothing."""
    space = heap(False)
    stepper = ep.EECA(space)
    told = 0

    def again(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        stepper.step(DT)

    space.on_collision(pre_solve=again)
    try:
        for _ in range(30):
            stepper.step(DT)
    except RuntimeError:
        told += 1
    far = heap(False)
    far.gravity = 0.0, -1e300
    try:
        ep.EECA(far).step(1.0)
    except ValueError:
        told += 1
    return "errors that are not told, of 2", 2.0 - told, 0.0


def steppers() -> Measured:
    """Energy of a moving pendulum that is handed to another stepper, relative."""
    space = pymunk.Space()
    body = box(space, 1, 0, 0.5, 0.2)
    space.add(pymunk.PivotJoint(space.static_body, body, (0, 0)))
    space.gravity = 0.0, -G
    first = ep.EECA(space)
    for _ in range(30):
        first.step(DT)
    before = ep.measure(space)
    ep.EECA(space).step(DT)
    return "jump of energy, relative", abs(ep.measure(space).energy - before.energy) / before.kinetic, 1e-12


def impulses() -> Measured:
    """m g dt, as `constraint.impulse` says once its stepper is gone."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    body = box(space, 0, -1, 0.5, 0.5, mass=2.0)
    joint = pymunk.PinJoint(space.static_body, body, (0, 0), (0, 0))
    space.add(joint)
    stepper = ep.EECA(space)
    stepper.step(DT)
    del stepper
    return "error of an impulse, relative", abs(joint.impulse / (2.0 * G * DT) - 1.0), 1e-9


def arbiters() -> Measured:
    """Impulses of `each_arbiter` against changes of momentum, of a box that bounces; relative to m v."""
    space = world()
    body = box(space, 0, 0.7, 1, 1, mass=2.0)
    for shape in space.shapes:
        shape.elasticity = 0.7
    stepper, most = ep.EECA(space), 0.0
    for _ in range(60):
        before, told = body.velocity, list[pymunk.Vec2d]()
        stepper.step(DT)
        body.each_arbiter(lambda arbiter, told=told: told.append(arbiter.total_impulse))
        change = 2.0 * (body.velocity - before) + pymunk.Vec2d(0, 2.0 * G * DT)
        most = max(most, abs(abs(sum(told, pymunk.Vec2d(0, 0))) - abs(change)))
    return "error of impulses, relative", most / (2.0 * math.sqrt(2 * G * 0.2)), 1e-9


def mixed() -> Measured:
    """How far disks that overlap are from where our step says, after one of native's."""
    space = pymunk.Space()
    for x in (-0.1, 0.1):
        add_disk(space, (x, 0.0), 0.5)
    stepper = ep.EECA(space)
    space.step(DT)
    before = [b.position for b in space.bodies]
    stepper.step(DT)
    return "way of disks at rest (m)", max(abs(b.position - p) for b, p in zip(space.bodies, before, strict=True)), 0.0


def raised() -> Measured:
    """A post-step callback that raises comes after a whole step: poses, and times, against a run without one."""
    runs, clocks = [], []
    for fails in (False, True):
        space = heap()
        stepper = ep.EECA(space)
        for k in range(30):
            if fails and k % 3 == 0:
                space.add_post_step_callback(lambda space, key: {}[key], k)
            try:
                stepper.step(DT)
            except KeyError:
                clocks.append(stepper.time)
        runs.append(poses(space))
    late = sum(abs(t - DT * (3 * k + 1)) > 1e-12 for k, t in enumerate(clocks))
    return "steps that are not whole, of 10", float(late + (10 - len(clocks)) + (runs[0] != runs[1])), 0.0


def compiler() -> Measured:
    """Machine code is named after its sources alone, and made ahead of time: environments with other versions of numba
    overwrite nothing, as steps import none."""
    code = subprocess.run([sys.executable, "-c", _FIRST_STEP], check=False, capture_output=True).returncode
    return "first steps that import numba, of 1", float(code), 0.0
