"""Sorting and copying in place, against numpy."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.rows.inplace import copy, sort


@pytest.mark.parametrize("n", [0, 1, 2, 3, 7, 64, 1000])
def test_the_first_numbers_are_sorted_and_no_others(n: int) -> None:
    random = np.random.default_rng(n)
    for most in (2, 10, 1 << 40):
        numbers = random.integers(-most, most, n + 5)
        sorted_ones = numbers.copy()
        sort(sorted_ones, n)
        assert (sorted_ones[:n] == np.sort(numbers[:n])).all()
        assert (sorted_ones[n:] == numbers[n:]).all()


def test_tables_are_copied() -> None:
    to, table = np.zeros((4, 3)), np.arange(12.0).reshape(4, 3)
    copy(to, table)
    assert (to == table).all()
