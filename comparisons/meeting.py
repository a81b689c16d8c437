"""Where features meet: joints, motors, contacts, large steps, thin shapes, saving, threads; each with its law."""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable

import pymunk

import eeca_pymunk as ep
from comparisons import meeting_programs as programs
from comparisons import meeting_scenes, runs
from comparisons.hard_cases import meeting as hard_cases
from comparisons.meeting_programs import DT, Measured, box
from comparisons.output import Output, Row

EECA = runs.eeca(ep.TimeOfImpact())
Case = Callable[[], Measured]


def motors() -> Measured:
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


def container(seed: int, joints: int, turning: float) -> pymunk.Space:
    """Boxes and disks of masses up to 1 : 100 in a kinematic box, so many joints between them; two of infinite moment,
    without spin, as friction on one that spins does work."""
    chance, space = random.Random(seed), pymunk.Space()
    space.gravity = 0.0, -9.81
    frame = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    frame.angular_velocity = turning
    space.add(frame)
    for start, end in (((-2, -2), (2, -2)), ((2, -2), (2, 2)), ((2, 2), (-2, 2)), ((-2, 2), (-2, -2))):
        space.add(pymunk.Segment(frame, start, end, 0.1))
    bodies: list[pymunk.Body] = []
    for k in range(14):
        mass = 10 ** chance.uniform(-1, 1)
        body = pymunk.Body(mass, math.inf if k in (3, 9) else 0.03 * mass)
        body.position = -1.5 + 0.75 * (k % 5), -1.4 + 0.9 * (k // 5)
        body.velocity = chance.uniform(-3, 3), chance.uniform(-3, 3)
        body.angular_velocity = chance.uniform(-3, 3) if math.isfinite(body.moment) else 0.0
        space.add(body, pymunk.Circle(body, 0.25) if k % 2 else pymunk.Poly.create_box(body, (0.5, 0.4)))
        bodies.append(body)
    for _ in range(joints):
        a, b = chance.sample(bodies, 2)
        middle = 0.5 * (a.position + b.position)
        kind = chance.randrange(3)
        if kind == 0:
            space.add(pymunk.PivotJoint(a, b, middle))
        elif kind == 1:
            space.add(pymunk.PinJoint(a, b))
        else:
            motor = pymunk.SimpleMotor(a, b, chance.uniform(-3, 3))
            motor.max_force = chance.uniform(0.1, 10.0)
            space.add(motor)
    for shape in space.shapes:
        shape.elasticity, shape.friction = chance.choice((0.0, 0.5, 1.0)), chance.uniform(0.0, 1.0)
    return space


def longest() -> Measured:
    """The longest step (processor time) of 14 bodies with 8 joints in a turning box, dt 1/30; 12 scenes. Each
    step's time is the shorter of two runs, as other processes have the machine, too."""
    worst = 0.0
    for seed in range(12):
        times: list[list[float]] = []
        for _ in range(2):
            stepper, spent = ep.EECA(container(seed, 8, 1.0)), []
            for _ in range(60):
                start = time.process_time()
                stepper.step(1 / 30)
                spent.append(time.process_time() - start)
            times.append(spent)
        worst = max(worst, *map(min, *times))
    return "longest step (ms)", 1e3 * worst, 20.0


def contained() -> Measured:
    """Energy that 14 rigid bodies, two of infinite moment, gain in a kinematic box at rest; 12 scenes, relative."""
    most = 0.0
    for seed in range(12):
        space = container(seed, 0, 0.0)
        stepper, before = ep.EECA(space), ep.measure(space).energy
        for _ in range(120):
            stepper.step(DT)
            now = ep.measure(space).energy
            most, before = max(most, (now - before) / (14 * 9.81 * 4.0)), now
    return "energy gained, relative", most, 1e-9


def large() -> Measured:
    """How far below their half height of .3 m centres of boxes come, dropped in steps of 1 s and 3 s."""
    return "deeper than the floor (m)", 0.3 * max(hard_cases.dropped(EECA, dt, 4) for dt in (1.0, 3.0)), 0.15


def stack() -> Measured:
    """How far a stack of ten moves in 30 steps of 3 s."""
    return "way of a stack at rest (m)", hard_cases.still(EECA), 1e-9


def hit_joints() -> Measured:
    """Angular momentum of a jointed pair that is hit, in free flight; relative."""
    return "change of angular momentum, relative", hard_cases.hit(EECA), 1e-12


def thin() -> Measured:
    """How far a rod without width, 1.8 m long, comes below a floor without width: flush, tilted, upright."""
    return "below the floor (m)", 0.9 * hard_cases.thin(EECA), 1e-3


CASES: dict[str, tuple[str, Case]] = {
    "1": ("bounded motors in a chain whose links touch", motors),
    "2": ("bodies and joints in a box that turns", longest),
    "3": ("first steps from several threads", programs.threads),
    "4": ("saving", programs.saving),
    "5": ("poses and velocities set back", programs.set_back),
    "6a": ("boxes dropped in large steps", large),
    "6b": ("stacks at rest in large steps", stack),
    "7": ("jointed bodies in free flight that are hit", hit_joints),
    "8": ("thin on thin", thin),
    "9, 15": ("steps within steps, energies beyond all numbers", programs.within),
    "10": ("callbacks after a step that raise", programs.raised),
    "12": ("another stepper on a moving jointed space", programs.steppers),
    "13": ("impulses of joints whose stepper is gone", programs.impulses),
    "14": ("arbiters after a step", programs.arbiters),
    "16": ("rigid bodies in a kinematic box, infinite moments", contained),
    "17": ("native steps and ours", programs.mixed),
    "18": ("environments with other versions of numba", programs.compiler),
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
    output.table("Ropes and bridges without slack, row 11", meeting_scenes.taut(), "taut")
