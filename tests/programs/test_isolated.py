"""Bodies that only act on each other keep their momenta, in scenes of seeds (`isolated.py`)."""

from __future__ import annotations

import pytest

from eeca_pymunk.compiled.kernels import prepare

from .isolated import Isolated

pytestmark = pytest.mark.skipif(not prepare().entries, reason="kernels as plain Python")


@pytest.mark.parametrize("start", range(0, 60, 10))
def test_what_only_acts_on_itself_keeps_its_momenta(start: int) -> None:
    for seed in range(start, start + 10):
        Isolated(seed).play()


@pytest.mark.parametrize("seed", [2729, 3533])
def test_intervals_are_short_enough_that_contacts_find_the_points_at_which_they_push(seed: int) -> None:
    """Light bodies on pivots, that others hit, turn by radians: within a long interval the arms of contacts do not
    become those of its middle, and the angular momentum was off by up to 2e-6, in steps that had converged."""
    Isolated(seed).play()


def test_what_joints_take_by_round_off_is_lost() -> None:
    """A limit is met just before the end of a step, and joints hold places to round-off within that short time: the
    ledger had called a millionth of the energy, which they took, work from outside."""
    Isolated(5871).play(1)
