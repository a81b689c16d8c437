"""Arrays side by side in one piece of memory."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.arrays import side_by_side


@pytest.mark.parametrize("rows", [0, 1, 7, 1000, 40_000])
def test_arrays_side_by_side_are_zeros_of_their_own(rows: int) -> None:
    wanted = (((rows, 16), np.float64), ((rows,), np.int32), ((rows + 3,), np.uint8), ((rows, 4), np.int64))
    found = side_by_side(*wanted)
    for (shape, dtype), array in zip(wanted, found, strict=True):
        assert array.shape == shape
        assert array.dtype == dtype
        assert array.flags.c_contiguous
        assert array.flags.writeable
        assert not array.any()
        assert array.size == 0 or array.ctypes.data % 128 == 0
    for k, array in enumerate(found):
        array[...] = k + 1
    assert all((array == k + 1).all() for k, array in enumerate(found))
