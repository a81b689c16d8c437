"""Intervals that are cut short give no energy (`islands/excess.py`)."""

from __future__ import annotations

import pymunk
import pytest

import eeca_pymunk as ep

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
