"""A stepper that takes over a moving mechanism keeps its energy; velocities that a program gives are projected."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable

import pymunk
import pytest

import eeca_pymunk as ep

G = 9.81


def chain(links: int) -> pymunk.Space:
    """A chain of rods of length 1, held out horizontally by one end."""
    space, last = pymunk.Space(), None
    space.gravity = 0.0, -G
    for k in range(links):
        link = pymunk.Body(1.0, 1 / 12)
        link.position = k + 0.5, 0.0
        space.add(link, pymunk.PivotJoint(last or space.static_body, link, (k, 0.0)))
        last = link
    return space


def anew(space: pymunk.Space, stepper: ep.EECA) -> ep.EECA:
    return ep.EECA(space)


def refreshed(space: pymunk.Space, stepper: ep.EECA) -> ep.EECA:
    stepper.refresh()
    return stepper


def copied(space: pymunk.Space, stepper: ep.EECA) -> ep.EECA:
    return ep.EECA(copy.deepcopy(space))


def set_back(space: pymunk.Space, stepper: ep.EECA) -> ep.EECA:
    stepper.set_state([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies])
    return stepper


@pytest.mark.parametrize("take", [anew, refreshed, copied, set_back])
@pytest.mark.parametrize(("links", "dt"), [(1, 0.1), (2, 1 / 60), (2, 1 / 30), (5, 1 / 60)])
def test_whoever_takes_over_goes_on_with_the_energy(
    links: int, dt: float, take: Callable[[pymunk.Space, ep.EECA], ep.EECA]
) -> None:
    """However fast the mechanism moves, and though velocities at its joints are no more exact than steps are."""
    space = chain(links)
    stepper, scale = ep.EECA(space), 0.5 * G * links**2
    for _ in range(round(4.0 / dt / 7)):
        for _ in range(6):
            stepper.step(dt)
        stepper = take(space, stepper)
        space = stepper.space
        before = ep.measure(space).energy
        report = stepper.step(dt)
        assert report.converged
        assert ep.measure(space).energy == pytest.approx(before, abs=1e-12 * scale)


@pytest.mark.parametrize("off", [20.0, 70.0, 90.0])
def test_velocities_that_a_program_gives_are_projected(off: float) -> None:
    """A bob on a pin, thrown at an angle to its circle, keeps the part along it: an impact without bounce."""
    space, bob = pymunk.Space(), pymunk.Body(1.0, 1.0)
    bob.position = 1.0, 0.0
    bob.velocity = 3.0 * math.sin(math.radians(off)), 3.0 * math.cos(math.radians(off))
    space.add(bob, pymunk.PinJoint(space.static_body, bob))
    report = ep.EECA(space).step(1 / 60)
    assert report.ledger is not None
    assert report.ledger.restitution == pytest.approx(4.5 * math.sin(math.radians(off)) ** 2, rel=1e-9)
    assert bob.velocity.length == pytest.approx(3.0 * math.cos(math.radians(off)), abs=1e-12)
