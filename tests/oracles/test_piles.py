"""What stands, stands still; what cannot stand falls; forces at rest are weights."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep
from comparisons.hard_cases import Case, piles, reports
from comparisons.hard_cases.case import heavy, matter
from scenes.scene import add_box, add_disk, add_walls

from .running import check, of


@pytest.mark.parametrize("one", of(piles, reports), ids=lambda one: one.name)
def test_case(one: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    check(one, monkeypatch)


@pytest.mark.parametrize(("between", "below"), [(1.0005, 1.0005), (0.9995, 1.1), (1.1, 0.9995)])
def test_three_disks_stand_from_their_frictions_on(between: float, below: float) -> None:
    """tan 15° between the disks, a third of that at the floor, to a part in two thousand."""
    space, mu = heavy(), 0.2679491924 * between
    floor = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
    space.add(floor)
    for where in ((-0.5, 0.5), (0.5, 0.5), (0.0, 0.5 + math.sqrt(0.75))):
        add_disk(space, where, 0.5)
    matter(space, mu)
    floor.friction = 0.0893163975 * below / math.sqrt(mu)
    moved = piles.moved(space, ep.EECA, 180)
    assert moved <= 1e-9 if min(between, below) > 1.0 else moved > 1e-3


@pytest.mark.parametrize("falls", [False, True])
@pytest.mark.parametrize(("bricks", "reach"), [(1, 0.5), (2, 0.75), (3, 0.916667), (4, 1.041667)])
def test_overhang_of_fewer_bricks(bricks: int, reach: float, falls: bool) -> None:
    space, factor, x = heavy(), 1.001 if falls else 0.999, 0.0
    add_walls(space, [((-3.0, 0.0), (0.0, 0.0))])
    for level in range(bricks):
        x += factor * 0.5 / (bricks - level)
        add_box(space, (x - 0.5, 0.1 + 0.2 * level), 1.0, 0.2)
    assert x == pytest.approx(factor * reach, abs=1e-6)
    matter(space, 0.8)
    assert (piles.moved(space, ep.EECA, 180) > 1e-3) == falls
