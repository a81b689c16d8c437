"""Steps that end early: nothing is lost, whatever instants the bodies of islands have come to."""

from __future__ import annotations

import math
from random import Random

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from comparisons import crowds
from eeca_pymunk.contacts.interval import step_island
from eeca_pymunk.geometry.flight import move_to
from eeca_pymunk.impacts.begin import begin, energy_of
from eeca_pymunk.impacts.intervals import cut_short, start_islands
from eeca_pymunk.islands.accounting import end_rest_or_interval
from eeca_pymunk.islands.intervals import begin_interval
from eeca_pymunk.model.scene import Scene


def open_energy(A: Scene) -> float:
    """What the ledger up to now does not explain, where all contacts are in it up to the instants of their bodies."""
    PAR = A.PAR
    return float(energy_of(A) - PAR.before - PAR.external + PAR.restitution + PAR.frictional + PAR.damped)


@pytest.mark.parametrize("begun", [False, True])
@pytest.mark.parametrize("beyond", [0, 1])
def test_an_island_beyond_the_cut_closes_its_ledger(begun: bool, beyond: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A box slides on a floor, and another one on it, until the step is cut, before their interval has begun, or after;
    then one of them has gone ahead on its path."""
    space, dt = pymunk.Space(), 0.01
    space.gravity = 0.0, -10.0
    floor = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
    floor.friction = 0.5
    space.add(floor)
    for k in range(2):
        body = pymunk.Body(1.0, 1.0)
        body.position, body.velocity = (0.0, 0.5 + k), (3.0 - 2.0 * k, 0.0)
        shape = pymunk.Poly.create_box(body, (1.0, 1.0))
        shape.friction = 0.5
        space.add(body, shape)
    stepper = ep.EECA(space)
    stepper.step(dt)
    monkeypatch.setattr(step_island, "run", step_island.python)  # within kernels in Python
    assert stepper.event_loop is not None
    A, J = stepper.event_loop.scene, stepper.event_loop.joints
    for i in range(2):
        A.BODY[i].since, A.BODY[i].ax, A.BODY[i].ay, A.BODY[i].angular = 0.0, 0.0, -10.0, 0.0
    begin(A, np.zeros((4, 0), np.int64))
    start_islands(A, J)
    root = A.STATE[0].island
    assert (root, A.STATE[1].island, A.MEMBER[root].bodies) == (0, 0, 2)
    if begun:
        move_to(A.BODY, beyond, 0.4 * dt)
    else:
        end_rest_or_interval(A, root, 0.4 * dt)
        begin_interval(A, root, 0.4 * dt)
        move_to(A.BODY, beyond, 0.5 * dt)
    cut_short(A, J, 0, 0.3 * dt)
    assert [float(A.BODY[i].since) for i in range(2)] == [A.PAR.dt] * 2
    assert open_energy(A) == pytest.approx(0.0, abs=1e-12)
    assert A.PAR.frictional > 0.01


def test_no_event_begins_without_work_for_it() -> None:
    """190 flat polygons of 40 corners fall on each other: an impact on one of them is solved with all that are near,
    and predicted anew for these, which takes up to half of the budget. What it will take is known by earlier ones, on
    average: at most one of 44 steps that end early takes more than 1.25 budgets, with gravity changed by up to 3e-9; 10
    to 14 of 34 if an event begins with any work that is left, up to 1.6 budgets."""
    chance, space = Random(2), crowds.container(5.0, 80.0)
    outline = [(0.6 * math.cos(math.tau * k / 40), 0.06 * math.sin(math.tau * k / 40)) for k in range(40)]
    for i in range(190):
        place, angle = (-4.2 + (i % 7) * 1.35, 0.8 + i // 7 * 1.3), chance.uniform(0.0, 6.0)
        body = crowds.put(space, lambda b: pymunk.Poly(b, outline), place, angle=angle, elasticity=0.1)
        body.angular_velocity = chance.uniform(-5.0, 5.0)
    stepper, works = ep.EECA(space), list[float]()
    for _ in range(75):
        works += [one.value / one.limit for one in stepper.step(1 / 30).unmet if one.name == "solves"]
    assert len(works) > 10
    assert sum(work > 1.25 for work in works) <= 3


def test_impacts_at_the_start_act_whatever_predictions_cost() -> None:
    """Rods that turn fast beside each other take more than the work of a step to predict; boxes that touch and approach
    collide at its first instant all the same, and time goes on."""
    space = pymunk.Space()
    for k in range(4):
        for x, angle in ((0.0, 0.0), (1.2, 0.5 * math.pi)):
            rod = pymunk.Body(1.0, 1.0)
            rod.position, rod.angle, rod.angular_velocity = (x, 10.0 * k + 10.0), angle, 2e5
            shape = pymunk.Poly(rod, [(-0.8, -0.01), (0.8, -0.01), (0.8, 0.01), (-0.8, 0.01)])
            shape.elasticity = 1.0
            space.add(rod, shape)
    boxes = []
    for x, v in ((-5.0, 1.0), (-4.0, 0.0)):
        box = pymunk.Body(1.0, 1.0)
        box.position, box.velocity = (x, 0.0), (v, 0.0)
        shape = pymunk.Poly.create_box(box, (1.0, 1.0))
        shape.elasticity = 1.0
        space.add(box, shape)
        boxes.append(box)
    stepper = ep.EECA(space)
    for _ in range(3):
        stepper.step(1 / 60)
        assert stepper.event_loop is not None
        assert stepper.event_loop.scene.PAR.dt > 0.0
    assert boxes[0].velocity.x == pytest.approx(0.0, abs=1e-12)
    assert boxes[1].velocity.x == pytest.approx(1.0, abs=1e-12)


def test_a_step_that_is_cut_reports_all_impulses() -> None:
    """The log is nearly full where the step is cut: that of the contacts of intervals has room."""
    for more in range(0, 100, 8):
        space, boxes = pymunk.Space(), []
        space.gravity = 0.0, -10.0
        floor = pymunk.Segment(space.static_body, (-80.0, 0.0), (80.0, 0.0), 0.0)
        walls = [pymunk.Segment(space.static_body, (x, -500.0), (x, 500.0), 0.0) for x in (100.0, 102.0)]
        disk = pymunk.Body(1.0, 1.0)
        disk.position, disk.velocity = (101.0, 10.0), (3e6, 0.0)
        space.add(floor, *walls, disk, pymunk.Circle(disk, 0.4))
        for q in range(more):
            space.add(pymunk.Circle(space.static_body, 0.1, (2.0 * (q % 20) - 20.0, -0.6 - 0.2 * (q // 20))))
        for k in range(20):
            box = pymunk.Body(1.0, 1.0 / 6.0)
            box.position, box.velocity = (2.0 * k - 20.0, 0.5), (0.3, 0.0)
            space.add(box, pymunk.Poly.create_box(box, (1.0, 1.0)))
            boxes.append(box)
        for shape in space.shapes:
            shape.friction, shape.elasticity = 0.5, 0.5
        for shape in (*walls, *disk.shapes):
            shape.elasticity = 1.0
        stepper = ep.EECA(space, ep.TimeOfImpact(max_impacts=10**7))
        report = stepper.step(1 / 60)
        assert [one.name for one in report.unmet] == ["solves"]
        assert stepper.event_loop is not None
        lasted, contacts = stepper.event_loop.scene.PAR.dt, report.contacts
        up = report.impulse * contacts.normal[:, 1]
        for box in boxes:
            i = contacts.bodies.index(box)
            borne = up[contacts.body_b == i].sum() - up[contacts.body_a == i].sum()
            assert borne == pytest.approx(box.velocity.y + 10.0 * lasted, abs=1e-9 * lasted), more
