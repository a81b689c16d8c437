"""Candidates of a step: every pair that can meet, while lists are made anew rarely."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
import scenes
from eeca_pymunk.closures.motion import DiskMotion, Disks, Start
from eeca_pymunk.compiled import table_of
from eeca_pymunk.compiled.records import columns, put
from eeca_pymunk.model.scene import scene_of
from eeca_pymunk.space.world import World
from scenes.scene import add_disk, add_walls

DT = 1e-3


def start_of(disks: Disks) -> Start:
    """The start of a step of length DT without forces."""
    BODY = disks.world.BODY
    still = np.zeros((len(BODY), 2))
    return Start(DT, columns(BODY, "x", "y"), columns(BODY, "vx", "vy"), still, BODY["inv_mass"].copy())


@pytest.mark.parametrize("count", [10, 30, 400])  # all in all lists, then with margins
@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_every_pair_that_can_meet_is_listed(count: int, unit: float) -> None:
    rng = np.random.default_rng(7)
    space = pymunk.Space()
    radius = unit * rng.uniform(0.005, 0.02, count)
    x = unit * rng.uniform(0, 1, (count, 2))
    v = unit * rng.normal(size=(count, 2)) * rng.choice([0.1, 10.0], (count, 1))  # slow ones and a few fast ones
    for xi, vi, ri in zip(x, v, radius, strict=True):
        add_disk(space, tuple(xi), ri, velocity=tuple(vi))
    add_walls(space, [((unit, -unit), (unit, 2 * unit))])
    world = World(space)
    world.load()
    disks = Disks(world, "test", lambda _, start: DiskMotion(start.free_velocity, start.free_displacement))
    meetings = 0
    for _ in range(60):
        put(world.BODY[:count], x, "x", "y")
        pairs, before, _ = disks.near(start_of(disks), DT * columns(world.BODY, "vx", "vy"))
        listed = {(int(a), int(b)) for a, b in pairs.shapes}
        assert len(listed) == len(pairs)
        # Closest approach of the straight paths within the step.
        d, move = x[None] - x[:, None], DT * (v[None] - v[:, None])
        s = np.clip(-(d * move).sum(axis=2) / np.maximum((move**2).sum(axis=2), 1e-300), 0.0, 1.0)
        meets = np.linalg.norm(d + s[..., None] * move, axis=2) <= radius[:, None] + radius
        assert {(int(i), int(j)) for i, j in np.argwhere(np.triu(meets, 1))} <= listed
        both = pairs.shapes[~pairs.walls]
        apart = np.linalg.norm(x[both[:, 0]] - x[both[:, 1]], axis=1) - radius[both[:, 0]] - radius[both[:, 1]]
        np.testing.assert_allclose(before.gap[~pairs.walls], apart, atol=1e-14 * unit)
        at_wall = np.abs(np.stack((x[:, 0], x[:, 0] + DT * v[:, 0])) - unit).min(axis=0) <= radius
        for i in np.flatnonzero(at_wall & (np.abs(x[:, 1] - 0.5 * unit) < 1.4 * unit)):
            assert (int(i), count) in listed
        meetings += int(at_wall.sum()) + int(np.triu(meets, 1).sum())
        x = x + DT * v
    assert meetings >= 3


@pytest.mark.parametrize("wind", [0.0, 1.0])
def test_lists_last_for_some_steps(wind: float) -> None:
    space = pymunk.Space()
    for i in range(100):
        add_disk(space, (i % 10, i // 10), 0.1, velocity=(wind, 0.0))
    stepper = ep.EECA(space, ep.Dashpot(1e6, 1.0))
    method = stepper._method
    assert isinstance(method, Disks)
    for _ in range(50):
        stepper.step(DT)
    assert scene_of(method.table).GRID.renewals <= 100 * 50 * wind * 0.1


@pytest.mark.parametrize("closure", [ep.Midstep(), ep.Dashpot(1e6, 1.0)], ids=["midstep", "dashpot"])
def test_one_disk_of_absurd_speed_among_many(closure: ep.Closure) -> None:
    space = pymunk.Space()
    for i in range(300):
        add_disk(space, (0.3 * (i % 20), 0.3 * (i // 20)), 0.1)
    bullet = add_disk(space, (-1.0, 0.15), 0.01, velocity=(1e9, 0.0))
    ep.EECA(space, closure).step(1e-6)
    assert bullet.velocity.length > 0.0


def test_a_pool_that_is_too_small_grows() -> None:
    scene = scenes.build("gas", count=100, packing=0.3, seed=2)
    stepper, energy = ep.EECA(scene.space, ep.Dashpot(1e6, 200.0)), ep.measure(scene.space).energy
    method = stepper._method
    assert isinstance(method, Disks)
    near = scene_of(method.table)
    room = int(near.GRID.pool_end)
    method.table = table_of(near._replace(POOL=near.POOL[:room].copy(), FLAG=near.FLAG[:room].copy()))
    for _ in range(100):
        stepper.step(2e-3)
    assert len(scene_of(method.table).POOL) > room
    assert ep.measure(scene.space).energy == pytest.approx(energy, rel=1e-12)
