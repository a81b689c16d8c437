"""What handlers read of arbiters and set in them: impulses, surface velocities, velocities of the bodies."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from scenes.scene import add_disk

from .test_idioms import DT, Make, both, box_on, ground, run


def test_total_impulse_of_a_stack_in_post_solve_is_the_weight_it_carries() -> None:
    """Also in `each_arbiter` after the step; of boxes with a frame off their centre of mass, too."""
    space, floor = ground()
    boxes = [box_on(space, 0.0, 0.6 + k) for k in range(3)]
    boxes[1].center_of_gravity = (0.0, 0.1)
    carried: dict[frozenset[pymunk.Body], float] = {}

    def note(arbiter: pymunk.Arbiter, space: object = None, data: object = None) -> None:
        carried[frozenset(arbiter.bodies)] = arbiter.total_impulse.length / DT

    space.on_collision(post_solve=note)
    stepper = ep.EECA(space)
    run(stepper, 60)
    weight = {frozenset(pair): 30.0 - 10.0 * k for k, pair in enumerate(pairwise((floor.body, *boxes)))}
    assert carried == pytest.approx(weight, rel=1e-4)
    carried.clear()
    boxes[0].each_arbiter(note)
    assert carried == pytest.approx({pair: weight[pair] for pair in weight if boxes[0] in pair}, rel=1e-4)


@both
def test_total_impulse_and_energy_of_an_impact(make: Make) -> None:
    """(1 + e) m v along the normal, mu times that across it."""
    space = pymunk.Space()
    floor = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
    ball = add_disk(space, (0.0, 0.74), 0.5, 2.0, (1.0, -3.0))
    space.add(floor)
    for shape in space.shapes:
        shape.elasticity, shape.friction = math.sqrt(0.5), math.sqrt(0.2)
    found: list[tuple[float, ...]] = []
    space.on_collision(post_solve=lambda arbiter, *_: found.append((*arbiter.total_impulse, arbiter.total_ke)))
    run(make(space), 10)
    ((x, y, lost),) = found
    assert (abs(x), abs(y)) == pytest.approx((2.0 / 3.0, 9.0), rel=1e-9)  # it sticks: m u/3
    assert lost > 0.5 * 2.0 * 9.0 * (1.0 - 0.25)
    assert ball.velocity == pytest.approx((2.0 / 3.0, 1.5), rel=1e-9)


def test_handlers_see_the_velocities_of_the_start_of_the_step() -> None:
    """As under pymunk, which accelerates after it has called them."""
    seen = []
    for make in (ep.Native, ep.EECA):
        space, _ = ground()
        box = box_on(space, 0.0, 0.601)
        box.velocity = (1.0, -0.2)
        speeds: list[float] = []
        space.on_collision(begin=lambda *_, b=box, to=speeds: to.extend((*b.velocity, b.angular_velocity)))
        make(space).step(DT)
        seen.append(speeds)
    assert seen[1] == pytest.approx([1.0, -0.2, 0.0], abs=1e-12)
    assert seen[0] == pytest.approx(seen[1], abs=1e-12)


@pytest.mark.parametrize("order", [(1, 2), (2, 1)])
def test_surface_velocity_set_in_pre_solve_moves_what_lies_there_as_native_s(order: tuple[int, int]) -> None:
    """By mu g t until it goes along; the other way round for shapes in the other order."""
    found = []
    for make in (ep.Native, ep.EECA):
        space, floor = ground()
        box = box_on(space, 0.0)
        floor.collision_type, next(iter(box.shapes)).collision_type = 1, 2

        def belt(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
            arbiter.surface_velocity = (5.0, 0.0)

        space.on_collision(*order, pre_solve=belt)
        stepper, speeds = make(space), []
        for _ in range(3):
            run(stepper, 30)
            speeds.append(box.velocity.x)
        found.append(speeds)
    assert np.abs(found[1]) == pytest.approx([0.49 * 10.0 * 0.5, 0.49 * 10.0, 5.0], rel=1e-9)
    assert found[1] == pytest.approx(found[0], rel=1e-9)


def test_surface_velocity_of_shapes_is_felt_once_also_with_handlers() -> None:
    """What pymunk makes of it along the contact, also at a slant, is not taken for one that was set."""
    speeds = []
    for handled in (False, True):
        space, floor = ground()
        floor.surface_velocity = (1.0, 2.0)
        floor.unsafe_set_endpoints((-50.0, -5.0), (50.0, 5.0))  # type: ignore[attr-defined]
        box = box_on(space, 0.0, 0.7)
        if handled:
            space.on_collision(pre_solve=lambda *_: None)
        run(ep.EECA(space), 60)
        speeds.append((*box.velocity, box.angular_velocity))
    assert speeds[0] == pytest.approx(speeds[1], abs=1e-9)
