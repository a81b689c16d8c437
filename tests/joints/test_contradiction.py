"""Joints that contradict one another become elastic at once; steps that are too long for their motion are divided."""

from __future__ import annotations

from itertools import pairwise
from random import Random
from typing import Any

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.jointed.alone import begin_alone
from eeca_pymunk.joints import gains, ladder, limits
from eeca_pymunk.joints.ladder import ELASTIC_RUNG, ORDER_4, WHOLE_STEP
from eeca_pymunk.joints.workspace import workspace
from eeca_pymunk.model.joint_steps import ELASTIC, NEARLY, UNHELD
from eeca_pymunk.model.joints import EDITED, ROTARY_LIMIT
from eeca_pymunk.model.parameters.joints import BALANCED, JOINT_APART
from eeca_pymunk.newton import solve as solve_of_newton

STEP = 1 / 60


def rungs_of(monkeypatch: pytest.MonkeyPatch, A: Any, J: Any, h: float) -> tuple[list[int], int]:
    """The rungs that a step h of the first component tries, and its status."""
    tried: list[int] = []

    def take_parts(W: Any, h: float, length: float, rung: int, *more: Any) -> int:
        tried.append(rung)
        return int(taken(W, h, length, rung, *more))

    taken = ladder.take_parts
    monkeypatch.setattr(ladder, "take_parts", take_parts)
    begin_alone(A, J, A.STATE[0].island, 0.0, h, True)
    return tried, int(J.STEPPED[0].status)


def two_bodies(*joints: Any) -> tuple[Any, Any]:
    """Scene and joints of two bodies on a pivot between them and on other joints, at the start of a step."""
    space = pymunk.Space()
    a, b = pymunk.Body(1.0, 0.1), pymunk.Body(1.0, 0.1)
    a.position, b.position = (0.0, 1.0), (1.0, 1.0)
    space.add(a, b, pymunk.PivotJoint(a, b, (0.5, 1.0)), *[joint(a, b) for joint in joints])
    stepper = ep.EECA(space)
    stepper.step(1e-9)
    assert stepper.event_loop is not None
    A, J = stepper.event_loop.scene, stepper.event_loop.joints
    A.PAR.dt = A.PAR.planned = STEP
    A.BODY[0].since, J.PROGRESS.effort, J.PROGRESS.budget = 0.0, 0.0, 1e12
    return A, J


def limit(a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    return pymunk.RotaryLimitJoint(a, b, -0.1, 0.0)


def gear(a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    return pymunk.GearJoint(a, b, 0.0, 1.0)


@pytest.mark.parametrize("other", [limit, gear])
@pytest.mark.parametrize("off", [0.6, 1e-3])
def test_joints_that_contradict_one_another_become_elastic_at_once(
    monkeypatch: pytest.MonkeyPatch, other: Any, off: float
) -> None:
    """A gear that turns to an angle beyond a limit, which it meets at once, or that differs from another gear's: of the
    exact rungs one fails by that."""
    A, J = two_bodies(other, gear)
    J.JOINT[2].phase, J.JOINT[2].touched = off, EDITED
    tried, status = rungs_of(monkeypatch, A, J, STEP)
    assert status >= ELASTIC
    # Order 4 is given up before the limit, which it must not meet.
    assert [rung for rung in tried if rung < ELASTIC_RUNG] == ([ORDER_4, WHOLE_STEP] if other is limit else [ORDER_4])


@pytest.mark.parametrize("off", [0.6, 1e-3, 1e-6])
def test_elastic_joints_that_contradict_one_another_are_solved_to_round_off(
    monkeypatch: pytest.MonkeyPatch, off: float
) -> None:
    """A linear problem but for the arc that bodies turn: Newton's method ends after a few iterations, at the round-off
    of impulses that cancel, and momentum holds to a small part of the size."""
    A, J = two_bodies(gear, gear)
    J.JOINT[2].phase, J.JOINT[2].touched = off, EDITED
    A.BODY[0].spin, A.BODY[1].vx = 1.0, 0.5
    solutions: list[int] = []

    def solve(W: Any, h: float, length: float, loops: bool, give: float) -> bool:
        before = len(iterations)
        done = bool(solved(W, h, length, loops, give))
        if give > 0.0:
            solutions.append(len(iterations) - before)
        return done

    def iterate(*arguments: Any) -> None:
        iterations.append(0)
        iterated(*arguments)

    iterations: list[int] = []
    solved, iterated = limits.solve, solve_of_newton.iterate
    monkeypatch.setattr(limits, "solve", solve)
    monkeypatch.setattr(solve_of_newton, "iterate", iterate)
    momentum = A.BODY[0].vx + A.BODY[1].vx
    _, status = rungs_of(monkeypatch, A, J, STEP)
    assert status in (ELASTIC, NEARLY)
    assert max(solutions) <= 6
    assert J.LOCAL[0].v0[0] + J.LOCAL[1].v0[0] == pytest.approx(momentum, rel=1e-12)


@pytest.mark.parametrize(("spins", "h", "last"), [((10.0, 20.0), 0.03, 1), ((10.0, 20.0), 0.05, 2)])
def test_a_step_too_long_for_its_motion_is_divided(
    monkeypatch: pytest.MonkeyPatch, spins: tuple[float, float], h: float, last: int
) -> None:
    """A linkage of four bars does not turn as far as its velocities would in the step: no iterate fits its joints, but
    they contradict nothing."""
    ground = pymunk.Body(body_type=pymunk.Body.STATIC)
    A, J = two_bodies(
        lambda a, b: pymunk.PivotJoint(ground, a, (-0.5, 1.0)),
        lambda a, b: pymunk.PinJoint(ground, b, (3.0, 1.5), (0.5, 0.0)),
    )
    for i in range(2):
        A.BODY[i].spin = spins[i]
    A.BODY[0].vy, A.BODY[1].vy = 0.5 * spins[0], spins[0] + 0.5 * spins[1]
    tried, status = rungs_of(monkeypatch, A, J, h)
    assert status == NEARLY
    assert tried == [ORDER_4, WHOLE_STEP, WHOLE_STEP, WHOLE_STEP + 1, WHOLE_STEP + 2][: 3 + last]


@pytest.mark.parametrize(
    ("end", "start", "left", "found"),
    [
        ((1.0, 0.0, 1.0), 1.0, STEP, True),
        ((1.0, 0.0, 0.5 * JOINT_APART), 1.0, STEP, False),  # closed all the same
        ((1.0, 4.0 * BALANCED**2, 1.0), 1.0, STEP, False),  # other poses fit better
        ((1.0, 0.0, 1.0), 0.5, STEP, False),  # the motion has opened it
        ((1.0, 0.0, 1.0), 1.0, 0.5 * STEP, False),  # a part after another one
    ],
)
def test_errors_are_a_contradiction_if_they_are_in_balance_and_do_not_arise_from_the_motion(
    monkeypatch: pytest.MonkeyPatch, end: tuple[float, float, float], start: float, left: float, found: bool
) -> None:
    _, J = two_bodies(gear, gear)
    J.PARTS.left = left
    misfits = iter((end, (start, 0.0, 1.0)))
    monkeypatch.setattr(ladder, "errors_of", lambda W, h: next(misfits))
    assert ladder.contradicts(workspace(J, 0), STEP) == found


@pytest.mark.parametrize(
    ("turned", "side", "moves"), [(0.05, 0, False), (0.2, 0, True), (-0.2, 0, True), (0.2, 1, False)]
)
def test_bodies_move_as_one_where_linear_rows_have_passed_a_limit(
    monkeypatch: pytest.MonkeyPatch, turned: float, side: int, moves: bool
) -> None:
    """Unless the joint stands on that limit, and is no farther from it than before."""
    _, J = two_bodies(lambda a, b: pymunk.RotaryLimitJoint(a, b, -0.1, 0.1))
    W, stopped = workspace(J, 0), []
    limit = next(k for k in range(W.joints) if W.link[k].kind == ROTARY_LIMIT)
    W.J.LOCAL[W.link[limit].body[1]].pose[2] = W.J.LOCAL[W.link[limit].body[0]].pose[2] + turned
    W.link[limit].side = side
    monkeypatch.setattr(gains, "pay_all", lambda *_: True)
    monkeypatch.setattr(gains, "farthest", lambda *_: 0.0)
    monkeypatch.setattr(gains, "stop_joints", lambda *_: stopped.append(True))
    assert gains.take_gain(W, STEP, 1.0, UNHELD, False, 0.0) == UNHELD
    assert stopped == [True] * moves


# Masses; moments over them; joints of neighbours: ratios of gears, half-widths of limits, 0 for none.
CHAINS = {
    "elastic": ((2.0, 3e-4, 3e-3, 1e-5, 1.2), (0.01, 0.01, 0.1, 0.1, 0.1), (1.0, 0.0, 1.0, 1.0), (0.0, 0.1, 0.0, 0.0)),
    "limits": (
        (28.0, 1e-4, 1.6e-3, 2e-5, 1.2), (0.01, 0.01, 0.01, 0.01, 0.1), (-1.0, 1.0, 0.0, 0.0), (0.0, 0.05, 0.15, 0.08),
    ),
}  # fmt: skip


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("name", list(CHAINS))
def test_joints_that_contradict_one_another_turn_no_chain_of_light_bodies(name: str, seed: int) -> None:
    """A gear and a limit between the ends of a chain: what impulses of thousands of N s leave by round-off turned it as
    a whole, by up to 1.6 J in a step."""
    masses, moments, gears, limits = CHAINS[name]
    chance, space = Random(seed), pymunk.Space()
    space.gravity = 0.0, -9.81
    chain = [pymunk.Body(m, m * part) for m, part in zip(masses, moments, strict=True)]
    for k, body in enumerate(chain):
        body.position, body.velocity = (float(k), 0.0), (chance.uniform(-1.0, 1.0), chance.uniform(-1.0, 1.0))
        body.angular_velocity = chance.uniform(-2.0, 2.0)
        space.add(body)
    for k, (a, b) in enumerate(pairwise(chain)):
        space.add(pymunk.PivotJoint(a, b, (k + 0.5, 0.0)))
        if gears[k] != 0.0:
            space.add(pymunk.GearJoint(a, b, 0.0, gears[k]))
        if limits[k] != 0.0:
            space.add(pymunk.RotaryLimitJoint(a, b, -limits[k], limits[k]))
    ends = chain[0], chain[-1]
    space.add(pymunk.RotaryLimitJoint(*ends, 0.1, 0.2), pymunk.GearJoint(*ends, 0.0, 1.0))
    if name == "elastic":
        space.add(pymunk.PivotJoint(*ends, (2.5, 0.4)))
    stepper, last = ep.EECA(space), ep.measure(space).energy
    scale = ep.measure(space).kinetic + 9.81 * sum(masses)
    for _ in range(30):
        stepper.step(STEP)
        now = ep.measure(space).energy
        assert now <= last + 1e-7 * scale
        last = now
