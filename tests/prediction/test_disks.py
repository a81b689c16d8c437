"""Forecasts of lone disks that are kept, against the same forecast anew: not a bit may differ."""

from __future__ import annotations

import numpy as np
import pytest

import eeca_pymunk as ep
import scenes
from eeca_pymunk.pairs import margins, setup

from ..crowds import SHORT, box_of, state


def gas(pull: float, seed: int) -> ep.EECA:
    scene = scenes.build("gas", count=30 if SHORT else 200, packing=0.4, seed=seed)
    scene.space.gravity = (0.3 * pull, -pull)
    return ep.EECA(scene.space, sync=False)


@pytest.mark.parametrize("pull", [0.0, 4.0])
@pytest.mark.parametrize("dt", [1e-3, 1e-2])
def test_forecasts_that_are_kept_over_steps_say_what_new_ones_say(dt: float, pull: float) -> None:
    kept, anew = gas(pull, 1), gas(pull, 1)
    impacts = 0
    for _ in range(40 if SHORT else 200):
        if anew._world is not None:
            anew._world.void_predictions()
        impacts += len(kept.step(dt).contacts)
        anew.step(dt)
        np.testing.assert_array_equal(state(kept.space), state(anew.space))
    assert impacts > 10


@pytest.mark.parametrize("pull", [0.0, 4.0])
@pytest.mark.parametrize("sizes", ["equal", "mixed"])
def test_how_often_lists_are_renewed_makes_no_difference(
    monkeypatch: pytest.MonkeyPatch, sizes: str, pull: float
) -> None:  # fmt: skip
    count = 30 if SHORT else 150
    radii = np.full(count, 0.02) if sizes == "equal" else np.random.default_rng(2).uniform(0.005, 0.03, count)
    steppers = []
    for neighbours in (5.0, 40.0):
        monkeypatch.setattr(margins, "NEIGHBOURS", neighbours)
        monkeypatch.setattr(setup, "fill_lists", margins.fill_lists.python)
        space, _ = box_of(radii, 3)
        space.gravity = (0.0, -pull)
        steppers.append(ep.EECA(space, sync=False))
        steppers[-1].step(1e-3)
    for _ in range(6 if SHORT else 30):
        for stepper in steppers:
            stepper.step(2e-2)
        np.testing.assert_array_equal(state(steppers[0].space), state(steppers[1].space))
    leaves = [int(stepper._method.scene.GRID.renewals) for stepper in steppers]
    assert leaves[0] > 1.5 * leaves[1] > 0
