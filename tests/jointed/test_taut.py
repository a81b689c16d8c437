"""Bridges as long as their gap, or hardly longer: what hangs across by the pull of its joints alone."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.arrays import FloatArray
from eeca_pymunk.compiled.records import Rows, columns, rows
from eeca_pymunk.impacts.scene import EventLoop
from eeca_pymunk.jointed import advance
from eeca_pymunk.jointed.bounded_rows import prescribe_bounded
from eeca_pymunk.joints.step import is_taut
from eeca_pymunk.joints.workspace import JointMemory, Linkage, workspace
from eeca_pymunk.model.bodies import Body
from eeca_pymunk.model.contacts import Row
from eeca_pymunk.model.joint_steps import STEP, BodyStep
from eeca_pymunk.model.joints import PIN, PIVOT, Joint, Joints, Workspace, joints_of
from eeca_pymunk.newton.response import prepare_response, respond

from .measures import apart, energy

DT = 1 / 60
LONG, THICK, SIDE = 0.5, 0.04, 0.6  # of a plank, half of it, of the box


def bridge(slack: float, unit: float = 1.0, planks: int = 12) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """Planks of mass 1 on pivots over a gap that is by `slack` shorter than they are, on an arc."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81 * unit
    order, low, high = np.arange(planks) - 0.5 * (planks - 1), 0.0, 0.5
    for _ in range(200 if slack > 0.0 else 0):
        bend = 0.5 * (low + high)
        low, high = (bend, high) if np.cos(order * bend).sum() > planks * (1.0 - slack) else (low, bend)
    long = LONG * unit
    before, anchor, place = space.static_body, (0.0, 0.0), np.zeros(2)
    deck = []
    for angle in order * low:
        along = long * np.array((math.cos(angle), math.sin(angle)))
        plank = pymunk.Body(1.0, long**2 / 12)
        plank.position, plank.angle = tuple(place + 0.5 * along), float(angle)
        shape = pymunk.Segment(plank, (-0.5 * long, 0.0), (0.5 * long, 0.0), THICK * unit)
        shape.filter = pymunk.ShapeFilter(group=1)
        space.add(plank, shape, pymunk.PivotJoint(before, plank, anchor, (-0.5 * long, 0.0)))
        deck.append(plank)
        before, anchor, place = plank, (0.5 * long, 0.0), place + along
    space.add(pymunk.PivotJoint(before, space.static_body, anchor, (planks * long * (1.0 - slack), 0.0)))
    return space, deck


def loaded(
    slack: float, load: float, height: float, unit: float = 1.0
) -> tuple[pymunk.Space, list[pymunk.Body], pymunk.Body]:
    """A box of mass `load` whose lower side is `height` above the pivots, over the middle of a bridge."""
    space, deck = bridge(slack, unit)
    box = pymunk.Body(load, load * (SIDE * unit) ** 2 / 6)
    box.position = 6 * LONG * (1.0 - slack) * unit, (height + 0.5 * SIDE) * unit
    space.add(box, pymunk.Poly.create_box(box, (SIDE * unit, SIDE * unit)))
    for shape in space.shapes:
        shape.elasticity, shape.friction = 0.3, 0.8
    return space, deck, box


def overlap(deck: list[pymunk.Body], box: pymunk.Body, unit: float) -> float:
    """How deep the lower side of the box is in the deck, over the unit."""
    worst = 0.0
    for x in np.linspace(-0.5 * SIDE, 0.5 * SIDE, 13):
        point = box.local_to_world((float(x) * unit, -0.5 * SIDE * unit))
        for plank in deck:
            at = plank.world_to_local(point) / unit
            if abs(at.x) <= 0.5 * LONG:
                worst = max(worst, THICK - at.y)
    return worst


@pytest.mark.parametrize("load", [1.0, 5.0])
@pytest.mark.parametrize(("slack", "deep"), [(0.0, 5e-4), (1e-6, 1e-4), (1e-4, 1e-6), (1e-3, 1e-5), (1e-2, 1e-5)])
def test_a_box_stays_on_a_bridge_however_tight(slack: float, deep: float, load: float) -> None:
    sag = math.sqrt(0.375 * slack) * 6.0
    space, deck, box = loaded(slack, load, 0.06 - sag)
    stepper, scale = ep.EECA(space), load * 9.81
    unmet, last = 0, energy(space)
    for k in range(240):
        report = stepper.step(DT)
        unmet += not report.converged
        assert abs(report.ledger.residual) <= 1e-12 * scale
        if k % 6 == 0:  # a box that lands is deeper for a while
            assert overlap(deck, box, 1.0) <= 2e-3
        if slack >= 1e-4:  # a bridge without any gives way elastically, and closes from outside
            assert energy(space) - last <= 1e-10 * scale
        last = energy(space)
    assert overlap(deck, box, 1.0) <= deep
    assert unmet <= 12
    assert apart(space) <= (1e-5 if slack < 1e-4 else 1e-11)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_units_do_not_matter(unit: float) -> None:
    places = []
    for u in (1.0, unit):
        space, deck, box = loaded(1e-5, 2.0, 0.05, u)
        stepper = ep.EECA(space)
        for _ in range(60):
            stepper.step(DT)
        assert overlap(deck, box, u) <= 1e-4
        places.append(box.position / u)
    assert (places[0] - places[1]).length <= 1e-3


def test_a_ball_falls_on_a_tight_rope() -> None:
    """Twenty times as heavy as a link: it went through."""
    space, links = bridge(1e-3, planks=20)
    for link in links:
        link.mass, link.moment = 0.05, 0.05 * LONG**2 / 12
    ball = pymunk.Body(1.0, 0.045)
    ball.position = 5.01, 0.8
    space.add(ball, pymunk.Circle(ball, 0.3))
    for shape in space.shapes:
        shape.elasticity, shape.friction = 0.3, 0.8
    stepper = ep.EECA(space)
    unmet = sum(not stepper.step(DT).converged for _ in range(240))
    assert unmet <= 12
    assert ball.position.y > -0.1
    assert abs(ball.position.x - 5.0) < 3.0


@pytest.mark.parametrize("slack", [1e-6, 1e-4, 1e-2])
def test_a_rope_holds_two_hundred_link_masses(slack: float) -> None:
    """At 5 m/s: nothing passes, joints hold, and energy does not rise, converged or not."""
    space, links = bridge(slack, planks=20)
    ball = pymunk.Body(200.0, 9.0)
    ball.position, ball.velocity = (5.1, 0.8), (0.0, -5.0)
    space.add(ball, pymunk.Circle(ball, 0.3))
    for shape in space.shapes:
        shape.elasticity, shape.friction = 0.3, 0.8
    stepper = ep.EECA(space)
    start = highest = energy(space)
    for _ in range(90):
        stepper.step(DT)
        highest = max(highest, energy(space))
        assert ball.position.y > min(link.position.y for link in links)
        assert apart(space) <= 1e-6
    assert highest - start <= 1e-9 * start


def scratch(stepper: ep.EECA) -> Joints:
    """The arrays of its joints."""
    method = stepper._method
    assert isinstance(method, EventLoop)
    return method.joints


@pytest.mark.parametrize("slack", [1e-5, 1e-3])
def test_what_planks_answer_is_the_derivative_of_a_step(slack: float) -> None:
    """Of the velocities after a step, by the force on a plank: by central differences of whole steps."""

    def run(force: float) -> tuple[pymunk.Space, list[pymunk.Body], ep.EECA]:
        space, deck = bridge(slack)
        stepper = ep.EECA(space)
        scratch(stepper).TALLY.order = 2
        for k in range(8):
            deck[1].force, deck[3].force, deck[5].force = (0.0, 3.0), (0.0, -5.0), (0.0, -20.0)
            deck[4].force = 0.0, force if k == 7 else 0.0
            stepper.step(DT)
        return space, deck, stepper

    change = 1e-3
    seen = np.array([b.velocity.y for b in run(change)[1]]) - np.array([b.velocity.y for b in run(-change)[1]])
    seen /= 2.0 * change * DT
    J = scratch(run(0.0)[2])
    assert prepare_response(workspace(J, 0), STEP, DT)
    places = [int(np.flatnonzero(J.JOINED["body"] == row)[0]) for row in range(12)]
    PUSH = np.zeros((13, 3))
    PUSH[places[4], 1] = 1.0
    respond(workspace(J, 0), PUSH)
    foreseen = PUSH[places, 1]
    assert np.abs(foreseen).max() > 1e-3
    assert np.abs(foreseen - seen).max() <= 1e-3 * np.abs(seen).max()


def least_answer(J: Joints, dt: float) -> float:
    """Least eigenvalue of the symmetric part of what two jointed bodies answer about a step."""
    assert prepare_response(workspace(J, 0), STEP, dt)
    S = np.empty((6, 6))
    for i in range(6):
        PUSH = np.zeros((2, 3))
        PUSH[i // 3, i % 3] = 1.0
        respond(workspace(J, 0), PUSH)
        S[:, i] = PUSH.ravel()
    return float(np.linalg.eigvalsh(S + S.T).min())


@pytest.mark.parametrize("force", [50.0, 2000.0, -2000.0])
def test_what_a_groove_answers_is_positive(force: float) -> None:
    """It pushes across itself, whatever it turns to: impulses on its bodies do no negative work."""
    space = pymunk.Space()
    rail, bead = pymunk.Body(1.0, 0.1), pymunk.Body(1.0, 1.0)
    bead.position = 0.5, 0.0
    space.add(rail, bead, pymunk.GrooveJoint(rail, bead, (-5.0, 0.0), (5.0, 0.0), (0.0, 0.0)))
    space.add(pymunk.DampedRotarySpring(rail, bead, 0.0, 1e-6, 0.0))
    stepper = ep.EECA(space)
    J = scratch(stepper)
    J.TALLY.order = 2
    bead.force, rail.force, rail.torque = (0.0, force), (0.0, -force), -0.5 * force
    stepper.step(0.1)
    assert least_answer(J, 0.1) >= -1e-12


@pytest.mark.parametrize(("limit", "here", "there", "force"), [
    (True, 0.0, 0.1, -20.0), (True, 0.0, 0.1, -2000.0), (True, 0.0, -0.1, 20.0), (True, 0.0, -0.1, 2000.0),
    (False, 0.6, 0.3, -200.0), (False, 0.6, 0.3, -2000.0), (False, 0.7, 0.25, -2000.0),
])  # fmt: skip
def test_what_a_joint_answers_that_pushes_a_body_is_positive(
    limit: bool, here: float, there: float, force: float
) -> None:
    """A slide at its bound, whose impulse counts as given, and a pin shorter than the arm whose point it pulls towards
    the body: without the inertia that their turning takes contacts seemed to give way against their impulses, were left
    out, and let bodies through a wall."""
    space = pymunk.Space()
    heavy, light = pymunk.Body(4.0, 1.0), pymunk.Body(1.0, 1e-3 if limit else 0.1)
    light.position = 0.5, 0.0
    far = 0.5 + there - here
    joint: pymunk.Constraint = pymunk.PinJoint(heavy, light, (here, 0.0), (there, 0.0))
    if limit:
        bounds = (far, 2.0 * far) if force > 0.0 else (0.0, far)
        joint = pymunk.SlideJoint(heavy, light, (here, 0.0), (there, 0.0), *bounds)
    space.add(heavy, light, joint, pymunk.DampedRotarySpring(heavy, light, 0.0, 1e-6, 0.0))
    stepper = ep.EECA(space)
    J = scratch(stepper)
    J.TALLY.order = 2
    light.force, heavy.force = (-force, 0.0), (force, 0.0)
    stepper.step(0.1)
    prescribe_bounded(J, 0, limit, limit)
    assert least_answer(J, 0.1) >= -1e-12


@pytest.mark.parametrize("kind", [PIVOT, PIN])
@pytest.mark.parametrize("turned", [0.0, 2.0])
def test_taut_is_what_pulls_hard(kind: int, turned: float) -> None:
    """Two rods end to end: a pull on their joint is stiff beside their moments if (h/4) h f r > I/2."""
    loop = ep.EECA(pymunk.Space())._method
    assert isinstance(loop, EventLoop)
    linkage = Linkage(rows(Joint, 1), rows(Body, 0), np.zeros(0, np.int64))
    J = joints_of(JointMemory().plan(loop.table, loop.n, linkage))._replace(LOCAL=rows(BodyStep, 2))
    joint, link, local = J.JOINT[0], J.COUPLING[:1], J.LOCAL
    link[0].kind, link[0].body[:] = kind, (0, 1)
    apart = 0.0 if kind == PIVOT else 0.25
    joint.anchor_a[:], joint.anchor_b[:] = (0.5, 0.0), (-0.5, 0.0)
    x, y = math.cos(turned), math.sin(turned)
    local[1].pose[:2] = (1.0 + apart) * x, (1.0 + apart) * y
    local["cos"], local["sin"], local["mobility"] = x, y, (1.0, 1.0, 12.0)
    least = 0.5 / (0.25 * 0.1 * 0.5 * 12.0)  # impulse
    for pull, expected in ((0.99, False), (1.01, True), (-10.0, False)):
        # On b, towards a: it pulls.
        f = -pull * least
        J.HINGE[0].lam[:] = (f * x, f * y) if kind == PIVOT else (f, 0.0)
        assert is_taut(Workspace(J, 0, link, 1, 2), 0.1) == expected


def test_arms_are_brought_to_one_point() -> None:
    rng = np.random.default_rng(3)
    ROWS, END = rows(Row, 4), rng.normal(size=(5, 3))
    P, Q = ROWS["a"], ROWS["b"] = np.arange(4), np.arange(1, 5)
    angle = rng.uniform(0.0, 6.0, 4)
    ROWS["nx"], ROWS["ny"] = np.cos(angle), np.sin(angle)
    middle = rng.normal(size=(4, 2))
    for arm_n, arm_t, away in (("arm_na", "arm_ta", 0.1), ("arm_nb", "arm_tb", -0.1)):
        put_arms(ROWS, middle + away, arm_n, arm_t)
    before = arms(ROWS, "arm_na", "arm_ta") + arms(ROWS, "arm_nb", "arm_tb")
    for i in range(4):
        advance.join_points(ROWS[i], *advance.separation(ROWS[i], END), 0.5)
    a, b = arms(ROWS, "arm_na", "arm_ta"), arms(ROWS, "arm_nb", "arm_tb")
    assert np.abs(END[P, :2] + a - END[Q, :2] - b).max() < 1e-14
    assert np.abs(a + b - before).max() < 1e-14


def put_arms(ROWS: Rows[Row], r: FloatArray, arm_n: str, arm_t: str) -> None:
    """r x n and r x t of arms r (m, 2)."""
    nx, ny = ROWS["nx"], ROWS["ny"]
    ROWS[arm_n], ROWS[arm_t] = r[:, 0] * ny - r[:, 1] * nx, r[:, 0] * nx + r[:, 1] * ny


def arms(ROWS: Rows[Row], arm_n: str, arm_t: str) -> FloatArray:
    """The arms (m, 2) with these products."""
    n = columns(ROWS, "nx", "ny")
    t = np.stack((-n[:, 1], n[:, 0]), axis=1)
    return ROWS[arm_t][:, None] * n - ROWS[arm_n][:, None] * t
