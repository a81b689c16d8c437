"""The shell of a step around one compiled call: bodies that meet nothing fly as `ep.EECA` lets them fly."""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable
from functools import partial

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.arrays import IntArray
from eeca_pymunk.compiled import Table
from eeca_pymunk.compiled.records import Rows
from eeca_pymunk.errors import NotFiniteError
from eeca_pymunk.model.contacts import Impulse
from eeca_pymunk.model.step import EVENTS
from eeca_pymunk.packed_stepper import PackedStepper
from eeca_pymunk.report import Details, Outcome, of_events
from eeca_pymunk.space import packing
from eeca_pymunk.space.private import spaces as private
from eeca_pymunk.space.world import World
from scenes.scene import add_disk

from .steppers import state
from .test_transfer import flown

DT = 0.0625


class FreeFlight(PackedStepper):
    """Bodies that meet nothing; `told` are the impulses it reports."""

    told: Rows[Impulse] | None = None

    def make_method(self, world: World) -> Flight:
        return Flight(self, world)


class Flight:
    """The method of `FreeFlight`."""

    def __init__(self, stepper: FreeFlight, world: World) -> None:
        self.stepper, self.world = stepper, world

    def step(self, reading: Table, dt: float, gx: float, gy: float, half_damping: float) -> int:
        status = flown(self.world, dt, half_damping)
        return status if self.stepper.told is None or status < 0 else status | EVENTS

    def rule(self, rules: object) -> None:
        """Nothing meets."""

    def details(self, dt: float, bodies: tuple[pymunk.Body, ...], owner: IntArray) -> Callable[[], Details]:
        assert self.stepper.told is not None
        return partial(of_events, self.stepper.told, dt, bodies, owner)

    def outcome(self) -> Outcome:
        return None, 1.0, True, 0


def swarm() -> pymunk.Space:
    """Bodies of all kinds that stay apart: disks, a turning box, an eccentric body, a lift, a pillar."""
    space = pymunk.Space()
    space.gravity = (0.5, -2.0)
    random = np.random.default_rng(5)
    for i in range(4):
        add_disk(space, (300.0 * i, 0.0), 0.5, 1.0 + i, tuple(random.normal(size=2)))
    box = pymunk.Body(2.0, 0.7)
    box.position, box.angular_velocity = (0.0, 900.0), 3.0
    off = pymunk.Body(1.0, 2.0)
    off.position, off.center_of_gravity = (900.0, 900.0), (0.2, 0.3)
    off.velocity, off.angular_velocity = (1.0, 0.0), -1.0
    lift = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    lift.position, lift.velocity = (-900.0, 0.0), (0.0, 1.0)
    pillar = pymunk.Body(body_type=pymunk.Body.STATIC)
    pillar.position = (-900.0, -900.0)
    space.add(box, pymunk.Poly.create_box(box, (1.0, 1.0)), off, pymunk.Circle(off, 0.5))
    space.add(lift, pymunk.Circle(lift, 0.5), pillar, pymunk.Circle(pillar, 0.5))
    return space


def push(space: pymunk.Space) -> None:
    for i, body in enumerate(space.bodies):
        if body.body_type == pymunk.Body.DYNAMIC:
            body.force, body.torque = (1.0 + i, -2.0), 0.5 * i


def damp(space: pymunk.Space) -> None:
    space.damping = 0.5


def steer(space: pymunk.Space) -> None:
    for body in list(space.bodies)[1:6:2]:
        body.velocity_func = lambda body, gravity, damping, dt: pymunk.Body.update_velocity(
            body, (1.0, 3.0), damping * 0.75, dt
        )


def guide(space: pymunk.Space) -> None:
    def wrap(body: pymunk.Body, dt: float) -> None:
        pymunk.Body.update_position(body, dt)
        body.position = (500.0 + body.position.x % 1.0, body.position.y)

    list(space.bodies)[2].position_func = wrap


def handle(space: pymunk.Space) -> None:
    space.on_collision(begin=lambda arbiter, space, data: None)


PARTS: dict[str, Callable[[pymunk.Space], None]] = {
    "gravity": lambda space: None,
    "forces": push,
    "damping": damp,
    "velocity functions": steer,
    "position functions": guide,
    "handlers": handle,
    "all": lambda space: [part(space) for part in (push, damp, steer, guide, handle)] and None,
}


@pytest.mark.parametrize("sync", [True, False])
@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS.keys())
def test_bodies_fly_as_in_eeca(part: Callable[[pymunk.Space], None], sync: bool) -> None:
    spaces = [swarm(), swarm()]
    steppers: list[ep.Stepper] = [FreeFlight(spaces[0], sync=sync), ep.EECA(spaces[1], sync=sync)]
    for space in spaces:
        part(space)
    for stepper in steppers:
        stepper.refresh()
    for k in range(40):
        for space, stepper in zip(spaces, steppers, strict=True):
            if part is not PARTS["gravity"] and k % 3 == 0:
                push(space)
            stepper.step(DT)
    a, b = (np.array(state(space)[1:]) for space in spaces)
    assert a == pytest.approx(b, rel=1e-13, abs=1e-13)
    assert steppers[0].time == 40 * DT
    if sync:
        for x, y in zip(spaces[0].shapes, spaces[1].shapes, strict=True):
            assert tuple(x.bb) == pytest.approx(tuple(y.bb), rel=1e-13)


def test_a_step_without_functions_calls_none_and_asks_no_property(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a scene lacks costs nothing: the shell of such a step is settings, two batch calls and the kernel."""
    space = swarm()
    stepper = FreeFlight(space, sync=False)
    stepper.step(DT)
    for name in ("gravity", "damping", "sleep_time_threshold", "static_body", "step"):
        monkeypatch.setattr(pymunk.Space, name, property(lambda self, name=name: pytest.fail(name)))
    for name in ("position", "velocity", "velocity_func", "position_func"):
        monkeypatch.setattr(pymunk.Body, name, property(lambda self, name=name: pytest.fail(name)))
    report = stepper.step(DT)
    monkeypatch.undo()
    assert report.time == 2 * DT
    assert len(report.contacts) == 0
    assert report.contacts.bodies == stepper._update_world().bodies.items


def test_functions_set_after_the_stepper_was_made_are_called() -> None:
    space = swarm()
    stepper = FreeFlight(space)
    body = next(iter(space.bodies))
    body.velocity_func = lambda *_: None
    velocity = body.velocity
    stepper.step(DT)
    assert body.velocity == velocity


@pytest.mark.parametrize("phase", ["begin", "post_solve"])
def test_what_handlers_change_is_kept(phase: str) -> None:
    space = pymunk.Space()
    a, b = (add_disk(space, (x, 0.0), 0.1, velocity=(1.0, 0.0)) for x in (0.0, 0.15))
    stepper = FreeFlight(space)
    done: list[pymunk.Body] = []

    def lift(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        if not done:
            a.velocity += (0.0, 4.0)
            done.append(a)

    space.on_collision(**{phase: lift})  # type: ignore[arg-type]
    stepper.step(DT)
    # What begin changes takes part in the motion of the step, what post_solve changes comes after it.
    assert (a.velocity, a.position.y) == ((1.0, 4.0), 4.0 * DT if phase == "begin" else 0.0)
    assert (b.velocity, b.position) == ((1.0, 0.0), (0.15 + DT, 0.0))
    stepper.step(DT)
    assert a.position.y == (8.0 if phase == "begin" else 4.0) * DT


def test_nothing_of_the_rehearsal_is_left() -> None:
    """pymunk's own solver spins rubbing disks, which must not stay."""
    space = pymunk.Space()
    disks = [add_disk(space, (x, 0.0), 0.1, velocity=(-10.0 * x, -3.0 * x)) for x in (-0.09, 0.09)]
    for shape in space.shapes:
        shape.friction = 1.0
    spins: list[float] = []
    space.on_collision(post_solve=lambda arbiter, space, data: spins.append(disks[0].angular_velocity))
    with pytest.warns(UserWarning, match="friction"):
        stepper = FreeFlight(space, ignore=("friction",))
    stepper.step(DT)
    assert spins
    assert spins[0] != 0.0
    for disk, x in zip(disks, (-0.09, 0.09), strict=True):
        assert (disk.angle, disk.angular_velocity) == (0.0, 0.0)
        assert disk.velocity == (-10.0 * x, -3.0 * x)


def test_what_handlers_decide_about_pairs_is_told_for_one_step() -> None:
    space = pymunk.Space()
    for x in (0.0, 0.15, 0.3):
        add_disk(space, (x, 0.0), 0.1)
    third = list(space.shapes)[2]
    third.collision_type = 3
    stepper = FreeFlight(space)
    world = stepper._update_world()
    assert not world.rules.ignored | set(world.rules.changed)

    def ignore(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        arbiter.process_collision = False

    def soften(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        arbiter.restitution = 0.25

    space.on_collision(0, 0, begin=ignore)
    space.on_collision(0, 3, pre_solve=soften)
    stepper.step(DT)
    assert stepper._world is world
    assert world.rules.of_pairs(world.SHAPE) == {(0, 1): (-1.0, 0.0, 0.0, 0.0), (1, 2): (0.25, 0.0, 0.0, 0.0)}


@pytest.mark.parametrize("sync", [True, False])
@pytest.mark.parametrize("kind", ["velocity", "position"])
def test_functions_of_bodies_are_called_once_a_step(kind: str, sync: bool) -> None:
    space = swarm()
    calls: list[float] = []
    own = {"velocity": pymunk.Body.update_velocity, "position": pymunk.Body.update_position}[kind]

    def count(body: pymunk.Body, *arguments: object) -> None:
        calls.append(float(arguments[-1]))  # type: ignore[arg-type]
        own(body, *arguments)  # type: ignore[operator]

    setattr(next(iter(space.bodies)), f"{kind}_func", count)
    stepper = FreeFlight(space, sync=sync)
    for _ in range(3):
        stepper.step(DT)
    assert calls == [DT] * 3


def test_settings_bodies_and_walls_may_change_between_steps() -> None:
    space = pymunk.Space()
    body = add_disk(space, (0.0, 0.0), 0.1)
    wall = pymunk.Body(body_type=pymunk.Body.STATIC)
    space.add(wall, pymunk.Circle(wall, 0.1))
    wall.position = (9.0, 9.0)
    stepper = FreeFlight(space)
    stepper.step(1.0)
    space.gravity = (2.0, 0.0)
    stepper.step(1.0)
    assert (body.position.x, body.velocity.x) == (1.0, 2.0)
    space.gravity = (0.0, 0.0)
    wall.position = (8.0, 8.0)
    stepper.step(1.0)
    assert body.position.x == 3.0
    other = add_disk(space, (0.0, 5.0), 0.1, velocity=(1.0, 0.0))
    stepper.step(1.0)
    assert (body.position.x, other.position.x) == (5.0, 1.0)
    space.remove(body, *body.shapes)
    add_disk(space, (0.0, 7.0), 0.1)
    stepper.step(1.0)
    assert (body.position.x, other.position.x) == (5.0, 2.0)
    assert wall.position == (8.0, 8.0)


@pytest.mark.parametrize("through", [copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_a_copy_goes_on_bitwise(through: Callable[[ep.Stepper], ep.Stepper]) -> None:
    stepper = FreeFlight(swarm())
    for _ in range(5):
        stepper.step(DT)
    other = through(stepper)
    for _ in range(5):
        stepper.step(DT)
        other.step(DT)
    assert state(stepper.space) == state(other.space)
    assert stepper.time == other.time


@pytest.mark.parametrize("when", ["begin", "position function", "rest step"])
def test_a_failure_leaves_the_space_as_it_was(when: str, monkeypatch: pytest.MonkeyPatch) -> None:
    space = swarm()
    push(space)

    def fail(*_: object) -> None:
        raise KeyboardInterrupt

    stepper = FreeFlight(space)
    if when == "begin":
        for x in (20.0, 20.1):
            add_disk(space, (x, 0.0), 0.5)
        space.on_collision(begin=fail)
    elif when == "position function":
        list(space.bodies)[1].position_func = fail
        stepper.refresh()
    else:
        monkeypatch.setattr(private, "step_without_end", fail)
    before, time = state(space), stepper.time
    with pytest.raises(KeyboardInterrupt):
        stepper.step(DT)
    assert state(space) == before
    assert stepper.time == time
    monkeypatch.undo()
    if when == "rest step":
        stepper.step(DT)
        assert stepper.time > time


def test_the_model_says_what_there_is() -> None:
    space = swarm()
    for shape in space.shapes:
        shape.elasticity = 1.0
    whole = "4 disks, 3 other moving shapes, 1 walls; {}; rotation with contact arms; {}"
    assert FreeFlight(space).model == whole.format("gravity or forces", "elastic; sustained contacts")
    space.gravity = (0.0, 0.0)
    assert FreeFlight(space).model == whole.format("no forces", "elastic")
    push(space)
    shape.elasticity = 0.5
    assert FreeFlight(space).model == whole.format("gravity or forces", "loss; sustained contacts")
    for part in (damp, steer, handle):
        part(space)
    assert FreeFlight(space).model.endswith("; damping; functions of bodies; collision handlers, by a rehearsal")
    still = pymunk.Space()
    disk = add_disk(still, (0.0, 0.0), 0.1)
    stepper = FreeFlight(still)
    assert stepper.model == "1 disks, 0 walls; no forces; no rotation; elastic"
    disk.angular_velocity = 1.0
    assert stepper.model == "1 disks, 0 walls; no forces; free rotation; elastic"


def test_shapes_that_stay_are_not_read_again(monkeypatch: pytest.MonkeyPatch) -> None:
    space = swarm()
    for shape in space.shapes:
        shape.elasticity = 1.0
    stepper = FreeFlight(space)
    asked: list[pymunk.Shape] = []
    read = packing.read
    monkeypatch.setattr(packing, "read", lambda shape, *wall: (asked.append(shape), read(shape, *wall))[1])
    added = pymunk.Circle(space.static_body, 1.0, (700.0, 700.0))
    added.elasticity = 1.0
    space.add(added)
    stepper.step(DT)
    assert asked == [added]
    assert "elastic" in stepper.model
    shape.elasticity = 0.5
    assert "loss" in stepper.model
    assert asked == [added, shape]
    space.remove(shape)
    stepper.step(DT)
    assert "elastic" in stepper.model
    assert len(asked) == 2


def test_errors_come_before_anything_moves() -> None:
    space = swarm()
    stepper = FreeFlight(space)
    for dt in (-1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="dt"):
            stepper.step(dt)
    body = next(iter(space.bodies))
    for name, value in (("velocity", (math.nan, 0.0)), ("force", (math.inf, 0.0)), ("velocity", (1e308, 0.0))):
        held = getattr(body, name)
        setattr(body, name, value)
        others = [(*b.position, *b.velocity) for b in list(space.bodies)[1:]]
        with pytest.raises(ValueError, match="overflow" if value[0] == 1e308 else rf"{name}\.x of .* is (nan|inf)"):
            stepper.step(100.0)
        assert [(*b.position, *b.velocity) for b in list(space.bodies)[1:]] == others
        setattr(body, name, held)
    stepper.step(DT)


def test_the_report_of_events_is_made_when_asked() -> None:
    space = swarm()
    stepper = FreeFlight(space)
    world = stepper._update_world()
    first, second = 0, len(world.shapes) - 1
    late = [first, second, 0.75 * DT, 2.0, 0.0, 1.0, 5.0, 6.0, 0.5, 3.0, 0.0, 0.25]
    soon = [second - 1, second, 0.25 * DT, 1.0, 1.0, 0.0, 7.0, 8.0, -0.5, 4.0, -0.1, 0.0]
    stepper.told = np.array([tuple(late), tuple(soon)], Impulse.TYPE)
    report = stepper.step(DT)
    contacts = report.contacts
    assert contacts.time.tolist() == [0.25 * DT, 0.75 * DT]
    assert report.impulse.tolist() == [1.0, 2.0]
    assert report.psi2.tolist() == [0.5, -0.5]
    assert report.gap_increment.tolist() == [0.5 * DT * 0.5 * 4.0, -0.5 * DT * 0.5 * 3.0]
    assert np.isinf(report.psi1).all()
    assert contacts.normal.tolist() == [[1.0, 0.0], [0.0, 1.0]]
    assert contacts.point.tolist() == [[7.0, 8.0], [5.0, 6.0]]
    assert contacts.gap.tolist() == [-0.5, 0.5]
    assert contacts.duration.tolist() == [0.0, 0.25]
    assert report.friction.tolist() == [-0.1, 0.0]
    assert contacts.bodies[contacts.body_a[1]] is world.shapes[first].body
    assert contacts.bodies[contacts.body_b[1]] is world.shapes[second].body
    assert report.contacts is contacts
    assert (report.iterations, report.substeps, report.lock, report.converged) == (0, 1, 1.0, True)
    with pytest.raises(AttributeError):
        report.time = 1.0  # type: ignore[misc]
    assert copy.deepcopy(report).impulse.tolist() == [1.0, 2.0]
    assert "2 contacts" in repr(report)


@pytest.mark.parametrize("hooked", [False, True])
@pytest.mark.parametrize("what", ["gravity", "velocity", "spin"])
def test_energies_beyond_all_numbers_are_refused_and_nothing_changed(what: str, hooked: bool) -> None:
    space = swarm()
    body = next(iter(space.bodies))
    if hooked:
        space.on_collision(begin=lambda *_: None)
    stepper = ep.EECA(space)
    stepper.step(DT)
    if what == "gravity":
        space.gravity = (0.0, -1e300)
    elif what == "velocity":
        body.velocity = (1e200, 0.0)
    else:
        body.angular_velocity = 1e200
    before, time = state(space), stepper.time
    with pytest.raises(NotFiniteError, match=r"energy.*smaller dt"):
        stepper.step(DT)
    assert (state(space), stepper.time) == (before, time)
    space.gravity, body.velocity, body.angular_velocity = (0.0, 0.0), (0.0, 0.0), 0.0
    assert stepper.step(DT).ledger.residual < 1e-9
