"""Joints that may contradict one another, between the same two bodies, in chains and in loops: energy and momentum."""

from __future__ import annotations

import math
from itertools import pairwise
from random import Random
from typing import Any

import pymunk
import pytest

import eeca_pymunk as ep


def drawn(chance: Random, a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    """A joint between two bodies, where they are or apart."""
    at_a = chance.uniform(-0.6, 0.6), chance.uniform(-0.6, 0.6)
    at_b = chance.uniform(-0.6, 0.6), chance.uniform(-0.6, 0.6)
    if chance.random() < 0.5:
        x, y = b.world_to_local(a.local_to_world(at_a))
        at_b = x + chance.choice((0.0, 1e-9, 1e-6, 1e-3)), y
    turned, low = b.angle - a.angle, chance.uniform(0.0, 1.0)
    end = at_a[0] + chance.uniform(0.1, 1.0), at_a[1] + chance.uniform(-0.5, 0.5)
    least = chance.choice((turned, turned + 0.01, turned - 0.1, -0.2))
    return chance.choice((
        lambda: pymunk.PivotJoint(a, b, at_a, at_b),
        lambda: pymunk.PinJoint(a, b, at_a, at_b),
        lambda: pymunk.SlideJoint(a, b, at_a, at_b, low, low + chance.choice((0.0, 0.01, 0.5))),
        lambda: pymunk.GrooveJoint(a, b, at_a, end, at_b),
        lambda: pymunk.GearJoint(a, b, chance.choice((0.0, turned + 0.01)), chance.choice((1.0, -1.0, 2.0, 0.3))),
        lambda: pymunk.RotaryLimitJoint(a, b, least, least + chance.choice((0.0, 0.01, 0.3))),
        lambda: pymunk.RatchetJoint(a, b, chance.uniform(-1.0, 1.0), chance.choice((0.1, 0.5, -0.3))),
    ))()  # fmt: skip


def scene(seed: int) -> tuple[pymunk.Space, float]:
    """Bodies of masses up to 1 : 10^4 without weight and their joints; and a length of steps."""
    chance, space, bodies = Random(seed), pymunk.Space(), list[pymunk.Body]()
    shape, count = chance.choice(("free", "tied", "chain", "loop")), chance.randint(3, 6)
    count = count if shape in ("chain", "loop") else 2
    for k in range(count):
        mass, turn = 10.0 ** chance.uniform(-4.0, 0.0), 2.0 * math.pi * k / count
        body, radius = pymunk.Body(mass, mass * 10.0 ** chance.uniform(-3.0, 0.0)), count / (2.0 * math.pi)
        body.position = (radius * math.cos(turn), radius * math.sin(turn)) if shape == "loop" else (float(k), 0.0)
        body.velocity = chance.uniform(-1.0, 1.0), chance.uniform(-1.0, 1.0)
        body.angular_velocity = chance.uniform(-2.0, 2.0)
        space.add(body)
        bodies.append(body)
    pairs = list(pairwise(bodies)) + ([(bodies[-1], bodies[0])] if shape == "loop" else [])
    if shape == "tied":
        pairs.append((space.static_body, bodies[0]))
    for a, b in pairs:
        if shape in ("chain", "loop"):
            space.add(pymunk.PivotJoint(a, b, (a.position + b.position) / 2))
        for _ in range(chance.choice((0, 1)) if shape in ("chain", "loop") else chance.choice((2, 3))):
            space.add(drawn(chance, a, b))
    if shape == "chain":
        space.add(drawn(chance, bodies[0], bodies[-1]), drawn(chance, bodies[0], bodies[-1]))
    return space, chance.choice((1 / 240, 1 / 60, 1 / 30, 0.1))


def drift(space: pymunk.Space, start: list[float]) -> float:
    """How far the momentum of free bodies is from `start`, which has their momenta: over the sum of their magnitudes;
    0 if a joint holds a body on the ground."""
    if any(space.static_body in (joint.a, joint.b) for joint in space.constraints):
        return 0.0
    now = [body.mass * speed for body in space.bodies for speed in body.velocity]
    off = abs(sum(now[::2]) - sum(start[::2])) + abs(sum(now[1::2]) - sum(start[1::2]))
    return off / sum(map(abs, start))


def worst(seed: int, steps: int = 20) -> tuple[float, float, float]:
    """The largest rise of kinetic energy in a step, what the ledger is open by, over the energy at the start; and the
    largest `drift`."""
    space, dt = scene(seed)
    stepper = ep.EECA(space)
    start = last = ep.measure(space).kinetic
    momenta = [body.mass * speed for body in space.bodies for speed in body.velocity]
    rise = residual = moved = 0.0
    for _ in range(steps):
        ledger: Any = stepper.step(dt).ledger
        now = ep.measure(space).kinetic
        rise, residual = max(rise, (now - last) / start), max(residual, abs(ledger.residual) / start)
        last, moved = now, max(moved, drift(space, momenta))
    return rise, residual, moved


MORE = (205, 277, 300, 376, 431, 502, 609, 680, 709, 803, 834, 839, 908, 1074, 1123, 1137, 1168)


@pytest.mark.parametrize("seed", [*range(100), *MORE])
def test_joints_give_no_energy_and_no_momentum_whether_they_converge_or_not(seed: int) -> None:
    """Nothing drives them, and closing them lifts nothing."""
    rise, residual, moved = worst(seed)
    assert rise <= 1e-9
    assert residual <= 1e-9
    assert moved <= 1e-11
