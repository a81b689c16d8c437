"""Warming up changes nothing that programs see, and everything it steps is a scene whose laws hold."""

from __future__ import annotations

import pymunk

import eeca_pymunk as ep
from eeca_pymunk.space.small_space import changes, small_space

WEIGHTS = 10 * 10.0 * 2.0  # J, of its bodies: number, gravity, height


def test_the_small_space_keeps_its_energy_ledger_and_uses_what_programs_use() -> None:
    space = small_space()
    stepper = ep.EECA(space)
    contacts = 0
    for _ in changes(space):
        report = stepper.step(0.01)
        contacts += len(report.contacts)
        assert report.converged
        assert abs(report.ledger.residual) <= 1e-13 * WEIGHTS
    assert contacts > 0
    assert stepper.reads > 8  # so often is a function called before Python specialises its code
    assert stepper.patches > 8


def test_warming_up_once_is_enough_and_leaves_spaces_alone() -> None:
    ep.warmup()
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    body.velocity = 1.0, 2.0
    space.add(body, pymunk.Circle(body, 1.0))
    assert ep.warmup() < 0.1
    assert (body.position, body.velocity) == ((0.0, 0.0), (1.0, 2.0))
    assert space.bodies == {body: None}.keys()
