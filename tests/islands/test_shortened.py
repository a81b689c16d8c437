"""Intervals that are cut short give no energy (`islands/shortened.py`)."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.records import rows
from eeca_pymunk.geometry.flight import move_to
from eeca_pymunk.islands import shortened
from eeca_pymunk.islands.shortened import losses_up_to, repay, scale_impulses
from eeca_pymunk.model.bodies import Body, Member, Next
from eeca_pymunk.model.contacts import Pair, Pushed
from eeca_pymunk.model.shapes import Link
from tests.packed import scene_with

G, RISE, FALL, HIT, DT = 10.0, 0.2, -5.0, 0.02, 0.05  # m/s^2, m/s, m/s, s, s


@pytest.mark.parametrize("on_plank", [False, True])
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_what_would_land_later_flies_freely_and_what_rests_keeps_its_force(size: float, on_plank: bool) -> None:
    """A block rises from what it stands on, a plank on the floor or the floor beside the plank, and would land softly
    within the step: its contact pushes from the start of the interval on, as it has to over the whole. A ball falls on
    the block about HIT later, at t. The impact shows where all are then: the block at RISE t - G t^2 / 2, the plank on
    the floor. With the force of the landing the block would be lower, without that of the floor the plank 2 mm.

    Lengths and accelerations are scaled by `size`."""
    space = pymunk.Space()
    space.gravity = 0.0, -G * size
    floor = pymunk.Segment(space.static_body, (-9.0 * size, 0.0), (9.0 * size, 0.0), 0.0)
    plank, block, ball = (pymunk.Body(1.0, size * size) for _ in range(3))
    x, below = (0.0, 0.2 * size) if on_plank else (3.0 * size, 0.0)
    plank.position, block.position, ball.position = (0.0, 0.1 * size), (x, below + 0.2 * size), (x, 9.0 * size)
    shapes = (
        floor, pymunk.Poly.create_box(plank, (2.0 * size, 0.2 * size)),
        pymunk.Poly.create_box(block, (0.4 * size, 0.4 * size)), pymunk.Circle(ball, 0.1 * size),
    )  # fmt: skip
    shapes[2].elasticity = shapes[3].elasticity = 1.0
    space.add(plank, block, ball, *shapes)
    stepper = ep.EECA(space)
    for _ in range(2):
        stepper.step(DT)
    block.velocity, ball.velocity = (0.0, RISE * size), (0.0, FALL * size)
    ball.position = x, below + 0.5 * size + (RISE - FALL) * HIT * size
    report = stepper.step(DT)
    contacts, seen = report.contacts, set()
    for i in range(len(contacts)):
        if contacts.duration[i] > 0.0:
            continue
        pair = {contacts.bodies[contacts.body_a[i]], contacts.bodies[contacts.body_b[i]]}
        t, y = contacts.time[i], contacts.point[i, 1]
        if pair == {plank, space.static_body}:
            assert y == pytest.approx(0.0, abs=1e-9 * size)
            seen.add("plank")
        elif ball not in pair:
            # Halfway between the block and what is below.
            assert y - below == pytest.approx(0.5 * (RISE * t - 0.5 * G * t * t) * size, abs=1e-9 * size)
            seen.add("block")
    assert seen == ({"plank", "block"} if on_plank else {"block"})
    assert report.ledger.restitution >= 0.0
    assert abs(report.ledger.residual) <= 1e-13 * size * size


@pytest.mark.parametrize("t", [0.05, 0.3, 1.0, 1.4])
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_scaled_impulses_give_no_energy(size: float, t: float) -> None:
    """A body of mass 1 that rises from a floor with 2 m/s and is to be at rest after 1.4 s, by a force from the start
    on. Cut after t, kinetic and potential energy are what they were: with no force before t = 0.4, when it falls. What
    rests on the floor beside it, in the same island, has given nothing: it keeps its force, and does not sink."""
    g, v, h = G * size, 2.0 * size, 1.4
    body, pushed, by, link, member = rows(Body, 3), rows(Pushed, 2), rows(Pair, 2), rows(Link, 3), rows(Member, 3)
    body[0].inv_mass, body[0].vy, body[0].ay, body[1].inv_mass = 1.0, v, -v / h, 1.0
    pushed[0].normal, pushed[0].un_before, pushed[1].normal = g * h - v, v, g * h
    for k in range(3):
        link[k].owner = k
    for k in range(2):
        pushed[k].length, pushed[k].ny, by[k].a, by[k].b = h, 1.0, 2, k
    member[0].following, member[1].following, member[0].bodies = 1, -1, 2
    scene = scene_with(
        BODY=body, PUSHED=pushed, PUSHED_BY=by, LINK=link, MEMBER=member, STATE=rows(Next, 3),
        PULL=np.array([[0.0, -g, 0.0], [0.0, -g, 0.0], [0.0, 0.0, 0.0]]), PLACE=np.full(3, -1),
    )  # fmt: skip
    scene.COUNT.pushes = 2
    scale_impulses(scene, 0, t)
    move_to(body, 0, t)
    assert pushed[1].normal == g * h
    assert body[1].ay == 0.0
    assert sum(losses_up_to(scene, 0, t)) == 0.0
    assert 0.5 * body[0].vy ** 2 + g * body[0].y == pytest.approx(0.5 * v * v, rel=1e-12)
    if t < 0.4:
        assert body[0].vy == pytest.approx(v - g * t, abs=1e-12 * size)
        assert pushed[0].normal == 0.0
    else:
        assert pushed[0].normal > 0.0


def test_places_of_an_impact_stay_as_intervals_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """An impact gathers its bodies, the first body here at place 5, while it ends their intervals, which may have to be
    solved again: that had taken the place away, and put bodies twice, beyond the end of the list."""
    body, pushed, by, link, member = rows(Body, 2), rows(Pushed, 1), rows(Pair, 1), rows(Link, 2), rows(Member, 2)
    body[0].inv_mass, body[0].vy, body[0].ay = 1.0, 2.0, -2.0
    pushed[0].normal, pushed[0].un_before, pushed[0].length, pushed[0].ny = 8.0, 2.0, 1.0, 1.0
    by[0].a, by[0].b, link[1].owner, member[0].following, member[0].bodies = 1, 0, 1, -1, 1
    scene = scene_with(
        BODY=body, PUSHED=pushed, PUSHED_BY=by, LINK=link, MEMBER=member, STATE=rows(Next, 2),
        PULL=np.array([[0.0, -10.0, 0.0], [0.0, 0.0, 0.0]]), PLACE=np.array([5, -1]),
    )  # fmt: skip
    scene.COUNT.pushes = 1
    monkeypatch.setattr(shortened, "solve_again", lambda A, root, t, first, end: scale_impulses(A, root, t))
    repay(scene, 0, 0.1)
    assert pushed[0].normal == 0.0
    assert list(scene.PLACE) == [5, -1]
