"""Where features meet: bounded motors and contacts, large steps, thin shapes, joints that are hit, extreme masses."""

from __future__ import annotations

import itertools
import math

import pymunk

import eeca_pymunk as ep
from comparisons import runs
from scenes.scene import add_box, add_disk, add_walls

from .case import DT, G, case, heavy, matter
from .joints import apart
from .piles import FLOOR

GAIN = "energy gained beyond the work of motors (relative)"
THROUGH = "beyond a wall (relative to the size)"


def hinged(space: pymunk.Space, links: int, most: float, length: float = 0.9) -> list[pymunk.Body]:
    """Links of a chain along x, with motors of torque `most` at their joints."""
    bodies: list[pymunk.Body] = []
    for i in range(links):
        body = add_box(space, (float(i), 1.0), length, 0.3)
        body.angular_velocity, body.velocity = 3.0 * math.sin(7 * i), (math.sin(3 * i), math.cos(5 * i))
        if bodies:
            joint = pymunk.PivotJoint(bodies[-1], body, (i - 0.5, 1.0))
            motor = pymunk.SimpleMotor(bodies[-1], body, 5.0 * math.cos(i))
            joint.collide_bodies, motor.max_force = False, most
            space.add(joint, motor)
        bodies.append(body)
    return bodies


def driven(space: pymunk.Space, bodies: list[pymunk.Body], make: runs.Make, steps: int, most: float) -> float:
    """The largest gain of energy in a step beyond `most` times the angle turned, over the first energy, or over `most`
    if that is more. The angle is the larger of the change and of dt times the mean spin: angles of jointed bodies
    follow Cayley's map, which turns them by less, (dt spin)^2 / 12 of it."""
    stepper, gain = make(space), 0.0
    start = before = ep.measure(space).energy
    pairs = list(itertools.pairwise(bodies))
    for _ in range(steps):
        angles, spins = (
            [b.angle - a.angle for a, b in pairs],
            [b.angular_velocity - a.angular_velocity for a, b in pairs],
        )
        stepper.step(DT)
        turned = 0.0
        for (a, b), angle, spin in zip(pairs, angles, spins, strict=True):
            mean = 0.5 * (spin + b.angular_velocity - a.angular_velocity)
            turned += max(abs(b.angle - a.angle - angle), DT * abs(mean))
        now = ep.measure(space).energy
        gain, before = max(gain, now - before - most * turned), now
    return gain / max(abs(start), most) if math.isfinite(gain) else math.inf


@case("motors of bounded torque, links that touch", GAIN, 1e-9)
def motors(make: runs.Make) -> float:
    space = pymunk.Space()
    return driven(space, hinged(space, 4, 20.0), make, 200, 20.0)


@case("motors of bounded torque on the ground", GAIN, 1e-9)
def crawler(make: runs.Make) -> float:
    space = heavy()
    add_walls(space, FLOOR)
    bodies = hinged(space, 5, 8.0)
    matter(space, 0.6)
    return driven(space, bodies, make, 240, 8.0)


@case("gripper of two motors on a disk", GAIN, 1e-9)
def gripper(make: runs.Make) -> float:
    """Two fingers on a palm, closed by motors of 30 N m on a disk between them."""
    space = pymunk.Space()
    palm = add_box(space, (0.0, 0.0), 2.0, 0.3, 3.0)
    bodies = [palm]
    for side in (-1.0, 1.0):
        finger = add_box(space, (side * 0.9, 0.8), 0.2, 1.4)
        joint = pymunk.PivotJoint(palm, finger, (side * 0.9, 0.1))
        motor = pymunk.SimpleMotor(palm, finger, -2.0 * side)
        joint.collide_bodies, motor.max_force = False, 30.0
        space.add(joint, motor)
        bodies = [finger, *bodies] if side < 0 else [*bodies, finger]
    add_disk(space, (0.05, 0.9), 0.45)
    matter(space, 0.5)
    return driven(space, bodies, make, 180, 30.0)


def dropped(make: runs.Make, dt: float, steps: int, count: int = 12) -> float:
    """How far centres of boxes come below half their height, over it."""
    space = heavy()
    add_walls(space, FLOOR)
    boxes = [add_box(space, (1.1 * (i % 4), 0.8 + 1.1 * (i // 4)), 0.8, 0.6) for i in range(count)]
    for i, body in enumerate(boxes):
        body.angle = 0.1 * i
    stepper, worst = make(space), 0.0
    for _ in range(steps):
        stepper.step(dt)
        worst = max(worst, 0.3 - min(b.position.y for b in boxes))
    return worst / 0.3


@case("boxes dropped in steps of 1 s", THROUGH, 0.5)
def dropped_one(make: runs.Make) -> float:
    return dropped(make, 1.0, 6)


@case("boxes dropped in steps of 3 s", THROUGH, 0.5)
def dropped_three(make: runs.Make) -> float:
    return dropped(make, 3.0, 3)


@case("stack of ten at rest, dt 3 s", "way of a body (m)", 1e-9)
def still(make: runs.Make) -> float:
    space = heavy()
    add_walls(space, FLOOR)
    boxes = [add_box(space, (0.0, 0.5 + i), 1.0, 1.0) for i in range(10)]
    stepper = make(space)
    for _ in range(30):
        stepper.step(3.0)
    return max((b.position - (0.0, 0.5 + i)).length for i, b in enumerate(boxes))


def rod(space: pymunk.Space, x: float, y: float, half: float, radius: float = 0.0) -> pymunk.Body:
    """A segment along x, of mass 1."""
    body = pymunk.Body(1.0, half * half / 3.0)
    body.position = (x, y)
    space.add(body, pymunk.Segment(body, (-half, 0.0), (half, 0.0), radius))
    return body


def ends(body: pymunk.Body, half: float) -> list[pymunk.Vec2d]:
    """The ends of a rod."""
    return [body.local_to_world((x, 0.0)) for x in (-half, half)]


@case("rod without width on a floor without width", THROUGH, 1e-3)
def thin(make: runs.Make) -> float:
    worst = 0.0
    for angle in (0.0, 0.3, math.pi / 2):
        space = heavy()
        add_walls(space, FLOOR)
        body = rod(space, 0.0, 1.5, 0.9)
        body.angle = angle
        matter(space, 0.4)
        stepper = make(space)
        for _ in range(200):
            stepper.step(DT)
            worst = max(worst, -min(p.y for p in ends(body, 0.9)) / 0.9)
    return worst


@case("rods without width in a corner of thin walls", THROUGH, 1e-3)
def corner(make: runs.Make) -> float:
    """Three rods slide down a V of two segments without width."""
    space = heavy()
    add_walls(space, [((-3.0, 3.0), (0.0, 0.0)), ((0.0, 0.0), (3.0, 3.0))])
    rods = [rod(space, -0.3 + 0.3 * i, 2.0 + 0.5 * i, 0.5) for i in range(3)]
    for i, body in enumerate(rods):
        body.angle = 0.4 * i - 0.3
    matter(space, 0.2)
    stepper, worst = make(space), 0.0
    for _ in range(240):
        stepper.step(DT)
        worst = max(worst, *(abs(p.x) - p.y for body in rods for p in ends(body, 0.5)))
    return worst / 0.5


@case("rod at 60 m/s against a thin wall", THROUGH, 1e-3)
def fast(make: runs.Make) -> float:
    space = pymunk.Space()
    add_walls(space, [((3.0, -20.0), (3.0, 20.0)), ((-3.0, -20.0), (-3.0, 20.0))])
    body = rod(space, 0.0, 0.0, 0.5)
    body.velocity, body.angular_velocity = (60.0, 0.5), 7.0
    stepper, worst = make(space), 0.0
    for _ in range(60):
        stepper.step(DT)
        worst = max(worst, *(abs(p.x) - 3.0 for p in ends(body, 0.5)))
    return worst / 0.5


def beyond(space: pymunk.Space, half: float) -> float:
    """How far a vertex of what moves is outside a square of half width `half` about the origin."""
    worst = -math.inf
    for body in space.bodies:
        for shape in body.shapes:
            for point in shape.get_vertices() if isinstance(shape, pymunk.Poly) else [shape.a, shape.b]:
                x, y = body.local_to_world(point)
                worst = max(worst, abs(x) - half, abs(y) - half)
    return worst


def square(space: pymunk.Space) -> None:
    """Four walls without width about the origin, 2 m long."""
    corners = [pymunk.Vec2d(1.0, 1.0).rotated(0.5 * math.pi * k) for k in range(4)]
    add_walls(space, list(itertools.pairwise([*corners, corners[0]])))


@case("plank put flush on a thin wall, thrown at it", THROUGH, 1e-3)
def flush(make: runs.Make) -> float:
    """A plank of 0.45 by 0.012 m that touches the wall, or is 1e-5 m off or in it, and moves into it."""
    worst = 0.0
    for turn, gap, elastic in itertools.product(range(4), (0.0, 1e-5, -3e-5), (0.0, 0.5, 1.0)):
        for dt, velocity, spin in ((0.1, (37.0, -21.0), 0.0), (DT, (3.0, -2.0), 0.0), (DT, (0.0, -2.0), 5.0)):
            space, angle = pymunk.Space(), 0.5 * math.pi * turn
            square(space)
            body = add_box(space, pymunk.Vec2d(0.994 - gap, 0.1).rotated(angle), 0.45, 0.012)
            body.angle, body.angular_velocity = angle + 0.5 * math.pi, spin
            body.velocity = pymunk.Vec2d(*velocity).rotated(angle)
            matter(space, 0.4, elastic)
            stepper = make(space)
            for _ in range(15):
                stepper.step(dt)
                worst = max(worst, beyond(space, 1.0) / 0.45)
    return worst


@case("rod flush on a thin floor slides into a thin wall", THROUGH, 1e-3)
def slides(make: runs.Make) -> float:
    """A rod of 1 m on the floor, or 1e-9 to 1e-5 m off or in it, goes left or right to the corner."""
    worst = 0.0
    heights = (0.0, 1e-9, -1e-9, 5e-8, -5e-8, 1e-5, -1e-5)
    for height, side, elastic, (speed, dt) in itertools.product(
        heights, (-1.0, 1.0), (0.0, 0.8), ((3.0, DT), (10.0, 0.1), (40.0, 0.1))
    ):
        space = heavy()
        square(space)
        body = rod(space, 0.2, height - 1.0, 0.5)
        body.velocity = (side * speed, 0.0)
        matter(space, 0.0, elastic)
        stepper = make(space)
        for _ in range(15):
            stepper.step(dt)
            worst = max(worst, beyond(space, 1.0) / 0.5)
    return worst


@case("jointed pair in free flight is hit", "change of angular momentum (relative)", 1e-12)
def hit(make: runs.Make) -> float:
    space = pymunk.Space()
    a, b = (add_box(space, (float(i), 0.0), 1.0, 0.3) for i in range(2))
    c = add_box(space, (0.6, 3.0), 0.5, 0.5, 2.0, (0.0, -8.0))
    joint = pymunk.PivotJoint(a, b, (0.5, 0.0))
    joint.collide_bodies, c.angle, a.angular_velocity = False, 0.3, 2.0
    space.add(joint)
    stepper, start = make(space), ep.measure(space).angular_momentum
    for _ in range(60):
        stepper.step(DT)
    return abs(ep.measure(space).angular_momentum / start - 1.0)


@case("jointed pair is hit, dt 1/10 s", "change of momentum (relative)", 1e-12)
def hit_coarse(make: runs.Make) -> float:
    space = pymunk.Space()
    a, b = (add_box(space, (float(i), 0.0), 1.0, 0.3) for i in range(2))
    joint = pymunk.PivotJoint(a, b, (0.5, 0.0))
    joint.collide_bodies = False
    space.add(joint)
    add_disk(space, (0.3, -3.0), 0.3, 4.0, (0.0, 6.0))
    stepper, start = make(space), ep.measure(space)
    for _ in range(20):
        stepper.step(0.1)
    end = ep.measure(space)
    way = math.hypot(*(end.linear_momentum - start.linear_momentum))
    return max(way, abs(end.angular_momentum - start.angular_momentum)) / 24.0


@case("rope of 20 links hit by 200 link masses", "joints apart (lengths) or energy above the start (relative)", 1e-8)
def heavy_hit(make: runs.Make) -> float:
    """A rope 1 % longer than the distance of its ends hangs in a V; a disk falls into it from 1 m."""
    space = heavy()
    angle, last = math.acos(1.0 / 1.01), space.static_body
    x = y = 0.0
    for i in range(20):
        way = (0.5 * math.cos(angle), (-0.5 if i < 10 else 0.5) * math.sin(angle))
        body = add_box(space, (x + 0.5 * way[0], y + 0.5 * way[1]), 0.5, 0.1)
        body.angle = math.atan2(way[1], way[0])
        joint = pymunk.PivotJoint(last, body, (x, y))
        joint.collide_bodies = False
        space.add(joint)
        x, y, last = x + way[0], y + way[1], body
    space.add(pymunk.PivotJoint(last, space.static_body, (x, y)))
    add_disk(space, (0.5 * x, 1.0), 0.5, 200.0)
    matter(space, 0.3)
    stepper, worst, start = make(space), 0.0, ep.measure(space).energy
    for _ in range(150):
        stepper.step(DT)
        worst = max(worst, apart(space) / 10.0, (ep.measure(space).energy - start) / (200.0 * G * 5.0))
    return worst if math.isfinite(worst) else math.inf


def held(make: runs.Make, unit: float, dt: float, ratio: float) -> float:
    """How far bodies of masses 1 and `ratio` get out of a box of twenty `unit`s, over their size."""
    space = heavy(G * unit)
    half = 10.0 * unit
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    add_walls(space, [(corners[i], corners[i - 1]) for i in range(4)])
    bodies = []
    for i in range(8):
        place = (unit * (3.0 * (i % 4) - 4.5), unit * (3.0 * (i // 4)))
        mass = ratio if i % 2 else 1.0
        velocity = (unit * 20.0 * math.sin(2 * i), unit * 20.0 * math.cos(3 * i))
        bodies.append(
            add_disk(space, place, unit, mass, velocity)
            if i % 3
            else add_box(space, place, 2 * unit, unit, mass, velocity)
        )
    matter(space, 0.4, 0.5)
    stepper, worst = make(space), 0.0
    for _ in range(120):
        stepper.step(dt)
        worst = max(worst, *(max(abs(b.position.x), abs(b.position.y)) - half for b in bodies))
    return worst / unit


@case("box of millimetres, dt 1/10 s", THROUGH, 1e-3)
def small(make: runs.Make) -> float:
    return held(make, 1e-3, 0.1, 1.0)


@case("masses 1 : 10 000 in a box", THROUGH, 1e-3)
def masses(make: runs.Make) -> float:
    return held(make, 0.2, DT, 1e4)


@case("masses 1 : 10 000 in a box, dt 1/10 s", THROUGH, 1e-3)
def masses_coarse(make: runs.Make) -> float:
    return held(make, 0.2, 0.1, 1e4)


@case("poses set back after a run", "difference of the paths (m)", 0.0)
def again(make: runs.Make) -> float:
    """A jointed heap; the same poses and velocities, `refresh` where a stepper has it, and the same path."""
    space = heavy()
    add_walls(space, FLOOR)
    boxes = [add_box(space, (0.9 * (i % 3), 0.6 + 1.05 * i), 0.8, 0.8) for i in range(6)]
    space.add(pymunk.PinJoint(boxes[0], boxes[1]))
    stepper, ends = make(space), []
    start = [(b.position, b.angle, b.velocity, b.angular_velocity) for b in boxes]
    for _ in range(2):
        for body, (place, angle, velocity, spin) in zip(boxes, start, strict=True):
            body.position, body.angle, body.velocity, body.angular_velocity = place, angle, velocity, spin
            space.reindex_shapes_for_body(body)
        refresh = getattr(stepper, "refresh", None)
        if refresh is not None:
            refresh()
        for _ in range(60):
            stepper.step(DT)
        ends.append([b.position for b in boxes])
    return float(max((p - q).length for p, q in zip(*ends, strict=True)))
