"""Kinds of failures that compositions with thrown, flat and bridged bodies found, and some more of these."""

from __future__ import annotations

import pytest

from .rare import KINDS, Rare
from .seeds import play


@pytest.mark.parametrize("first", range(0, 60, 20))
def test_random_compositions_with_rare_bodies_keep_the_laws(first: int) -> None:
    assert play(Rare, range(first, first + 20), 40) > 0


def test_each_kind_is_drawn() -> None:
    assert {*KINDS, "swings"} <= set().union(*(Rare(seed, True).has for seed in range(20)))


@pytest.mark.parametrize(("seed", "steps"), [(68000010, 32), (68000025, 62)])
def test_corrections_do_not_turn_what_is_flat_through_a_wall(seed: int, steps: int) -> None:
    """An ellipse of 56 or 87 corners below a body 2600 times heavier, on a wall without width: what lifted the corner
    that was deepest turned the next one deeper, to and fro, until the ellipse was through."""
    Rare(seed).play(steps)


def test_corrections_of_what_is_joined_do_not_turn_what_is_flat_through_a_wall() -> None:
    Rare(69000257, True).play(91)


def test_what_is_flat_does_not_rock_through_a_wall() -> None:
    """An ellipse of 97 corners, whose rocking grew as it sank, by a tenth of the way through in each interval."""
    Rare(68010118).play(45)


def test_linear_rows_do_not_pass_limits_of_joints() -> None:
    """A slide joint that had a little play was left .02 of its length beyond its limit by linear rows."""
    Rare(69010055, True).play(120)
