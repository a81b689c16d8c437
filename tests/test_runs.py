"""A run is its steps, bit by bit: in compiled code, and where functions are called in between."""

from __future__ import annotations


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
