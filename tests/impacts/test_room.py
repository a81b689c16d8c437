"""Steps that want more room than they have: they go on as if they had had it from the start."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.model.scene import Scene
from eeca_pymunk.pairs import setup
from scenes.scene import add_disk, add_walls

from ..crowds import box_of, deepest, positions, reference


def test_forces_are_reset_after_a_step_of_more_impacts_than_there_was_room_for() -> None:
    space = pymunk.Space()
    add_walls(space, [((-1.0, 0.0), (-1.0, 1.0)), ((1.0, 0.0), (1.0, 1.0))])
    disk = add_disk(space, (0.0, 0.5), 0.1, velocity=(100.0, 0.0))
    disk.angular_velocity = 1.0
    disk.force = (1.0, 0.0)
    report = ep.EECA(space, sync=False).step(5.0)
    assert len(report.contacts) > 200
    assert disk.force == (0.0, 0.0)
    assert disk.angle == pytest.approx(5.0, rel=1e-12)


@pytest.mark.parametrize("seed", [2, 3])
def test_lists_that_grow_on_the_way_miss_nobody(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    # Little room is given each time, so that it is wanted again and again.
    def little_more(scene: Scene) -> Scene:
        room = len(scene.POOL) + 40
        return scene._replace(POOL=np.zeros(room, np.int32), FLAG=np.zeros(room, np.uint8))

    monkeypatch.setattr(setup, "_with_larger_pool", little_more)
    space, bodies = box_of(np.full(150, math.sqrt(0.3 / math.pi / 150)), seed)
    stepper = ep.EECA(space, sync=False)
    stepper.step(1e-3)
    loop = stepper._method
    room = int(loop.scene.GRID.pool_end) + 40  # type: ignore[attr-defined]
    pool, flag = loop.scene.POOL[:room].copy(), loop.scene.FLAG[:room].copy()  # type: ignore[attr-defined]
    loop.scene = loop.scene._replace(POOL=pool, FLAG=flag)  # type: ignore[attr-defined]
    exact = reference(bodies)
    exact.run(0.1)
    assert len(stepper.step(0.1).contacts) == exact.events
    assert len(loop.scene.POOL) > room  # type: ignore[attr-defined]
    assert deepest(bodies, 1.0) < 1e-9
    assert np.median(np.abs(positions(bodies) - exact.position)) < 1e-9


def test_pairs_that_were_given_up_are_met_again_in_the_next_step() -> None:
    # A kinematic body drives a disk into a wall: each step tries anew, whether the stepper is new or not.
    space = pymunk.Space()
    add_disk(space, (-1.0, 0.0), 0.5)
    add_walls(space, [((-0.5, -3.0), (-0.5, 3.0))])
    driver = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    driver.position, driver.velocity = (-2.1, 0.0), (1.0, 0.0)
    shape = pymunk.Circle(driver, 0.5)
    shape.elasticity = 1.0
    space.add(driver, shape)
    stepper = ep.EECA(space, sync=False)
    impacts = [len(stepper.step(0.1).contacts) for _ in range(5)]
    assert impacts[2:] == [impacts[2]] * 3
    assert impacts[2] > 0


@pytest.mark.parametrize("jointed", [False, True])
def test_an_impact_of_many_shapes_reports_all_its_impulses(jointed: bool) -> None:
    """A row of 100 disks of one body lands flat: the impulses are its change of momentum."""
    space = pymunk.Space()
    floor = pymunk.Segment(space.static_body, (-60, 0), (60, 0), 0.5)
    floor.elasticity = 1.0
    body = pymunk.Body(2.0, 1e3)
    body.position, body.velocity = (0.0, 2.0), (0.0, -3.0)
    space.add(floor, body)
    for k in range(100):
        disk = pymunk.Circle(body, 0.3, (k - 49.5, 0))
        disk.elasticity = 1.0
        space.add(disk)
    if jointed:
        bob = pymunk.Body(1.0, 1.0)
        bob.position, bob.velocity = (0.0, 9.0), (0.0, -3.0)
        space.add(bob, pymunk.Circle(bob, 0.1), pymunk.PinJoint(body, bob))
    stepper, impulse, contacts = ep.EECA(space), 0.0, 0
    for _ in range(25):
        report = stepper.step(0.02)
        impulse, contacts = impulse + report.impulse.sum(), contacts + len(report.impulse)
    moved = 2.0 * (body.velocity.y + 3.0) + (bob.velocity.y + 3.0 if jointed else 0.0)
    assert contacts == 100
    assert impulse == pytest.approx(moved, rel=1e-9)
    assert moved > 11.0
