"""Names of numpy's array types, and operations on rows that numpy lacks."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.intp]
BoolArray: TypeAlias = npt.NDArray[np.bool_]
PoolArray: TypeAlias = npt.NDArray[np.int32]
FlagArray: TypeAlias = npt.NDArray[np.uint8]


def put_rows(array: FloatArray, rows: IntArray, values: FloatArray) -> None:
    """array[rows] = values for arrays (N, d) and (m, d), a row as one item: numpy's own way takes several times as
    long, as `array[rows]` does beside `array.take(rows, axis=0)`."""
    row = np.dtype((np.void, array.shape[1] * array.itemsize))
    array.view(row)[:, 0][rows] = np.ascontiguousarray(values).view(row)[:, 0]


def rotated(vectors: FloatArray, angle: FloatArray) -> FloatArray:
    """(..., 2) vectors turned by angles (...)."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack((c * x - s * y, s * x + c * y), axis=-1)
