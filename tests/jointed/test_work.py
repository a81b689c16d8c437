"""The work of a step with joints, after which it ends early: each part of a solution adds what it takes. One that adds
nothing may take most of the time of a step, as sweeps over discs did, and impacts that are solved several times."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.impacts import joint_impact
from eeca_pymunk.islands.candidates import pairs_within
from eeca_pymunk.islands.local import number_bodies
from eeca_pymunk.jointed import iteration, meet, solve
from eeca_pymunk.model.parameters import joints as parameters
from eeca_pymunk.model.parameters.events import PAIR_LOOKS
from eeca_pymunk.newton import effort, response, systems
from eeca_pymunk.rows import columns, dense, homotopy, homotopy_start
from eeca_pymunk.rows.coulomb import lawful

STEP = 0.01
BOX, FLOOR = 0, 1  # rows of shapes


def box_with(joined: Callable[[pymunk.Space, pymunk.Body], None], floor: bool, high: float = 0.0) -> tuple[Any, Any]:
    """Scene and joints, before an interval STEP, of a box of mass 1 that slides, in the air or on a floor, with
    friction; or `high` above that."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    body = pymunk.Body(1.0, 1.0)
    body.position, body.velocity = (0.0, 0.5 + high), (3.0, 0.0)
    box = pymunk.Poly.create_box(body, (1.0, 1.0))
    box.friction = 0.5
    space.add(body, box)
    if floor:
        ground = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
        ground.friction = 0.5
        space.add(ground)
    joined(space, body)
    stepper = ep.EECA(space)
    stepper.step(1e-9)
    assert stepper.event_loop is not None
    A, J = stepper.event_loop.scene, stepper.event_loop.joints
    A.PAR.dt = A.PAR.planned = STEP
    A.BODY[0].since = J.PROGRESS.effort = 0.0
    return A, J


def dragged(space: pymunk.Space, body: pymunk.Body) -> None:
    """By a pivot of bounded force: the impulse is in a disc."""
    pivot = pymunk.PivotJoint(space.static_body, body, (0.0, 0.5))
    pivot.max_force = 2.0
    space.add(pivot)


def with_arms(space: pymunk.Space, body: pymunk.Body) -> None:
    """With five arms on springs, whose system is condensed."""
    for k in range(5):
        arm = pymunk.Body(0.1, 0.1)
        arm.position = 0.3 * math.cos(0.4 * math.pi * k), 2.0 + 0.3 * math.sin(0.4 * math.pi * k)
        space.add(arm, pymunk.PinJoint(body, arm, (0.0, 0.2)), pymunk.DampedRotarySpring(body, arm, 0.0, 10.0, 0.1))


def with_weight(space: pymunk.Space, body: pymunk.Body) -> None:
    """With a weight on a pin."""
    weight = pymunk.Body(1.0, 1.0)
    weight.position = 1.0, 2.0
    space.add(weight, pymunk.PinJoint(body, weight))


def interval(A: Any, J: Any) -> None:
    """An interval."""
    assert solve.try_jointed(A, J, A.STATE[0].island, 0.0, STEP, True)[0] == 0


def impact(A: Any, J: Any) -> None:
    """An impact on the floor."""
    for i in range(2):
        A.BODY[i].vy = -1.0
    A.MEMBER[A.STATE[0].island].open = 0
    joint_impact.collide(A, J, BOX, FLOOR, 0.0)


Case = tuple[Callable[[pymunk.Space, pymunk.Body], None], bool, Callable[[Any, Any], None]]
ON_FLOOR: Case = (dragged, True, interval)
WITH_ARMS: Case = (with_arms, True, interval)
IMPACT: Case = (with_weight, True, impact)


def dual(W: Any, more: int) -> int:
    """Unknowns of the dual system of a component, times its band and `more`."""
    component = W.J.COMPONENT[W.s]
    return int(component.dual_size * (component.dual_band + more))


Part = tuple[Any, str, Callable[..., float]]  # a function of a module, and how much work a call is
ROWS: list[Part] = [(module, "assemble", lambda W, *_: W.joints + 1) for module in (systems, response)]
FACTORS: list[Part] = [
    (systems, "factor", lambda matrix, size, *_: size),
    (systems, "factor_banded", lambda matrix, size, band, *_: 0.5 * size),
    (systems, "factor_dual", lambda W, *_: W.J.COMPONENT[W.s].dual_size),
]
BACK: list[Part] = [
    (systems, "back_condensed", lambda W, passes, size, band, *_: passes * size * (band + 6)),
    (systems, "back_banded", lambda matrix, size, band, *_: size * (band + 6)),
    (systems, "back_dual", lambda W, right: dual(W, 30)),
]
REFINEMENTS: list[Part] = [(systems, "back_condensed", lambda W, passes, *_: passes * W.joints)]
# The box is the only body: each contact and each row has one entry.
SWEEPS: list[Part] = [(columns, "sweep_bounded", lambda B, L, m, V: m + B.NUMBER[0])]
SLIPS: list[Part] = [(columns, "lawful", lambda *given: lawful(*given)[2])]
DISCS: list[Part] = [(columns, "sweep_bounded", lambda *_: 1)]
HOMOTOPIES: list[Part] = [(homotopy, "start_homotopy", lambda *_: 1)]
MATRICES: list[Part] = [
    (module, "matrix_jointed", lambda problem, slip, at, kind, N, W: N * N) for module in (homotopy_start, dense)
]
CHANGES: list[Part] = [
    (module, name, lambda tableau, *_: tableau.T.shape[1])
    for module, name in ((homotopy_start, "slip"), (homotopy, "change"))
]
ITERATIONS: list[Part] = [(iteration, "advance", lambda A, J, interval, *_: interval.m + 2)]
INTERVALS: list[Part] = [(solve, "pairs_within", lambda *_: 3)]  # one pair, and two more


def counted(function: Callable[..., Any], amount: Callable[..., float], done: list[float]) -> Callable[..., Any]:
    """A function that also notes how much work its calls are."""

    def call(*given: Any) -> Any:
        done.append(float(amount(*given)))
        return function(*given)

    return call


@pytest.mark.parametrize(
    ("case", "module", "name", "parts"),
    [
        (WITH_ARMS, effort, "ROW_WORK", ROWS),
        (WITH_ARMS, effort, "FACTOR_WORK", FACTORS),
        (WITH_ARMS, effort, "BACK_WORK", BACK),
        (WITH_ARMS, effort, "REFINEMENT_WORK", REFINEMENTS),
        (ON_FLOOR, effort, "ROW_WORK", ROWS),
        (ON_FLOOR, effort, "FACTOR_WORK", FACTORS),
        (ON_FLOOR, effort, "BACK_WORK", BACK),
        (ON_FLOOR, columns, "DISC_WORK", DISCS),
        (ON_FLOOR, columns, "SWEEP_WORK", SWEEPS),
        (ON_FLOOR, columns, "SWEEP_ENTRY_WORK", SWEEPS),
        (ON_FLOOR, columns, "SLIP_WORK", SLIPS),
        (ON_FLOOR, homotopy_start, "HOMOTOPY_WORK", HOMOTOPIES),
        (ON_FLOOR, dense, "MATRIX_WORK", MATRICES),
        (ON_FLOOR, homotopy_start, "CHANGE_WORK", CHANGES),
        (ON_FLOOR, parameters, "CONTACT_WORK", ITERATIONS),
        (ON_FLOOR, solve, "INTERVAL_WORK", INTERVALS),
        (IMPACT, effort, "ROW_WORK", ROWS),
        (IMPACT, effort, "FACTOR_WORK", FACTORS),
        (IMPACT, effort, "BACK_WORK", BACK),
        (IMPACT, columns, "SWEEP_WORK", SWEEPS),
    ],
)
def test_each_part_adds_its_work(
    monkeypatch: pytest.MonkeyPatch, case: Case, module: Any, name: str, parts: list[Part]
) -> None:
    """A unit of work for each of what a part does adds as much to the work of the step."""
    joined, floor, act = case
    work, done = [], [0.0]
    for unit in (0.0, 1.0):
        A, J = box_with(joined, floor)
        with monkeypatch.context() as changed:
            changed.setattr(module, name, unit)
            done.clear()
            for where, called, amount in parts:
                changed.setattr(where, called, counted(getattr(where, called), amount, done))
            act(A, J)
        work.append(float(J.PROGRESS.effort))
    assert sum(done) > 0.0
    assert work[1] - work[0] == pytest.approx(sum(done), rel=1e-9)


def test_the_search_for_an_impact_ends_where_the_budget_of_the_step_is_spent(monkeypatch: pytest.MonkeyPatch) -> None:
    """What cannot go so far went half as far, and so on, up to 40 times, each with a solution (random scene 26000331,
    28e6 operations beyond 57e6). It stays where it was apart, and the step ends."""
    A, J = box_with(with_weight, True, 0.05)
    A.SHAPE[BOX].elasticity = A.SHAPE[FLOOR].elasticity = 1.0
    for i in range(2):
        A.BODY[i].vy, A.BODY[i].spin = -8.0, 1.0
    A.MEMBER[A.STATE[0].island].open = 0
    J.PROGRESS.budget = 1e12
    interval(A, J)
    searched: list[float] = []
    monkeypatch.setattr(meet, "too_late", lambda A, J, S: 0.5 * S.t)
    monkeypatch.setattr(meet, "end_both", counted(meet.end_both, lambda A, J, S, t: t, searched))
    J.PROGRESS.budget = J.PROGRESS.effort
    t, apart = meet.locate_impact(A, J, BOX, FLOOR, 0.009)
    assert (t, apart) == (0.0, True)
    assert len(searched) <= parameters.MEET_SECANTS + 1


@pytest.mark.parametrize(("high", "gaps"), [(0.0, 0), (0.05, 1)])
def test_gaps_of_pairs_that_an_interval_leaves_out_are_work(high: float, gaps: int) -> None:
    """On the floor, where it is part of the solve, and above it."""
    A, _ = box_with(with_weight, True, high)
    root = A.STATE[0].island
    MINE, before = number_bodies(A, root), A.COUNT.work
    assert len(pairs_within(A, root, 0.0, 1e-6, True, MINE)) == (high == 0.0)
    assert A.COUNT.work - before == gaps * PAIR_LOOKS
