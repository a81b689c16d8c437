"""Some random compositions; `python -m tests.programs.soak --compositions` plays thousands."""

from __future__ import annotations

import gc
import math
import pickle
import threading
from functools import partial
from itertools import pairwise

import pymunk
import pytest

import eeca_pymunk as ep

from .compositions import Composition, Found, stored
from .outside import Outside
from .seeds import play


@pytest.mark.parametrize("first", range(0, 200, 20))
def test_random_compositions_keep_the_laws(first: int) -> None:
    """Of thick shapes that do not fall far in a step: nobody leaves, energies are right, saved runs go on bitwise."""
    assert play(partial(Composition, thin=False), range(first, first + 20)) >= 5


@pytest.mark.parametrize("first", range(0, 80, 20))
def test_random_compositions_with_thin_shapes_keep_the_laws(first: int) -> None:
    """Rods, planks and segments without width, among walls without width that turn and shake: nobody leaves."""
    assert play(Composition, range(first, first + 20)) > 0


@pytest.mark.parametrize(("seed", "steps"), [(164, 4), (190, 6)])
def test_a_step_that_is_cut_short_gives_no_energy(seed: int, steps: int) -> None:
    """What lies in the part of a span that is not to be is neither lost nor lifted for: it gained 3e-5 of all."""
    Composition(seed).play(steps)


@pytest.mark.parametrize("length", [None, 1.7, 0.0])
def test_saved_steppers_know_the_lengths_of_pins(length: float | None) -> None:
    """pymunk's pickles do not have them, and measure the anchors: off by a round-off, or by all that a pin is apart."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    bodies = [pymunk.Body(1.0, 0.1) for _ in range(3)]
    for k, body in enumerate(bodies):
        body.position = 1.1 * k, 0.3 * k
        space.add(body, pymunk.Circle(body, 0.1))
    pins = [pymunk.PinJoint(a, b) for a, b in pairwise(bodies)]
    space.add(*pins, pymunk.PivotJoint(space.static_body, bodies[0], (0.0, 0.0)))
    if length is not None:
        pins[0].distance = length
    stepper = ep.EECA(space)
    for _ in range(7):
        stepper.step(1 / 60)
    other, again = pickle.loads(pickle.dumps((space, stepper)))
    for _ in range(20):
        stepper.step(1 / 60)
        again.step(1 / 60)
    assert [(*b.position, *b.velocity) for b in space.bodies] == [(*b.position, *b.velocity) for b in other.bodies]
    assert sorted(pin.distance for pin in pins) == sorted(
        c.distance for c in other.constraints if isinstance(c, pymunk.PinJoint)
    )


def test_hits_that_cut_solves_of_contacts_short_gain_no_energy() -> None:
    """Friction of an island that is hit has given energy up to the hit: step 98 gained 1.9e-6 of all, converged."""
    Composition(135, thin=False).play(100)


def test_compositions_in_threads_go_the_same_ways() -> None:
    """Each space has its own stepper: threads change no bit."""
    scenes: list[Composition] = []

    def run(seed: int, out: dict[int, list[tuple[float, ...]]]) -> None:
        scene = Composition(seed, thin=False)
        scenes.append(scene)
        for k in range(30):
            scene.drive(k)
            scene.stepper.step(scene.dt)
        out[seed] = scene.state()

    seeds = (0, 1, 2, 3)
    together: dict[int, list[tuple[float, ...]]] = {}
    workers = [threading.Thread(target=run, args=(seed, together)) for seed in seeds]
    # pymunk frees its spaces in whatever thread they become garbage, which is not safe: none does meanwhile.
    gc.collect()
    gc.disable()
    try:
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
    finally:
        gc.enable()
    alone: dict[int, list[tuple[float, ...]]] = {}
    for seed in seeds:
        run(seed, alone)
    assert together == alone


def test_a_composition_that_breaks_a_law_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Energy that is not in the ledger, as of a push between steps, is none of ours; a container too small is."""
    scene = Composition(0, thin=False)
    monkeypatch.setattr(scene, "half", 0.1 * scene.half)
    with pytest.raises(AssertionError, match="outside"):
        scene.play(10)
    assert isinstance(Composition(1, thin=False).play(5), Found)


@pytest.mark.parametrize(
    ("seed", "steps"),
    [
        (76, 101),  # corners that closed by round-off: 100 000 impacts without impulse
        (296, 60),  # of bodies that overlap, a corner beside their common face
        (338, 9),  # a body that turns fast while it hops came through, by half its size
        (660, 2),  # forecasts of what never came changed on which side a segment was
        (560, 42),  # what a turning wall presses was never lifted, and went ever deeper
    ],
)
def test_kinds_that_broke_the_laws_in_steep_compositions(seed: int, steps: int) -> None:
    """Scenes of a millimetre and metre in steps in which bodies fall through many times their size."""
    Composition(seed).play(steps)


def test_time_goes_on_where_corners_close_by_round_off() -> None:
    """A polygon whose corner in a floor has a speed of 1e-19 of the others': its impacts have no impulse."""
    scene = Composition(121)
    for k in range(40):
        scene.drive(k)
        report = scene.stepper.step(scene.dt)
        assert all(u.name != "solves" for u in report.unmet)


class Generous(ep.EECA):
    """Books a part of what friction takes, or of the energy, as external."""

    def step(self, dt: float) -> ep.StepReport:
        report = super().step(dt)
        assert report._book is not None
        book = report._book.copy()
        book[0] += 1e-9 * abs(book[5])
        book[2] += 1e-9 * abs(book[5])
        report._book = book
        return report


@pytest.mark.parametrize("joints", [False, True])
def test_work_from_nowhere_is_found(joints: bool) -> None:
    """A ledger that closes, of a scene that nothing acts on: its energy from outside and its losses are both wrong."""
    scene = next(
        scene
        for scene in (Composition(seed, joints) for seed in range(99))
        if not scene.turns and all(math.isinf(joint.max_force) for joint in scene.space.constraints)
    )
    scene.stepper = Generous(scene.space)
    with pytest.raises(AssertionError, match=r"from outside, 0\.0e"):
        scene.play(10)


@pytest.mark.parametrize("first", range(0, 60, 20))
def test_joints_bring_no_more_energy_than_their_bounds_do(first: int) -> None:
    """What joints book as external is at most `max_force` times the way, and 0 without such a joint."""
    assert play(partial(Composition, joints=True), range(first, first + 20), 10) > 0


def test_a_container_that_lifts_a_body_against_a_spring_does_the_work_that_the_spring_stores() -> None:
    """Without gravity, and though a step that ends early has no impulse to report for it (random scene 23000263)."""
    space, box = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    box.velocity = 0.0, 1e-6
    body = pymunk.Body(1.0, math.inf)
    body.position = 0.0, 0.5
    disk = pymunk.Circle(body, 0.6)
    spring = pymunk.DampedSpring(space.static_body, body, (0.0, 2.0), (0.0, 0.0), 2.0, 100.0, 0.0)
    space.add(box, body, pymunk.Segment(box, (-9.0, 0.0), (9.0, 0.0), 0.0), disk, spring)
    outside, stepper, before = Outside(space, box, False), ep.EECA(space), stored(space)
    report = stepper.step(1e-3)
    assert report.ledger is not None
    assert body.position.y > 0.5
    assert 0.0 < report.ledger.external <= outside.most(report, 1e-3, True)
    assert report.ledger.external == pytest.approx(ep.measure(space).kinetic + stored(space) - before, rel=1e-9)


@pytest.mark.parametrize("kind", ["disk", "box"])
def test_what_overlaps_a_moving_container_has_a_depth_whatever_pymunk_calls_its_distance(kind: str) -> None:
    """Lifting it out of a wall of radius 0.2 is the work of the container, though there is no impulse to report."""
    space, box = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    box.velocity = 1.0, 0.0
    body = pymunk.Body(1.0, 1.0)
    body.position = 0.0, 0.69
    shape = pymunk.Circle(body, 0.5) if kind == "disk" else pymunk.Poly.create_box(body, (1.0, 1.0))
    space.add(box, body, pymunk.Segment(box, (-9.0, 0.0), (9.0, 0.0), 0.2), shape)
    assert Outside(space, box, False).depth == pytest.approx(0.01)
