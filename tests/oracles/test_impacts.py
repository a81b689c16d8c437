"""Impacts with friction and of bodies that turn; invariances of scenes with friction."""

from __future__ import annotations

import pytest

from comparisons.hard_cases import Case, invariances, oblique
from comparisons.hard_cases.case import DT, G, heavy, matter
from scenes.scene import add_disk, add_walls

from .audit import Audit
from .running import check, of


@pytest.mark.parametrize("one", of(oblique, invariances), ids=lambda one: one.name)
def test_case(one: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    check(one, monkeypatch)


@pytest.mark.parametrize("e", [0.0, 0.5, 0.8, 0.9])
def test_all_the_energy_of_a_ball_that_comes_to_rest_is_booked(e: float) -> None:
    space = heavy()
    add_walls(space, [((-9.0, 0.0), (9.0, 0.0))])
    ball = add_disk(space, (0.0, 1.5), 0.5)
    matter(space, 0.0, e)
    stepper = Audit(space)
    for _ in range(600):
        stepper.step(DT)
    assert ball.position.y == pytest.approx(0.5, abs=1e-9)
    assert stepper.total["restitution"] == pytest.approx(G, rel=1e-9)
    assert stepper.total["change"] == pytest.approx(-G, rel=1e-9)
