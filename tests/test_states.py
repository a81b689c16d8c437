"""States: a path goes on from where it was saved, bit by bit, and begins anew from poses and velocities."""

from __future__ import annotations

import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.kernels import prepare
from scenes.scene import add_disk
from tests.bitwise import CASES, CLOSURES

SLOW = not prepare().entries  # kernels as plain Python
NAMES = ("pool break", "lossy gas", "motor and spring", "kinematic") if SLOW else sorted(CASES)
STEPS = 3 if SLOW else 15


def poses(space: pymunk.Space) -> np.ndarray:
    bodies = [b for b in space.bodies if b.body_type != pymunk.Body.STATIC]
    return np.array([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in bodies])


def run(stepper: ep.EECA, dt: float) -> list[np.ndarray]:
    found = []
    for _ in range(STEPS):
        stepper.step(dt)
        found.append(poses(stepper.space))
    return found


@pytest.mark.parametrize("closure", sorted(CLOSURES))
@pytest.mark.parametrize("name", NAMES)
def test_back_to_a_state(name: str, closure: str) -> None:
    space, dt = CASES[name][0]()
    stepper = ep.EECA(space, CLOSURES[closure]())
    stepper.run(STEPS, dt)
    state, time = stepper.get_state(), stepper.time
    np.testing.assert_array_equal(stepper.get_state(), state)  # telling changes nothing
    first = run(stepper, dt)
    run(stepper, dt)
    stepper.set_state(state)
    assert stepper.time == time
    np.testing.assert_array_equal(stepper.get_state(), state)
    np.testing.assert_array_equal(run(stepper, dt), first)
    other = CASES[name][0]()[0]
    another = ep.EECA(other, CLOSURES[closure]())
    another.set_state(state)
    np.testing.assert_array_equal(run(another, dt), first)


@pytest.mark.parametrize("closure", sorted(CLOSURES))
@pytest.mark.parametrize("name", NAMES)
def test_poses_and_velocities_alone_forget_everything_else(name: str, closure: str) -> None:
    space, dt = CASES[name][0]()
    stepper = ep.EECA(space, CLOSURES[closure]())
    stepper.run(STEPS, dt)
    if any(b.is_sleeping for b in space.bodies):
        pytest.skip("pymunk's order of bodies is another once some have slept")
    start = poses(space)
    found = []
    for _ in range(3):
        stepper.set_state(start)
        found.append(run(stepper, dt))
    another = CASES[name][0]()[0]
    for body, (x, y, angle, vx, vy, spin) in zip(moving(another), start.tolist(), strict=True):
        body.position, body.angle, body.velocity, body.angular_velocity = (x, y), angle, (vx, vy), spin
    new = run(ep.EECA(another, CLOSURES[closure]()), dt)
    for path in found:
        np.testing.assert_array_equal(path, new)


def moving(space: pymunk.Space) -> list[pymunk.Body]:
    return [b for b in space.bodies if b.body_type != pymunk.Body.STATIC]


def test_in_another_process(tmp_path: Path) -> None:
    script = """
import sys, numpy as np, eeca_pymunk as ep
from tests.bitwise import CASES
from tests.test_states import poses
space, dt = CASES["jointed heap"][0]()
stepper = ep.EECA(space)
stepper.set_state(np.load(sys.argv[1]))
stepper.run(10, dt)
np.save(sys.argv[2], poses(space))
"""
    if SLOW:
        pytest.skip("takes long without machine code")
    space, dt = CASES["jointed heap"][0]()
    stepper = ep.EECA(space)
    stepper.run(60, dt)
    np.save(tmp_path / "state.npy", stepper.get_state())
    subprocess.run(
        [sys.executable, "-c", script, str(tmp_path / "state.npy"), str(tmp_path / "end.npy")],
        check=True, cwd=Path(__file__).parents[1],
    )  # fmt: skip
    stepper.run(10, dt)
    np.testing.assert_array_equal(np.load(tmp_path / "end.npy"), poses(space))


def disk() -> tuple[ep.EECA, pymunk.Body]:
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    space.add(body, pymunk.Circle(body, 1.0))
    return ep.EECA(space), body


def test_states_that_do_not_fit_change_nothing() -> None:
    stepper, body = disk()
    body.velocity = (1.0, 0.0)
    good = stepper.get_state()
    space, _ = CASES["cradle"][0]()
    bad = [
        np.zeros((2, 6)), np.zeros(6), np.full((1, 6), np.nan), good[:-1], np.zeros(9, np.int64),
        ep.EECA(space).get_state(),
    ]  # fmt: skip
    for state in bad:
        with pytest.raises(ValueError, match=r"give|get_state"):
            stepper.set_state(state)
        assert body.velocity == (1.0, 0.0)
        np.testing.assert_array_equal(stepper.get_state(), good)


def test_a_state_has_forces_and_a_motors_rate_is_the_users() -> None:
    stepper, body = disk()
    body.force = (2.0, 0.0)
    state = stepper.get_state()
    stepper.run(3, 0.5)
    assert body.velocity == (1.0, 0.0)
    stepper.set_state(state)
    assert (body.force, body.velocity) == ((2.0, 0.0), (0.0, 0.0))
    motor = pymunk.SimpleMotor(stepper.space.static_body, body, 1.0)
    stepper.space.add(motor)
    stepper.set_state(np.zeros((1, 6)))
    stepper.step(0.5)
    state = stepper.get_state()
    motor.rate = 3.0
    stepper.set_state(state)
    stepper.step(0.5)
    assert body.angular_velocity == pytest.approx(-3.0, rel=1e-12)


def test_queries_see_where_bodies_were_put() -> None:
    stepper, _ = disk()
    stepper.step(0.1)
    stepper.set_state(np.array([[50.0, 0.0, 0.0, 0.0, 0.0, 0.0]]))
    assert stepper.space.point_query_nearest((50.0, 0.5), 0.0, pymunk.ShapeFilter()) is not None


def test_sleepers_sleep_again() -> None:
    space, dt = CASES["sleeping"][0]()
    stepper = ep.EECA(space)
    while not any(b.is_sleeping for b in space.bodies):
        stepper.step(dt)
        assert stepper.time < 10.0
    asleep = [b.is_sleeping for b in space.bodies]
    state = stepper.get_state()
    for body in space.bodies:
        body.activate()
    stepper.set_state(state)
    assert [b.is_sleeping for b in space.bodies] == asleep
    before = poses(space)
    stepper.run(5, dt)
    np.testing.assert_array_equal(poses(space)[asleep], before[asleep])
    stepper.set_state(before)
    assert not any(b.is_sleeping for b in space.bodies)


def through(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> bool:
    """Let shapes pass through each other, in pymunk 6 and 7."""
    arbiter.process_collision = False
    return False


def passing(phase: str) -> tuple[pymunk.Space, pymunk.Body, ep.EECA]:
    """A disk far from another one at rest, at which it flies ten diameters in a step; they may not collide."""
    space = pymunk.Space()
    for x in (-5.0, 0.0):
        add_disk(space, (x, 0.0), 0.5)
    space.on_collision(**{phase: through})
    stepper = ep.EECA(space)
    return space, next(iter(space.bodies)), stepper


def fly(body: pymunk.Body, stepper: ep.EECA, anew: bool) -> float:
    """Send the disk at the other one from where it began, and take a step; where it comes to."""
    body.position, body.velocity = (-5.0, 0.0), (600.0, 0.0)
    body.space.reindex_shapes_for_body(body)
    if anew:
        stepper.refresh()
    stepper.step(1 / 60)
    return float(body.position.x)


@pytest.mark.parametrize("phase", ["begin", "pre_solve"])
def test_set_back_by_hand_what_handlers_have_decided_since_is_forgotten(phase: str) -> None:
    """Within a step pymunk does not see them touch, so they collide; unless a handler has decided just before."""
    space, body, stepper = passing(phase)
    first = fly(body, stepper, True)
    assert first == pytest.approx(-1.0)
    for again in (False, True):
        body.position, body.velocity = (-0.8, 0.0), (0.0, 0.0)
        for other in space.bodies:
            other.velocity = 0.0, 0.0
            if other is not body:
                other.position = 0.0, 0.0
        stepper.step(1 / 60)  # they touch
        end = fly(body, stepper, again)
        assert end == (first if again else 5.0)


@pytest.mark.parametrize("saved", [False, True])
@pytest.mark.parametrize("phase", ["begin", "pre_solve"])
def test_states_have_what_handlers_have_decided_before(phase: str, saved: bool) -> None:
    space, body, stepper = passing(phase)
    body.position, body.velocity = (-0.8, 0.0), (0.0, 0.0)
    stepper.step(1 / 60)
    body.position, body.velocity = (-5.0, 0.0), (600.0, 0.0)
    space.reindex_shapes_for_body(body)
    state, copied = stepper.get_state(), pickle.dumps((space, stepper))
    for _ in range(space.collision_persistence + 1):
        stepper.step(1 / 60)
        body.position = 50.0, 0.0
    if saved:
        space, stepper = pickle.loads(copied)
    else:
        stepper.set_state(state)
    stepper.step(1 / 60)
    assert [b.position.x for b in space.bodies] == [5.0, 0.0]


@pytest.mark.parametrize("refreshed", [False, True])
@pytest.mark.parametrize("phase", ["begin", "pre_solve"])
def test_copies_go_on_through_what_handlers_have_rejected(phase: str, refreshed: bool) -> None:
    """pymunk's pickles have the contacts, but not that they were rejected; also if the stepper has forgotten it, as
    pymunk calls `begin` once."""
    space, body, stepper = passing(phase)
    body.position, body.velocity = (-0.9, 0.0), (6.0, 0.0)
    for _ in range(5):
        stepper.step(1 / 60)
    assert body.position.x == pytest.approx(-0.4)
    if refreshed:
        stepper.refresh()
    copied, other = pickle.loads(pickle.dumps((space, stepper)))
    for _ in range(10):
        stepper.step(1 / 60)
        other.step(1 / 60)
    assert [b.position for b in copied.bodies] == [b.position for b in space.bodies]
    assert body.position.x == pytest.approx(0.6)


@pytest.mark.parametrize("phase", ["begin", "pre_solve"])
def test_what_was_rejected_goes_on_in_the_step_in_which_pymunk_forgets_it(phase: str) -> None:
    """In that step they overlap at its start, and, as they are fast, neither before nor at its end. Copies go on in the
    same way."""
    space, body, stepper = passing(phase)
    body.position = -0.8, 0.0
    stepper.step(1 / 60)
    body.position = -5.0, 0.0
    for _ in range(space.collision_persistence - 1):
        stepper.step(1 / 60)
    body.position, body.velocity = (-0.8, 0.0), (600.0, 0.0)
    space.reindex_shapes_for_body(body)
    copied, other = pickle.loads(pickle.dumps((space, stepper)))
    stepper.step(1 / 60)
    other.step(1 / 60)
    assert [b.position for b in copied.bodies] == [b.position for b in space.bodies]
    assert [b.position.x for b in space.bodies] == pytest.approx([9.2, 0.0])


def test_copies_go_on_after_bodies_have_gone() -> None:
    """pymunk fills the place of a body that goes with the last one; its copies have the order in which bodies came."""
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    space.add(pymunk.Segment(space.static_body, (-20.0, 0.0), (20.0, 0.0), 0.1))
    boxes = []
    for k in range(6):
        body = pymunk.Body(1.0 + k, 1.0)
        body.position, body.angular_velocity = (0.3 * k, 1.0 + 1.2 * k), 1.0
        boxes.append(pymunk.Poly.create_box(body, (1.0, 1.0)))
        boxes[-1].friction = 0.5
        space.add(body, boxes[-1])
    stepper = ep.EECA(space)
    run(stepper, 1 / 60)
    space.remove(boxes[1], boxes[1].body)
    run(stepper, 1 / 60)
    copied, other = pickle.loads(pickle.dumps((space, stepper)))
    for _ in range(3):
        assert np.array_equal(run(stepper, 1 / 60), run(other, 1 / 60))
    assert np.array_equal(poses(copied), poses(space))


@pytest.mark.parametrize("name", ["lossy gas", "motor and spring"])
def test_a_copy_that_has_taken_no_step_goes_to_a_state(name: str) -> None:
    space, dt = CASES[name][0]()
    stepper = ep.EECA(space)
    stepper.step(dt)
    state = stepper.get_state()
    _, other = pickle.loads(pickle.dumps((space, stepper)))
    wanted = run(stepper, dt)
    other.set_state(state)
    np.testing.assert_array_equal(run(other, dt), wanted)


def test_notches_of_ratchets_are_those_of_the_state() -> None:
    """A wheel on a spring and a ratchet is set back behind the notch that it has reached, and to the notch itself."""
    space = pymunk.Space()
    wheel = pymunk.Body(1.0, 0.125)
    ratchet = pymunk.RatchetJoint(space.static_body, wheel, 0.0, 0.3)
    space.add(
        wheel, pymunk.Circle(wheel, 0.5), pymunk.PivotJoint(space.static_body, wheel, (0.0, 0.0)), ratchet,
        pymunk.DampedRotarySpring(space.static_body, wheel, 0.0, 0.5, 0.0),
    )  # fmt: skip
    stepper = ep.EECA(space)
    start = np.array([[0.0, 0.0, 0.0, 0.0, 0.0, 3.0]])
    paths = []
    for _ in range(3):
        stepper.set_state(start)
        assert ratchet.angle == 0.0
        stepper.run(100, 0.02)
        paths.append(poses(space))
        assert ratchet.angle == pytest.approx(1.2)
    np.testing.assert_array_equal(paths[0], paths[1])
    np.testing.assert_array_equal(paths[0], paths[2])
    frames = ep.rollout(stepper, np.array([start, paths[0], start]), 100, 0.02)
    for k in (0, 2):
        np.testing.assert_array_equal(frames[k, -1], paths[0])
    assert frames[1, :, 0, 2] == pytest.approx(1.2)
    assert ratchet.angle == pytest.approx(1.2)
    stepper.set_state(paths[0])
    stepper.run(100, 0.02)
    assert wheel.angle == pytest.approx(1.2)
