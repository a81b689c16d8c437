"""Which contacts take part in a step: touching ones, those the flight closes, those the impulses close."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from scenes.scene import add_disk, add_walls

from ..steppers import EECAS, Make

every = pytest.mark.parametrize("make", EECAS.values(), ids=EECAS.keys())


def test_line_of_touching_disks_is_one_simultaneous_impact() -> None:
    # Nine disks at rest touch in a line: the tenth meets their total mass, v' = (1 - 9) / (1 + 9), the others 2 / 10.
    space = pymunk.Space()
    bodies = [add_disk(space, (0.2 * i, 0.0), 0.1, velocity=(1.0 if i == 0 else 0.0, 0.0)) for i in range(10)]
    report = ep.EECA(space).step(1e-3)
    assert len(report.contacts) == 9
    np.testing.assert_allclose([b.velocity.x for b in bodies], [-0.8] + [0.2] * 9, atol=1e-12)


@pytest.mark.parametrize("name", ["midstep", "dashpot_200"])
def test_contacts_that_impulses_close_join_the_step(name: str) -> None:
    # b is hit and would run half a step's way into c, which is nearer than that.
    space = pymunk.Space()
    a, b, c = (add_disk(space, (x, 0.0), 0.1) for x in (0.0, 0.2, 0.4 + 1e-5))
    a.velocity = (1.0, 0.0)
    report = EECAS[name](space).step(1e-3)
    assert len(report.contacts) == 2
    assert c.velocity.x > 0.0
    if np.isinf(report.psi1).all():  # the rigid limit; the dashpot lets shapes overlap a little
        assert c.position.x - b.position.x >= 0.2 - 1e-12
        assert b.position.x - a.position.x >= 0.2 - 1e-12


@every
def test_disk_that_would_pass_a_thin_wall_within_a_step_is_sent_back(make: Make) -> None:
    # At the end of the free flight it is clear of the wall again, on the other side; half-way its centre is behind.
    space = pymunk.Space()
    disk = add_disk(space, (0.0, 0.15), 0.1, velocity=(0.0, -32.0))
    add_walls(space, [((-1.0, 0.0), (1.0, 0.0))])
    make(space).step(0.01)
    assert disk.velocity.y == pytest.approx(32.0)
    assert disk.position.y > 0.0


@every
def test_walls_added_before_disks_make_no_difference(make: Make) -> None:
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    lines = list(zip(corners, corners[1:] + corners[:1], strict=True))
    ends = []
    for walls_first in (True, False):
        space = pymunk.Space()
        if walls_first:
            add_walls(space, lines)
        bodies = [
            add_disk(space, (0.2 + 0.3 * (i % 3), 0.2 + 0.3 * (i // 3)), 0.1, velocity=(np.cos(i), np.sin(3 * i)))
            for i in range(9)
        ]
        if not walls_first:
            add_walls(space, lines)
        stepper, energy = make(space), ep.measure(space).energy
        for _ in range(150):
            stepper.step(2e-3)
        assert ep.measure(space).energy == pytest.approx(energy, rel=1e-12)
        ends.append(np.array([b.position for b in bodies]))
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)


@every
def test_wall_added_first_beside_two_disks_that_meet_in_the_same_step(make: Make) -> None:
    # Sorted by shape the disk-wall pair (a, wall) would come before the disk-disk pair (a, b).
    space = pymunk.Space()
    add_walls(space, [((-2.0, 0.0), (2.0, 0.0))])
    a = add_disk(space, (0.0, 0.1005), 0.1, velocity=(1.0, -1.0))
    b = add_disk(space, (0.2005, 0.1005), 0.1, velocity=(-1.0, -1.0))
    stepper = make(space)
    for _ in range(3):
        stepper.step(1e-3)
    np.testing.assert_allclose((*a.velocity, *b.velocity), (-1.0, 1.0, 1.0, 1.0), atol=1e-2)
