"""What stands, stands still; what cannot stand falls; forces at rest are weights."""

from __future__ import annotations

import pytest

import eeca_pymunk as ep
from comparisons.hard_cases import Case, piles, reports
from comparisons.hard_cases.case import heavy, matter
from scenes.scene import add_box, add_walls

from .running import check, of


@pytest.mark.parametrize("one", of(piles, reports), ids=lambda one: one.name)
def test_case(one: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    check(one, monkeypatch)


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
