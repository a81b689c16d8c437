"""Where features meet: joints, motors, contacts, large steps, thin shapes, saving, threads; each with its law."""

from __future__ import annotations

import copy
import math
import pickle
import threading
from collections.abc import Callable

import pymunk

import eeca_pymunk as ep
from comparisons import meeting_scenes, runs
from comparisons.hard_cases import meeting as hard_cases
from comparisons.output import Output, Row
from scenes.scene import add_disk

DT = 1 / 60
G = 9.81
EECA = runs.eeca(ep.TimeOfImpact())
Case = Callable[[], "tuple[str, float, float]"]  # what was measured, its value, and the most that its law allows


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


def motors() -> tuple[str, float, float]:
    """Energy that a step gains beyond the work of its motors, F |d angle|."""
    space, links, most = pymunk.Space(), list[pymunk.Body](), 0.0
    for i in range(4):
        body = box(space, i, 0.0, 0.9, 0.3)
        body.angular_velocity, body.velocity = 3.0 * math.sin(7 * i), (math.sin(3 * i), math.cos(5 * i))
        if links:
            joint = pymunk.PivotJoint(links[-1], body, (i - 0.5, 0))
            joint.collide_bodies = False
            motor = pymunk.SimpleMotor(links[-1], body, 5.0 * math.cos(i))
            motor.max_force = 20.0
            space.add(joint, motor)
        links.append(body)
    stepper = ep.EECA(space)
    for _ in range(200):
        before, angles = ep.measure(space).energy, [b.angle for b in links]
        stepper.step(DT)
        turned = [
            abs((b.angle - p) - (a.angle - q)) for a, b, q, p in zip(links, links[1:], angles, angles[1:], strict=False)
        ]
        most = max(most, ep.measure(space).energy - before - 20.0 * sum(turned))
    return "energy beyond the work of motors (J)", most, 1e-9


def threads() -> tuple[str, float, float]:
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


def saving() -> tuple[str, float, float]:
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


def set_back() -> tuple[str, float, float]:
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


def large() -> tuple[str, float, float]:
    """How far below their half height of .3 m centres of boxes come, dropped in steps of 1 s and 3 s."""
    return "deeper than the floor (m)", 0.3 * max(hard_cases.dropped(EECA, dt, 4) for dt in (1.0, 3.0)), 0.15


def stack() -> tuple[str, float, float]:
    """How far a stack of ten moves in 30 steps of 3 s."""
    return "way of a stack at rest (m)", hard_cases.still(EECA), 1e-9


def hit_joints() -> tuple[str, float, float]:
    """Angular momentum of a jointed pair that is hit, in free flight; relative."""
    return "change of angular momentum, relative", hard_cases.hit(EECA), 1e-12


def thin() -> tuple[str, float, float]:
    """How far a rod without width, 1.8 m long, comes below a floor without width: flush, tilted, upright."""
    return "below the floor (m)", 0.9 * hard_cases.thin(EECA), 1e-3


def within() -> tuple[str, float, float]:
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


def steppers() -> tuple[str, float, float]:
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


def impulses() -> tuple[str, float, float]:
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


def arbiters() -> tuple[str, float, float]:
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


def mixed() -> tuple[str, float, float]:
    """How far disks that overlap are from where our step says, after one of native's."""
    space = pymunk.Space()
    for x in (-0.1, 0.1):
        add_disk(space, (x, 0.0), 0.5)
    stepper = ep.EECA(space)
    space.step(DT)
    before = [b.position for b in space.bodies]
    stepper.step(DT)
    return "way of disks at rest (m)", max(abs(b.position - p) for b, p in zip(space.bodies, before, strict=True)), 0.0


CASES: dict[str, tuple[str, Case]] = {
    "1": ("bounded motors in a chain whose links touch", motors),
    "3": ("first steps from several threads", threads),
    "4": ("saving", saving),
    "5": ("poses and velocities set back", set_back),
    "6a": ("boxes dropped in large steps", large),
    "6b": ("stacks at rest in large steps", stack),
    "7": ("jointed bodies in free flight that are hit", hit_joints),
    "8": ("thin on thin", thin),
    "9, 15": ("steps within steps, energies beyond all numbers", within),
    "12": ("another stepper on a moving jointed space", steppers),
    "13": ("impulses of joints whose stepper is gone", impulses),
    "14": ("arbiters after a step", arbiters),
    "17": ("native steps and ours", mixed),
}


def table() -> list[Row]:
    """A row for each case: what was measured, and whether its law holds."""
    rows: list[Row] = []
    for number, (what, case) in CASES.items():
        measured, value, most = case()
        rows.append(
            {"row": number, "what": what, "measured": measured, "value": value, "at most": most, "holds": value <= most}
        )
    return rows


def run(output: Output, full: bool) -> None:
    """Print the table; write CSV."""
    ep.warmup()
    output.parameters({"dt": DT})
    output.table("Where features meet", table())
    output.table("Named scenes", meeting_scenes.named(), "named")
    output.table("Ropes and bridges without slack", meeting_scenes.taut(), "taut")
