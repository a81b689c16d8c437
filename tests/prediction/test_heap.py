"""The heap of events, and when shapes leave their margin circles."""

from __future__ import annotations

import heapq
import math

import numpy as np
import pytest

from eeca_pymunk.compiled.records import columns, rows
from eeca_pymunk.model.bodies import POSE, VELOCITY, Body
from eeca_pymunk.model.scene import Scene
from eeca_pymunk.model.shapes import Mark
from eeca_pymunk.prediction.heap import pop, push_event, sweep_out
from eeca_pymunk.prediction.next_event import inside_until, margin_used
from tests.packed import Thing, World, box, disk


@pytest.mark.parametrize("ties", [False, True])
def test_events_come_out_by_time_and_then_by_body(ties: bool) -> None:
    rng = np.random.default_rng(0)
    time, of = np.zeros(500), np.zeros(500, np.int64)
    n, reference = 0, list[tuple[float, int]]()
    for _ in range(3000):
        if n < 500 and (n == 0 or rng.uniform() < 0.55):
            event = (float(rng.integers(0, 8)) if ties else float(rng.uniform()), int(rng.integers(0, 50)))
            n = push_event(time, of, n, *event)
            heapq.heappush(reference, event)
        else:
            assert (time[0], of[0]) == heapq.heappop(reference)
            n = pop(time, of, n)
        assert n == len(reference)
    while n > 0:
        assert (time[0], of[0]) == heapq.heappop(reference)
        n = pop(time, of, n)


def test_sweeping_keeps_what_is_due_in_order() -> None:
    rng = np.random.default_rng(1)
    body = rows(Body, 40)
    body["due"] = rng.uniform(size=40)
    time, of, n = np.zeros(200), np.zeros(200, np.int64), 0
    for i in rng.permutation(40).tolist():
        n = push_event(time, of, n, float(body["due"][i]), i)
        for _ in range(int(rng.integers(0, 4))):  # forecasts of before
            n = push_event(time, of, n, float(rng.uniform()), i)
    assert n > 60
    n = sweep_out(time, of, n, body)
    assert n == 40
    found = []
    while n > 0:
        found.append((float(time[0]), int(of[0])))
        n = pop(time, of, n)
    assert found == sorted((float(body["due"][i]), i) for i in range(40))


def wanderer(rng: np.random.Generator, turning: bool, pulled: bool, unit: float) -> World:
    """One body with its margin circle somewhere about it: a lone disk, or a box off its centre of mass."""
    shapes = [([(x + 0.3, y) for x, y in box(0.2, 0.1)[0][0]], 0.0)] if turning else disk(0.1)
    shapes = [([(unit * x, unit * y) for x, y in v], unit * r) for v, r in shapes]
    rate, pull = rng.normal(size=(2, 3)) * (unit, unit, 2.0)
    thing = Thing(
        shapes, tuple(rng.uniform(-1.0, 1.0, 3) * unit), (*rate[:2], rate[2] * turning), tuple(pull * pulled),
        since=float(rng.uniform(0.0, 0.1)),
    )  # fmt: skip
    return World([thing])


def marked(world: World, x: float, y: float, margin: float) -> Scene:
    """The world with the margin circle of its one shape about (x, y)."""
    mark = rows(Mark, 1)
    mark[0].x, mark[0].y, mark[0].margin = x, y, margin
    return world.scene._replace(MARK=mark)


def centre_at(world: World, t: float) -> np.ndarray:
    body, shape = world.body[0], world.shape[0]
    s = t - body.since
    x, y, angle = columns(body, *POSE) + (columns(body, *VELOCITY) + 0.5 * columns(body, "ax", "ay", "angular") * s) * s
    kx, ky = shape.centre_x, shape.centre_y
    return np.array([x + math.cos(angle) * kx - math.sin(angle) * ky, y + math.sin(angle) * kx + math.cos(angle) * ky])


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(("turning", "pulled"), [(False, False), (False, True), (True, False), (True, True)])
def test_nobody_leaves_before_the_instant_told(turning: bool, pulled: bool, unit: float) -> None:
    rng = np.random.default_rng(2)
    for _ in range(50):
        world = wanderer(rng, turning, pulled, unit)
        margin = unit * float(10.0 ** rng.uniform(-2.0, 0.0))
        now = float(world.body["since"][0]) + (float(rng.uniform(0.0, 3.0)) if rng.uniform() < 0.7 else 0.0)
        place = centre_at(world, now) + margin * rng.uniform(-0.6, 0.6, 2)
        scene = marked(world, float(place[0]), float(place[1]), margin)
        looks = 0
        while True:
            t = inside_until(scene, 0, 0, now)
            assert t >= now
            for instant in np.linspace(now, t, 20):
                assert np.hypot(*(centre_at(world, instant) - place)) <= margin * (1.0 + 1e-9)
            if margin_used(scene, 0, t):
                break
            looks += 1
            now = t
            assert looks < 100
        if not turning:
            assert looks <= (4 if pulled else 0)
        if not (turning or pulled):
            assert np.hypot(*(centre_at(world, t) - place)) == pytest.approx(margin, rel=1e-9)


@pytest.mark.parametrize("speed", [0.0, 1.0, -1.0])
@pytest.mark.parametrize("pull", [0.0, 1.0])
def test_who_was_put_elsewhere_has_left_already(speed: float, pull: float) -> None:
    # At rest, or on its way through the circle, which it leaves again later.
    world = World([Thing(disk(0.1), (5.0, 0.0, 0.0), (speed, 0.0, 0.0), (pull, 0.0, 0.0))])
    scene = marked(world, 0.0, 0.0, 1.0)
    assert inside_until(scene, 0, 0, 0.0) == 0.0
    assert margin_used(scene, 0, 0.0)


def test_who_rests_or_knows_everybody_never_leaves() -> None:
    world = World([Thing(disk(0.1), (0.5, 0.0, 0.0))])
    for margin in (1.0, math.inf):
        scene = marked(world, 0.0, 0.0, margin)
        assert inside_until(scene, 0, 0, 0.0) == math.inf


def test_entries_that_are_alike_are_swept_out() -> None:
    rng = np.random.default_rng(1)
    body = rows(Body, 20)
    body["due"] = rng.integers(0, 8, 20) / 8.0
    time, of, n = np.zeros(400), np.zeros(400, np.int64), 0
    for _ in range(400):
        i = int(rng.integers(20))
        n = push_event(time, of, n, float(body["due"][i] if rng.random() < 0.7 else rng.random()), i)
    valid = {(float(time[k]), int(of[k])) for k in range(n) if time[k] == body["due"][of[k]]}
    n = sweep_out(time, of, n, body)
    out = []
    while n > 0:
        out.append((float(time[0]), int(of[0])))
        n = pop(time, of, n)
    assert out == sorted(valid)
