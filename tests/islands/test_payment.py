"""What pays for lifting overlapping bodies: a wall that moves, where it drives into others."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from eeca_pymunk.compiled.kernels import prepare
from eeca_pymunk.compiled.records import kind_of, zeros
from eeca_pymunk.islands import payment
from eeca_pymunk.model.contacts import Row
from tests.programs.varied import Varied


@pytest.mark.parametrize(
    ("gap", "impulse", "rate", "drives"),
    [(-0.2, 0.0, 1.0, False), (-0.2, 0.0, -1.0, True), (-0.2, 0.0, 0.0, True), (-0.2, 0.5, 1.0, True),
     (-0.05, 0.5, -1.0, False)],
)  # fmt: skip
def test_walls_drive_into_what_does_not_part_by_itself(
    monkeypatch: pytest.MonkeyPatch, gap: float, impulse: float, rate: float, drives: bool
) -> None:
    """A body 1 without mobility that moves, on a body 0 in its way, deeper than the 0.1 that an interval allows or not
    as deep."""
    for name, value in (("moves_itself", True), ("shapes_of", (0, 1)), ("depth_limit", 0.1)):
        monkeypatch.setattr(payment, name, lambda *_, value=value: value)
    rows, velocities = zeros(1, kind_of(Row)), np.zeros((2, 3))
    rows[0].b, rows[0].ny, rows[0].gap = 1, -1.0, gap
    velocities[0, 1] = rate
    isle = cast(Any, SimpleNamespace(WHO=(0, 1)))
    pushes = np.array([[impulse, 0.0]])
    assert payment.how_deep(cast(Any, None), isle, rows, pushes, velocities, 1, 1) == (True, drives)


@pytest.mark.skipif(not prepare().entries, reason="kernels as plain Python")
def test_walls_do_no_work_on_what_joints_pull_out_of_them() -> None:
    """A disk strikes a wall that turns while a rod pulls it back, and parts from it without an impulse: within the
    step it was lifted out, at the cost of 4e-5 of the energy, by the wall."""
    Varied(50000873, True).play(116)
