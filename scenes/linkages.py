"""Jointed bodies without contacts: pendulums, linkages, chains, cloth, and the digits that are known of them."""

from __future__ import annotations

import math

import pymunk

GRAVITY = 9.81
# IFToMM A01: m = L = 1 from (-1, 0) at rest, g = 9.81.
PENDULUM_PERIOD = 2.3678419475762
PENDULUM_AT = {1.0: (0.98629175113188, -0.16501085312554), 10.0: (-0.27508746257612, -0.96141920509912)}
# IFToMM A02: end of the first crank after 10 s, by number of loops.
FOUR_BAR_AT_10 = {2: (0.32845811153586, 0.94451853818033), 40: (0.18051222668365, 0.98357274058288)}
# Chrono's rods: m = l = J = 1, g = 10, both horizontal at rest: centre of the end rod.
RODS_AT = {1.0: (-0.569764210469, -1.290546602590), 5.0: (0.746493363360, -1.273357544921)}
# Point masses 1 on lengths 1, both angles 90 degrees at rest, g = 9.81: angles from the vertical.
DOUBLE_AT = {1.0: (-0.625087699806, -1.034585085680), 5.0: (-0.6271867051, -1.3013155502)}
SMALL_DOUBLE_AT_10 = (0.036262129518, 0.041828648536)  # from .1 and .1 rad


def empty(gravity: float = GRAVITY) -> pymunk.Space:
    """A space with gravity downwards."""
    space = pymunk.Space()
    space.gravity = (0.0, -gravity)
    return space


def body(
    space: pymunk.Space, mass: float, moment: float, position: tuple[float, float], angle: float = 0.0
) -> pymunk.Body:
    """A body without shapes."""
    one = pymunk.Body(mass, moment)
    one.position, one.angle = position, angle
    space.add(one)
    return one


def pendulum(length: float = 1.0, gravity: float = GRAVITY) -> pymunk.Space:
    """A point mass on a massless rod, let go horizontally on the left."""
    space = empty(gravity)
    bob = body(space, 1.0, 1.0, (-length, 0.0))
    space.add(pymunk.PinJoint(space.static_body, bob, (0.0, 0.0), (0.0, 0.0)))
    return space


def point_double(first: float, second: float) -> pymunk.Space:
    """Two point masses on massless rods, from these angles (rad, from the vertical)."""
    space = empty()
    x, y = math.sin(first), -math.cos(first)
    a = body(space, 1.0, 1.0, (x, y))
    b = body(space, 1.0, 1.0, (x + math.sin(second), y - math.cos(second)))
    space.add(pymunk.PinJoint(space.static_body, a), pymunk.PinJoint(a, b))
    return space


def bars() -> pymunk.Space:
    """A double pendulum of bars: masses 1 and 1.5, moments .05 and .03, centres .9 and .7 apart, horizontal at rest."""
    space = empty()
    a = body(space, 1.0, 0.05, (0.9, 0.0))
    b = body(space, 1.5, 0.03, (1.6, 0.0))
    ground = space.static_body
    space.add(pymunk.PivotJoint(ground, a, (0.0, 0.0), (-0.9, 0.0)), pymunk.PivotJoint(a, b, (0.0, 0.0), (-0.7, 0.0)))
    return space


def rods() -> pymunk.Space:
    """Chrono's double pendulum of rods, from the horizontal."""
    space = empty(10.0)
    a = body(space, 1.0, 1.0, (0.5, 0.0))
    b = body(space, 1.0, 1.0, (1.5, 0.0))
    ground = space.static_body
    space.add(pymunk.PivotJoint(ground, a, (0.0, 0.0), (-0.5, 0.0)), pymunk.PivotJoint(a, b, (0.5, 0.0), (-0.5, 0.0)))
    return space


def four_bars(loops: int) -> pymunk.Space:
    """IFToMM's N-four-bar: 2N + 1 unit links of 1 kg, N squares side by side, top moving at (1, 0).

    The first crank is the space's first body; its end is at (0, 1).
    """
    space = empty()
    ground = space.static_body
    cranks = [body(space, 1.0, 1.0 / 12.0, (float(i), 0.5), math.pi / 2.0) for i in range(loops + 1)]
    for i, crank in enumerate(cranks):
        crank.velocity, crank.angular_velocity = (0.5, 0.0), -1.0
        space.add(pymunk.PivotJoint(ground, crank, (float(i), 0.0), (-0.5, 0.0)))
    for i in range(loops):
        rod = body(space, 1.0, 1.0 / 12.0, (i + 0.5, 1.0))
        rod.velocity = (1.0, 0.0)
        space.add(pymunk.PivotJoint(cranks[i], rod, (0.5, 0.0), (-0.5, 0.0)))
        space.add(pymunk.PivotJoint(rod, cranks[i + 1], (0.5, 0.0), (0.5, 0.0)))
    return space


def braced_four_bar() -> pymunk.Space:
    """A parallelogram with three cranks, its rod in one piece: three rows more than it needs."""
    space = empty()
    ground = space.static_body
    rod = body(space, 1.0, 1.0 / 12.0, (0.5, 1.0))
    rod.velocity = (1.0, 0.0)
    for x in (0.0, 0.5, 1.0):
        crank = body(space, 1.0, 1.0 / 12.0, (x, 0.5), math.pi / 2.0)
        crank.velocity, crank.angular_velocity = (0.5, 0.0), -1.0
        space.add(pymunk.PivotJoint(ground, crank, (x, 0.0), (-0.5, 0.0)))
        space.add(pymunk.PivotJoint(rod, crank, (x - 0.5, 0.0), (0.5, 0.0)))
    return space


def chain(count: int, end_mass: float = 1.0, lean: float = 0.0) -> pymunk.Space:
    """Bars of length 1 and mass 1 on pivots, let go from `lean` (rad) below the horizontal; the last may be heavier."""
    space = empty()
    before, anchor = space.static_body, (0.0, 0.0)
    along = (math.cos(lean), -math.sin(lean))
    for i in range(count):
        mass = end_mass if i == count - 1 else 1.0
        bar = body(space, mass, mass / 12.0, ((i + 0.5) * along[0], (i + 0.5) * along[1]), -lean)
        space.add(pymunk.PivotJoint(before, bar, anchor, (-0.5, 0.0)))
        before, anchor = bar, (0.5, 0.0)
    return space


def planks(count: int = 5, gravity: float = 10.0) -> pymunk.Space:
    """Planks of 1 kg, 1 m by .5 m, on pivots in a row, which fall a little onto a floor that rubs."""
    space = empty(gravity)
    floor = pymunk.Segment(space.static_body, (-5.0, 0.0), (1.1 * count + 5.0, 0.0), 0.1)
    floor.friction = 0.8
    space.add(floor)
    last = None
    for k in range(count):
        plank = body(space, 1.0, pymunk.moment_for_box(1.0, (1.0, 0.5)), (1.1 * k, 0.6 + 0.05 * (k % 2)))
        shape = pymunk.Poly.create_box(plank, (1.0, 0.5))
        shape.friction = 0.6
        space.add(shape)
        if last is not None:
            space.add(pymunk.PivotJoint(last, plank, (last.position + plank.position) / 2))
        last = plank
    return space


def cloth(side: int = 15, mesh: float = 0.1) -> pymunk.Space:
    """Point masses of .1 on a mesh of pins, its rows folded by 30 degrees, held at two corners."""
    space = empty()
    width, fold = mesh * math.cos(math.pi / 6.0), mesh * math.sin(math.pi / 6.0)
    knots = {
        (i, j): body(space, 0.1, 0.01, (i * width, (i % 2) * fold - j * mesh)) for i in range(side) for j in range(side)
    }
    for (i, j), knot in knots.items():
        if i:
            space.add(pymunk.PinJoint(knots[i - 1, j], knot))
        if j:
            space.add(pymunk.PinJoint(knots[i, j - 1], knot))
    for i in (0, side - 1):
        space.add(pymunk.PivotJoint(space.static_body, knots[i, 0], knots[i, 0].position, (0.0, 0.0)))
    return space


def draped(side: int = 7, mesh: float = 0.1) -> pymunk.Space:
    """A `cloth` that nothing holds, above a fixed disk: its knots are disks of .03, which pass through one another."""
    space = cloth(side, mesh)
    for joint in list(space.constraints):
        if isinstance(joint, pymunk.PivotJoint):
            space.remove(joint)
    for knot in list(space.bodies):
        shape = pymunk.Circle(knot, 0.03)
        shape.filter = pymunk.ShapeFilter(group=1)
        space.add(shape)
    middle = (side // 2) * mesh * math.cos(math.pi / 6.0) + 0.013
    space.add(pymunk.Circle(space.static_body, 0.15 * side / 7, (middle, -1.0 * side / 7)))
    return space


# Andrews' squeezing mechanism (Test Set for IVP Solvers, problem andrews): angles at the start, angles and their rates
# after .03 s.
SQUEEZER_START = {
    "beta": -0.0617138900142764496358948458001,
    "theta": 0.0,
    "gamma": 0.455279819163070380255912382449,
    "phi": 0.222668390165885884674473185609,
    "delta": 0.487364979543842550225598953530,
    "omega": -0.222668390165885884674473185609,
    "epsilon": 1.23054744454982119249735015568,
}
SQUEEZER_AT_003 = {
    "beta": 15.81077119629904,
    "theta": -15.75637105984298,
    "gamma": 0.04082224013073101,
    "phi": -0.5347301163226948,
    "delta": 0.5244099658805304,
    "omega": 0.5347301163226948,
    "epsilon": 1.048080741042263,
}
SQUEEZER_RATES_AT_003 = {
    "beta": 1139.920302151208,
    "theta": -1424.379294994111,
    "gamma": 11.03291221937134,
    "phi": 19.29337464421385,
    "delta": 0.5735699284790808,
    "omega": -19.29337464421385,
    "epsilon": 0.3231791658026955,
}
SQUEEZER_WORK = 0.5237920078  # J, torque .033 over the turn of beta


def squeezer() -> pymunk.Space:
    """Andrews' squeezing mechanism, SI units: seven bodies, ten pivots, a spring, and a motor of torque .033 on K1."""
    space = empty(0.0)
    ground, s = space.static_body, SQUEEZER_START
    rr, d, e, zf, zt, u = 7e-3, 28e-3, 2e-2, 2e-2, 4e-2, 4e-2
    at_a, at_b, at_c = pymunk.Vec2d(-0.06934, -0.00227), pymunk.Vec2d(-0.03635, 0.03273), pymunk.Vec2d(0.014, 0.072)
    beta, gamma, delta, epsilon = s["beta"], s["gamma"], s["delta"], s["epsilon"]
    k2, k4, k6 = beta + s["theta"], s["phi"] + delta, s["omega"] + epsilon

    def along(angle: float, x: float, y: float) -> pymunk.Vec2d:
        return pymunk.Vec2d(x, y).rotated(angle)

    knee = along(beta, rr, 0.0)
    point = knee - along(k2, d, 0.0)
    elbow_4, elbow_6 = at_a + along(delta, zt, 0.0), at_a + along(epsilon, 0.0, -u)
    parts = [
        (0.04325, 2.194e-6, along(beta, 92e-5, 0.0), beta),
        (0.00365, 4.410e-7, knee - along(k2, 115e-4, 0.0), k2),
        (0.02373, 5.255e-6, at_b + along(gamma, 1043e-5, -1874e-5), gamma),
        (0.00706, 5.667e-7, elbow_4 + along(k4, 0.0, -(e - 1421e-5)), k4),
        (0.07050, 1.169e-5, at_a + along(delta, 2308e-5, 916e-5), delta),
        (0.00706, 5.667e-7, elbow_6 + along(k6, zf - 1421e-5, 0.0), k6),
        (0.05498, 1.912e-5, at_a + along(epsilon, -449e-5, -1228e-5), epsilon),
    ]
    bodies = [body(space, mass, moment, centre, angle) for mass, moment, centre, angle in parts]
    k = [ground, *bodies]
    for a, b, where in (
        (0, 1, pymunk.Vec2d(0.0, 0.0)), (1, 2, knee), (2, 3, point), (2, 4, point), (2, 6, point), (0, 3, at_b),
        (4, 5, elbow_4), (0, 5, at_a), (6, 7, elbow_6), (0, 7, at_a),
    ):  # fmt: skip
        space.add(pymunk.PivotJoint(k[a], k[b], k[a].world_to_local(where), k[b].world_to_local(where)))
    hook = k[3].world_to_local(at_b + along(gamma, 2e-2, -18e-3))
    space.add(pymunk.DampedSpring(ground, k[3], at_c, hook, 7785e-5, 4530.0, 0.0))
    motor = pymunk.SimpleMotor(ground, k[1], -1e6)
    motor.max_force = 0.033
    space.add(motor)
    return space
