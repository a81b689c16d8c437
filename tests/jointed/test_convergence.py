"""Contacts and joints come to agree: in hardly any step is one of them left unsolved."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from comparisons import program_joints
from eeca_pymunk.compiled.records import zeros
from eeca_pymunk.contacts.interval import make_contacts
from eeca_pymunk.jointed import contact_laws, iterates
from eeca_pymunk.jointed.advance import Interval, Motion
from eeca_pymunk.jointed.broyden import update_columns
from eeca_pymunk.jointed.groups import Groups
from eeca_pymunk.model.contacts import ROW, Columns
from eeca_pymunk.model.islands import Island
from eeca_pymunk.model.parameters.joints import CHORD, COLUMN_CONTACTS
from eeca_pymunk.rows.bounded import room_for_rows
from eeca_pymunk.rows.columns import push_columns

from .test_work import box_with, interval, with_weight

Spaces = Callable[[], pymunk.Space]


@pytest.mark.parametrize(
    ("make", "rates", "share"),
    [
        (lambda: program_joints.six_legs().space, (60,), 0.99),
        (lambda: program_joints.soft_rings().space, (60,), 0.99),
        (lambda: program_joints.rings_of_planks().space, (50, 60, 120), 0.99),
        (lambda: program_joints.car().space, (60,), 0.99),
        (lambda: program_joints.rag_dolls(5).space, (100, 120, 140), 0.95),
    ],
)
def test_steps_converge(make: Spaces, rates: tuple[int, ...], share: float) -> None:
    """How often a pile of figures comes to a state that does not converge is chance in one run: in several."""
    steppers = [(ep.EECA(make()), 1 / rate) for rate in rates]
    assert np.mean([stepper.step(dt).converged for stepper, dt in steppers for _ in range(300)]) >= share


@pytest.mark.parametrize("h", [1e-3, 1.0])
def test_contacts_count_that_may_act(h: float) -> None:
    """Of two disks that stand apart by g, and approach by u: those that meet within h are counted, others not."""
    rows, still, pull = zeros(200, ROW), np.zeros((2, 3)), 10.0
    rows["b"], rows["nx"], rows["gap"] = 1, 1.0, 1.01 * pull * h * h
    assert contact_laws.few_act(rows, still, 200, h, pull)
    rows["gap"][:COLUMN_CONTACTS] = 0.99 * pull * h * h
    assert contact_laws.few_act(rows, still, 200, h, pull)
    rows["gap"][COLUMN_CONTACTS] = 0.0
    assert not contact_laws.few_act(rows, still, 200, h, pull)
    assert contact_laws.few_act(rows, still, COLUMN_CONTACTS, h, pull)
    closing = np.array([[1.02 * pull * h, 0.0, 0.0], [0.0, 0.0, 0.0]])
    rows["gap"] = 2.01 * pull * h * h
    assert contact_laws.few_act(rows, still, 200, h, pull)
    assert not contact_laws.few_act(rows, closing, 200, h, pull)


def test_contacts_that_a_long_interval_leaves_are_solved_in_shorter_ones() -> None:
    """A chain that strong motors curl, whose links press on one another, without friction: 20 of 180 steps had been
    left unsolved, since half of what a step has of work would not do for 64 intervals, though it does for 16."""
    space, links = pymunk.Space(), list[pymunk.Body]()
    for i, mass in enumerate((0.2, 4.0, 5.0, 2.0, 0.2)):
        body = pymunk.Body(mass, pymunk.moment_for_box(mass, (0.9, 0.3)))
        body.position = i, 0.0
        space.add(body, pymunk.Poly.create_box(body, (0.9, 0.3)))
        if links:
            joint, motor = pymunk.PivotJoint(links[-1], body, (i - 0.5, 0.0)), pymunk.SimpleMotor(links[-1], body, -6.0)
            joint.collide_bodies, motor.max_force = False, 20.0
            space.add(joint, motor)
        links.append(body)
    stepper = ep.EECA(space)
    assert all(stepper.step(1 / 30).converged for _ in range(180))


def test_a_rope_that_is_taut_at_rest_is_solved() -> None:
    """Two boxes that slide, are stopped by the limit of a slide and stand: whether it pulls is for friction to say."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    floor = pymunk.Segment(space.static_body, (-50.0, 0.0), (50.0, 0.0), 0.0)
    floor.friction = 1.0
    boxes = [pymunk.Body(1.0, pymunk.moment_for_box(1.0, (0.4, 0.4))) for _ in range(2)]
    space.add(floor, pymunk.SlideJoint(*boxes, (0.0, 0.1), (0.0, -0.1), 0.0, 1.3))
    for x, box in zip((0.0, 1.0), boxes, strict=True):
        box.position, box.velocity = (x, 0.2), (3.0 * x, 0.0)
        shape = pymunk.Poly.create_box(box, (0.4, 0.4))
        shape.friction = 0.8
        space.add(box, shape)
    stepper = ep.EECA(space)
    for _ in range(60):
        report = stepper.step(1 / 30)
        assert report.converged
        assert report.ledger is not None
        assert abs(report.ledger.external) <= 1e-13


@pytest.mark.parametrize("unit", [1.0, 1e-14])
def test_columns_answer_as_the_last_motion_did(unit: float) -> None:
    """Y' d = Y d + e, Y' x = Y x for x across W d: Broyden's update, of two bodies of one component and one that is
    free. What may be round-off is not taken."""
    rng = np.random.default_rng(1)
    groups = Groups(
        np.array([0, 0, 1]), np.array([0, 2, 3]), np.array([0, 1, 2]), np.array([0, -1]), np.array([0]), np.zeros(2)
    )
    columns = Columns(
        np.array([0, 3, 6]), np.array([0, 1, 2, 0, 1, 2]), rng.normal(size=(6, 3)), rng.normal(size=(6, 3)),
        np.zeros(2, np.int64), np.zeros(1),
    )  # fmt: skip
    contacts, bodies = make_contacts(2, 3), np.zeros((3, 3))
    mean, before = unit * rng.normal(size=(2, 3, 3))
    motion = Motion(bodies, mean, bodies, bodies, bodies[:, :2], bodies)
    contacts.ROWS["a"][:2], contacts.ROWS["b"][:2], contacts.ROWS["a_nn"][:2] = (0, 1), (2, 2), (1.0, 4.0)
    isle = Island(*[bodies] * 6, np.ones(3), np.ones(3), np.empty((0, 4), np.int64))
    interval = Interval(isle, groups, contacts.ROWS, motion, columns, 2, 3, 0.0, 1.0, True)
    old, new = unit * rng.normal(size=(2, 2, 2))
    across = np.array([[new[0, 1] - old[0, 1], old[0, 0] - new[0, 0]], [0.0, 0.0]])

    def answer(impulses: np.ndarray) -> np.ndarray:
        velocities = np.zeros((3, 3))
        push_columns(columns, impulses, 2, 1.0, velocities)
        return velocities

    was, was_across = answer(new - old), answer(across)
    update_columns(interval, room_for_rows(0, 0), new, old, np.empty(0), before)
    fitted = mean - before if unit == 1.0 else was
    np.testing.assert_allclose(answer(new - old)[:2], fitted[:2], rtol=1e-12)
    np.testing.assert_allclose(answer(new - old)[2], was[2], rtol=1e-12)  # free bodies answer by their mass
    np.testing.assert_allclose(answer(across), was_across, rtol=1e-9, atol=1e-12 * unit)


@pytest.mark.parametrize("floor", [False, True])
def test_joints_that_contradict_one_another_do_not_stop_time(floor: bool) -> None:
    """A gear far beyond a rotary limit: joints give way in an interval of any length, so a shorter one is of no use.
    Steps are taken whole, by a small part of their work."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    a, b = pymunk.Body(1.0, 0.1), pymunk.Body(1.0, 0.1)
    a.position, b.position = (0.0, 1.0), (1.0, 1.0)
    space.add(a, b, pymunk.Circle(a, 0.3), pymunk.Circle(b, 0.3), pymunk.PivotJoint(a, b, (0.5, 1.0)))
    space.add(pymunk.RotaryLimitJoint(a, b, -0.1, 0.1), pymunk.GearJoint(a, b, 0.6, 1.0))
    if floor:
        space.add(pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.1))
    stepper = ep.EECA(space)
    unmet, efforts = 0, []
    for _ in range(40):
        report = stepper.step(1 / 60)
        unmet += not report.converged
        loop = stepper.event_loop
        assert loop is not None
        assert loop.scene.PAR.dt == loop.scene.PAR.planned
        efforts.append(loop.joints.PROGRESS.effort / loop.joints.PROGRESS.budget)
        assert not floor or min(a.position.y, b.position.y) > 0.3
    assert unmet > 20
    assert np.median(efforts) <= 0.05


@pytest.mark.parametrize(("off", "most"), [(1e9, CHORD), (1e-3, CHORD + 2)])
def test_iterations_that_do_not_come_to_agree_end(monkeypatch: pytest.MonkeyPatch, off: float, most: int) -> None:
    """Whether what contacts and components differ by is beyond all speeds or hardly changes: after new columns."""
    solved = []

    def laws(*arguments: Any) -> float:
        solved.append(1)
        return solve(*arguments)

    solve = contact_laws.solve_columns
    monkeypatch.setattr(contact_laws, "solve_columns", laws)
    monkeypatch.setattr(iterates, "farthest_apart", lambda *_: off)
    interval(*box_with(with_weight, True))
    assert len(solved) == most
