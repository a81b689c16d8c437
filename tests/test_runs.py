"""A run is its steps, bit by bit: in compiled code, and where functions are called in between."""

from __future__ import annotations

import math
from dataclasses import fields
from pathlib import Path

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.kernels import prepare
from tests.bitwise import CASES, CLOSURES

SLOW = not prepare().entries  # kernels as plain Python
PLAIN = ("pool break", "lossy gas", "motor and spring", "kinematic")


def state(space: pymunk.Space) -> list[tuple[float, ...]]:
    return [(*b.position, b.angle, *b.velocity, b.angular_velocity, *b.force, b.torque) for b in space.bodies]


def stepped(name: str, closure: str, run: bool, steps: int) -> tuple[object, ...]:
    space, dt = CASES[name][0]()
    stepper = ep.EECA(space, CLOSURES[closure]())
    if run:
        report = stepper.run(steps, dt)
        told = report.ledger, report.impacts, report.unmet, report.iterations, report.lock
    else:
        whole = ep.Stepper.run(stepper, steps, dt)
        told = whole.ledger, whole.impacts, whole.unmet, whole.iterations, whole.lock
    stepper.step(dt)
    impulses = [c.impulse for c in space.constraints]
    return state(space), stepper.time, told, impulses


@pytest.mark.parametrize("closure", sorted(CLOSURES))
@pytest.mark.parametrize("name", PLAIN if SLOW else sorted(CASES))
def test_a_run_is_its_steps(name: str, closure: str) -> None:
    steps = 5 if SLOW else min(CASES[name][1], 40)
    assert repr(stepped(name, closure, True, steps)) == repr(stepped(name, closure, False, steps))


def test_a_run_counts_iterations_of_steps_without_contacts_that_were_not_solved() -> None:
    """A fast motor turns two bodies in a chain of pins: joints are unmet, and there is no contact."""
    told = []
    for run in (True, False):
        space, one, two = pymunk.Space(), pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
        two.position, two.velocity, ground = (1.0, 0.0), (0.0, 3.0), space.static_body
        space.add(one, two, pymunk.SimpleMotor(one, two, 1e4), pymunk.PinJoint(ground, one, (-1, 0)))
        space.add(pymunk.PinJoint(one, two), pymunk.PinJoint(two, ground, (0, 0), (3, 0)))
        stepper = ep.EECA(space)
        report = stepper.run(5, 1.0) if run else ep.Stepper.run(stepper, 5, 1.0)
        told.append((report.unmet, report.iterations, report.lock, report.impacts))
    assert told[0] == told[1]
    assert told[0][0] > 0
    assert told[0][1] > 0


class Stepwise(ep.EECA):
    """EECA whose runs and recordings are Python loops."""

    def compiles(self) -> bool:
        return False


@pytest.mark.parametrize("closure", sorted(CLOSURES))
@pytest.mark.parametrize("name", PLAIN if SLOW else sorted(CASES))
def test_a_recording_is_the_same_from_either_loop(name: str, closure: str) -> None:
    steps = 6 if SLOW else min(CASES[name][1], 30)
    found = []
    for kind in (ep.EECA, Stepwise):
        space, dt = CASES[name][0]()
        found.append(ep.record(kind(space, CLOSURES[closure]()), steps * dt, dt, every=2))
    one, other = (
        {f.name: getattr(part, f.name) for part in (run, run.ledger, run.events) for f in fields(part)} for run in found
    )
    for label in one:
        if isinstance(one[label], np.ndarray):
            np.testing.assert_array_equal(one[label], other[label], err_msg=label)


def test_events_tell_all_impulses() -> None:
    """Momentum of a disk between two walls: what each impact of the recording gives adds up to the change."""
    space = pymunk.Space()
    for x in (-1.0, 1.0):
        wall = pymunk.Segment(space.static_body, (x, -9.0), (x, 9.0), 0.0)
        wall.elasticity = 1.0
        space.add(wall)
    body = pymunk.Body(2.0, 1.0)
    body.velocity = (3.0, 0.1)
    ball = pymunk.Circle(body, 0.25)
    ball.elasticity = 1.0
    space.add(body, ball)
    recording = ep.record(ep.EECA(space), 4.0, 0.1)
    events = recording.events
    assert recording.parameters["steps_unmet"] == 0
    # From x = 0 at speed 3 in 1.5 of free way: impacts at .25 + k / 2.
    np.testing.assert_allclose(events.time, 0.25 + 0.5 * np.arange(8), rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(events.impulse, 12.0, rtol=1e-14)
    assert (np.sort(events.bodies, axis=1) == [-1, 0]).all()
    np.testing.assert_allclose(np.abs(events.point[:, 0]), 1.0, rtol=1e-13)
    sign = np.where(events.bodies[:, 1] == 0, 1.0, -1.0)
    given = (sign * events.impulse)[:, None] * events.normal
    np.testing.assert_allclose(given.sum(axis=0), recording.momentum[-1] - recording.momentum[0], atol=1e-12)


def test_events_are_saved(tmp_path: Path) -> None:
    space, dt = CASES["pool break"][0]()
    recording = ep.record(ep.EECA(space), 40 * dt, dt, every=4)
    assert len(recording.events) > 5
    recording.save(tmp_path / "run.npz")
    again = ep.Recording.load(tmp_path / "run.npz")
    for f in fields(ep.Events):
        np.testing.assert_array_equal(getattr(again.events, f.name), getattr(recording.events, f.name))
    np.testing.assert_array_equal(again.spin, recording.spin)


def ball(height: float = 2.0) -> tuple[pymunk.Space, pymunk.Body]:
    space = pymunk.Space()
    space.gravity = (0.0, -10.0)
    floor = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0)
    body = pymunk.Body(1.0, 1.0)
    body.position = (0.0, height)
    disk = pymunk.Circle(body, 0.5)
    floor.elasticity = disk.elasticity = 1.0
    space.add(floor, body, disk)
    return space, body


def test_an_interrupt_leaves_the_space_between_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    space, _ = ball()
    stepper = ep.EECA(space)
    loop = stepper.event_loop
    assert loop is not None
    follow, calls = loop.follow, []

    def interrupted(*args: object) -> int:
        calls.append(follow(*args))
        if len(calls) == 2:
            raise KeyboardInterrupt
        return calls[-1]

    monkeypatch.setattr(loop, "follow", interrupted)
    with pytest.raises(KeyboardInterrupt):
        stepper.run(10**6, 1e-3)
    monkeypatch.undo()
    taken = round(stepper.time / 1e-3)
    assert 64 < taken < 10**6
    other, _ = ball()
    ep.EECA(other).run(taken, 1e-3)
    assert state(other) == state(space)
    stepper.step(1e-3)


def test_a_step_that_fails_leaves_what_the_steps_before_have_done() -> None:
    ends = []
    for kind in (ep.EECA, Stepwise):
        space, body = ball()
        space.gravity = (0.0, 1e153)  # the energy is too large for a number after some steps
        stepper = kind(space)
        with pytest.raises(ValueError, match="overflow") as raised:
            stepper.run(100, 1.0)
        ends.append((repr(state(space)), stepper.time, str(raised.value).replace(str(body), "")))
        assert 5.0 < stepper.time < 30.0
        space.gravity = body.position = body.velocity = (0.0, 2.0)
        stepper.step(0.1)
    assert ends[0] == ends[1]


@pytest.mark.parametrize(("steps", "dt"), [(-1, 0.1), (1, -0.1), (1, math.nan)])
def test_bad_numbers_change_nothing(steps: int, dt: float) -> None:
    space, _ = ball()
    before = state(space)
    for stepper in (ep.EECA(space), ep.Native(space)):
        with pytest.raises(ValueError, match="give"):
            stepper.run(steps, dt)
        with pytest.raises(TypeError, match=r"steps = 1\.5: give a whole number >= 0"):
            stepper.run(1.5, dt)  # type: ignore[arg-type]
    assert state(space) == before


def test_nothing_to_do() -> None:
    space, _ = ball()
    before = state(space)
    for steps, dt in ((0, 0.1), (3, 0.0)):
        for stepper in (ep.EECA(space), ep.EECA(space, ep.Dashpot(1e6, 1.0)), ep.Native(space)):
            report = stepper.run(steps, dt)
            assert (report.steps, report.time, report.converged, report.ledger) == (0, 0.0, True, None)
    assert state(space) == before


def test_a_run_within_a_step_is_refused() -> None:
    space, _ = ball(0.6)
    stepper = ep.EECA(space)
    raised = []

    def again(*_: object) -> None:
        try:
            stepper.run(1, 0.1)
        except RuntimeError as error:
            raised.append(error)

    space.on_collision(begin=again)
    stepper.step(0.2)
    assert raised


def test_post_step_callbacks_that_wait_are_called_after_the_first_step() -> None:
    space, body = ball()
    seen: list[float] = []
    space.add_post_step_callback(lambda *_: seen.append(body.position.y), "key")
    ep.EECA(space).run(3, 0.1)
    assert seen == [2.0 - 0.5 * 10.0 * 0.01]


@pytest.mark.parametrize(
    "make", [ep.Native, lambda space: ep.EECA(space, ep.Dashpot(1e5, 0.5))], ids=["native", "dashpot"]
)
def test_other_steppers_run_too(make: object) -> None:
    (one, _), (other, _) = ball(), ball()
    report = make(one).run(50, 1 / 60)  # type: ignore[operator]
    stepper = make(other)  # type: ignore[operator]
    for _ in range(50):
        stepper.step(1 / 60)
    assert state(one) == state(other)
    assert report.steps == 50
    assert report.time == stepper.time
