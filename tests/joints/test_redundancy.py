"""Cycles of joints whose rows are independent begin with the impulses of the last step, as joints without cycles."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from comparisons.program_joints import six_legs
from eeca_pymunk.model.joints import DEPENDENT, INDEPENDENT, UNTESTED


def four_bars() -> pymunk.Space:
    """A crank, a rod and a rocker."""
    space, bars = pymunk.Space(), list[pymunk.Body]()
    space.gravity = 0.0, -9.81
    places = [pymunk.Vec2d(*p) for p in ((0.0, 0.0), (1.0, 0.0), (3.0, 0.0), (3.0, -2.0))]
    for p, q in pairwise(places):
        bar = pymunk.Body(1.0, (q - p).length ** 2 / 12.0)
        bar.position, bar.angle = (p + q) / 2, (q - p).angle
        bars.append(bar)
    space.add(*bars)
    ends = [space.static_body, *bars, space.static_body]
    space.add(*(pymunk.PivotJoint(a, b, p) for (a, b), p in zip(pairwise(ends), places, strict=True)))
    return space


def swing() -> pymunk.Space:
    """A bar on three parallel pins of one length: two of them hold it as all three do."""
    space, bar = pymunk.Space(), pymunk.Body(1.0, 0.1)
    space.gravity, bar.position = (0.0, -9.81), (0.5, -1.0)
    space.add(bar, *(pymunk.PinJoint(space.static_body, bar, (0.5 + x, 0.0), (x, 0.0)) for x in (-0.5, 0.0, 0.5)))
    return space


def rope() -> pymunk.Space:
    """Two pins, without a cycle."""
    space = pymunk.Space()
    a, b = pymunk.Body(1.0, 0.1), pymunk.Body(1.0, 0.1)
    a.position, b.position = (1.0, 0.0), (2.0, 0.0)
    space.add(a, b, pymunk.PinJoint(space.static_body, a), pymunk.PinJoint(a, b))
    return space


def joints_of(stepper: ep.EECA) -> Any:
    assert stepper.event_loop is not None
    return stepper.event_loop.joints


@pytest.mark.parametrize(
    ("space", "found"),
    [(four_bars(), INDEPENDENT), (swing(), DEPENDENT), (rope(), UNTESTED)],
    ids=["linkage", "swing", "rope"],
)
def test_which_rows_depend_on_one_another(space: pymunk.Space, found: int) -> None:
    stepper = ep.EECA(space)
    stepper.step(1e-4)
    assert joints_of(stepper).COMPONENT[0].dependence == found


def test_a_walker_begins_each_solution_with_its_last_impulses() -> None:
    """59 000 operations for each joint in a step; 326 000 if each begins without them."""
    space, dt, _ = six_legs()
    stepper, efforts = ep.EECA(space), []
    for _ in range(120):
        stepper.step(dt)
        efforts.append(joints_of(stepper).PROGRESS.effort)
    assert np.mean(efforts[20:]) / len(space.constraints) < 120_000.0
