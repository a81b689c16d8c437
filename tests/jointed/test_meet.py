"""Intervals of islands with joints that are brought to an instant: their paths lead through nobody."""

from __future__ import annotations

import math
from itertools import pairwise

import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.jointed import meet as meetings
from eeca_pymunk.jointed import paths
from eeca_pymunk.jointed.ends import shorten
from eeca_pymunk.jointed.meet import end_before, meet
from eeca_pymunk.jointed.paths import passes
from eeca_pymunk.jointed.solve import open_span
from eeca_pymunk.model.joint_steps import LINEAR
from eeca_pymunk.model.joints import Joints
from eeca_pymunk.model.scene import Scene

G, SPEED, RADIUS = 10.0, 20.0, 0.2


def falling(h: float, high: float) -> tuple[Scene, Joints]:
    """A disk on a long rope, its row is 0, that has begun an interval h in which it falls on a floor `high` below."""
    space = pymunk.Space()
    space.gravity = 0.0, -G
    body = pymunk.Body(2.0, 1.0)
    body.position, body.velocity = (0.0, high), (0.0, -SPEED)
    disk = pymunk.Circle(body, RADIUS)
    floor = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
    disk.elasticity = floor.elasticity = 1.0
    space.add(body, disk, floor, pymunk.SlideJoint(space.static_body, body, (0, high), (0, 0), 0.0, 99.0))
    stepper = ep.EECA(space)
    stepper.step(1e-9)
    assert stepper.event_loop is not None
    A, J = stepper.event_loop.scene, stepper.event_loop.joints
    A.PAR.dt = A.PAR.planned = h
    A.BODY[0].since, A.BODY[0].y, A.BODY[0].vy = 0.0, high, -SPEED
    assert open_span(A, J, 0, 0.0, h, True)[0] == 0
    return A, J


@pytest.mark.parametrize("h", [0.01, 0.06, 0.1, 0.5, 5.0])
def test_a_path_through_a_wall_is_seen_wherever_it_ends(h: float) -> None:
    """In the wall, just behind it, where its other side is near, or far away."""
    A, _ = falling(h, 1.0)
    assert (passes(A, 0, h) <= h) == (SPEED * h + 0.5 * G * h * h > 1.0 - RADIUS)


@pytest.mark.parametrize("h", [0.01, 0.1, 0.5, 1.0])
def test_an_interval_that_would_lead_through_a_wall_ends_before(h: float) -> None:
    """Its body stays on its side, with the energy that it had, until the instant that it is brought to."""
    A, J = falling(2.0 * h, 1.0)
    shorten(A, J, 0, h)
    assert end_before(A, J, 0, h, False, False) == (h > 0.01)
    assert (J.TALLY.worst == LINEAR) == (h > 0.01)
    body = A.BODY[0]
    assert (body.since, A.MEMBER[0].open) == (h, 0)
    assert RADIUS <= body.y <= 1.0
    assert 0.5 * body.vy**2 + G * body.y == pytest.approx(0.5 * SPEED**2 + G, rel=1e-12)
    if h == 0.01:
        assert body.y == pytest.approx(1.0 - SPEED * h - 0.5 * G * h * h, rel=1e-12)


def test_the_path_is_looked_at_once_however_many_instants_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Instants before the impact are tried, from which the disk is seen to meet the floor."""
    A, J = falling(0.1, 1.0)
    seen, tried = [], []

    def looked(A: Scene, root: int, t: float) -> float:
        seen.append(root)
        return passes(A, root, t)

    def shortened(A: Scene, J: Joints, root: int, t: float) -> int:
        tried.append(root)
        return shorten(A, J, root, t)

    monkeypatch.setattr(meetings, "passes", looked)
    monkeypatch.setattr(meetings, "shorten", shortened)
    t, _ = meet(A, J, 0, 1, 0.03)
    assert SPEED * t + 0.5 * G * t * t == pytest.approx(1.0 - RADIUS, rel=1e-6)
    assert tried.count(0) > 2
    assert seen.count(0) == 1


def test_pairs_of_an_island_are_looked_at_once_each(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of shapes that are in each other's lists; and looking through lists is work."""
    space, n = pymunk.Space(), 6
    bodies = [pymunk.Body(1.0, 1.0) for _ in range(n)]
    for k, body in enumerate(bodies):
        body.position = k, 0.0
        space.add(body, pymunk.Circle(body, RADIUS))
    space.add(*(pymunk.SlideJoint(a, b, (0, 0), (0, 0), 0.0, 9.0) for a, b in pairwise(bodies)))
    stepper = ep.EECA(space)
    stepper.step(1e-9)
    assert stepper.event_loop is not None
    A, J = stepper.event_loop.scene, stepper.event_loop.joints
    assert open_span(A, J, A.STATE[0].island, 0.0, 1e-9, True)[0] == 0
    pairs: list[tuple[int, int]] = []

    def met(A: Scene, a: int, b: int, t: float) -> tuple[float, bool]:
        pairs.append((min(a, b), max(a, b)))
        return math.inf, False

    monkeypatch.setattr(paths, "first_meeting", met)
    A.COUNT.work = 0
    assert passes(A, A.STATE[0].island, 1e-9) == math.inf
    assert len(pairs) == len(set(pairs)) == n * (n - 1) // 2
    assert A.COUNT.work > 0
