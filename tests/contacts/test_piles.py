"""Stacks, heaps and free islands: what must not move does not, energy never rises, the ledger closes."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from eeca_pymunk.compiled.records import row, rows
from eeca_pymunk.contacts.forces import copy_recent, find, row_for
from eeca_pymunk.model.contacts import Force
from eeca_pymunk.model.step import Count

from ..packed import Thing, World, box, disk
from .pile import Pile

G = 9.81
UNITS = [1e-3, 1.0, 1e3]


def floor(unit: float) -> list[tuple[list[tuple[float, float]], float]]:
    return [([(-100.0 * unit, 0.0), (100.0 * unit, 0.0)], 0.0)]


def stack(masses: list[float], unit: float = 1.0) -> Pile:
    things = [Thing(box(unit, unit), (0.0, unit * (0.5 + i), 0.0)) for i in range(len(masses))]
    mass = np.array(masses)
    return Pile(World(things, floor(unit)), mass, mass * unit**2 / 6, (0.0, -G * unit), 0.0, 0.5)


def pyramid(rows: int) -> Pile:
    things = [Thing(box(1, 1), (1.1 * (i + 0.5 * j), 0.5 + j, 0.0)) for j in range(rows) for i in range(rows - j)]
    n = len(things)
    return Pile(World(things, floor(1.0)), np.ones(n), np.full(n, 1 / 6), (0.0, -G), 0.0, 0.5)


def heap(kind: str, count: int, e: float, mu: float, unit: float = 1.0) -> Pile:
    """Bodies that fall into a box."""
    rng = np.random.default_rng(1)
    side = int(math.sqrt(count))
    width = 1.2 * side * unit
    shapes = disk(0.5 * unit) if kind == "disk" else box(0.9 * unit, 0.9 * unit)
    things = [
        Thing(shapes, (unit * (1.2 * (i % side) + 0.1 * rng.random()), unit * (0.7 + 1.2 * (i // side)), rng.random()))
        for i in range(count)
    ]
    left, right, top = -unit, width, 3 * width
    walls = [
        ([(left, 0.0), (right, 0.0)], 0.0), ([(left, 0.0), (left, top)], 0.0), ([(right, 0.0), (right, top)], 0.0)
    ]  # fmt: skip
    moment = (1 / 8 if kind == "disk" else 0.9**2 / 6) * unit**2
    return Pile(World(things, walls), np.ones(count), np.full(count, moment), (0.0, -G * unit), e, mu)


def check(pile: Pile, scale: float) -> None:
    """The books of a run: closed, losses not negative, energy never rising; all relative to an energy."""
    assert pile.worst_closure <= 1e-12 * scale
    assert pile.least_loss >= -1e-12 * scale
    assert pile.rise <= 1e-12 * scale


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("count", [2, 10])
def test_stack_stands_still(count: int, unit: float) -> None:
    pile = stack([1.0] * count, unit)
    start, energy = pile.pose.copy(), pile.energy()
    pile.run(300, 1 / 60)
    assert np.abs(pile.pose - start).max() <= 1e-8 * unit
    check(pile, energy)


@pytest.mark.parametrize("masses", [[1.0] * 50, [1.0, 10.0, 100.0, 1000.0], [1000.0, 100.0, 10.0, 1.0], [1.0, 1000.0]])
def test_tall_and_uneven_stacks_stand_still(masses: list[float]) -> None:
    pile = stack(masses)
    start = pile.pose.copy()
    pile.run(300, 1 / 60)
    assert np.abs(pile.pose - start).max() <= 1e-8
    weight = G * sum(masses)
    assert pile.L[np.flatnonzero(pile.B[: pile.m] == pile.n), 0].sum() * 60 == pytest.approx(weight, rel=1e-9)


def test_pyramid_stands_still() -> None:
    pile = pyramid(12)
    start = pile.pose.copy()
    pile.run(200, 1 / 60)
    assert np.abs(pile.pose - start).max() <= 1e-8


@pytest.mark.parametrize("kind", ["disk", "box"])
@pytest.mark.parametrize(("e", "mu"), [(0.0, 0.5), (0.3, 0.5), (0.8, 0.1), (1.0, 0.3)])
def test_heaps_only_lose_energy(kind: str, e: float, mu: float) -> None:
    pile = heap(kind, 9, e, mu)
    energy = pile.energy()
    pile.run(400, 1 / 60)  # disks roll on others for long
    check(pile, energy)
    if e < 0.5:
        assert pile.kinetic() <= 1e-6 * energy
    inside = pile.pose[: pile.n]
    assert (inside[:, 1] > 0.3).all()
    assert (np.abs(inside[:, 0] - 1.3) < 2.4).all()


def test_push_out_takes_no_more_energy_than_was_lost() -> None:
    """Boxes that begin deep in each other on a floor: nothing moves up without losses to pay for it."""
    things = [Thing(box(1, 1), (0.0, 0.4, 0.0)), Thing(box(1, 1), (0.1, 1.2, 0.05), (0.0, -0.5, 0.0))]
    pile = Pile(World(things, floor(1.0)), [1.0, 1.0], [1 / 6, 1 / 6], (0.0, -G), 0.0, 0.5)
    energy = pile.energy()
    pile.run(100, 1 / 60)
    check(pile, energy)
    assert 0.0 < pile.ledger.lifted <= (pile.ledger.restitution + pile.ledger.friction) * (1 + 1e-12)


@pytest.mark.parametrize("unit", UNITS)
def test_heaps_do_not_know_their_unit(unit: float) -> None:
    pile = heap("box", 12, 0.2, 0.4, unit)
    energy = pile.energy()
    pile.run(100, 1 / 60)
    check(pile, energy)
    assert abs(pile.deepest) <= 0.1 * unit


@pytest.mark.parametrize("kind", ["disk", "box"])
def test_elastic_heap_keeps_its_energy(kind: str) -> None:
    pile = heap(kind, 20, 1.0, 0.0)
    energy = pile.energy()
    pile.run(300, 1 / 60)
    assert pile.energy() == pytest.approx(energy, rel=1e-12)
    assert pile.kinetic() > 1e-2 * energy


def clump(e: float, mu: float, unit: float, drift: float = 0.0) -> Pile:
    """Three boxes that meet in free space."""
    things = [
        Thing(box(unit, unit), (0.0, 0.0, 0.1), (unit * (0.5 + drift), 0.1 * unit, 3.0)),
        Thing(box(unit, 0.5 * unit), (1.05 * unit, 0.2 * unit, 0.3), (unit * (drift - 0.8), -0.2 * unit, 1.0)),
        Thing(box(unit, unit), (0.5 * unit, 1.15 * unit, 0.0), (unit * drift, -unit, 0.0)),
    ]
    mass = np.array([1.0, 2.0, 0.5])
    return Pile(World(things), mass, mass * [1 / 6, 1.25 / 12, 1 / 6] * unit**2, (0.0, 0.0), e, mu)


def momenta(pile: Pile) -> np.ndarray:
    """Momentum and angular momentum about the origin."""
    n = pile.n
    p = pile.v[:n] / np.stack((pile.im, pile.im, pile.ii), axis=1)[:n]
    turning = (pile.pose[:n, 0] * p[:, 1] - pile.pose[:n, 1] * p[:, 0] + p[:, 2]).sum()
    return np.array([p[:, 0].sum(), p[:, 1].sum(), turning])


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize(("e", "mu"), [(0.0, 0.5), (0.5, 0.5), (0.9, 0.2), (1.0, 0.0)])
def test_free_island_keeps_momentum_and_angular_momentum(e: float, mu: float, unit: float) -> None:
    pile = clump(e, mu, unit)
    before, energy = momenta(pile), pile.kinetic()
    pile.run(200, 0.01)
    assert np.abs((momenta(pile) - before) / [unit, unit, unit**2]).max() <= 1e-12
    assert pile.kinetic() < energy if e < 1.0 else pile.kinetic() == pytest.approx(energy, rel=1e-12)
    check(pile, energy)


def test_galilean_observers_agree() -> None:
    at_rest, drifting = clump(0.3, 0.4, 1.0).run(100, 0.01), clump(0.3, 0.4, 1.0, 5.0).run(100, 0.01)
    assert np.abs(drifting.v - at_rest.v - [5, 0, 0]).max() <= 1e-10
    assert np.abs(drifting.pose - at_rest.pose - [5, 0, 0]).max() <= 1e-10


def test_mirror_images_stay_mirror_images() -> None:
    """Two boxes with a third laid across them, in a state that settles.

    Until it slides and stops by round-off; there some solves are cut short, and sweeps know which contact comes first.
    """
    mass = np.ones(3)

    def trestle(sign: float) -> Pile:
        things = [
            Thing(box(1, 1), (-1.0 * sign, 0.5, 0.0)), Thing(box(1, 1), (1.2 * sign, 0.5, 0.0)),
            Thing(box(4, 0.5), (0.3 * sign, 1.3, 0.0), (0.4 * sign, 0.0, -0.3 * sign)),
        ]  # fmt: skip
        return Pile(World(things, floor(1.0)), mass, [1 / 6, 1 / 6, 16.25 / 12], (0.0, -G), 0.2, 0.4)

    left, right = trestle(1.0), trestle(-1.0)
    for steps, tolerance in ((7, 1e-14), (53, 1e-4)):
        left.run(steps, 1 / 60)
        right.run(steps, 1 / 60)
        assert np.abs(left.pose * [-1, 1, -1] - right.pose).max() <= tolerance


def test_steps_converge_to_one_another() -> None:
    """A disk rolling off a box's edge: positions at halved steps approach each other."""

    def end(h: float) -> np.ndarray:
        things = [
            Thing(disk(0.3), (0.2, 1.3, 0.0), (1.0, 0.0, -1.0 / 0.3)), Thing(box(1, 1), (0.0, 0.5, 0.0)),
        ]  # fmt: skip
        pile = Pile(World(things, floor(1.0)), [1.0, 1.0], [0.045, 1 / 6], (0.0, -G), 0.0, 0.5)
        return pile.run(round(0.4 / h), h).pose[0, :2]

    ends = [end(h) for h in (8e-3, 4e-3, 2e-3, 1e-3, 5e-4)]
    steps = [float(np.hypot(*(b - a))) for a, b in pairwise(ends)]
    assert steps[-1] <= 1e-3
    assert steps[-1] < steps[0]


def test_memory_finds_what_was_remembered() -> None:
    """Against a dictionary, with keys that collide."""
    rng = np.random.default_rng(2)
    keys, forces, count = np.full(256, -1), rows(Force, 256), row(Count)
    known: dict[int, tuple[float, float]] = {}
    for _ in range(300):
        key = int(rng.integers(0, 60)) * 1024
        known[key] = (float(rng.random()), float(rng.integers(1, 4)))
        force = forces[row_for(keys, count, key)]
        force.normal, force.stamp = known[key]
    assert count.remembered == len(known)
    assert all(forces[find(keys, key)].normal == value for key, (value, _) in known.items())
    assert find(keys, 7) < 0
    kept, kept_forces = np.full(128, -1), rows(Force, 128)
    copy_recent(keys, forces, count, kept, kept_forces, 2.0)
    assert {int(key) for key in kept[kept >= 0]} == {key for key, (_, stamp) in known.items() if stamp >= 2.0}
    assert all(kept_forces[find(kept, key)].normal == value for key, (value, stamp) in known.items() if stamp >= 2.0)
