"""The ledger closes in every step, whatever happens in it, and however badly it is solved."""

from __future__ import annotations

import math
from random import Random
from types import SimpleNamespace

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.records import kind_of, zeros
from eeca_pymunk.impacts.intervals import cut_short
from eeca_pymunk.jointed.ends import take_back
from eeca_pymunk.jointed.ledger import account_component
from eeca_pymunk.jointed.losses import slip_of
from eeca_pymunk.model.contacts import Pair, Pushed, Row
from eeca_pymunk.model.joint_steps import JointLedger
from eeca_pymunk.model.step import KINDS, Step

from .measures import kinetic, moving

CONSTRAINTS = 10


def constraint(chance: Random, a: pymunk.Body, b: pymunk.Body, unit: float) -> pymunk.Constraint:
    """Any of pymunk's ten, between places of the bodies that need not be near each other."""
    p, q = ((chance.uniform(-0.3, 0.3) * unit, chance.uniform(-0.3, 0.3) * unit) for _ in range(2))
    kinds: list[pymunk.Constraint] = [
        pymunk.PinJoint(a, b, p, q),
        pymunk.PivotJoint(a, b, tuple((a.position + b.position) / 2)),
        pymunk.SlideJoint(a, b, p, q, 0.2 * unit, 2.0 * unit),
        pymunk.GrooveJoint(a, b, (-unit, 0.0), (unit, 0.2 * unit), p),
        pymunk.DampedSpring(a, b, p, q, 0.8 * unit, chance.choice([5.0, 200.0]), chance.choice([0.0, 0.5])),
        pymunk.DampedRotarySpring(a, b, 0.3, 2.0 * unit**2, 0.1 * unit**2),
        pymunk.GearJoint(a, b, 0.0, chance.choice([1.0, -2.0])),
        pymunk.RotaryLimitJoint(a, b, -0.5, 0.5),
        pymunk.RatchetJoint(a, b, 0.0, 0.5),
        pymunk.SimpleMotor(a, b, chance.uniform(-5.0, 5.0)),
    ]
    chosen = kinds[chance.randrange(CONSTRAINTS)]
    if chance.random() < 0.25:
        chosen.max_force = chance.choice([1.0, 20.0]) * unit
    chosen.collide_bodies = chance.random() < 0.6
    return chosen


def heap(chance: Random, unit: float) -> pymunk.Space:
    """Three to nine bodies thrown into a box, on and in each other, held by joints that may contradict each other; in
    some also by a body that moves by itself, over floors that do, and in a space that slows them."""
    space = pymunk.Space()
    space.gravity = 0.0, chance.choice([-9.81, -9.81, 0.0]) * unit
    space.damping = chance.choice([1.0, 0.9])
    elasticity, friction = chance.choice([0.0, 0.0, 0.3, 1.0]), chance.choice([0.0, 0.3, 0.8])
    shapes: list[pymunk.Shape] = []
    for start, end in (((-4.0, 0.0), (4.0, 0.0)), ((-4.0, 0.0), (-4.0, 4.0)), ((4.0, 0.0), (4.0, 4.0))):
        here, there = (tuple(x * unit for x in place) for place in (start, end))
        shapes.append(pymunk.Segment(space.static_body, here, there, 0.02 * unit))
        shapes[-1].surface_velocity = chance.choice([-0.5, 0.0, 0.0]) * unit, 0.0
    bodies = [pymunk.Body() for _ in range(chance.randint(3, 9))]
    for body in bodies:
        size = chance.uniform(0.15, 0.4) * unit
        kind = chance.randrange(3)
        if kind == 0:
            shapes.append(pymunk.Circle(body, size))
        elif kind == 1:
            shapes.append(pymunk.Poly.create_box(body, (2.0 * size, chance.uniform(0.5, 2.0) * size)))
        else:
            shapes.append(pymunk.Segment(body, (-size, 0.0), (size, 0.0), 0.1 * size))
        shapes[-1].mass = chance.choice([0.1, 1.0, 5.0])
        body.position = chance.uniform(-1.5, 1.5) * unit, chance.uniform(0.2, 2.0) * unit
        body.angle, body.angular_velocity = chance.uniform(-3.0, 3.0), chance.uniform(-5.0, 5.0)
        body.velocity = chance.uniform(-3.0, 3.0) * unit, chance.uniform(-3.0, 3.0) * unit
    if chance.random() < 0.3:
        mover = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        mover.position, mover.velocity, mover.angular_velocity = (0.0, -0.2 * unit), (0.5 * unit, 0.2 * unit), 0.5
        shapes.append(pymunk.Poly.create_box(mover, (1.5 * unit, 0.4 * unit)))
        bodies.append(mover)
    space.add(*bodies)
    for shape in shapes:
        shape.elasticity, shape.friction = elasticity, friction
        space.add(shape)
    for _ in range(chance.randint(2, len(bodies) + 2)):
        a, b = chance.sample([*bodies, space.static_body], 2)
        if pymunk.Body.DYNAMIC in (a.body_type, b.body_type):
            space.add(constraint(chance, a, b, unit))
    return space


@pytest.mark.parametrize("closure", [None, ep.Midstep()], ids=["impacts", "midstep"])
@pytest.mark.parametrize("unit", [1e-2, 1.0, 1e2])
def test_ledger_closes_in_random_heaps(unit: float, closure: ep.Closure | None) -> None:
    unmet = 0
    for seed in range(12):
        chance = Random(seed)
        space = heap(chance, unit)
        forced = chance.random() < 0.4
        stepper = ep.EECA(space) if closure is None else ep.EECA(space, closure)
        for step in range(25):
            for body in moving(space) if forced else []:
                body.torque = math.sin(0.1 * step + body.mass) * 20.0 * body.moment
                body.force = body.mass * unit * math.cos(0.2 * step), 0.0
            report = stepper.step(1.0 / 60.0)
            book = report.ledger
            assert book is not None
            unmet += not report.converged
            whole = sum(kinetic(b) + b.mass * abs(space.gravity.dot(b.position)) for b in moving(space))
            whole += abs(book.change) + abs(book.external) + book.restitution + book.friction + book.damping
            assert abs(book.residual) <= 1e-12 * whole, (seed, step)
            assert min(book.restitution, book.friction, book.damping) >= -1e-11 * whole, (seed, step)
            # Nobody is thrown out: forces, motors and movers of these scenes do not make such speeds.
            assert max(b.velocity.length for b in space.bodies) <= 1e4 * unit, (seed, step)
    assert closure is not None or unmet > 5


@pytest.mark.parametrize(("closed", "work", "loss"), [(3.0, 0.0, 2.0), (7.0, 2.0, 0.0), (-1.0, -1.0, 5.0)])
def test_what_a_limit_stops_brings_no_work_from_outside(closed: float, work: float, loss: float) -> None:
    """The round-off of what holds, as a limit stops its bodies in an instant, comes from what the limit takes."""
    joints = SimpleNamespace(STEPPED=zeros(1, kind_of(JointLedger)), TALLY=SimpleNamespace(worst=0))
    scene = SimpleNamespace(PAR=zeros(1, kind_of(Step))[0])
    joints.STEPPED[0].closed, joints.STEPPED[0].limited = closed, 5.0
    account_component(scene, joints, 0)
    assert (scene.PAR.external, scene.PAR.restitution) == (work, loss)
    assert (joints.STEPPED[0].closed, joints.STEPPED[0].limited) == (0.0, 0.0)


def test_contacts_of_an_island_stay_together_as_another_interval_is_taken_back() -> None:
    """Contacts that are solved again up to a cut take the rows of those they replace, one after another."""
    roots = (5, 7, 5, 7, 7, 2, 2)
    pairs, pushes = zeros(len(roots), kind_of(Pair)), zeros(len(roots), kind_of(Pushed))
    scene = SimpleNamespace(
        PUSHED_BY=pairs, PUSHED=pushes, COUNT=SimpleNamespace(pushes=len(roots)), LIST=zeros(0, kind_of(Pair))
    )
    for c, root in enumerate(roots):
        pairs[c].root, pairs[c].a, pushes[c].normal = root, c, float(c)
    take_back(scene, 5)
    left = range(scene.COUNT.pushes)
    assert [int(pairs[c].root) for c in left] == [7, 7, 7, 2, 2]
    assert [(int(pairs[c].a), pushes[c].normal) for c in left] == [(c, float(c)) for c in (1, 3, 4, 5, 6)]


def test_ledger_closes_where_joints_contradict_each_other() -> None:
    """Gears to a body that spins on, and a limit: rows push without bound, and works of limits, joints and supports
    cancelled but for the round-off of 1e10 times what was left. Steps tell that, and are taken whole."""
    told = 0
    for seed in range(30, 40):
        chance, space = Random(seed), pymunk.Space()
        axis = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        axis.angular_velocity = chance.uniform(-3.0, 3.0)
        a, b = pymunk.Body(1.0, chance.choice((0.1, 1.0, 100.0))), pymunk.Body(1.0, 1.0)
        a.position, b.position = (1.0, 0.0), (4.0, 0.0)
        b.angular_velocity, a.angular_velocity = chance.uniform(-3.0, 3.0), chance.uniform(-3.0, 3.0)
        space.add(axis, a, b, pymunk.GearJoint(a, b, 0.0, chance.choice((1.0, -1.0, 2.0))))
        space.add(pymunk.GearJoint(a, axis, 0.0, chance.choice((1.0, -2.0, 0.5))))
        space.add(pymunk.RotaryLimitJoint(b, axis, -0.1 * chance.random(), 0.1 * chance.random()))
        stepper = ep.EECA(space)
        for _ in range(20):
            before, report = ep.measure(space).kinetic, stepper.step(0.1)
            ledger = report.ledger
            assert ledger is not None
            scale = before + ep.measure(space).kinetic + abs(ledger.external) + ledger.restitution
            assert abs(ledger.residual) <= 1e-12 * scale
            assert all(unmet.name == "joints" for unmet in report.unmet)
            told += not report.converged
    assert told > 0


def test_a_step_without_shapes_that_ends_early_is_due_to_no_contact() -> None:
    space = pymunk.Space()
    one, two = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    two.position = 1.0, 0.0
    space.add(one, two, pymunk.PinJoint(one, two))
    stepper = ep.EECA(space)
    stepper.step(0.1)
    loop = stepper.event_loop
    assert loop is not None
    cut_short(loop.scene, loop.joints, 0, 0.05)
    (missed,) = loop.missed
    assert (KINDS[int(missed.kind)], missed.first, missed.second) == ("solves", -1.0, -1.0)


@pytest.mark.parametrize("dt", [1e-9, 1e-10, 1e-11])
def test_joints_give_no_energy_in_the_shortest_steps(dt: float) -> None:
    """A bead far out on a turning rail: its place is held to round-off, times the impulse over dt."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    rail, bead, ground = pymunk.Body(1.0, 1e3), pymunk.Body(1.0, 1.0), space.static_body
    bead.position, bead.velocity, rail.angular_velocity = (50.0, 0.0), (0.0, 150.0), 3.0
    space.add(rail, bead, pymunk.PivotJoint(ground, rail, (0.0, 0.0)))
    space.add(pymunk.GrooveJoint(rail, bead, (0.0, 0.0), (200.0, 0.0), (0.0, 0.0)))
    stepper = ep.EECA(space)
    for _ in range(12):
        stepper.step(1.0 / 30.0)
        book = stepper.step(dt).ledger
        assert book is not None
        assert book.external <= 1e-10 * (rail.kinetic_energy + bead.kinetic_energy)


def test_slip_on_a_belt_is_exact_however_short_the_interval() -> None:
    """A body that moves 2 mm/s beside a belt that moves 1 m/s: the way of a nanosecond beside what is 1."""
    row = zeros(1, kind_of(Row))
    row[0].b, row[0].nx, row[0].ny, row[0].surface = 1, 0.0, 1.0, 1.0
    for h in 10.0 ** np.arange(-12.0, 0.0):
        way = np.array([[h * 2e-3, 0.0, 0.0], [0.0, 0.0, 0.0]])
        slip = slip_of(row[0], way, h)
        assert slip == pytest.approx(h * (1.0 + 2e-3), rel=1e-14, abs=0.0)


@pytest.mark.parametrize("springs", [1, 2])
def test_bodies_fall_after_the_last_joint_was_removed(springs: int) -> None:
    """They touch nothing, so that no island would be built for them; those of the joint are over."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    one, two = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    two.position, one.velocity = (3.0, 0.0), (1.0, 2.0)
    space.add(one, two, *(pymunk.Circle(body, 0.3) for body in (one, two)))
    for _ in range(springs):
        space.add(pymunk.DampedSpring(one, two, (0.1, 0.0), (0.0, 0.1), 1.0, 20.0, 0.5))
    stepper = ep.EECA(space)
    for joint in list(space.constraints):
        for _ in range(3):
            stepper.step(0.02)
        space.remove(joint)
    y, v = one.position.y, one.velocity.y
    for _ in range(10):
        book = stepper.step(0.02).ledger
        assert book is not None
        assert abs(book.residual) <= 1e-13
    assert one.velocity.y == pytest.approx(v - 10.0 * 0.2, abs=1e-13)
    assert one.position.y == pytest.approx(y + 0.2 * v - 5.0 * 0.04, abs=1e-13)
