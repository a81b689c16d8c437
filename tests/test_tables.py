"""Tables of arrays: what kernels see of them is what the arrays hold."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from eeca_pymunk.tables import Opener, Table, table_of

from eeca_pymunk.arrays import FloatArray, IntArray, PoolArray
from eeca_pymunk.compiled import compiler, kernel, uncounted


class Some(NamedTuple):
    LINE: IntArray
    SHEET: FloatArray
    BLOCK: FloatArray
    SMALL: PoolArray
    NONE: FloatArray


some_of = Opener(Some)


@uncounted
def add(A: Some, i: int) -> float:
    """Write to one array what the others hold, and read their shapes."""
    A.SHEET[i, 1] += 2.0 * A.LINE[i] + A.SMALL[i]
    return float(A.BLOCK[1, i, 3] + A.BLOCK.shape[0] + 10 * A.BLOCK.shape[1] + 100 * A.BLOCK.shape[2])


@kernel
def total(TABLE: Table) -> float:
    A = some_of(TABLE)
    found = 1000.0 * len(A.NONE) + 1e4 * A.NONE.shape[1] + 1e6 * A.LINE.shape[0]
    VIEW = A.SHEET[1:]
    for i in range(3):
        found += add(A, i) + VIEW[0, 2]
    return found


def made() -> Some:
    return Some(
        np.arange(4), np.arange(12.0).reshape(4, 3), np.arange(24.0).reshape(2, 3, 4), np.arange(5, dtype=np.int32),
        np.zeros((0, 6)),
    )  # fmt: skip


def test_kernels_read_and_write_the_arrays_of_a_table() -> None:
    here, there = made(), made()
    expected = 4e6 + 6e4 + sum(15.0 + 4 * i + 2 + 30 + 400 + 5 for i in range(3))
    assert total(table_of(here)) == expected
    assert (here.SHEET[:3, 1] == there.SHEET[:3, 1] + 3.0 * np.arange(3)).all()
    assert (here.BLOCK == there.BLOCK).all()


@pytest.mark.skipif(compiler() is None, reason="without numba a table is the tuple itself")
@pytest.mark.parametrize(
    ("wrong", "told"),
    [({"SHEET": np.zeros((3, 4)).T}, "C-contiguous"), ({"LINE": np.zeros(4)}, "are"), ({"SHEET": np.zeros(3)}, "are")],
)
def test_what_kernels_would_misread_is_refused(wrong: dict[str, FloatArray], told: str) -> None:
    table_of(made())
    with pytest.raises(TypeError, match=told):
        table_of(made()._replace(**wrong))
